//! The files that grow while a run goes on: rows as text and as columns, and calls of instances that are to be logged.

use super::TraceError;
use super::call_log::CallLog;
use super::csv::TraceFile;
use super::parquet::ParquetFile;
use super::run_folder::{RunFolder, SIGNALS_JSON, TRACE_CSV, TRACE_PARQUET};
use super::signals::{self, Signal};

/// Takes what a run tells; at first it wants nothing.
#[derive(Debug, Default)]
pub struct Recorder {
    rows: Option<Rows>,
    /// With the index of the instance.
    calls: Vec<(usize, CallLog)>,
}

#[derive(Debug)]
struct Rows {
    csv: TraceFile,
    parquet: ParquetFile,
}

impl Recorder {
    /// Begins the files of rows, and says in `signals.json` what their columns are: the time first.
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
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
    /// If the system refuses to create the file; the error names it.
    pub fn begin_calls(&mut self, folder: &RunFolder, instance: usize, name: &str) -> Result<(), TraceError> {
        self.calls.push((instance, CallLog::begin(folder, name)?));
        Ok(())
    }

    /// Adds the row of a tick: one slot for each signal but the time, the bits of a Real, else the number widened.
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn record(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        let Some(Rows { csv, parquet }) = &mut self.rows else { return Ok(()) };
        csv.record(tick, slots)?;
        parquet.record(tick, slots).inspect_err(|_| {
            // The run ends by this error; the rows so far stay readable, if that can be.
            csv.save().ok();
        })
    }

    /// Adds a piece to the log of an instance's calls.
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn add_call(&mut self, instance: usize, piece: &[u8]) -> Result<(), TraceError> {
        let mut logs = self.calls.iter_mut().filter(|(of, _)| *of == instance);
        logs.try_for_each(|(_, log)| log.add(piece))
    }

    /// Writes what is there to the files that survive a crash of this process: all but `trace.parquet`.
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn save(&mut self) -> Result<(), TraceError> {
        let rows = self.rows.as_mut().map_or(Ok(()), |rows| rows.csv.save());
        self.calls.iter_mut().map(|(_, log)| log.save()).fold(rows, Result::and)
    }

    /// Ends the files and gives them their final names.
    ///
    /// # Errors
    /// If the system refuses to write or to rename; the error names the file.
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
