//! The files that grow during a run: rows as text and as columns, and logs of instances' calls.

use super::TraceError;
use super::call_log::CallLog;
use super::csv::TraceFile;
use super::parquet::ParquetFile;
use super::run_folder::{RunFolder, SIGNALS_JSON, TRACE_CSV, TRACE_PARQUET};
use super::signals::{self, Signal};

/// Writes rows and calls to the files that were begun; without any it ignores them.
#[derive(Debug, Default)]
pub struct Recorder {
    rows: Option<Rows>,
    /// Each with the index of its instance.
    calls: Vec<(usize, CallLog)>,
}

#[derive(Debug)]
struct Rows {
    csv: TraceFile,
    parquet: ParquetFile,
}

impl Recorder {
    /// Begins the files of rows, and writes `signals.json` about their columns, of which the time is the first.
    ///
    /// # Errors
    /// A file cannot be written; the error names it.
    pub fn begin_rows(&mut self, folder: &RunFolder, step_ns: u64, signals: &[Signal<'_>]) -> Result<(), TraceError> {
        folder.write(SIGNALS_JSON, &signals::json(signals))?;
        let csv = TraceFile::begin(folder.begin(TRACE_CSV)?, step_ns, &signals::csv_columns(signals))?;
        let parquet = ParquetFile::begin(folder.begin(TRACE_PARQUET)?, step_ns, signals)?;
        self.rows = Some(Rows { csv, parquet });
        Ok(())
    }

    /// Begins the log of an instance's calls.
    ///
    /// # Errors
    /// The file cannot be created; the error names it.
    pub fn begin_calls(&mut self, folder: &RunFolder, instance: usize, name: &str) -> Result<(), TraceError> {
        self.calls.push((instance, CallLog::begin(folder, name)?));
        Ok(())
    }

    /// Adds the row of a tick: one slot for each signal but the time, the bits of a Real, else the number widened.
    ///
    /// # Errors
    /// A file cannot be written; the error names it.
    pub fn record(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        let Some(Rows { csv, parquet }) = &mut self.rows else { return Ok(()) };
        csv.record(tick, slots)?;
        parquet.record(tick, slots).inspect_err(|_| {
            // The run ends with this error. The rows so far are written as text, if possible, so that they can be read.
            csv.save().ok();
        })
    }

    /// Adds a piece to the log of an instance's calls.
    ///
    /// # Errors
    /// A file cannot be written; the error names it.
    pub fn add_call(&mut self, instance: usize, piece: &[u8]) -> Result<(), TraceError> {
        let mut logs = self.calls.iter_mut().filter(|(of, _)| *of == instance);
        logs.try_for_each(|(_, log)| log.add(piece))
    }

    /// Writes all buffered data to the files that stay readable after a crash of this process: all but `trace.parquet`.
    ///
    /// # Errors
    /// A file cannot be written; the error names it.
    pub fn save(&mut self) -> Result<(), TraceError> {
        let rows = self.rows.as_mut().map_or(Ok(()), |rows| rows.csv.save());
        self.calls.iter_mut().map(|(_, log)| log.save()).fold(rows, Result::and)
    }

    /// Ends the files and gives them their final names.
    ///
    /// # Errors
    /// A file cannot be written or renamed; the error names it.
    pub fn finish(self) -> Result<(), TraceError> {
        let rows = self.rows.map_or(Ok(()), |Rows { csv, parquet }| csv.finish().and(parquet.finish()));
        self.calls.into_iter().map(|(_, log)| log.finish()).fold(rows, Result::and)
    }
}

#[test]
fn rows_stay_readable_as_text_when_the_columns_cannot_be_written() {
    use super::run_record::tests::record;
    use super::signals::SlotType;
    use super::signals::tests::signal;
    let home = tempfile::tempdir().unwrap();
    let folder = RunFolder::claim(home.path(), &record()).unwrap();
    std::os::unix::fs::symlink("/dev/full", home.path().join("trace.parquet.partial")).unwrap();
    let signals = ["time", "quad.x"].map(|name| signal(name, SlotType::Real));
    let mut recorder = Recorder::default();
    recorder.begin_rows(&folder, 1_000_000, &signals).unwrap();
    let (tick, error) = (0..).find_map(|tick| Some((tick, recorder.record(tick, &[tick]).err()?))).unwrap();
    assert!(error.to_string().contains("trace.parquet.partial: "), "{error}");
    let text = std::fs::read_to_string(home.path().join("trace.csv.partial")).unwrap();
    assert_eq!(text.lines().count() as u64, tick + 2, "the header and every row");
}
