//! A run with a process for each instance: the step loop is a thread of this process, the workers are its children.
//!
//! The step loop needs no process of its own, as this process loads no unit that could crash it.

use super::worker_processes::WorkerProcesses;
use super::worker_set::WorkerSet;
use crate::host::supervise::{Stepping, SuperviseRequest};
use crate::run::board_observer;
use crate::run::stepping::step_run_with;
use std::io;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;
use unit::board::Board;
use unit::failure::Cause;

/// How long workers may take to end after their last order.
const EXIT_DEADLINE: Duration = Duration::from_secs(1);

/// The step loop's thread and the worker processes; dropping it ends the processes.
#[derive(Debug)]
struct Isolated {
    processes: Arc<WorkerProcesses>,
    thread: JoinHandle<()>,
}

/// Starts a worker process for each instance, and the step loop; see [`StartWorkers`](crate::host::supervise::StartWorkers).
///
/// # Errors
/// As for [`Isolated::start`].
pub fn start_isolated(request: &SuperviseRequest<'_>, board: &Arc<Board>) -> io::Result<Box<dyn Stepping>> {
    Ok(Box::new(Isolated::start(request, board)?))
}

impl Isolated {
    /// Starts a worker for each instance, and the step loop. Rows, messages and claims go to this board.
    ///
    /// # Errors
    /// A process cannot be started, or its board cannot be made.
    fn start(request: &SuperviseRequest<'_>, board: &Arc<Board>) -> io::Result<Self> {
        let spec = request.spec.clone();
        let home = request.spec.board.parent().unwrap_or(&request.spec.board);
        let count = spec.scenario.instances.len();
        let workers = WorkerSet::start(&request.program, home, count, request.step_timeout)?;
        let (processes, board) = (workers.processes(), Arc::clone(board));
        let children = Arc::clone(&processes);
        let step = move || {
            let worker_of: Vec<_> = (0..count).collect();
            step_run_with(&spec, &board, &worker_of, |wiring| {
                workers.initialize(&spec, wiring, &board_observer::sink(&board))
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
