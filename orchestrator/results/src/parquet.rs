//! `trace.parquet`: the rows of a run by columns, for pandas, Polars, DuckDB and other readers of Parquet.
//!
//! A separate thread converts groups of rows to columns and writes them; recording waits for it only if the disk is
//! slower than the run. The bytes depend on the rows alone: a group ends after a fixed number of rows, not after a
//! time. The file can be read only when it is complete. The metadata of a field is what `signals.json` contains about
//! the column: `pyarrow.parquet.read_schema(file).field("quad.height").metadata[b"unit"]`.

use super::run_folder::PartialFile;
use super::run_record::RunState;
use super::signals::{Due, DueRows, Signal, SlotType};
use super::sink::Sink;
use super::{TraceError, arrow_schema};
use parquet::basic::{Compression, Encoding, Repetition, Type as PhysicalType};
use parquet::data_type::{BoolType, DataType, DoubleType, Int32Type};
use parquet::errors::{ParquetError, Result as Written};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesBuilder};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::thread;
use unit::time::seconds;

/// Rows are sent to the thread in blocks of about this size, which fits into the cache of one processor core.
const BLOCK_BYTES: usize = 256 << 10;
/// The number of blocks that are written as one row group, and of blocks that may wait in the channel meanwhile.
const GROUP_BLOCKS: usize = 32;

/// The file in a run's folder, and the thread that writes it.
#[derive(Debug)]
pub struct ParquetFile {
    path: PathBuf,
    rows: DueRows,
    /// The block that is being filled: for each row the tick, then its slots.
    block: Vec<u64>,
    block_words: usize,
    blocks: SyncSender<Vec<u64>>,
    ended: Ended,
}

type Ended = Receiver<Written<SerializedFileWriter<PartialFile>>>;

impl ParquetFile {
    /// Begins the file for these signals, of which the time is the first.
    ///
    /// # Errors
    /// The file cannot be written or the thread cannot be started; the error names the file.
    pub fn begin(file: PartialFile, step_ns: u64, signals: &[Signal<'_>]) -> Result<Self, TraceError> {
        let path = file.path().to_owned();
        let columns = Columns::begin(file, step_ns, signals).map_err(|error| write_error(&path, error))?;
        let (blocks, filled) = sync_channel(GROUP_BLOCKS);
        let (end, ended) = channel();
        // The send fails if the `ParquetFile` was dropped because another file of the run could not be written.
        let write = move || end.send(columns.write(filled)).unwrap_or_default();
        let started = thread::Builder::new().name("parquet".to_owned()).spawn(write);
        started.map_err(TraceError::io("start a thread to write", &path))?;
        let block_words = block_words(signals.len());
        let rows = DueRows::new(signals.iter().skip(1).map(|signal| signal.due));
        Ok(Self { path, rows, block: Vec::with_capacity(block_words), block_words, blocks, ended })
    }
}

impl Sink for ParquetFile {
    /// The error may be that of an earlier row.
    fn row(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        if !self.rows.contain(tick) {
            return Ok(());
        }
        self.block.push(tick);
        self.block.extend_from_slice(slots);
        if self.block.len() < self.block_words {
            return Ok(());
        }
        let block = std::mem::replace(&mut self.block, Vec::with_capacity(self.block_words));
        self.blocks.send(block).or_else(|_| outcome(&self.ended, &self.path).map(drop))
    }

