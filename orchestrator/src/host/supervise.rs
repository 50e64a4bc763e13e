//! Supervises a run: starts the process or thread that steps it, writes and prints what it reports, returns how it ended.
//!
//! Whatever a unit does to the stepping process, this process has the rows up to then and the call in progress. Where each
//! instance has a process of its own, the loop runs in a thread of this one, and all else is the same.

mod checkpoints;
mod log_lines;
mod log_order;
mod post_mortem;
mod standings;
mod stepping_process;
mod terms;
#[cfg(test)]
mod tests;
mod windows;

use crate::host::watchdog::Watchdog;
use crate::run::interruption;
use crate::run::message::{Finish, Message, Reason};
use crate::run::run_spec::RunSpec;
use log_lines::LogLines;
use log_order::LogOrder;
pub use post_mortem::{cause_of_death, failure};
use results::TraceError;
use results::checkpoint::Saving;
use results::events::WindowChange;
use results::recorder::Recorder;
use results::report::console::Console;
use results::report::progress::Progress;
use results::sink::Event;
use standings::standing_claims;
pub(crate) use standings::standings;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};
pub use stepping_process::SUBCOMMAND;
use stepping_process::SteppingProcess;
pub use terms::{BeginLive, RunEnd, StartWorkers, Stepping, SuperviseError};
use unit::board::{Board, BoardLayout, InCall};
use unit::failure::{Cause, Failure};
use unit::logger::LogMessage;
use unit::process::LONGEST_STOP;
use unit::time::seconds;

/// How long the parent sleeps when nothing came, and when something did.
const IDLE: Duration = Duration::from_millis(5);
const BUSY: Duration = Duration::from_millis(1);
/// Recorded rows reach the disk at least this often.
const SAVE_EVERY: Duration = Duration::from_millis(500);
/// The time between two questions whether the stepping process is stopped.
const LOOK_PERIOD: Duration = Duration::from_millis(50);
/// How long a stepping process may take to exit after it reported the end of the run.
const EXIT_DEADLINE: Duration = Duration::from_secs(2);

pub(super) fn start_error(doing: &'static str) -> impl FnOnce(io::Error) -> SuperviseError {
    move |error| SuperviseError::Start { doing, error }
}

/// Runs a spec to its end. Its child process is one of `program`; its workers, if it has any, are started by
/// `start_workers`. Rows and calls go to the recorder, whose files are complete when this returns, and then to what shows
/// the run while it goes on.
///
/// # Errors
/// If what steps cannot be started or the trace not be written; no process of the run is left then either.
pub fn supervise<W: Write>(
    spec: &RunSpec,
    saving: &Saving,
    program: &Path,
    start_workers: Option<StartWorkers>,
    mut recorder: Recorder,
    live: Option<BeginLive>,
    console: &mut Console<W>,
) -> Result<RunEnd, SuperviseError> {
    let columns = if spec.options.hands_over_rows() { spec.scenario.columns.len() } else { 0 };
    let layout = BoardLayout { notes: 1, columns, claims: spec.scenario.claims.len() };
    let board = if spec.worker_of.is_some() { Board::private(&layout) } else { Board::create(&spec.board, &layout) };
    let board = Arc::new(board.map_err(start_error("make the board of the run"))?);
    let stepping = match (&spec.worker_of, start_workers) {
        (None, _) => SteppingProcess::start(program, spec)
            .map(|process| -> Box<dyn Stepping> { Box::new(process) })
            .map_err(start_error("start the stepping process")),
        (Some(_), Some(start_workers)) => {
            start_workers(program, spec, &board).map_err(start_error("start the workers"))
        }
        (Some(_), None) => Err(start_error("start the workers")(io::ErrorKind::Unsupported.into())),
    }?;
    // Last, so that all that a run opens is open before clients connect, and that rows are in the files before the end of the
    // run is published.
    live.into_iter().for_each(|begin| recorder.add(begin(&board)));
    supervise_loop(Supervision::new(spec, saving, &board, recorder, console), stepping)
}

/// The order of the parameters is that in which they are dropped, last to first: what steps a run that is given up ends
/// before that is published.
fn supervise_loop<W: Write>(
    mut run: Supervision<'_, W>,
    mut stepping: Box<dyn Stepping>,
) -> Result<RunEnd, SuperviseError> {
    loop {
        // Asked before the rings are emptied, so that they contain all that was sent before it ended.
        let over = stepping.ended().map_err(start_error("look after what steps the run"))?;
        let began = Instant::now();
        let drained = run.drain();
        if let Some(cause) = over {
            return run.conclude(cause, drained.err());
        }
        let busy = drained.map_err(|error| run.give_up(error))?;
        while run.interrupts < interruption::received() {
            run.interrupt(&mut *stepping);
        }
        stepping.reap_adopted();
        run.watch(&mut *stepping);
        run.report_progress();
        if !busy {
            thread::sleep(IDLE);
        } else if began.elapsed() < BUSY {
            // Otherwise more has arrived meanwhile, and the stepping process may be waiting for space in the rings.
            thread::sleep(BUSY);
        }
    }
}

