//! The files of recorded rows: `trace.csv`, `trace.parquet`, and `signals.json` that says what their columns are.

use super::TraceError;
use super::csv::TraceFile;
use super::parquet::ParquetFile;
use super::run_folder::{RunFolder, SIGNALS_JSON, TRACE_CSV, TRACE_PARQUET};
use super::signals::{self, Signal};

/// Takes the rows of a run.
#[derive(Debug)]
pub struct Recorder {
    csv: TraceFile,
    parquet: ParquetFile,
}

impl Recorder {
    /// Begins the files in a run's folder. The signals are those of [`signals::of`].
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn begin(folder: &RunFolder, step_ns: u64, signals: &[Signal<'_>]) -> Result<Self, TraceError> {
        folder.write(SIGNALS_JSON, &signals::json(signals))?;
        let csv = TraceFile::begin(folder.begin(TRACE_CSV)?, step_ns, &signals::csv_columns(signals))?;
        let parquet = ParquetFile::begin(folder.begin(TRACE_PARQUET)?, step_ns, signals)?;
        Ok(Self { csv, parquet })
    }

    /// Adds the row of a tick: one slot for each signal but the time, the bits of a Real, else the number widened.
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn record(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        self.csv.record(tick, slots)?;
        self.parquet.record(tick, slots).or_else(|error| {
            // The run ends by this error; the rows so far stay readable.
            self.csv.save()?;
            Err(error)
        })
    }

    /// Writes the rows that are there to `trace.csv`, the file that survives a crash of this process.
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn save(&mut self) -> Result<(), TraceError> {
        self.csv.save()
    }

    /// Ends the files and gives them their final names.
    ///
    /// # Errors
    /// If the system refuses to write or to rename; the error names the file.
    pub fn finish(self) -> Result<(), TraceError> {
        self.csv.finish()?;
        self.parquet.finish()
    }
}

#[test]
fn rows_stay_readable_as_text_when_the_columns_cannot_be_written() {
    use super::run_record::tests::record;
    use super::signals::tests::signal;
    use fmi2::description::BaseType;
    let home = tempfile::tempdir().unwrap();
    let folder = RunFolder::claim(home.path(), &record()).unwrap();
    std::os::unix::fs::symlink("/dev/full", home.path().join("trace.parquet.partial")).unwrap();
    let signals = ["time", "quad.x"].map(|name| signal(name, BaseType::Real));
    let mut recorder = Recorder::begin(&folder, 1_000_000, &signals).unwrap();
    let (tick, error) = (0..).find_map(|tick| Some((tick, recorder.record(tick, &[tick]).err()?))).unwrap();
    assert!(error.to_string().contains("trace.parquet.partial: "), "{error}");
    let text = std::fs::read_to_string(home.path().join("trace.csv.partial")).unwrap();
    assert_eq!(text.lines().count() as u64, tick + 2, "the header and every row");
}
