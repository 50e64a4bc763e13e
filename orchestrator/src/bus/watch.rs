//! Live values: a run publishes rows, state and claims on keys, and never waits for a subscriber.
//!
//! ```text
//! the parent of the run ── rows ──► queue, drops the oldest ──► publisher, a thread ── keys ──► any zenoh client
//!                                                                   └── state and claims, from the board
//! ```
//!
//! A row is copied only while a key has a subscriber. `docs/watching.md` describes keys and payloads.

mod keys;
mod payload;
mod publisher;
mod rows;
mod session;
#[cfg(test)]
mod tests;

pub use session::{ANY_LOCAL_PORT, ListenError, Listening};

use crate::bus::link::run_name;
use crate::run::run_spec::RunSpec;
use publisher::Publisher;
use results::TraceError;
use results::report::status;
use results::run_record::RunState;
use results::sink::Sink;
use rows::Rows;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;
use unit::board::Board;

/// The time between two samples, and between two publications of the state.
const SAMPLE_EVERY: Duration = Duration::from_millis(20);
/// The time between two checks for rows if every row is published.
const CHECK_EVERY: Duration = Duration::from_millis(2);
/// Bytes of rows that may wait for the publisher if every row is published.
const QUEUE_BYTES: usize = 4 << 20;
/// How long subscribers may take to receive the end of a run.
const END_TIMEOUT: Duration = Duration::from_secs(1);

/// Which rows are published.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// The newest, 50 times a second.
    Sample,
    /// All, unless the run makes them faster than they can be published.
    EveryTick,
}

impl Rate {
    fn period(self) -> Duration {
        match self {
            Self::Sample => SAMPLE_EVERY,
            Self::EveryTick => CHECK_EVERY,
        }
    }

    /// How many rows of so many columns may wait for the publisher.
    fn capacity(self, columns: usize) -> usize {
        match self {
            Self::Sample => 1,
            Self::EveryTick => (QUEUE_BYTES / 8 / (columns + 1)).max(1),
        }
    }
}

/// Shared by the run's thread and the publisher.
#[derive(Debug)]
struct Shared {
    rows: Mutex<Rows>,
    /// How many keys have subscribers. Relaxed ordering is enough: no other memory depends on it, and a row more or less at
    /// the begin of a subscription does not matter.
    watched: AtomicUsize,
    /// The run's board with tick and claims, once the run has begun.
    board: OnceLock<Arc<Board>>,
}

impl Shared {
    fn rows(&self) -> MutexGuard<'_, Rows> {
        // A thread that panicked with the lock has left the queue valid: the assertions of `Rows` come before its changes.
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A key has its first subscriber, or has lost its last.
    fn count_key(&self, watched: bool) {
        if watched {
            self.watched.fetch_add(1, Ordering::Relaxed);
        } else {
            self.watched.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

/// A run that can be watched.
#[derive(Debug)]
pub struct Watch {
    run: String,
    rate: Rate,
    shared: Arc<Shared>,
    ending: Sender<RunState>,
    dropped: Receiver<u64>,
    /// The state in which the run ended; broken if it ends without `finish`.
    end: RunState,
}

impl Watch {
    /// Declares the keys of a run and starts the publisher.
    ///
    /// # Errors
    /// The session is closed.
    pub fn new(listening: Listening, spec: &RunSpec, rate: Rate) -> Result<Self, ListenError> {
        let columns = spec.scenario.columns.len();
        let rows = Mutex::new(Rows::new(columns, rate.capacity(columns)));
        let shared = Arc::new(Shared { rows, watched: AtomicUsize::new(0), board: OnceLock::new() });
        let run = run_name();
        let publisher = Publisher::new(&listening, Arc::clone(&shared), rate, run.clone(), spec)
            .map_err(|error| ListenError::new(listening.endpoint(), &error))?;
        let (ending, end) = mpsc::channel();
        let (sender, dropped) = mpsc::channel();
        thread::spawn(move || sender.send(publisher.run(&end)));
        Ok(Self { run, rate, shared, ending, dropped, end: RunState::Broken })
    }

    /// The run begins; how far it is and how its claims stand is on this board.
    #[must_use]
    pub fn on(self, board: &Arc<Board>) -> Self {
        let begun = self.shared.board.set(Arc::clone(board));
        assert!(begun.is_ok(), "a run begins once");
        self
    }

    /// The run's name in keys.
    #[must_use]
    pub fn run(&self) -> &str {
        &self.run
    }
}

impl Sink for Watch {
    fn row(&mut self, tick: u64, slots: &[u64]) -> Result<(), TraceError> {
        if self.shared.watched.load(Ordering::Relaxed) > 0 {
            self.shared.rows().push(tick, slots);
        }
        Ok(())
    }

    /// The end is published when `self` is dropped, as that of a run whose results cannot be written.
    fn finish(mut self: Box<Self>, end: RunState) -> Result<(), TraceError> {
        self.end = end;
        Ok(())
    }
}

impl Drop for Watch {
    /// Waits up to a second until the end of the run is published.
    fn drop(&mut self) {
        // The publisher's thread runs until it receives this.
        self.ending.send(self.end).ok();
        match (self.dropped.recv_timeout(END_TIMEOUT), self.rate) {
            (Ok(dropped @ 1..), Rate::EveryTick) => {
                status(&format!("note: {dropped} rows came too fast for --live-every-tick; --pace slows a run down"));
            }
            (Ok(_), _) => {}
            (Err(_), _) => status("note: those who watch did not hear the end of the run within a second"),
        }
    }
}