/// A run that goes on.
struct Supervision<'a, W: Write> {
    spec: &'a RunSpec,
    saving: &'a Saving,
    /// The checkpoints that are written, by tick.
    kept: Vec<u64>,
    board: &'a Board,
    console: &'a mut Console<W>,
    recorder: Recorder,
    saved: Instant,
    began: Instant,
    polled: Instant,
    log_order: LogOrder,
    log_lines: LogLines,
    calls: Option<Watchdog<InCall>>,
    /// When it was last asked whether the stepping process is stopped, and since when it is.
    looked: Instant,
    stopped: Watchdog<()>,
    exit_deadline: Watchdog<()>,
    last_row: Option<u64>,
    /// The first tick that did not increase; no row is taken after it.
    repeated: Option<u64>,
    finish: Option<Finish>,
    failure: Option<Failure>,
    events: Vec<WindowChange>,
    interrupts: usize,
}

impl<'a, W: Write> Supervision<'a, W> {
    fn new(
        spec: &'a RunSpec,
        saving: &'a Saving,
        board: &'a Board,
        recorder: Recorder,
        console: &'a mut Console<W>,
    ) -> Self {
        let now = Instant::now();
        Self {
            spec,
            saving,
            kept: Vec::new(),
            board,
            console,
            recorder,
            saved: now,
            began: now,
            polled: now,
            log_order: LogOrder::default(),
            log_lines: LogLines::default(),
            // Where each instance has a process of its own, the coordinator limits the time of its replies.
            calls: spec.options.step_timeout.filter(|_| spec.worker_of.is_none()).map(Watchdog::new),
            looked: now,
            stopped: Watchdog::new(LONGEST_STOP),
            exit_deadline: Watchdog::new(EXIT_DEADLINE),
            last_row: None,
            repeated: None,
            finish: None,
            failure: None,
            events: Vec::new(),
            interrupts: 0,
        }
    }

    /// Takes everything out of the rings; says whether there was something.
    fn drain(&mut self) -> Result<bool, TraceError> {
        // Read before the rings are emptied: all messages that count before this tick were sent before it was reached.
        let reached = self.board.tick();
        let (recorder, last_row) = (&mut self.recorder, &mut self.last_row);
        let mut refused = None;
        let repeated = &mut self.repeated;
        let rows = self.board.pop_rows(|tick, slots| {
            if repeated.is_some() || last_row.is_some_and(|last| tick <= last) {
                repeated.get_or_insert(tick);
                return;
            }
            *last_row = Some(tick);
            let recorded = recorder.row(tick, slots);
            refused = refused.take().or(recorded.err());
        });
        let mut messages = Vec::new();
        self.board.pop_messages(|bytes| messages.push(postcard::from_bytes::<Message>(bytes)));
        let busy = rows + messages.len() > 0;
        for message in messages {
            match message {
                Ok(message) => refused = refused.or(self.receive(message).err()),
                Err(error) => self.console.say(&format!("warning: a message of a unit could not be read: {error}")),
            }
        }
        let due = self.log_order.before(reached);
        self.print_messages(due);
        if self.log_order.are_many() {
            self.print_all_messages();
        }
        if refused.is_none() && self.saved.elapsed() >= SAVE_EVERY {
            self.saved = Instant::now();
            refused = self.recorder.save().err();
        }
        refused.map_or(Ok(busy), Err)
    }

    fn receive(&mut self, message: Message) -> Result<(), TraceError> {
        match message {
            Message::Log(log) => self.log_order.add(log),
            Message::Saved(tick) => return self.store(tick),
            Message::Calls(call) => {
                return self.recorder.event(Event::Calls { instance: call.instance, piece: &call.bytes });
            }
            Message::Window(change) => return self.window(change),
            Message::Finished(finish) => self.finish = Some(finish),
            // A failure after the user killed the run is a consequence of that.
            Message::Broken(_) if self.interrupts > 1 => {}
            Message::Broken(failure) => self.failure = Some(failure),
        }
        Ok(())
    }

    /// A file cannot be written, so the run ends; rows that wait to be written to others are, as far as that can be.
    fn give_up(&mut self, error: TraceError) -> SuperviseError {
        self.recorder.save().ok();
        SuperviseError::unwritten(self.failure.take(), error)
    }

    fn print_all_messages(&mut self) {
        let all = self.log_order.all();
        self.print_messages(all);
    }

