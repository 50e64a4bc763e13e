//! A run whose instances have a process each: the loop is a thread of this process, the workers are its children.

use super::worker_processes::Fleet;
use super::worker_set::Crew;
use crate::host::supervise::{Orders, Stepping};
use crate::run::board_observer;
use crate::run::stepping::fly_with;
use std::io;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;
use unit::board::Board;
use unit::failure::Cause;

/// How long workers may take to go after the last word.
const FAREWELL: Duration = Duration::from_secs(1);

/// The loop's thread and the workers; ended when dropped.
#[derive(Debug)]
struct Isolated {
    fleet: Arc<Fleet>,
    thread: JoinHandle<()>,
}

/// Starts a worker process for each instance, and the loop; see [`StartWorkers`](crate::host::supervise::StartWorkers).
///
/// # Errors
/// As for [`Isolated::start`].
pub fn start_isolated(orders: &Orders<'_>, board: &Arc<Board>) -> io::Result<Box<dyn Stepping>> {
    Ok(Box::new(Isolated::start(orders, board)?))
}

impl Isolated {
    /// Starts a worker for each instance of the plan, and the loop. Rows, messages and claims go to this board.
    ///
    /// # Errors
    /// A process cannot be started, or its board not be made.
    fn start(orders: &Orders<'_>, board: &Arc<Board>) -> io::Result<Self> {
        let plan = orders.plan.clone();
        let home = orders.plan.board.parent().unwrap_or(&orders.plan.board);
        let count = plan.scenario.instances.len();
        let crew = Crew::start(&orders.program, home, count, orders.step_timeout)?;
        let (fleet, board) = (crew.fleet(), Arc::clone(board));
        let workers = Arc::clone(&fleet);
        let fly = move || {
            let worker_of: Vec<_> = (0..count).collect();
            fly_with(&plan, &board, &worker_of, |wiring| crew.enlist(&plan, wiring, &board_observer::sink(&board)));
            workers.dismiss(FAREWELL);
        };
        let thread = thread::Builder::new().name("step loop".to_owned()).spawn(fly)?;
        Ok(Self { fleet, thread })
    }
}

impl Stepping for Isolated {
    fn ended(&mut self) -> io::Result<Option<Cause>> {
        // It ends without a word only if it panicked, which the panic has told already.
        let silent = || Cause::Other("the step loop ended without a word".to_owned());
        Ok(self.thread.is_finished().then(silent))
    }

    fn kill(&mut self) {
        self.fleet.abandon();
    }
}

impl Drop for Isolated {
    fn drop(&mut self) {
        if !self.thread.is_finished() {
            self.fleet.abandon();
            self.fleet.dismiss(Duration::ZERO);
        }
    }
}
