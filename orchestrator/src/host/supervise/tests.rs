//! The parent's side of a run, with a board that the test itself writes like a stepping process.

use super::*;
use crate::example::{claim, record, scenario};
use crate::run::run_options::RunOptions;
use fmi2::calls::Call;
use parquet::file::reader::{FileReader, SerializedFileReader};
use results::recorder::Formats;
use results::report::console::Style;
use results::run_folder::{RunFolder, TRACE_CSV, TRACE_PARQUET};
use results::run_record::RunState;
use results::signals::{self, Signal};
use results::sink::Sink;
use results::verdict::Verdict;
use std::cell::RefCell;
use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::ExitStatus;
use std::rc::Rc;
use tempfile::TempDir;
use unit::board::ClaimNote;
use unit::failure::Doing;
use unit::logger::LogMessage;

const DIED_OF_SIGSEGV: i32 = 11;
const EXITED_WITH_0: i32 = 0;

/// A run of one column and two claims in a folder of its own.
struct Run {
    home: TempDir,
    spec: RunSpec,
    saving: Saving,
    board: Board,
}

impl Run {
    fn new() -> Self {
        let home = tempfile::tempdir().unwrap();
        let mut scenario = scenario();
        scenario.claims = vec![claim("a", "always quad.a"), claim("b", "always quad.b")];
        let spec = RunSpec {
            scenario,
            units: vec![],
            folder: home.path().to_owned(),
            board: home.path().join("board"),
            options: RunOptions { record: true, ..RunOptions::default() },
            worker_of: None,
            saves: vec![],
            from: None,
        };
        let board = Board::private(&BoardLayout { notes: 1, columns: 1, claims: 2 }).unwrap();
        Self { home, spec, saving: Saving::default(), board }
    }

    fn supervise(&self, program: &str, live: Option<BeginLive>) -> Result<RunEnd, SuperviseError> {
        let mut console = Console::new(Vec::new(), Style::Tenths);
        let program = Path::new(program);
        supervise(&self.spec, &self.saving, program, None, Recorder::default(), live, &mut console)
    }

    fn rows(&self, count: u64) {
        for tick in 0..count {
            self.board.set_tick(tick);
            self.board.write_row(tick, |row| row.set(0, (tick as f64).to_bits()));
        }
    }

    fn send(&self, message: &Message) {
        assert!(self.board.push_message(&postcard::to_stdvec(message).unwrap()));
    }

    fn finish(&self, reason: Reason) {
        self.send(&Message::Finished(Finish { last_tick: 9000, reason }));
    }

    /// What the parent makes of it once the process is gone, and what it printed.
    fn concluded(&self, status: i32) -> (RunEnd, String) {
        let folder = RunFolder::claim(&self.home.path().join("run"), &record()).unwrap();
        let signals = [signals::time(), Signal { name: "quad.x", ..signals::time() }];
        let mut recorder = Recorder::default();
        recorder.begin_rows(&folder, self.spec.scenario.step_ns, &signals, Formats::default()).unwrap();
        let mut console = Console::new(Vec::new(), Style::Tenths);
        let mut supervision = Supervision::new(&self.spec, &self.saving, &self.board, recorder, &mut console);
        supervision.drain().unwrap();
        let ended = supervision.conclude(cause_of_death(ExitStatus::from_raw(status)), None).unwrap();
        (ended, String::from_utf8(console.into_inner()).unwrap())
    }

    fn trace(&self) -> String {
        fs::read_to_string(self.home.path().join("run").join(TRACE_CSV)).unwrap()
    }
}

#[test]
fn rows_and_the_call_of_a_process_that_died_are_there() {
    let run = Run::new();
    run.rows(3);
    let note = run.board.note(0);
    let now = note.at(2, 0.02);
    now.call(0, Doing::Call(Call::DoStep), || ());
    let (ended, _) = run.concluded(DIED_OF_SIGSEGV);
    let failure = ended.failure.unwrap().to_string();
    assert_eq!(failure, "`quad` died of signal 11 (SIGSEGV) in fmi2DoStep at 0.02 s");
    assert_eq!(ended.last_tick, 2);
    assert_eq!(run.trace(), "time,quad.x\n0,0\n0.01,1\n0.02,2\n");
    let columns = File::open(run.home.path().join("run").join(TRACE_PARQUET)).unwrap();
    assert_eq!(SerializedFileReader::new(columns).unwrap().metadata().file_metadata().num_rows(), 3);
}

/// Stores what it is called with.
#[derive(Clone, Debug, Default)]
struct RecordingSink(Rc<RefCell<Vec<String>>>);

impl Sink for RecordingSink {
    fn row(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        self.0.borrow_mut().push(format!("{tick}: {}", f64::from_bits(slots[0])));
        Ok(())
    }

