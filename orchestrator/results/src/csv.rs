//! `trace.csv`: rows of slots as text, fast enough to record everything.
//!
//! One buffer is filled and written in large pieces. Texts of numbers are remembered: what stands still costs a copy,
//! and so does an input that shows what an output showed before. The file is whole after each piece: every piece ends
//! with a row.

use super::TraceError;
use super::run_folder::PartialFile;
use super::run_record::RunState;
use super::signals::{Due, DueRows, SlotType};
use super::sink::Sink;
use std::io::{self, Write};
use unit::time::seconds;

/// Bytes of the longest number.
const LONGEST: usize = 24;
/// The buffer is written when it holds this much.
const PIECE: usize = 256 * 1024;

/// One column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsvColumn {
    /// The name in the header.
    pub name: String,
    /// The type of its slots.
    pub slot_type: SlotType,
    /// When it has a value.
    pub due: Due,
}

/// Turns rows into text.
#[derive(Debug)]
pub struct CsvWriter<W: Write> {
    out: W,
    step_ns: u64,
    /// The type of the slots of each column, and when it has a value.
    columns: Vec<(SlotType, Due)>,
    rows: DueRows,
    texts: Texts,
    /// Long enough for a piece and a row; what is not yet written ends at `filled`.
    buffer: Vec<u8>,
    filled: usize,
}

impl<W: Write> CsvWriter<W> {
    /// Begins with the header line, which is written with the first piece.
    pub fn new(out: W, step_ns: u64, columns: &[CsvColumn]) -> Self {
        let mut header = String::from("time");
        for column in columns {
            header.push(',');
            header.push_str(&quoted(&column.name));
        }
        header.push('\n');
        let mut buffer = header.into_bytes();
        let filled = buffer.len();
        let widest_row = (columns.len() + 1) * (LONGEST + 1) + 1;
        buffer.resize(filled.max(PIECE) + widest_row, 0);
        let rows = DueRows::new(columns.iter().map(|column| column.due));
        let texts = Texts::new(4 * columns.len());
        let columns = columns.iter().map(|column| (column.slot_type, column.due)).collect();
        Self { out, step_ns, columns, rows, texts, buffer, filled }
    }

    /// Adds the row of a tick, if a column is due: one slot for each column, the bits of a Real, else the number widened.
    ///
    /// # Errors
    /// The error of the writer.
    pub fn row(&mut self, tick: u64, slots: &[u64]) -> io::Result<()> {
        assert_eq!(slots.len(), self.columns.len(), "a row has one slot for each column");
        if !self.rows.contain(tick) {
            return Ok(());
        }
        let Self { texts, buffer, filled, .. } = self;
        let mut place = Place { buffer, filled: *filled };
        place.add(real_text(&mut zmij::Buffer::new(), seconds(tick, self.step_ns)));
        for (&(slot_type, due), &slot) in self.columns.iter().zip(slots) {
            place.add_byte(b',');
            if due.contains(tick) {
                texts.append(number(slot_type, slot), &mut place);
            }
        }
        place.add_byte(b'\n');
        *filled = place.filled;
        if self.filled >= PIECE { self.flush() } else { Ok(()) }
    }

    /// Writes all buffered rows; the file then ends with a complete row.
    ///
    /// # Errors
    /// The error of the writer.
    pub fn flush(&mut self) -> io::Result<()> {
        let written = self.out.write_all(&self.buffer[..self.filled]);
        self.filled = 0;
        written
    }

    /// Writes all buffered rows and returns the writer.
    ///
    /// # Errors
    /// The error of the writer.
    pub fn into_inner(mut self) -> Result<W, io::Error> {
        self.flush()?;
        Ok(self.out)
    }
}

/// A slot as a number; those of Integers and Booleans read as shortest decimals of Reals do.
fn number(slot_type: SlotType, slot: u64) -> f64 {
    match slot_type {
        SlotType::Real => f64::from_bits(slot),
        SlotType::Integer => f64::from(slot as u32 as i32),
        SlotType::Boolean => f64::from(u8::from(slot != 0)),
    }
}

