//! `trace.csv`: rows of slots as text, fast enough to record everything.
//!
//! One buffer is filled and written in large pieces. A slot whose bits did not change keeps the text it had, so that
//! what stands still costs a copy. The file is whole after each piece: every piece ends with a row.

use super::TraceError;
use crate::wiring::seconds;
use fmi2::description::BaseType;
use std::io::{self, Write};

/// Room for the longest number.
const LONGEST: usize = 24;
/// The buffer is written when it holds this much.
const PIECE: usize = 256 * 1024;

/// One column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsvColumn {
    /// The name in the header.
    pub name: String,
    /// How its slots are read.
    pub base_type: BaseType,
}

/// Turns rows into text.
#[derive(Debug)]
pub struct CsvWriter<W: Write> {
    out: W,
    step_ns: u64,
    cells: Vec<Cell>,
    buffer: Vec<u8>,
}

/// The last slot of a column with its text; before the first row a zero, which all types write alike.
#[derive(Debug)]
struct Cell {
    base_type: BaseType,
    slot: u64,
    text: [u8; LONGEST],
    length: usize,
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
        let widest_row = (columns.len() + 1) * (LONGEST + 1);
        buffer.reserve(PIECE + widest_row);
        let cells = columns.iter().map(|column| Cell::new(column.base_type)).collect();
        Self { out, step_ns, cells, buffer }
    }

    /// Adds the row of a tick: one slot for each column, the bits of a Real, else the number widened.
    ///
    /// # Errors
    /// What the writer says.
    pub fn row(&mut self, tick: u64, slots: &[u64]) -> io::Result<()> {
        assert_eq!(slots.len(), self.cells.len(), "a row has one slot for each column");
        let mut digits = zmij::Buffer::new();
        self.buffer.extend_from_slice(real_text(&mut digits, seconds(tick, self.step_ns)));
        for (cell, &slot) in self.cells.iter_mut().zip(slots) {
            self.buffer.push(b',');
            cell.append(slot, &mut self.buffer);
        }
        self.buffer.push(b'\n');
        if self.buffer.len() >= PIECE { self.flush() } else { Ok(()) }
    }

    /// Writes what is there; the file then ends with a whole row.
    ///
    /// # Errors
    /// What the writer says.
    pub fn flush(&mut self) -> io::Result<()> {
        let written = self.out.write_all(&self.buffer);
        self.buffer.clear();
        written
    }

    /// Writes what is there and returns the writer.
    ///
    /// # Errors
    /// What the writer says.
    pub fn into_inner(mut self) -> Result<W, io::Error> {
        self.flush()?;
        Ok(self.out)
    }
}

impl Cell {
    fn new(base_type: BaseType) -> Self {
        Self { base_type, slot: 0, text: [b'0'; LONGEST], length: 1 }
    }

    /// Adds the text of a slot.
    fn append(&mut self, slot: u64, buffer: &mut Vec<u8>) {
        if self.slot == slot {
            buffer.extend_from_slice(&self.text[..self.length]);
            return;
        }
        self.slot = slot;
        match self.base_type {
            BaseType::Real => {
                let mut digits = zmij::Buffer::new();
                let text = real_text(&mut digits, f64::from_bits(slot));
                // Not from the copy: reading what was only just stored is slow.
                buffer.extend_from_slice(text);
                self.text[..text.len()].copy_from_slice(text);
                self.length = text.len();
            }
            BaseType::Boolean => self.append_integer(i32::from(slot != 0), buffer),
            BaseType::Integer => self.append_integer(slot as u32 as i32, buffer),
            BaseType::String => unreachable!("the resolver admits no column of strings"),
        }
    }

    fn append_integer(&mut self, value: i32, buffer: &mut Vec<u8>) {
        let mut rest = &mut self.text[..];
        if write!(rest, "{value}").is_err() {
            unreachable!("an integer of 32 bits has at most 11 characters");
        }
        self.length = LONGEST - rest.len();
        buffer.extend_from_slice(&self.text[..self.length]);
    }
}

/// The shortest decimal that reads back to the same bits, without `.0`.
fn real_text(digits: &mut zmij::Buffer, value: f64) -> &[u8] {
    let text = digits.format(value).as_bytes();
    text.strip_suffix(b".0").unwrap_or(text)
}

/// A name as it stands in the header: quoted where a comma, a quote or a line break would mislead a reader.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}

/// The file of a run's folder behind the writer, with errors that name it.
pub type TraceFile = CsvWriter<super::run_folder::PartialFile>;

impl TraceFile {
    /// Begins with the header line; see [`CsvWriter::new`].
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn begin(
        file: super::run_folder::PartialFile,
        step_ns: u64,
        columns: &[CsvColumn],
    ) -> Result<Self, TraceError> {
        let mut writer = Self::new(file, step_ns, columns);
        writer.save()?;
        Ok(writer)
    }

    /// Ends the file and gives it its final name.
    ///
    /// # Errors
    /// If the system refuses to write or to rename.
    pub fn finish(mut self) -> Result<(), TraceError> {
        let flushed = self.flush();
        self.out.named(flushed)?;
        self.out.finish()
    }

    /// Adds a row; see [`CsvWriter::row`].
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn record(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        let written = self.row(tick, slots);
        self.out.named(written)
    }

    /// Writes what is there; see [`CsvWriter::flush`].
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn save(&mut self) -> Result<(), TraceError> {
        let written = self.flush();
        self.out.named(written)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(list: &[(&str, BaseType)]) -> Vec<CsvColumn> {
        list.iter().map(|&(name, base_type)| CsvColumn { name: name.to_owned(), base_type }).collect()
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
            ("quad.position.x", BaseType::Real),
            ("gear.down", BaseType::Boolean),
            ("plan.count", BaseType::Integer),
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
        let columns = columns(&[("m[1,2]", BaseType::Real), ("a.'say \"x\"'", BaseType::Real)]);
        assert_eq!(text(&columns, &[]), "time,\"m[1,2]\",\"a.'say \"\"x\"\"'\"\n");
    }

    #[test]
    fn the_first_row_shows_a_zero_that_never_changed() {
        assert_eq!(text(&columns(&[("a.b", BaseType::Real)]), &[&[0]]), "time,a.b\n0,0\n");
    }

    #[test]
    fn the_longest_numbers_fit_into_rows_that_cross_the_end_of_a_piece() {
        let columns = columns(&[("a.b", BaseType::Real); 40]);
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
            let columns = columns(&[("a.b", BaseType::Real); 3]);
            let text = text(&columns, &[&bits]);
            let row = text.lines().nth(1).unwrap();
            for (cell, bits) in row.split(',').skip(1).zip(bits) {
                let (read, written) = (cell.parse::<f64>().unwrap(), f64::from_bits(bits));
                assert!(read.to_bits() == bits || (read.is_nan() && written.is_nan()), "{cell} for {written:e}");
            }
        }
    }
}