    fn finish(self: Box<Self>, _end: RunState) -> Result<(), TraceError> {
        let Self { path, block, blocks, ended, .. } = *self;
        // If the thread has ended because of an error, the send fails, and `outcome` returns that error.
        blocks.send(block).ok();
        drop(blocks);
        outcome(&ended, &path)?.inner().finish()
    }
}

/// The result of the thread: the finished writer, or the first error.
fn outcome(ended: &Ended, path: &Path) -> Result<SerializedFileWriter<PartialFile>, TraceError> {
    let written = ended.recv().unwrap_or_else(|_| unreachable!("the thread that writes a file says how it ended"));
    written.map_err(|error| write_error(path, error))
}

fn write_error(path: &Path, error: ParquetError) -> TraceError {
    TraceError::io("write", path)(match error {
        // If it is an error of the system, that error itself: its message is the one that users know.
        ParquetError::External(error) => error.downcast().map_or_else(io::Error::other, |error| *error),
        error => io::Error::other(error),
    })
}

/// The number of words in a full block: whole rows, at least one.
fn block_words(columns: usize) -> usize {
    (BLOCK_BYTES / 8 / columns).max(1) * columns
}

/// Converts rows to columns and writes them.
struct Columns<W: Write> {
    writer: SerializedFileWriter<W>,
    step_ns: u64,
    times: Vec<f64>,
    /// One for each slot of a row.
    columns: Vec<Column>,
}

/// One column of a row group that is not yet written.
struct Column {
    due: Due,
    /// For each row 1 if there is a value and 0 if not; unused if the column is due at every tick.
    levels: Vec<i16>,
    values: Values,
}

/// The values where the column is due.
enum Values {
    Reals(Vec<f64>),
    Integers(Vec<i32>),
    Booleans(Vec<bool>),
}

impl<W: Write + Send> Columns<W> {
    fn begin(out: W, step_ns: u64, signals: &[Signal<'_>]) -> Written<Self> {
        let fields = signals.iter().map(|signal| {
            let column = Type::primitive_type_builder(signal.name, physical_type(signal.slot_type));
            let repetition = if signal.due == Due::ALWAYS { Repetition::REQUIRED } else { Repetition::OPTIONAL };
            column.with_repetition(repetition).build().map(Arc::new)
        });
        let schema = Type::group_type_builder("trace").with_fields(fields.collect::<Written<_>>()?).build()?;
        let writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties(signals)))?;
        let columns = signals.iter().skip(1).map(Column::new).collect();
        Ok(Self { writer, step_ns, times: Vec::new(), columns })
    }

    /// Writes blocks until the channel is closed, then the end of the file.
    fn write(mut self, blocks: Receiver<Vec<u64>>) -> Written<SerializedFileWriter<W>> {
        for (count, block) in (1_usize..).zip(blocks) {
            self.add(&block);
            if count % GROUP_BLOCKS == 0 {
                self.write_group()?;
            }
        }
        self.write_group()?;
        self.writer.finish()?;
        Ok(self.writer)
    }

    fn add(&mut self, block: &[u64]) {
        let width = 1 + self.columns.len();
        let rows = || block.chunks_exact(width);
        self.times.extend(rows().map(|row| seconds(row[0], self.step_ns)));
        for (column, at) in self.columns.iter_mut().zip(1..) {
            let due = column.due;
            if due == Due::ALWAYS {
                column.values.extend(rows().map(|row| row[at]));
            } else {
                column.levels.extend(rows().map(|row| i16::from(due.contains(row[0]))));
                column.values.extend(rows().filter(|row| due.contains(row[0])).map(|row| row[at]));
            }
        }
    }

    /// Writes the rows added since the last group, if there are any.
    fn write_group(&mut self) -> Written<()> {
        if self.times.is_empty() {
            return Ok(());
        }
        let mut group = self.writer.next_row_group()?;
        write_column::<_, DoubleType>(&mut group, &mut self.times, None)?;
        for Column { due, levels, values } in &mut self.columns {
            let present = (*due != Due::ALWAYS).then_some(levels.as_slice());
            match values {
                Values::Reals(values) => write_column::<_, DoubleType>(&mut group, values, present),
                Values::Integers(values) => write_column::<_, Int32Type>(&mut group, values, present),
                Values::Booleans(values) => write_column::<_, BoolType>(&mut group, values, present),
            }?;
            levels.clear();
        }
        group.close().map(drop)
    }
}

impl Column {
    fn new(signal: &Signal<'_>) -> Self {
        let values = match signal.slot_type {
            SlotType::Real => Values::Reals(Vec::new()),
            SlotType::Integer => Values::Integers(Vec::new()),
            SlotType::Boolean => Values::Booleans(Vec::new()),
        };
        Self { due: signal.due, levels: Vec::new(), values }
    }
}

impl Values {
    fn extend(&mut self, slots: impl Iterator<Item = u64>) {
        match self {
            Self::Reals(values) => values.extend(slots.map(f64::from_bits)),
            Self::Integers(values) => values.extend(slots.map(|slot| slot as i32)),
            Self::Booleans(values) => values.extend(slots.map(|slot| slot != 0)),
        }
    }
}

