//! Field metadata of `trace.parquet`: the key `ARROW:schema`, where Arrow readers look for what Parquet has no place
//! for.
//!
//! ```text
//! base64 of   FFFFFFFF, length, Message (Flatbuffers)
//!                               └─ Schema ─ fields: name, type, custom_metadata: key, value
//! ```
//!
//! The value is a schema message of the Arrow columnar format, section "Encapsulated message format"; its tables stand
//! in Arrow's `Message.fbs` and `Schema.fbs`. Every cell of a table has 4 bytes here, since none of the values needs
//! more.

use super::signals::{Due, Signal, SlotType};
use base64::prelude::{BASE64_STANDARD, Engine};

/// The key in the file's metadata.
pub const KEY: &str = "ARROW:schema";

/// `MetadataVersion.V5`
const VERSION: u32 = 4;
/// `MessageHeader.Schema`
const SCHEMA: u32 = 1;
/// `Precision.DOUBLE`
const DOUBLE: u32 = 2;

/// What a Flatbuffers table or vector can hold.
#[derive(Clone, Debug)]
enum Value {
    /// A number in place.
    Number(u32),
    Text(String),
    Vector(Vec<Value>),
    /// The fields by number; `None` is the default of the schema.
    Table(Vec<Option<Value>>),
}

/// The value of the key for the columns of a trace.
pub fn value(signals: &[Signal<'_>]) -> String {
    let schema = Value::Table(vec![None, Some(Value::Vector(signals.iter().map(field).collect()))]);
    BASE64_STANDARD.encode(message(&Value::Table(vec![
        Some(Value::Number(VERSION)),
        Some(Value::Number(SCHEMA)),
        Some(schema),
    ])))
}

fn field(signal: &Signal<'_>) -> Value {
    let (kind, attributes) = match signal.slot_type {
        SlotType::Real => (3, vec![Some(Value::Number(DOUBLE))]),
        SlotType::Integer => (2, vec![Some(Value::Number(32)), Some(Value::Number(1))]),
        SlotType::Boolean => (6, Vec::new()),
    };
    let text = |text: &str| Some(Value::Text(text.to_owned()));
    let fact = |(key, value): (&str, String)| Value::Table(vec![text(key), Some(Value::Text(value))]);
    Value::Table(vec![
        text(signal.name),
        // Whether it can be empty.
        (signal.due != Due::ALWAYS).then_some(Value::Number(1)),
        Some(Value::Number(kind)),
        Some(Value::Table(attributes)),
        None,
        Some(Value::Vector(Vec::new())),
        Some(Value::Vector(signal.facts().into_iter().map(fact).collect())),
    ])
}

/// A message with its frame, in whole units of 8 bytes.
fn message(root: &Value) -> Vec<u8> {
    let mut buffer = Buffer(Vec::new());
    buffer.cells(&[root]);
    let Buffer(mut bytes) = buffer;
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    let length = u32::try_from(bytes.len()).unwrap_or_else(|_| unreachable!("a schema has less than 4 GB"));
    [&[0xff; 4], &length.to_le_bytes(), bytes.as_slice()].concat()
}

/// Flatbuffers from front to back: what holds something comes before what it holds, as offsets are unsigned.
struct Buffer(Vec<u8>);

impl Buffer {
    fn add(&mut self, number: usize) {
        // An offset within less than 4 GB, as `message` checks.
        self.0.extend((number as u32).to_le_bytes());
    }

    /// Adds a row of cells, then the values to which the cells that are not numbers point.
    fn cells(&mut self, values: &[&Value]) {
        let first = self.0.len();
        for value in values {
            self.add(if let Value::Number(number) = value { *number as usize } else { 0 });
        }
        for (at, value) in (first..).step_by(4).zip(values) {
            if !matches!(value, Value::Number(_)) {
                let offset = (self.referenced(value) - at) as u32;
                self.0[at..at + 4].copy_from_slice(&offset.to_le_bytes());
            }
        }
    }

    /// Adds the value that a cell's offset points to, and returns where it begins.
    fn referenced(&mut self, value: &Value) -> usize {
        let begin = self.0.len();
        match value {
            Value::Number(_) => unreachable!("a number stands in its cell"),
            Value::Text(text) => {
                self.add(text.len());
                self.0.extend(text.bytes().chain([0]));
                self.align();
            }
            Value::Vector(items) => {
                self.add(items.len());
                self.cells(&items.iter().collect::<Vec<_>>());
            }
            Value::Table(fields) => return self.table(fields),
        }
        begin
    }

    /// Adds a table behind its list of places: their size, the table's, and for each field where it stands or 0.
    fn table(&mut self, fields: &[Option<Value>]) -> usize {
        let places = self.0.len();
        let present: Vec<_> = fields.iter().flatten().collect();
        let sizes = [4 + 2 * fields.len(), 4 + 4 * present.len()];
        let mut free = (4..).step_by(4);
        let stands = fields.iter().map(|field| if field.is_some() { free.next().unwrap_or_default() } else { 0 });
        for number in sizes.into_iter().chain(stands) {
            self.0.extend((number as u16).to_le_bytes());
        }
        self.align();
        let begin = self.0.len();
        self.add(begin - places);
        self.cells(&present);
        begin
    }

    fn align(&mut self) {
        self.0.resize(self.0.len().next_multiple_of(4), 0);
    }
}

#[cfg(test)]
mod tests {
    use super::super::signals::tests::signal;
    use super::*;

    #[test]
    fn only_a_column_that_is_not_always_due_is_nullable() {
        let nullable = |every, from_tick| {
            let due = Due { every, from_tick };
            let Value::Table(fields) = field(&Signal { due, ..signal("quad.x", SlotType::Real) }) else { panic!() };
            fields[1].clone()
        };
        assert!(nullable(1, 0).is_none());
        assert!(matches!(nullable(2, 0), Some(Value::Number(1))));
        assert!(matches!(nullable(1, 5), Some(Value::Number(1))));
    }

    #[test]
    fn a_table_is_laid_out_as_flatbuffers_says() {
        let root = Value::Table(vec![Some(Value::Number(7)), None, Some(Value::Text("ab".to_owned()))]);
        let bytes = message(&root);
        #[rustfmt::skip]
        let expected = [
            0xff, 0xff, 0xff, 0xff, 40, 0, 0, 0, // the frame: what follows has 40 bytes
            16, 0, 0, 0,                         // the root lies 16 bytes on
            10, 0, 12, 0, 4, 0, 0, 0, 8, 0, 0, 0, // places: 10 bytes for a table of 12; field 0 at 4, field 2 at 8; filled up
            12, 0, 0, 0,                         // the table: its places stand 12 bytes before
            7, 0, 0, 0,                          // field 0
            4, 0, 0, 0,                          // field 2 lies 4 bytes on
            2, 0, 0, 0, b'a', b'b', 0, 0,        // a text of 2 bytes, its closing zero, filled up
            0, 0, 0, 0,
        ];
        assert_eq!(bytes, expected);
    }
}
