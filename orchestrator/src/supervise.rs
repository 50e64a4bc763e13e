//! The parent of a run: starts the stepping process, carries what it tells to files and people, and says how it ended.
//!
//! Whatever a unit does to the stepping process, the rows up to there and the call in which it happened are here.

mod last_words;
mod stepping_process;
#[cfg(test)]
mod tests;
mod watchdog;

use crate::claims::Verdict;
use crate::failure::{Cause, Failure};
use crate::message::{Finish, Message, Reason};
use crate::plan::Plan;
use crate::report::console::Console;
use crate::report::progress::Progress;
use crate::trace::TraceError;
use crate::trace::recorder::Recorder;
use crate::trace::verdict::{Finding, JudgedClaim, Judgement};
use crate::unit::board::{Board, BoardLayout, InCall};
use crate::wiring::seconds;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitStatus;
use std::time::{Duration, Instant};
use std::{fmt, thread};
pub use stepping_process::SUBCOMMAND;
use stepping_process::SteppingProcess;
use watchdog::Watchdog;

/// How long the parent sleeps when nothing came, and when something did.
const IDLE: Duration = Duration::from_millis(5);
const BUSY: Duration = Duration::from_millis(1);
/// Recorded rows reach the disk at least this often.
const SAVE_EVERY: Duration = Duration::from_millis(500);
/// How long a stepping process may take to go after it said that it is done.
const FAREWELL: Duration = Duration::from_secs(2);

/// What the parent of a run is told.
#[derive(Clone, Debug)]
pub struct Orders<'a> {
    /// What to run.
    pub plan: &'a Plan,
    /// The program that knows the subcommand `step-loop`.
    pub program: PathBuf,
    /// How long a call of a unit may take; `None` waits for ever.
    pub step_timeout: Option<Duration>,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Ended {
    /// The tick that it reached.
    pub last_tick: u64,
    /// What the loop said, if it ended by itself.
    pub finish: Option<Finish>,
    /// What broke it, if something did.
    pub failure: Option<Failure>,
    /// Whether the user ended it.
    pub interrupted: bool,
    /// How each claim came out.
    pub findings: Vec<Finding>,
    /// How long it took.
    pub wall: Duration,
}

/// Why a run could not be looked after.
#[derive(Debug)]
pub enum SuperviseError {
    /// The system refused something before the first step.
    Start {
        /// What was being done.
        doing: &'static str,
        /// What the system said.
        error: io::Error,
    },
    /// The results could not be written.
    Trace(TraceError),
    /// The results could not be written of a run that had broken before.
    Broken {
        /// What broke it.
        failure: Box<Failure>,
        /// Why there are no results.
        error: TraceError,
    },
}

impl SuperviseError {
    /// The results could not be written; what broke the run before is kept.
    #[must_use]
    pub fn unwritten(failure: Option<Failure>, error: TraceError) -> Self {
        match failure {
            Some(failure) => Self::Broken { failure: Box::new(failure), error },
            None => Self::Trace(error),
        }
    }
}

impl fmt::Display for SuperviseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start { doing, error } => write!(f, "cannot {doing}: {error}"),
            Self::Trace(error) | Self::Broken { error, .. } => error.fmt(f),
        }
    }
}

impl std::error::Error for SuperviseError {}

fn start_error(doing: &'static str) -> impl FnOnce(io::Error) -> SuperviseError {
    move |error| SuperviseError::Start { doing, error }
}

