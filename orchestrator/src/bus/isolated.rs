//! A run whose instances have a process each: the loop is a thread of this process, the workers are its children.

use super::fleet::Fleet;
use super::remote::{Remote, Way};
use super::worker_process::Address;
use crate::child::{fly_with, told};
use crate::failure::{Cause, Failure};
use crate::message::Message;
use crate::plan::Plan;
use crate::supervise::{Orders, Stepping};
use crate::unit::board::{Board, BoardLayout};
use crate::unit::logger::LogSink;
use crate::wiring::Wiring;
use crate::worker::{Leaving, Worker};
use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::io;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// How long workers may take to go after the last word.
const FAREWELL: Duration = Duration::from_secs(1);

/// The loop's thread and the workers; ended when dropped.
#[derive(Debug)]
pub struct Isolated {
    fleet: Arc<Fleet>,
    thread: JoinHandle<()>,
}

impl Isolated {
    /// Starts a worker for each instance of the plan, and the loop. Rows, messages and claims go to this board.
    ///
    /// # Errors
    /// A process cannot be started, or its board not be made.
    pub fn start(orders: &Orders<'_>, board: &Arc<Board>) -> io::Result<Self> {
        let plan = orders.plan.clone();
        let home = orders.plan.board.parent().unwrap_or(&orders.plan.board).to_owned();
        let addresses: Vec<_> =
            (0..plan.scenario.instances.len()).map(|number| Address { home: home.clone(), number }).collect();
        let layout = BoardLayout { notes: 1, columns: 0, claims: 0 };
        let boards = addresses.iter().map(|address| Board::create(&address.board(), &layout));
        let boards = boards.collect::<io::Result<Vec<_>>>()?;
        let fleet = Arc::new(Fleet::start(&orders.program, &addresses)?);
        let (board, crew, patience) = (Arc::clone(board), Arc::clone(&fleet), orders.step_timeout);
        let fly = move || {
            let sink: LogSink = {
                let board = Arc::clone(&board);
                Arc::new(move |said| told::message(&board, &Message::Log(said)))
            };
            let ways = addresses.into_iter().zip(boards).map(|(address, board)| {
                let fleet = Arc::clone(&crew);
                Way { address, board, fleet, patience }
            });
            let worker_of: Vec<_> = (0..plan.scenario.instances.len()).collect();
            fly_with(&plan, &board, &worker_of, |wiring| enlist(&plan, wiring, ways.collect(), &sink));
            crew.dismiss(FAREWELL);
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

/// Brings all workers into initialization mode: each step is begun everywhere before the first is awaited.
fn enlist<'a>(
    plan: &'a Plan,
    wiring: &Wiring,
    ways: Vec<Way>,
    sink: &LogSink,
) -> Result<Vec<Box<dyn Worker + 'a>>, Failure> {
    let run = run_name();
    let dialled: Vec<_> = thread::scope(|scope| {
        let dial = |way| {
            let run = &run;
            scope.spawn(move || Remote::dial(plan, wiring, way, Arc::clone(sink), run))
        };
        let threads: Vec<_> = ways.into_iter().map(dial).collect();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    });
    let mut remotes = dialled.into_iter().collect::<Result<Vec<_>, _>>()?;
    for step in [Remote::greet, Remote::open, Remote::enter] {
        let asked: Vec<_> = remotes.iter_mut().map(step).collect();
        let mut failed = None;
        for (remote, asked) in remotes.iter_mut().zip(asked) {
            let agreed = asked.and_then(|asked| remote.agree(asked));
            if let Err(lost) = agreed {
                failed.get_or_insert(lost.failure);
            }
        }
        if let Some(failure) = failed {
            for remote in &mut remotes {
                remote.finish(0, Leaving::AtOnce).ok();
            }
            return Err(failure);
        }
    }
    Ok(remotes.into_iter().map(|remote| Box::new(remote) as Box<dyn Worker>).collect())
}

/// A name that no other run has: for keys, no secret, and in no result.
fn run_name() -> String {
    format!("{:016x}", RandomState::new().build_hasher().finish())
}
