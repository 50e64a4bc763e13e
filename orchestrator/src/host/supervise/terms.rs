//! The types of supervision: its result and what it supervises.

use crate::run::message::Finish;
use crate::run::run_spec::RunSpec;
use results::TraceError;
use results::events::WindowChange;
use results::run_record::RunState;
use results::sink::Sink;
use results::verdict::Standing;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use std::{fmt, io};
use unit::board::Board;
use unit::failure::{Cause, Failure};

/// Starts the workers of a run, which are processes of this program, and its loop, which writes rows, messages and claims
/// to this board.
pub type StartWorkers = fn(&Path, &RunSpec, &Arc<Board>) -> io::Result<Box<dyn Stepping>>;

/// Begins to show a run while it goes on: how far it is and how its claims stand is on this board.
pub type BeginLive = Box<dyn FnOnce(&Arc<Board>) -> Box<dyn Sink>>;

/// The process or thread that steps a run, seen by its supervisor.
pub trait Stepping {
    /// If it is over: the reason, in case it counts as broken because it did not report its end. All that it reported is
    /// on the board then.
    ///
    /// # Errors
    /// The system cannot report the state of the process.
    fn ended(&mut self) -> io::Result<Option<Cause>>;

    /// Waits for the programs which its units started, whose parents have ended and which have ended themselves.
    fn reap_adopted(&self);

    /// Whether it is a process that was stopped (`SIGSTOP`) and not continued.
    fn is_stopped(&self) -> bool;

    /// Ends it at once; [`Stepping::ended`] tells when that has happened.
    fn kill(&mut self);
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub struct RunEnd {
    /// The tick that it reached.
    pub last_tick: u64,
    /// What the loop said, if it ended by itself.
    pub finish: Option<Finish>,
    /// What broke it, if something did.
    pub failure: Option<Failure>,
    /// Whether the user ended it.
    pub interrupted: bool,
    /// How each claim stands at the end.
    pub standings: Vec<Standing>,
    /// The windows that opened and closed.
    pub events: Vec<WindowChange>,
    /// How long it took.
    pub wall: Duration,
}

impl RunEnd {
    /// The state in which the run ended.
    #[must_use]
    pub fn state(&self) -> RunState {
        match (self.interrupted, &self.failure) {
            (true, _) => RunState::Interrupted,
            (false, Some(_)) => RunState::Broken,
            (false, None) => RunState::Finished,
        }
    }
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
