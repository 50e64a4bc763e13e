//! The processes of a run's workers: started together, told apart by number, and never left behind.
//!
//! Their standard input is a pipe that stays open as long as this process lives; that it closes tells a worker that the
//! coordinator is gone. What units print goes to this process's standard error.

use crate::bus::worker::Address;
use std::io;
use std::num::NonZero;
use std::os::fd::AsFd;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{available_parallelism, sleep};
use std::time::{Duration, Instant};

/// The subcommand that a worker is started with.
pub const SUBCOMMAND: &str = "worker";

/// A worker has one link, so few threads serve it best.
const RUNTIME: (&str, &str) = (
    "ZENOH_RUNTIME",
    "(rx: (worker_threads: 1), tx: (handover: rx), net: (handover: rx), acc: (handover: rx), app: (handover: rx))",
);
const LOOK_AGAIN: Duration = Duration::from_millis(1);

/// Processes that do not outlive this value.
#[derive(Debug)]
pub struct WorkerProcesses {
    children: Vec<Mutex<Child>>,
    /// How many this process may use.
    processors: usize,
    killed: AtomicBool,
}

impl WorkerProcesses {
    /// Starts a process for each address, in process groups of their own so that Ctrl-C reaches them through us only.
    ///
    /// # Errors
    /// One could not be started; those that were are gone again.
    pub fn start<'a>(program: &Path, addresses: impl IntoIterator<Item = &'a Address>) -> io::Result<Self> {
        let mut processes = Self {
            children: Vec::new(),
            processors: available_parallelism().map_or(1, NonZero::get),
            killed: AtomicBool::new(false),
        };
        for address in addresses {
            let mut command = Command::new(program);
            command.arg(SUBCOMMAND).args(["--once", "--home"]).arg(&address.home).arg(address.number.to_string());
            command.env(RUNTIME.0, RUNTIME.1).stdin(Stdio::piped()).process_group(0);
            command.stdout(io::stderr().as_fd().try_clone_to_owned()?);
            processes.children.push(Mutex::new(command.spawn()?));
        }
        Ok(processes)
    }

    fn child(&self, number: usize) -> MutexGuard<'_, Child> {
        // What it guards is whole after every statement.
        self.children[number].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether there is a processor for each worker and one more for whoever waits for them.
    #[must_use]
    pub fn has_room(&self) -> bool {
        self.children.len() < self.processors
    }

    /// How a worker ended, if it did.
    #[must_use]
    pub fn ended(&self, number: usize) -> Option<ExitStatus> {
        self.child(number).try_wait().ok().flatten()
    }

    /// How a worker ended, if it does so within this time.
    #[must_use]
    pub fn ends_within(&self, number: usize, patience: Duration) -> Option<ExitStatus> {
        let began = Instant::now();
        loop {
            let ended = self.ended(number);
            if ended.is_some() || began.elapsed() >= patience {
                return ended;
            }
            sleep(LOOK_AGAIN);
        }
    }

    /// Ends a worker at once.
    pub fn kill(&self, number: usize) {
        // It may be gone already.
        let _ = self.child(number).kill();
    }

    /// Ends all workers at once, for good.
    pub fn kill_all(&self) {
        self.killed.store(true, Ordering::Release);
        (0..self.children.len()).for_each(|number| self.kill(number));
    }

    /// Whether all workers were ended at once.
    #[must_use]
    pub fn were_killed(&self) -> bool {
        self.killed.load(Ordering::Acquire)
    }

    /// Waits until all workers are gone; whoever is still there after this time is ended.
    pub fn await_exit(&self, grace: Duration) {
        let began = Instant::now();
        for number in 0..self.children.len() {
            if self.ends_within(number, grace.saturating_sub(began.elapsed())).is_none() {
                self.kill(number);
            }
        }
        for child in &self.children {
            let _ = child.lock().unwrap_or_else(PoisonError::into_inner).wait();
        }
    }
}

impl Drop for WorkerProcesses {
    fn drop(&mut self) {
        self.kill_all();
        self.await_exit(Duration::ZERO);
    }
}
