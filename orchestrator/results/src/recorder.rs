//! All that takes what a run yields: a list of sinks.

use super::TraceError;
use super::call_log::CallLog;
use super::csv::TraceFile;
use super::events::EventsFile;
use super::parquet::ParquetFile;
use super::run_folder::{EVENTS_CSV, RunFolder, SIGNALS_JSON, TRACE_CSV, TRACE_PARQUET};
use super::run_record::RunState;
use super::signals::{self, Signal};
use super::sink::{Event, Sink};
use serde::{Deserialize, Serialize};

/// The formats in which the rows of a run are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Formats {
    /// `trace.csv`
    pub csv: bool,
    /// `trace.parquet`
    pub parquet: bool,
}

impl Default for Formats {
    fn default() -> Self {
        Self { csv: true, parquet: true }
    }
}

/// Passes rows and events to its sinks, in the order in which they were added. The error of one ends the run, but no
/// other sink misses anything because of it.
#[derive(Debug, Default)]
pub struct Recorder {
    sinks: Vec<Box<dyn Sink>>,
}

impl Recorder {
    /// Adds a sink.
    pub fn add(&mut self, sink: Box<dyn Sink>) {
        self.sinks.push(sink);
    }

    /// Begins the files of rows in these formats, and writes `signals.json` about their columns, of which the time is the first.
    ///
    /// # Errors
    /// A file cannot be written; the error names it.
    pub fn begin_rows(
        &mut self,
        folder: &RunFolder,
        step_ns: u64,
        signals: &[Signal<'_>],
        formats: Formats,
    ) -> Result<(), TraceError> {
        folder.write(SIGNALS_JSON, &signals::json(signals))?;
        if formats.csv {
            self.add(Box::new(TraceFile::begin(folder.begin(TRACE_CSV)?, step_ns, &signals::csv_columns(signals))?));
        }
        if formats.parquet {
            self.add(Box::new(ParquetFile::begin(folder.begin(TRACE_PARQUET)?, step_ns, signals)?));
        }
        Ok(())
    }

    /// Begins the file of the script's windows.
    ///
    /// # Errors
    /// The file cannot be written; the error names it.
    pub fn begin_events(&mut self, folder: &RunFolder) -> Result<(), TraceError> {
        self.add(Box::new(EventsFile::begin(folder.begin(EVENTS_CSV)?)?));
        Ok(())
    }

    /// Begins the log of an instance's calls.
    ///
    /// # Errors
    /// The file cannot be created; the error names it.
    pub fn begin_calls(&mut self, folder: &RunFolder, instance: usize, name: &str) -> Result<(), TraceError> {
        self.add(Box::new(CallLog::begin(folder, instance, name)?));
        Ok(())
    }

    /// Passes on the row of a tick; see [`Sink::row`].
    ///
    /// # Errors
    /// The first of the sinks.
    pub fn row(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        self.each(|sink| sink.row(tick, slots)).inspect_err(|_| {
            // The run ends with this error. The rows so far are written to the other files, so that they can be read.
            self.save().ok();
        })
    }

    /// Passes on an event.
    ///
    /// # Errors
    /// The first of the sinks.
    pub fn event(&mut self, event: Event<'_>) -> Result<(), TraceError> {
        self.each(|sink| sink.event(event))
    }

    /// Writes all buffered data to the files that stay readable after a crash of this process: all but `trace.parquet`.
    ///
    /// # Errors
    /// The first of the sinks.
    pub fn save(&mut self) -> Result<(), TraceError> {
        self.each(|sink| sink.save())
    }

    /// The run has ended so, and its files get their final names. If one of them cannot be written, the sinks after it
    /// see a broken run.
    ///
    /// # Errors
    /// The first of the sinks.
    pub fn finish(self, end: RunState) -> Result<(), TraceError> {
        let mut first = Ok(());
        for sink in self.sinks {
            let finished = sink.finish(if first.is_ok() { end } else { RunState::Broken });
            first = first.and(finished);
        }
        first
    }

    /// Calls each sink and drops those that fail: a file that cannot be written keeps its partial name.
    fn each(&mut self, mut call: impl FnMut(&mut dyn Sink) -> Result<(), TraceError>) -> Result<(), TraceError> {
        let mut first = Ok(());
        self.sinks.retain_mut(|sink| {
            let called = call(&mut **sink);
            let works = called.is_ok();
            if first.is_ok() {
                first = called;
            }
            works
        });
        first
    }
}

#[cfg(test)]
mod tests {
    use super::super::run_record::tests::record;
    use super::super::signals::SlotType;
    use super::super::signals::tests::signal;
    use super::*;
    use sha2::{Digest, Sha256};
    use std::cell::RefCell;
    use std::io::ErrorKind::StorageFull;
    use std::path::Path;
    use std::rc::Rc;