    fn print_messages(&mut self, messages: impl Iterator<Item = LogMessage>) {
        for line in messages.flat_map(|message| self.log_lines.of(message, &self.spec.scenario)) {
            self.console.say(&line);
        }
    }

    /// The first time asks the loop to end, the second time ends it.
    fn interrupt(&mut self, stepping: &mut dyn Stepping) {
        self.interrupts += 1;
        if self.interrupts == 1 {
            self.board.request_stop();
            self.console.say("ending after this step; once more ends at once");
        } else {
            stepping.kill();
        }
    }

    /// The failure of a unit that has copied its process, if one has.
    fn copied(&self) -> Option<Failure> {
        if let Some(call) = self.board.note(0).copied() {
            return Some(failure(Some(call), call.tick, &self.spec.scenario, Cause::Copied));
        }
        let text = "its row came a second time, from a copy of the stepping process (fork)".to_owned();
        Some(Failure::between_calls(seconds(self.repeated?, self.spec.scenario.step_ns), text))
    }

    /// Kills a process that a unit has copied, that has been in one call for too long, or that does not exit after it
    /// reported the end.
    fn watch(&mut self, stepping: &mut dyn Stepping) {
        let since = self.polled.elapsed();
        self.polled = Instant::now();
        if self.failure.is_none()
            && let Some(copied) = self.copied()
        {
            self.failure = Some(copied);
            stepping.kill();
        }
        if self.finish.is_some() || self.failure.is_some() {
            if self.exit_deadline.expired(since, Some(())) {
                stepping.kill();
            }
            return;
        }
        let Some(calls) = &mut self.calls else { return };
        let looked = self.looked.elapsed();
        if looked >= LOOK_PERIOD {
            self.looked = Instant::now();
            if self.stopped.expired(looked, stepping.is_stopped().then_some(())) {
                let (call, limit_s) = (self.board.note(0).read(), LONGEST_STOP.as_secs_f64());
                self.failure = Some(failure(call, self.board.tick(), &self.spec.scenario, Cause::Stopped(limit_s)));
                return stepping.kill();
            }
        }
        let call = self.board.note(0).read();
        if calls.expired(since, call) {
            let limit_s = calls.limit().as_secs_f64();
            self.failure = Some(failure(call, self.board.tick(), &self.spec.scenario, Cause::Hung(limit_s)));
            stepping.kill();
        }
    }

    fn report_progress(&mut self) {
        let scenario = &self.spec.scenario;
        let (tick, board, wall_s) = (self.board.tick(), self.board, self.began.elapsed().as_secs_f64());
        let part = tick as f64 / scenario.stop_tick.max(1) as f64;
        let from_s = self.spec.from_s();
        self.console.progress(part, || Progress {
            time_s: seconds(tick, scenario.step_ns),
            stop_s: seconds(scenario.stop_tick, scenario.step_ns),
            from_s,
            wall_s,
            claims: standing_claims(board, self.spec),
        });
    }

    /// What stepped is gone and the rings are empty; `refused` is why their last rows could not be written.
    fn conclude(mut self, cause: Cause, refused: Option<TraceError>) -> Result<RunEnd, SuperviseError> {
        self.print_all_messages();
        self.log_lines.rest(&self.spec.scenario).iter().for_each(|line| self.console.say(line));
        self.console.clear();
        let killed_by_user = self.interrupts > 1;
        self.failure = self.failure.take().or_else(|| self.copied());
        if self.finish.is_none() && self.failure.is_none() && !killed_by_user {
            let call = self.board.note(0).read();
            self.failure = Some(failure(call, self.board.tick(), &self.spec.scenario, cause));
        }
        if let Some(error) = refused {
            return Err(self.give_up(error));
        }
        let ended_by_loop = self.finish.as_ref().map(|finish| finish.reason == Reason::Interrupted);
        let last_tick = match (&self.finish, self.last_row) {
            (Some(finish), _) => finish.last_tick,
            (None, Some(last_row)) => last_row,
            (None, None) => self.board.tick(),
        };
        let mut ended = RunEnd {
            last_tick,
            interrupted: ended_by_loop.unwrap_or(self.interrupts > 0),
            standings: standings(self.board, self.spec.scenario.claims.len()),
            events: std::mem::take(&mut self.events),
            wall: Duration::ZERO,
            finish: self.finish.take(),
            failure: self.failure.clone(),
        };
        let finished = std::mem::take(&mut self.recorder).finish(ended.state());
        ended.wall = self.began.elapsed();
        finished.map_err(|error| SuperviseError::unwritten(self.failure.take(), error))?;
        self.report_unsaved(last_tick);
        Ok(ended)
    }
}