/// Runs a plan to its end. Rows and calls go to the recorder, whose files are whole when this returns.
///
/// # Errors
/// If the stepping process cannot be started or a file not be written; the stepping process is gone then too.
pub fn supervise<W: Write>(
    orders: &Orders,
    recorder: Recorder,
    console: &mut Console<W>,
) -> Result<Ended, SuperviseError> {
    let plan = orders.plan;
    let columns = if plan.record { plan.scenario.columns.len() } else { 0 };
    let layout = BoardLayout { notes: 1, columns, claims: plan.scenario.claims.len() };
    let board = Board::create(&plan.board, &layout).map_err(start_error("make the board of the run"))?;
    let mut signals = Signals::new([SIGINT, SIGTERM]).map_err(start_error("listen for Ctrl-C"))?;
    let mut process =
        SteppingProcess::start(&orders.program, plan).map_err(start_error("start the stepping process"))?;
    let mut run = Supervision::new(orders, &board, recorder, console);
    loop {
        // Asked before the rings are emptied: what it said before it ended is in them.
        let status = process.ended().map_err(start_error("look after the stepping process"))?;
        let began = Instant::now();
        let drained = run.drain();
        if let Some(status) = status {
            return run.conclude(status, drained.err());
        }
        let busy = drained.map_err(|error| SuperviseError::unwritten(run.failure.take(), error))?;
        for _ in signals.pending() {
            run.interrupt(&mut process);
        }
        run.watch(&mut process);
        run.tell_progress();
        if !busy {
            thread::sleep(IDLE);
        } else if began.elapsed() < BUSY {
            // Otherwise more has come meanwhile, and the stepping process may be waiting for room.
            thread::sleep(BUSY);
        }
    }
}

/// A run that goes on.
struct Supervision<'a, W: Write> {
    plan: &'a Plan,
    board: &'a Board,
    console: &'a mut Console<W>,
    recorder: Recorder,
    saved: Instant,
    began: Instant,
    polled: Instant,
    calls: Option<Watchdog<InCall>>,
    farewell: Watchdog<()>,
    last_row: Option<u64>,
    finish: Option<Finish>,
    failure: Option<Failure>,
    interrupts: usize,
}

impl<'a, W: Write> Supervision<'a, W> {
    fn new(orders: &Orders<'a>, board: &'a Board, recorder: Recorder, console: &'a mut Console<W>) -> Self {
        let now = Instant::now();
        Self {
            plan: orders.plan,
            board,
            console,
            recorder,
            saved: now,
            began: now,
            polled: now,
            calls: orders.step_timeout.map(Watchdog::new),
            farewell: Watchdog::new(FAREWELL),
            last_row: None,
            finish: None,
            failure: None,
            interrupts: 0,
        }
    }

    /// Takes everything out of the rings; says whether there was something.
    fn drain(&mut self) -> Result<bool, TraceError> {
        let (recorder, last_row) = (&mut self.recorder, &mut self.last_row);
        let mut refused = None;
        let rows = self.board.pop_rows(|tick, slots| {
            *last_row = Some(tick);
            if refused.is_none() {
                refused = recorder.record(tick, slots).err();
            }
        });
        let mut messages = Vec::new();
        self.board.pop_messages(|bytes| messages.push(postcard::from_bytes::<Message>(bytes)));
        let busy = rows + messages.len() > 0;
        for message in messages {
            match message {
                Ok(message) => refused = refused.or(self.hear(message).err()),
                Err(error) => self.console.say(&format!("warning: a message of a unit could not be read: {error}")),
            }
        }
        if refused.is_none() && self.saved.elapsed() >= SAVE_EVERY {
            self.saved = Instant::now();
            refused = self.recorder.save().err();
        }
        refused.map_or(Ok(busy), Err)
    }

    fn hear(&mut self, message: Message) -> Result<(), TraceError> {
        match message {
            Message::Calls(piece) => return self.recorder.add_call(piece.instance, &piece.bytes),
            Message::Log(said) => self.console.say(&last_words::log_line(&said, &self.plan.scenario)),
            Message::Finished(finish) => self.finish = Some(finish),
            Message::Broken(failure) => self.failure = Some(failure),
        }
        Ok(())
    }

    /// The first time asks the loop to end, the second time ends it.
    fn interrupt(&mut self, process: &mut SteppingProcess) {
        self.interrupts += 1;
        if self.interrupts == 1 {
            self.board.request_stop();
            self.console.say("ending after this step; once more ends at once");
        } else {
            process.kill();
        }
    }