    #[test]
    fn rows_stay_readable_as_text_when_the_columns_cannot_be_written() {
        let home = tempfile::tempdir().unwrap();
        let folder = RunFolder::claim(home.path(), &record()).unwrap();
        std::os::unix::fs::symlink("/dev/full", home.path().join("trace.parquet.partial")).unwrap();
        let signals = ["time", "quad.x"].map(|name| signal(name, SlotType::Real));
        let mut recorder = Recorder::default();
        recorder.begin_rows(&folder, 1_000_000, &signals, Formats::default()).unwrap();
        let (tick, error) = (0..).find_map(|tick| Some((tick, recorder.row(tick, &[tick]).err()?))).unwrap();
        assert!(error.to_string().contains("trace.parquet.partial: "), "{error}");
        let text = std::fs::read_to_string(home.path().join("trace.csv.partial")).unwrap();
        assert_eq!(text.lines().count() as u64, tick + 2, "the header and every row");
    }

    #[test]
    fn a_trace_whose_columns_are_due_at_every_tick_has_the_bytes_that_it_had_before_there_were_periods() {
        let home = tempfile::tempdir().unwrap();
        let folder = RunFolder::claim(home.path(), &record()).unwrap();
        let names = [("time", SlotType::Real), ("quad.x", SlotType::Real)];
        let names = names.into_iter().chain([("plan.count", SlotType::Integer), ("gear.down", SlotType::Boolean)]);
        let signals: Vec<_> = names.map(|(name, slot_type)| signal(name, slot_type)).collect();
        let mut recorder = Recorder::default();
        recorder.begin_rows(&folder, 5_000_000, &signals, Formats::default()).unwrap();
        for tick in 0..300_000 {
            recorder.row(tick, &[(tick as f64 * 0.1).to_bits(), tick / 7, tick % 2]).unwrap();
        }
        recorder.finish(RunState::Finished).unwrap();
        for (name, hash) in [
            (TRACE_CSV, "138a8770390909a83b848620732d1685d7d3be29f97a9ad81181eaf7ec75e2e2"),
            (TRACE_PARQUET, "e3740067c6bf5dbe3b8ba1e3bc1c407da978056dc734f2ae402abb8554172ccb"),
        ] {
            let digest = Sha256::digest(std::fs::read(home.path().join(name)).unwrap());
            assert_eq!(digest.iter().map(|byte| format!("{byte:02x}")).collect::<String>(), hash, "{name}");
        }
    }

    /// Logs its calls; fails in the ones that `fails` names.
    #[derive(Debug)]
    struct Fake {
        name: &'static str,
        fails: &'static str,
        calls: Rc<RefCell<Vec<String>>>,
    }

    impl Fake {
        fn called(&self, call: &str) -> Result<(), TraceError> {
            self.calls.borrow_mut().push(format!("{}: {call}", self.name));
            if call.starts_with(self.fails) {
                return Err(TraceError::io("write", Path::new(self.name))(StorageFull.into()));
            }
            Ok(())
        }
    }

    impl Sink for Fake {
        fn row(&mut self, tick: u64, _: &[u64]) -> Result<(), TraceError> {
            self.called(&format!("row {tick}"))
        }
        fn save(&mut self) -> Result<(), TraceError> {
            self.called("save")
        }
        fn finish(self: Box<Self>, end: RunState) -> Result<(), TraceError> {
            self.called(&format!("finish {end:?}"))
        }
    }

    fn recorder(fails: [&'static str; 3]) -> (Recorder, Rc<RefCell<Vec<String>>>) {
        let (mut recorder, calls) = (Recorder::default(), Rc::default());
        for (name, fails) in ["a", "b", "c"].into_iter().zip(fails) {
            recorder.add(Box::new(Fake { name, fails, calls: Rc::clone(&calls) }));
        }
        (recorder, calls)
    }

    #[test]
    fn a_sink_that_fails_takes_no_more_and_the_others_miss_nothing() {
        let (mut recorder, calls) = recorder(["row 1", "row 1", "none"]);
        recorder.row(0, &[]).unwrap();
        assert!(recorder.row(1, &[]).unwrap_err().to_string().starts_with("cannot write a: "));
        recorder.row(2, &[]).unwrap();
        let expected = ["a: row 0", "b: row 0", "c: row 0", "a: row 1", "b: row 1", "c: row 1", "c: save", "c: row 2"];
        assert_eq!(*calls.borrow(), expected);
    }

    #[test]
    fn every_sink_is_finished_and_those_after_one_that_fails_see_a_broken_run() {
        let (recorder, calls) = recorder(["none", "finish", "finish"]);
        let error = recorder.finish(RunState::Finished).unwrap_err();
        assert!(error.to_string().starts_with("cannot write b: "), "{error}");
        assert_eq!(*calls.borrow(), ["a: finish Finished", "b: finish Finished", "c: finish Broken"]);
    }
}
