//! The signals that end the program: SIGINT, SIGTERM, SIGHUP and SIGQUIT.
//!
//! While a run has results to complete, signals are counted, and its supervisor ends it. At any other time a signal ends the
//! program at once; the private folders of runs are removed before.

use signal_hook::consts::{SIGABRT, SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::Builder;
use unit::{exit, process};

/// The exit code of a program that was interrupted.
pub const INTERRUPTED: u8 = 130;
/// The exit code of a program that broke.
pub const BROKEN: u8 = 3;
/// Enough for the removal of a folder.
const STACK_BYTES: usize = 256 << 10;
/// How often the removal of a folder is tried in which another thread may still make files.
const REMOVALS: usize = 100;

static STATE: Mutex<State> = Mutex::new(State { runs: 0, received: 0, homes: Vec::new() });

/// The thread that ends the program keeps it locked, so that no other thread prints a consequence of that.
struct State {
    /// Runs that have results to complete.
    runs: usize,
    /// Signals that came while there were such runs.
    received: usize,
    /// The private folders that exist.
    homes: Vec<PathBuf>,
}

fn state() -> MutexGuard<'static, State> {
    // A thread that panicked with the lock has left the value valid: no change of it takes two statements.
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Handles the signals from now on. SIGHUP stays ignored where `nohup` ignores it. An abort, the end of a program that gets
/// no memory, has the exit code of a run that broke.
///
/// # Errors
/// The system gives no thread or no descriptors.
pub fn listen() -> io::Result<()> {
    flag::register_conditional_shutdown(SIGABRT, BROKEN.into(), Arc::new(true.into()))?;
    let handled = [SIGINT, SIGTERM, SIGQUIT, SIGHUP].into_iter();
    let mut signals = Signals::new(handled.filter(|&signal| signal != SIGHUP || !process::is_ignored(SIGHUP)))?;
    let receive = move || {
        for _ in signals.forever() {
            let mut state = state();
            if state.runs == 0 {
                end(state, INTERRUPTED);
            }
            state.received += 1;
        }
    };
    Builder::new().name("signals".to_owned()).stack_size(STACK_BYTES).spawn(receive).map(drop)
}

/// How many signals have come while there was a run with results to complete.
#[must_use]
pub fn received() -> usize {
    state().received
}

/// Removes the private folders and ends the program.
fn end(state: MutexGuard<'_, State>, code: u8) -> ! {
    for home in &state.homes {
        let mut removals = (0..REMOVALS).map(|_| std::fs::remove_dir_all(home));
        // A failure is not reported: the next run tries again.
        removals.find(|removed| removed.is_ok() || !home.exists());
    }
    exit::at_once(code.into())
}

/// Changes the list of the private folders. No folder is made or removed but in `change`.
pub(super) fn homes<T>(change: impl FnOnce(&mut Vec<PathBuf>) -> T) -> T {
    change(&mut state().homes)
}

/// A run with results to complete: as long as this value exists, signals are counted.
#[derive(Debug)]
pub struct Completion(());

impl Completion {
    /// Counts signals from now on.
    #[must_use]
    pub fn begin() -> Self {
        state().runs += 1;
        Self(())
    }
}

impl Drop for Completion {
    fn drop(&mut self) {
        state().runs -= 1;
    }
}
