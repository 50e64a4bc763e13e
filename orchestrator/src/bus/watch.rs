//! Live values: what a run shows on keys to whoever watches, without ever waiting for them.
//!
//! ```text
//! the parent of the run ── rows ──► queue, the newest count ──► publisher, a thread ── keys ──► anybody's client
//!                                                                   └── state and claims, from the board
//! ```
//!
//! A row is copied only while somebody watches. `docs/watching.md` tells keys and payloads.

mod keys;
mod payload;
mod publisher;
mod rows;
mod session;
#[cfg(test)]
mod tests;

pub use session::{ANY_LOCAL_PORT, ListenError, Listening};

use crate::bus::link::run_name;
use crate::host::supervise::LiveObserver;
use crate::run::run_spec::RunSpec;
use publisher::Publisher;
use results::report::status;
use results::run_record::RunState;
use rows::Rows;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;
use std::time::Duration;
use unit::board::Board;

/// Between two samples, and between two words on how the run stands.
const SAMPLE_EVERY: Duration = Duration::from_millis(20);
/// Between two looks for rows of which all are wanted.
const LOOK_EVERY: Duration = Duration::from_millis(2);
/// Bytes of rows that may wait for the publisher where all are wanted.
const ROOM_BYTES: usize = 4 << 20;
/// How long those who watch may take to hear the end of a run.
const FAREWELL: Duration = Duration::from_secs(1);

/// Which rows are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// The newest, 50 times a second.
    Sample,
    /// All, as far as they can be put as fast as they come.
    EveryTick,
}

impl Rate {
    fn look_every(self) -> Duration {
        match self {
            Self::Sample => SAMPLE_EVERY,
            Self::EveryTick => LOOK_EVERY,
        }
    }

    /// How many rows of so many columns may wait.
    fn room(self, columns: usize) -> usize {
        match self {
            Self::Sample => 1,
            Self::EveryTick => (ROOM_BYTES / 8 / (columns + 1)).max(1),
        }
    }
}

/// What the run's thread and the publisher share.
#[derive(Debug)]
struct Shared {
    rows: Mutex<Rows>,
    /// How many keys somebody watches.
    watched: AtomicUsize,
    /// Where the run notes how far it is, once it has begun.
    board: OnceLock<Arc<Board>>,
}

impl Shared {
    fn rows(&self) -> MutexGuard<'_, Rows> {
        // A queue is whole between its calls.
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Another key is watched, or one less.
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
}

impl Watch {
    /// Declares what there is to watch in a run and starts the publisher.
    ///
    /// # Errors
    /// The session is closed.
    pub fn new(listening: Listening, spec: &RunSpec, rate: Rate) -> Result<Self, ListenError> {
        let columns = spec.scenario.columns.len();
        let rows = Mutex::new(Rows::new(columns, rate.room(columns)));
        let shared = Arc::new(Shared { rows, watched: AtomicUsize::new(0), board: OnceLock::new() });
        let run = run_name();
        let publisher = Publisher::new(&listening, Arc::clone(&shared), rate, run.clone(), spec)
            .map_err(|error| ListenError::new(listening.endpoint(), &error))?;
        let (ending, end) = mpsc::channel();
        let (tell, dropped) = mpsc::channel();
        thread::spawn(move || tell.send(publisher.run(&end)));
        Ok(Self { run, rate, shared, ending, dropped })
    }

    /// The run's name in keys.
    #[must_use]
    pub fn run(&self) -> &str {
        &self.run
    }
}

impl LiveObserver for Watch {
    fn begin(&mut self, board: &Arc<Board>) {
        let begun = self.shared.board.set(Arc::clone(board));
        assert!(begun.is_ok(), "a run begins once");
    }

    fn row(&mut self, tick: u64, slots: &[u64]) {
        if self.shared.watched.load(Ordering::Relaxed) > 0 {
            self.shared.rows().push(tick, slots);
        }
    }

    /// Gives those who watch a second to hear it.
    fn end(self: Box<Self>, state: RunState) {
        // The publisher lives until it hears this.
        self.ending.send(state).ok();
        match (self.dropped.recv_timeout(FAREWELL), self.rate) {
            (Ok(dropped @ 1..), Rate::EveryTick) => {
                status(&format!("note: {dropped} rows came too fast for --live-every-tick; --pace slows a run down"));
            }
            (Ok(_), _) => {}
            (Err(_), _) => status("note: those who watch did not hear the end of the run within a second"),
        }
    }
}