fn write_column<W: Write + Send, T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    values: &mut Vec<T::T>,
    levels: Option<&[i16]>,
) -> Written<()> {
    let column = group.next_column()?;
    let mut column = column.unwrap_or_else(|| unreachable!("the schema has as many columns as a row has values"));
    column.typed::<T>().write_batch(values, levels, None)?;
    values.clear();
    column.close()
}

fn physical_type(slot_type: SlotType) -> PhysicalType {
    match slot_type {
        SlotType::Real => PhysicalType::DOUBLE,
        SlotType::Integer => PhysicalType::INT32,
        SlotType::Boolean => PhysicalType::BOOLEAN,
    }
}

/// The encoding of the columns. Reals use BYTE_STREAM_SPLIT, which stores bytes of the same significance side by side,
/// then a fast compression: smooth signals then take a fifth of the space. A dictionary would take four times as long,
/// and save space only where values repeat exactly.
fn properties(signals: &[Signal<'_>]) -> WriterProperties {
    let properties = WriterProperties::builder()
        .set_created_by("lockstep".to_owned())
        .set_key_value_metadata(Some(vec![KeyValue::new(arrow_schema::KEY.to_owned(), arrow_schema::value(signals))]))
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_offset_index_disabled(true);
    let reals = signals.iter().filter(|signal| signal.slot_type == SlotType::Real);
    let split = |properties: WriterPropertiesBuilder, signal: &Signal<'_>| {
        properties.set_column_encoding(ColumnPath::from(signal.name), Encoding::BYTE_STREAM_SPLIT)
    };
    reals.fold(properties, split).build()
}

#[cfg(test)]
mod tests {
    use super::super::run_folder::{RunFolder, TRACE_PARQUET};
    use super::super::run_record::tests::record;
    use super::super::signals::tests::signal;
    use super::*;
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::Field;
    use std::fs::File;
    use tempfile::TempDir;

    const STEP_NS: u64 = 5_000_000;

