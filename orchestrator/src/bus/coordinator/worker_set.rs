//! The workers of a run: processes that are started and brought into initialization mode at the same time.

use super::hang_monitor::HangMonitor;
use super::remote::{Remote, WorkerHandle};
use super::worker_processes::WorkerProcesses;
use crate::bus::link::endpoint;
use crate::bus::link::run_name;
use crate::bus::worker::Address;
use crate::run::message::MessageSink;
use crate::run::run_spec::RunSpec;
use crate::run::worker::{Lost, Shutdown, Worker};
use flatten::wiring::Plan;
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::thread;
use std::time::Duration;
use unit::board::{Board, BoardLayout};
use unit::descriptors::{are_left, raise_limit};
use unit::failure::Failure;
use unit::process::{has_address_space, may_start};

/// What zenoh opens in the coordinator, once and for each worker, with the pipe to the worker; and as many more for the start
/// of processes. zenoh ends the program with a panic where it gets none.
const DESCRIPTORS: usize = 24;
const DESCRIPTORS_PER_WORKER: usize = 3;
/// What zenoh's threads map, likewise.
const ADDRESS_SPACE: usize = 1 << 30;
const ADDRESS_SPACE_PER_WORKER: usize = 64 << 20;
/// Threads of zenoh and of ours, likewise; of a worker with its process.
const THREADS: usize = 12;
const THREADS_PER_WORKER: usize = 9;

/// Worker processes to which there is no connection yet.
#[derive(Debug)]
pub struct WorkerSet {
    processes: Arc<WorkerProcesses>,
    handles: Vec<WorkerHandle>,
}

impl WorkerSet {
    /// Starts so many processes of a program that has the subcommand [`SUBCOMMAND`](super::SUBCOMMAND), with their boards
    /// in a private folder. `step_timeout` is the limit of a call of a unit; `None` waits without limit.
    ///
    /// # Errors
    /// A process cannot be started, or its board cannot be made.
    pub fn start(program: &Path, home: &Path, count: usize, step_timeout: Option<Duration>) -> io::Result<Self> {
        let addresses: Vec<_> = (0..count).map(|number| Address { home: home.to_owned(), number }).collect();
        for address in &addresses {
            endpoint(&address.socket()).map_err(io::Error::other)?;
        }
        raise_limit();
        if !are_left(DESCRIPTORS + count * DESCRIPTORS_PER_WORKER) {
            let text = format!("{count} of them need more file descriptors than are left; raise the limit (ulimit -n)");
            return Err(io::Error::other(text));
        }
        if !has_address_space(ADDRESS_SPACE + count * ADDRESS_SPACE_PER_WORKER) {
            return Err(io::Error::other("they need more address space than is left; raise the limit (ulimit -v)"));
        }
        if !may_start(THREADS + count * THREADS_PER_WORKER) {
            let text = "they need more processes and threads than are left; raise the limit (ulimit -u)";
            return Err(io::Error::other(text));
        }
        let layout = BoardLayout { notes: 1, columns: 0, claims: 0 };
        let boards = addresses.iter().map(|address| Board::create(&address.board(), &layout).map(Arc::new));
        let boards = boards.collect::<io::Result<Vec<_>>>()?;
        let hang_monitor = Arc::new(HangMonitor::new(&boards, step_timeout));
        let processes = Arc::new(WorkerProcesses::start(program, &addresses)?);
        let handles = addresses.into_iter().zip(boards).map(|(address, board)| {
            let (processes, hang_monitor) = (Arc::clone(&processes), Arc::clone(&hang_monitor));
            WorkerHandle { address, board, processes, hang_monitor }
        });
        Ok(Self { handles: handles.collect(), processes })
    }

    /// The processes.
    #[must_use]
    pub fn processes(&self) -> Arc<WorkerProcesses> {
        Arc::clone(&self.processes)
    }

    /// Brings all workers into initialization mode. Each order goes to all workers before the first reply is awaited, so
    /// that units load at the same time. A worker holds the instances that have its number in the plan; `sink` takes the
    /// log messages of units.
    ///
    /// # Errors
    /// The failure of the first instance in the script's order; the other connected workers are ordered to end.
    pub fn initialize<'a>(
        self,
        spec: &'a RunSpec,
        plan: &Plan,
        sink: &MessageSink,
    ) -> Result<Vec<Box<dyn Worker + 'a>>, Failure> {
        let run = run_name();
        let connected: Vec<_> = thread::scope(|scope| {
            let connect = |handle| {
                let run = &run;
                scope.spawn(move || Remote::connect(spec, plan, handle, Arc::clone(sink), run))
            };
            let threads: Vec<_> = self.handles.into_iter().map(connect).collect();
            let join = |thread: thread::ScopedJoinHandle<'_, _>| {
                thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            };
            threads.into_iter().map(join).collect()
        });
        let mut remotes = connected.into_iter().collect::<Result<Vec<_>, _>>()?;
        for step in [Remote::shake_hands, Remote::open, Remote::enter] {
            let pending: Vec<_> = remotes.iter_mut().map(step).collect();
            let confirmed = remotes.iter_mut().zip(pending);
            let confirmed = confirmed.map(|(remote, pending)| pending.and_then(|pending| remote.confirm(pending)));
            let lost: Vec<_> = confirmed.filter_map(Result::err).collect();
            if let Some(Lost { failure, .. }) = lost.into_iter().min_by_key(|lost| lost.instance) {
                for remote in &mut remotes {
                    // The run has failed already; a second failure here would hide the first.
                    remote.finish(0, Shutdown::Immediate).ok();
                }
                return Err(failure);
            }
        }
        Ok(remotes.into_iter().map(|remote| Box::new(remote) as Box<dyn Worker>).collect())
    }
}