    /// Ends a process that has been in one call for too long, or that does not go after its last word.
    fn watch(&mut self, process: &mut SteppingProcess) {
        let since = self.polled.elapsed();
        self.polled = Instant::now();
        if self.finish.is_some() || self.failure.is_some() {
            if self.farewell.bites(since, Some(())) {
                process.kill();
            }
            return;
        }
        let Some(calls) = &mut self.calls else { return };
        let call = self.board.note(0).read();
        if calls.bites(since, call) {
            let limit_s = calls.limit().as_secs_f64();
            self.failure =
                Some(last_words::failure(call, self.board.tick(), &self.plan.scenario, Cause::Hung(limit_s)));
            process.kill();
        }
    }

    fn tell_progress(&mut self) {
        let scenario = &self.plan.scenario;
        let (tick, board, wall_s) = (self.board.tick(), self.board, self.began.elapsed().as_secs_f64());
        let part = tick as f64 / scenario.stop_tick.max(1) as f64;
        self.console.progress(part, || Progress {
            time_s: seconds(tick, scenario.step_ns),
            stop_s: seconds(scenario.stop_tick, scenario.step_ns),
            wall_s,
            claims: standing_claims(board, self.plan),
        });
    }

    /// The process is gone and the rings are empty; `refused` is why their last rows could not be written.
    fn conclude(mut self, status: ExitStatus, refused: Option<TraceError>) -> Result<Ended, SuperviseError> {
        self.console.clear();
        let killed_by_user = self.interrupts > 1;
        if self.finish.is_none() && self.failure.is_none() && !killed_by_user {
            let cause = last_words::cause_of_death(status);
            let call = self.board.note(0).read();
            self.failure = Some(last_words::failure(call, self.board.tick(), &self.plan.scenario, cause));
        }
        if let Some(error) = refused.or_else(|| self.recorder.finish().err()) {
            return Err(SuperviseError::unwritten(self.failure, error));
        }
        let ended_by_loop = self.finish.as_ref().map(|finish| finish.reason == Reason::Interrupted);
        let last_tick = match (&self.finish, self.last_row) {
            (Some(finish), _) => finish.last_tick,
            (None, Some(last_row)) => last_row,
            (None, None) => self.board.tick(),
        };
        Ok(Ended {
            last_tick,
            interrupted: ended_by_loop.unwrap_or(self.interrupts > 0),
            findings: findings(self.board, self.plan),
            wall: self.began.elapsed(),
            finish: self.finish,
            failure: self.failure,
        })
    }
}

/// The claims that say something already, for the progress line.
fn standing_claims(board: &Board, plan: &Plan) -> Vec<JudgedClaim> {
    let claims = plan.scenario.claims.iter().enumerate();
    let told = claims.filter_map(|(i, claim)| {
        let note = board.claim(i)?;
        let judgement = match Verdict::from_number(note.verdict) {
            Some(Verdict::Fails) => Judgement::Failed,
            _ => Judgement::Ok,
        };
        let finding = Finding { judgement, margin: note.margin, worst_tick: note.worst_tick };
        Some(JudgedClaim::new(claim, &finding, plan.scenario.step_ns))
    });
    told.collect()
}

/// How the claims came out; what is still open when the process is gone is unjudged.
fn findings(board: &Board, plan: &Plan) -> Vec<Finding> {
    let finding = |i| {
        let unjudged = Finding { judgement: Judgement::Unjudged, margin: 0.0, worst_tick: 0 };
        board.claim(i).map_or(unjudged, |note| Finding {
            judgement: match Verdict::from_number(note.verdict) {
                Some(Verdict::Holds) => Judgement::Ok,
                Some(Verdict::Fails) => Judgement::Failed,
                Some(Verdict::Undecided | Verdict::Unjudged) | None => Judgement::Unjudged,
            },
            margin: note.margin,
            worst_tick: note.worst_tick,
        })
    };
    (0..plan.scenario.claims.len()).map(finding).collect()
}