/// Where the next text goes.
struct Place<'a> {
    buffer: &'a mut [u8],
    filled: usize,
}

impl Place<'_> {
    fn add_byte(&mut self, byte: u8) {
        self.buffer[self.filled] = byte;
        self.filled += 1;
    }

    fn add(&mut self, text: &[u8]) {
        self.buffer[self.filled..self.filled + text.len()].copy_from_slice(text);
        self.filled += text.len();
    }
}

/// A cache of texts of recent numbers, each in the entry that a hash of its bits selects.
#[derive(Debug)]
struct Texts {
    known: Vec<Known>,
    shift: u32,
}

/// A number and its text; initially zero.
#[derive(Clone, Debug)]
struct Known {
    bits: u64,
    text: [u8; LONGEST],
    length: usize,
}

impl Texts {
    /// A cache of at least `count` entries.
    fn new(count: usize) -> Self {
        let count = count.next_power_of_two().max(2);
        let zero = Known { bits: 0, text: [b'0'; LONGEST], length: 1 };
        Self { known: vec![zero; count], shift: u64::BITS - count.trailing_zeros() }
    }

    /// Adds the text of a number.
    fn append(&mut self, number: f64, place: &mut Place<'_>) {
        let bits = number.to_bits();
        // Fibonacci hashing: the upper bits of the product depend on all bits of the number.
        let known = &mut self.known[(bits.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> self.shift) as usize];
        if known.bits == bits {
            // All of it, as a copy of known length is the faster one; the next text begins where this one ends.
            place.buffer[place.filled..place.filled + LONGEST].copy_from_slice(&known.text);
            place.filled += known.length;
            return;
        }
        let mut digits = zmij::Buffer::new();
        let text = real_text(&mut digits, number);
        place.add(text);
        known.bits = bits;
        known.text[..text.len()].copy_from_slice(text);
        known.length = text.len();
    }
}

/// The shortest decimal that reads back to the same bits, without `.0`.
fn real_text(digits: &mut zmij::Buffer, value: f64) -> &[u8] {
    let text = digits.format(value).as_bytes();
    text.strip_suffix(b".0").unwrap_or(text)
}

/// A text as it stands in a cell: quoted where a comma, a quote or a line break would mislead a reader.
pub(crate) fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// The file of a run's folder behind the writer, with errors that name it.
pub type TraceFile = CsvWriter<PartialFile>;

impl TraceFile {
    /// Begins with the header line; see [`CsvWriter::new`].
    ///
    /// # Errors
    /// The file cannot be written; the error names it.
    pub fn begin(file: PartialFile, step_ns: u64, columns: &[CsvColumn]) -> Result<Self, TraceError> {
        let mut writer = Self::new(file, step_ns, columns);
        writer.save()?;
        Ok(writer)
    }
}

impl Sink for TraceFile {
    fn row(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        let written = self.row(tick, slots);
        self.out.named(written)
    }

    fn save(&mut self) -> Result<(), TraceError> {
        let written = self.flush();
        self.out.named(written)
    }

