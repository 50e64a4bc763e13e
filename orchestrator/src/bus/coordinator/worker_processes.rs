//! The worker processes of a run: started together, identified by number, and ended with this value.
//!
//! Their standard input is a pipe to this process. The system closes it when this process ends, even by SIGKILL; that is
//! how a worker detects the end of its coordinator. What units print goes to this process's standard error.

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
use unit::process::is_stopped;

/// The subcommand that a worker is started with.
pub const SUBCOMMAND: &str = "worker";

/// zenoh's threads in a worker: one for all, as a worker has only one link and the processors are for the units.
const RUNTIME: (&str, &str) = (
    "ZENOH_RUNTIME",
    "(rx: (worker_threads: 1), tx: (handover: rx), net: (handover: rx), acc: (handover: rx), app: (handover: rx))",
);
/// The time between two checks whether a process has ended.
const CHECK_PERIOD: Duration = Duration::from_millis(1);

/// Processes that are ended when this value is dropped.
#[derive(Debug)]
pub struct WorkerProcesses {
    children: Vec<Mutex<Child>>,
    ids: Vec<u32>,
    /// How many processors this process may use.
    processors: usize,
    /// Set by [`WorkerProcesses::kill_all`], so that threads that still connect to workers stop.
    killed: AtomicBool,
}

impl WorkerProcesses {
    /// Starts a process for each address. Each has its own process group: the terminal sends Ctrl-C to the foreground group
    /// only, so the coordinator alone decides how the run ends.
    ///
    /// # Errors
    /// One could not be started; the others are ended again.
    pub fn start<'a>(program: &Path, addresses: impl IntoIterator<Item = &'a Address>) -> io::Result<Self> {
        let mut processes = Self {
            children: Vec::new(),
            ids: Vec::new(),
            processors: available_parallelism().map_or(1, NonZero::get),
            killed: AtomicBool::new(false),
        };
        for address in addresses {
            let mut command = Command::new(program);
            command.arg(SUBCOMMAND).args(["--once", "--home"]).arg(&address.home).arg(address.number.to_string());
            command.env(RUNTIME.0, RUNTIME.1).stdin(Stdio::piped()).process_group(0);
            command.stdout(io::stderr().as_fd().try_clone_to_owned()?);
            let child = command.spawn()?;
            processes.ids.push(child.id());
            processes.children.push(Mutex::new(child));
        }
        Ok(processes)
    }

    fn child(&self, number: usize) -> MutexGuard<'_, Child> {
        // A thread that panicked with the lock has left the value valid: no change of it takes two statements.
        self.children[number].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether one of them has this id.
    #[must_use]
    pub fn contain(&self, id: u32) -> bool {
        self.ids.contains(&id)
    }

    /// Whether there is a processor for each worker and one more for the coordinator, which may then poll for replies.
    #[must_use]
    pub fn have_processors_left(&self) -> bool {
        self.children.len() < self.processors
    }

    /// The exit status of a worker that has ended.
    #[must_use]
    pub fn ended(&self, number: usize) -> Option<ExitStatus> {
        self.child(number).try_wait().ok().flatten()
    }

    /// The exit status of a worker that ends within this time.
    #[must_use]
    pub fn ends_within(&self, number: usize, timeout: Duration) -> Option<ExitStatus> {
        let began = Instant::now();
        loop {
            let ended = self.ended(number);
            if ended.is_some() || began.elapsed() >= timeout {
                return ended;
            }
            sleep(CHECK_PERIOD);
        }
    }

    /// Whether a worker is stopped (`SIGSTOP`).
    #[must_use]
    pub fn is_stopped(&self, number: usize) -> bool {
        is_stopped(self.child(number).id())
    }

    /// Kills a worker.
    pub fn kill(&self, number: usize) {
        // It may have ended already.
        let _ = self.child(number).kill();
    }

    /// Kills all workers. The flag is set first, so that no thread waits for a worker that is about to end.
    pub fn kill_all(&self) {
        self.killed.store(true, Ordering::Release);
        (0..self.children.len()).for_each(|number| self.kill(number));
    }

    /// Whether [`WorkerProcesses::kill_all`] was called.
    #[must_use]
    pub fn were_killed(&self) -> bool {
        self.killed.load(Ordering::Acquire)
    }

    /// Waits until all workers have ended; those still running after this time are killed.
    pub fn await_exit(&self, timeout: Duration) {
        let began = Instant::now();
        for number in 0..self.children.len() {
            if self.ends_within(number, timeout.saturating_sub(began.elapsed())).is_none() {
                self.kill(number);
            }
        }
        for child in &self.children {
            // Without this wait an ended child stays a zombie process.
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