    fn finish(self: Box<Self>, end: RunState) -> Result<(), TraceError> {
        self.0.borrow_mut().push(format!("{end:?}"));
        Ok(())
    }
}

#[test]
fn what_shows_a_run_begins_with_its_board_and_takes_its_end() {
    let (run, sink) = (Run::new(), RecordingSink::default());
    let begin = |shown: RecordingSink| -> BeginLive {
        Box::new(|board| {
            shown.0.borrow_mut().push(format!("{} claims", board.layout().claims));
            Box::new(shown)
        })
    };
    run.supervise("/bin/true", Some(begin(sink.clone()))).unwrap();
    assert_eq!(*sink.0.borrow(), ["2 claims", "Broken"]);
}

#[test]
fn claims_that_were_decided_before_a_death_stay_decided() {
    let run = Run::new();
    let note =
        |verdict: Verdict| ClaimNote { verdict: verdict as u8, margin: -1.0, worst_tick: 7, first_tick: 7, part: 0 };
    run.board.set_claim(0, &note(Verdict::Fails));
    run.board.set_claim(1, &note(Verdict::Undecided));
    let (ended, _) = run.concluded(DIED_OF_SIGSEGV);
    let verdicts: Vec<_> = ended.standings.iter().map(|standing| standing.verdict).collect();
    assert_eq!(verdicts, [Verdict::Fails, Verdict::Undecided]);
}

#[test]
fn an_exit_with_code_0_is_a_break_unless_the_run_said_that_it_is_over() {
    let silent = Run::new();
    assert!(silent.concluded(EXITED_WITH_0).0.failure.is_some());
    let over = Run::new();
    over.finish(Reason::StopTime);
    let (ended, _) = over.concluded(EXITED_WITH_0);
    assert_eq!((ended.failure, ended.last_tick, ended.interrupted), (None, 9000, false));
}

#[test]
fn what_the_run_says_about_its_break_counts_more_than_how_its_process_ended() {
    let run = Run::new();
    let failure = Failure {
        instance: Some("quad".to_owned()),
        doing: Doing::Call(Call::DoStep),
        time_s: Some(0.05),
        cause: Cause::Status(3),
    };
    run.send(&Message::Broken(failure.clone()));
    assert_eq!(run.concluded(DIED_OF_SIGSEGV).0.failure, Some(failure));
}

#[test]
fn a_death_is_kept_when_the_last_rows_cannot_be_written_and_no_file_is_finished() {
    let (run, sink, mut recorder) = (Run::new(), RecordingSink::default(), Recorder::default());
    run.rows(2);
    recorder.add(Box::new(sink.clone()));
    let mut console = Console::new(Vec::new(), Style::Tenths);
    let mut supervision = Supervision::new(&run.spec, &run.saving, &run.board, recorder, &mut console);
    supervision.drain().unwrap();
    let full = TraceError::io("write", Path::new("trace.csv"))(io::ErrorKind::StorageFull.into());
    let error = supervision.conclude(Cause::Signal(DIED_OF_SIGSEGV), Some(full)).unwrap_err();
    let SuperviseError::Broken { failure, .. } = &error else { panic!("{error:?}") };
    assert_eq!(failure.cause, Cause::Signal(11));
    assert!(error.to_string().starts_with("cannot write trace.csv: "), "{error}");
    assert_eq!(*sink.0.borrow(), ["0: 0", "1: 1"]);
}

#[test]
fn a_run_that_stopped_when_asked_to_is_interrupted_and_not_broken() {
    let run = Run::new();
    run.finish(Reason::Interrupted);
    let (ended, _) = run.concluded(EXITED_WITH_0);
    assert!(ended.interrupted && ended.failure.is_none());
}

#[test]
fn what_units_say_is_printed_in_order() {
    let run = Run::new();
    for (tick, text) in [(1, "low battery"), (2, "empty battery")] {
        let category = "battery".to_owned();
        let (instance, counts_at, text) = (Some(0), tick, text.to_owned());
        run.send(&Message::Log(LogMessage { instance, tick, counts_at, status: 1, category, text }));
    }
    let (_, printed) = run.concluded(EXITED_WITH_0);
    assert_eq!(printed, "0.01 s  quad  warning  low battery\n0.02 s  quad  warning  empty battery\n");
}

#[test]
fn a_program_that_ends_at_once_breaks_the_run() {
    let run = Run::new();
    let ended = run.supervise("/bin/true", None).unwrap();
    assert_eq!(ended.failure.unwrap().to_string(), "the stepping process ended (exit code 0) between calls at 0 s");
}

#[test]
fn a_program_that_cannot_be_started_is_an_error() {
    let run = Run::new();
    let error = run.supervise("/no/such/program", None).unwrap_err().to_string();
    assert!(error.starts_with("cannot start the stepping process: "), "{error}");
}