    fn finish(mut self: Box<Self>, _end: RunState) -> Result<(), TraceError> {
        self.save()?;
        self.out.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(list: &[(&str, SlotType)]) -> Vec<CsvColumn> {
        list.iter().map(|&(name, slot_type)| CsvColumn { name: name.to_owned(), slot_type, due: Due::ALWAYS }).collect()
    }

    fn text(columns: &[CsvColumn], rows: &[&[u64]]) -> String {
        let mut writer = CsvWriter::new(Vec::new(), 5_000_000, columns);
        for (tick, row) in (0..).zip(rows) {
            writer.row(tick, row).unwrap();
        }
        String::from_utf8(writer.into_inner().unwrap()).unwrap()
    }

    #[test]
    fn a_trace_has_time_first_bare_names_and_shortest_decimals() {
        let columns = columns(&[
            ("quad.position.x", SlotType::Real),
            ("gear.down", SlotType::Boolean),
            ("plan.count", SlotType::Integer),
        ]);
        let rows: [&[u64]; 4] = [
            &[0.1_f64.to_bits(), 0, 7],
            &[0.1_f64.to_bits(), 1, u64::from(u32::MAX)],
            &[(-0.0_f64).to_bits(), 1, i32::MIN as i64 as u64],
            &[f64::NAN.to_bits(), 0, 0],
        ];
        assert_eq!(
            text(&columns, &rows),
            "time,quad.position.x,gear.down,plan.count\n0,0.1,0,7\n0.005,0.1,1,-1\n0.01,-0,1,-2147483648\n0.015,NaN,0,0\n"
        );
    }

    #[test]
    fn a_name_with_a_comma_is_quoted_and_a_quote_in_it_doubled() {
        let columns = columns(&[("m[1,2]", SlotType::Real), ("a.'say \"x\"'", SlotType::Real)]);
        assert_eq!(text(&columns, &[]), "time,\"m[1,2]\",\"a.'say \"\"x\"\"'\"\n");
    }

    #[test]
    fn the_first_row_shows_a_zero_that_never_changed() {
        assert_eq!(text(&columns(&[("a.b", SlotType::Real)]), &[&[0]]), "time,a.b\n0,0\n");
    }

    #[test]
    fn a_cell_is_empty_where_its_column_is_not_due_and_a_row_where_none_is_due_is_missing() {
        let mut columns = columns(&[("a.b", SlotType::Real), ("a.c", SlotType::Boolean)]);
        (columns[0].due.every, columns[1].due.every) = (2, 3);
        let row: &[u64] = &[1.5_f64.to_bits(), 1];
        let expected = "time,a.b,a.c\n0,1.5,1\n0.01,1.5,\n0.015,,1\n0.02,1.5,\n0.03,1.5,1\n";
        assert_eq!(text(&columns, &[row; 7]), expected);
    }

    #[test]
    fn cells_before_the_first_tick_of_a_column_are_empty_and_their_rows_stay() {
        let mut columns = columns(&[("mean", SlotType::Real)]);
        columns[0].due = Due { every: 2, from_tick: 3 };
        let row: &[u64] = &[1.5_f64.to_bits()];
        let expected = "time,mean\n0,\n0.01,\n0.02,1.5\n0.03,1.5\n";
        assert_eq!(text(&columns, &[row; 7]), expected);
    }

    #[test]
    fn the_longest_numbers_fit_into_rows_that_cross_the_end_of_a_piece() {
        let columns = columns(&[("a.b", SlotType::Real); 40]);
        let longest = (-2.225_073_858_507_201_4e-308_f64).to_bits();
        let mut writer = CsvWriter::new(Vec::new(), 1, &columns);
        let rows = 3 * PIECE / (40 * 24);
        for tick in 0..rows as u64 {
            writer.row(tick, &[longest ^ (tick & 1); 40]).unwrap();
        }
        let text = String::from_utf8(writer.into_inner().unwrap()).unwrap();
        assert_eq!(text.lines().count(), rows + 1);
        assert!(text.lines().all(|line| line.split(',').count() == 41));
        assert!(text.ends_with('\n'));
    }

    proptest::proptest! {
        #[test]
        fn every_real_reads_back_to_the_same_bits(bits: [u64; 3]) {
            let columns = columns(&[("a.b", SlotType::Real); 3]);
            let text = text(&columns, &[&bits]);
            let row = text.lines().nth(1).unwrap();
            for (cell, bits) in row.split(',').skip(1).zip(bits) {
                let (read, written) = (cell.parse::<f64>().unwrap(), f64::from_bits(bits));
                assert!(read.to_bits() == bits || (read.is_nan() && written.is_nan()), "{cell} for {written:e}");
            }
        }
    }
}