    fn signals() -> Vec<Signal<'static>> {
        vec![
            signal("time", SlotType::Real),
            signal("quad.position.x", SlotType::Real),
            signal("plan.count", SlotType::Integer),
            signal("gear.down", SlotType::Boolean),
        ]
    }

    fn begin(home: &TempDir, signals: &[Signal<'_>]) -> Box<ParquetFile> {
        let folder = RunFolder::claim(home.path(), &record()).unwrap();
        Box::new(ParquetFile::begin(folder.begin(TRACE_PARQUET).unwrap(), STEP_NS, signals).unwrap())
    }

    fn read(home: &TempDir) -> SerializedFileReader<File> {
        SerializedFileReader::new(File::open(home.path().join(TRACE_PARQUET)).unwrap()).unwrap()
    }

    /// The rows as they were recorded, with the bits of the time instead of the tick.
    fn slots(file: &SerializedFileReader<File>) -> Vec<Vec<u64>> {
        let slot = |slot: Option<u64>| slot.unwrap_or_else(|| panic!("a value is missing"));
        cells(file).into_iter().map(|row| row.into_iter().map(slot).collect()).collect()
    }

    /// As `slots`, with `None` where a column was not due.
    fn cells(file: &SerializedFileReader<File>) -> Vec<Vec<Option<u64>>> {
        let cell = |(_, field): (&String, &Field)| match field {
            Field::Double(value) => Some(value.to_bits()),
            Field::Int(value) => Some(i64::from(*value).cast_unsigned()),
            Field::Bool(value) => Some(u64::from(*value)),
            Field::Null => None,
            other => panic!("{other:?}"),
        };
        file.get_row_iter(None).unwrap().map(|row| row.unwrap().get_column_iter().map(cell).collect()).collect()
    }

    #[test]
    fn every_value_reads_back_to_the_same_bits() {
        let home = tempfile::tempdir().unwrap();
        let reals = [0.1, -0.0, f64::INFINITY, f64::from_bits(0x7ff8_0000_dead_beef)].map(f64::to_bits);
        let integers = [7, -1, i32::MIN, i32::MAX].map(|value| i64::from(value).cast_unsigned());
        let mut file = begin(&home, &signals());
        for tick in 0..4 {
            file.row(tick as u64, &[reals[tick], integers[tick], tick as u64 & 1]).unwrap();
        }
        file.finish(RunState::Finished).unwrap();
        let times = [0.0, 0.005, 0.01, 0.015].map(f64::to_bits);
        let expected: Vec<_> = (0..4).map(|i| vec![times[i], reals[i], integers[i], i as u64 & 1]).collect();
        assert_eq!(slots(&read(&home)), expected);
    }

    #[test]
    fn a_run_is_written_in_row_groups_and_the_file_gets_its_name_when_it_is_complete() {
        let home = tempfile::tempdir().unwrap();
        let group = (GROUP_BLOCKS * block_words(signals().len()) / signals().len()) as u64;
        let rows = 2 * group + 5;
        let mut file = begin(&home, &signals());
        for tick in 0..rows {
            file.row(tick, &[tick, tick, 1]).unwrap();
        }
        assert!(!home.path().join(TRACE_PARQUET).exists());
        file.finish(RunState::Finished).unwrap();
        let read = read(&home);
        let groups: Vec<_> = read.metadata().row_groups().iter().map(|group| group.num_rows() as u64).collect();
        assert_eq!(groups, [group, group, 5]);
        let bits_of = |tick| vec![seconds(tick, STEP_NS).to_bits(), tick, tick, 1];
        assert!(slots(&read).into_iter().eq((0..rows).map(bits_of)));
    }

    #[test]
    fn a_value_is_null_where_its_column_is_not_due_and_only_such_a_column_is_optional() {
        let home = tempfile::tempdir().unwrap();
        let mut signals = signals();
        for (signal, every) in signals.iter_mut().skip(1).zip([2, 3, 6]) {
            signal.due = Due { every, from_tick: 100 };
        }
        // More than one row group, of which none begins where all columns are due.
        let ticks = 5 * (GROUP_BLOCKS * block_words(signals.len()) / signals.len()) as u64;
        let mut file = begin(&home, &signals);
        for tick in 0..ticks {
            file.row(tick, &[tick, tick, 1]).unwrap();
        }
        file.finish(RunState::Finished).unwrap();
        let read = read(&home);
        assert!(read.num_row_groups() > 1);
        let value = |tick: u64, every, slot| (tick.is_multiple_of(every) && tick >= 100).then_some(slot);
        let due = (0..ticks).filter(|tick| tick.is_multiple_of(2) || tick.is_multiple_of(3));
        let expected = due.map(|tick| {
            let time = Some(seconds(tick, STEP_NS).to_bits());
            vec![time, value(tick, 2, tick), value(tick, 3, tick), value(tick, 6, 1)]
        });
        assert!(cells(&read).into_iter().eq(expected));
        let columns = read.metadata().file_metadata().schema_descr().columns().iter();
        let optional: Vec<_> = columns.map(|column| column.self_type().is_optional()).collect();
        assert_eq!(optional, [false, true, true, true]);
    }

    #[test]
    fn a_block_has_whole_rows_and_at_least_one() {
        assert_eq!([3, 30_000, 50_000].map(block_words), [32_766, 30_000, 50_000]);
    }

    #[test]
    fn a_run_without_rows_has_columns() {
        let home = tempfile::tempdir().unwrap();
        begin(&home, &signals()).finish(RunState::Finished).unwrap();
        let file = read(&home);
        let columns = file.metadata().file_metadata().schema_descr().columns().iter();
        assert_eq!(
            columns.map(|column| column.name()).collect::<Vec<_>>(),
            ["time", "quad.position.x", "plan.count", "gear.down"]
        );
        assert_eq!(file.metadata().file_metadata().created_by(), Some("lockstep"));
        assert_eq!(slots(&file), Vec::<Vec<u64>>::new());
    }

    #[test]
    fn a_full_disk_is_an_error_that_names_the_file() {
        let home = tempfile::tempdir().unwrap();
        let folder = RunFolder::claim(home.path(), &record()).unwrap();
        let path = folder.path().join("trace.parquet.partial");
        std::os::unix::fs::symlink("/dev/full", &path).unwrap();
        let file = || folder.begin(TRACE_PARQUET).unwrap();
        let begin = || Box::new(ParquetFile::begin(file(), STEP_NS, &signals()).unwrap());
        let expected = format!("cannot write {}: No space left on device (os error 28)", path.display());
        assert_eq!(begin().finish(RunState::Finished).unwrap_err().to_string(), expected);
        let mut file = begin();
        let error = (0..).find_map(|tick| file.row(tick, &[0, 0, 0]).err());
        assert_eq!(error.map(|error| error.to_string()), Some(expected));
    }
}
