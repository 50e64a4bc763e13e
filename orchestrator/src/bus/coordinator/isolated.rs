//! A run whose instances live in worker processes: the step loop is a thread of this process, the workers are its children.
//!
//! The step loop needs no process of its own, as this process loads no unit that could crash it.

use super::worker_processes::WorkerProcesses;
use super::worker_set::WorkerSet;
use crate::host::supervise::Stepping;
use crate::run::board_observer;
use crate::run::run_spec::RunSpec;
use crate::run::stepping::step_run_with;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;
use unit::board::Board;
use unit::failure::Cause;
use unit::process;

/// How long workers may take to end after their last order.
const EXIT_DEADLINE: Duration = Duration::from_secs(1);

/// The step loop's thread and the worker processes; dropping it ends the processes.
#[derive(Debug)]
struct Isolated {
    processes: Arc<WorkerProcesses>,
    thread: JoinHandle<()>,
}

/// Starts the worker processes of a run and the step loop; see [`StartWorkers`](crate::host::supervise::StartWorkers).
///
/// # Errors
/// A process cannot be started, or its board not be made.
pub fn start_isolated(program: &Path, spec: &RunSpec, board: &Arc<Board>) -> io::Result<Box<dyn Stepping>> {
    Ok(Box::new(Isolated::start(program, spec, board)?))
}

impl Isolated {
    /// Starts as many workers as the run has and the step loop. Rows, messages and claims go to this board.
    ///
    /// # Errors
    /// A process cannot be started, or its board cannot be made.
    fn start(program: &Path, spec: &RunSpec, board: &Arc<Board>) -> io::Result<Self> {
        let (spec, worker_of) = (spec.clone(), spec.worker_of.clone().unwrap_or_default());
        let home = spec.board.parent().unwrap_or(&spec.board);
        let count = worker_of.iter().max().map_or(0, |last| last + 1);
        let workers = WorkerSet::start(program, home, count, spec.options.step_timeout)?;
        let (processes, board) = (workers.processes(), Arc::clone(board));
        let children = Arc::clone(&processes);
        let step = move || {
            step_run_with(&spec, &board, &worker_of, |plan| {
                workers.initialize(&spec, plan, &board_observer::sink(&board))
            });
            children.await_exit(EXIT_DEADLINE);
        };
        let thread = thread::Builder::new().name("step loop".to_owned()).spawn(step)?;
        Ok(Self { processes, thread })
    }
}

impl Stepping for Isolated {
    fn ended(&mut self) -> io::Result<Option<Cause>> {
        // Called when no end of the run was reported. The thread ends so only by a panic, whose message was printed already.
        let unreported = || Cause::Other("the step loop ended without a word".to_owned());
        Ok(self.thread.is_finished().then(unreported))
    }

    fn reap_adopted(&self) {
        process::reap_adopted(|process| self.processes.contain(process));
    }

    fn is_stopped(&self) -> bool {
        // The step loop is a thread of this process, and the coordinator watches the workers.
        false
    }

    fn kill(&mut self) {
        self.processes.kill_all();
    }
}

impl Drop for Isolated {
    fn drop(&mut self) {
        if !self.thread.is_finished() {
            // The thread waits for replies of the workers. Their end lets it return, so it is not joined here.
            self.processes.kill_all();
            self.processes.await_exit(Duration::ZERO);
        }
    }
}
