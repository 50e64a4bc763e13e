//! Measures a round of orders of an isolated run in comparison with raw sockets and with zenoh alone.
//!
//! `cargo bench -p orchestrator --bench rounds` orders a step of so many workers, each in a process of its own with a unit
//! that does nothing, and awaits all replies. In turn with that it measures processes that send back what they receive: over
//! blocking sockets of the same kind, and over zenoh sessions with the same settings, with one put and one callback for each
//! piece in each direction. Messages have the same length everywhere. The time of one round of all workers is reported.
#![expect(clippy::print_stdout, reason = "this is what a benchmark is for")]

mod echo;
#[path = "../peer/mod.rs"]
#[expect(dead_code, reason = "shared with the other benchmarks")]
#[expect(unsafe_code, reason = "another benchmark's hand-written loop stands there")]
mod peer;

use echo::Echoes;
use flatten::wiring::Plan;
use orchestrator::bus::WorkerSet;
use orchestrator::run::message::MessageSink;
use orchestrator::run::run_options::RunOptions;
use orchestrator::run::run_spec::{RunSpec, UnitSpec};
use orchestrator::run::worker::{Order, Shutdown, Worker};
use peer::table::{Table, alternate};
use peer::{Unit, to_error};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

const BLOCKS: usize = 31;
/// Rounds in one block.
const ROUNDS: u64 = 200;
/// Bytes of a message besides its Reals: its header and the header of its one block.
const OVERHEAD: usize = 64;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, echo, kind, bytes, place] = arguments.as_slice()
        && echo == "echo"
    {
        return echo::serve(kind, bytes.parse()?, Path::new(place));
    }
    let table = Table::begin("a round of all workers over Unix sockets");
    for (ports, workers, beside_raw) in
        [(1, 1, 11.0), (1, 2, 11.0), (1, 4, 11.0), (1, 8, 14.0), (1, 16, 14.0), (8192, 1, 7.0), (8192, 4, 7.0)]
    {
        rows(&table, ports, workers, beside_raw)?;
    }
    Ok(())
}

fn rows(table: &Table, ports: usize, workers: usize, beside_raw: f64) -> Result<(), Box<dyn Error>> {
    let unit = Unit::in_c(ports)?;
    let spec = spec(&unit, workers);
    let bytes = OVERHEAD + 8 * ports;
    let each = |row: peer::table::Row| row.each(ROUNDS);
    let name = |peer: &str| format!("{workers} workers, {bytes} B each way, beside {peer}");
    for (peer, kind, limit) in [("raw sockets", echo::RAW, beside_raw), ("bare zenoh", echo::BARE, 1.25)] {
        let measure = || {
            let mut ours = Rounds::begin(&spec, &unit, workers)?;
            let mut echoes = Echoes::start(kind, workers, bytes)?;
            let row = alternate(BLOCKS, || ours.block(), || echoes.block(ROUNDS))?;
            ours.end()?;
            Ok(each(row))
        };
        table.row(&name(peer), Some(limit), measure)?;
    }
    Ok(())
}

/// Workers that have started.
struct Rounds<'a> {
    workers: Vec<Box<dyn Worker + 'a>>,
    plan: Plan,
    tick: u64,
    _home: tempfile::TempDir,
}

impl<'a> Rounds<'a> {
    fn begin(spec: &'a RunSpec, unit: &Unit, count: usize) -> Result<Self, Box<dyn Error>> {
        let home = tempfile::tempdir()?;
        let worker_of: Vec<_> = (0..count).collect();
        let plan = Plan::new(&spec.scenario, &vec![&unit.description; count], &worker_of);
        let program = Path::new(env!("CARGO_BIN_EXE_lockstep"));
        let workers = WorkerSet::start(program, home.path(), count, Some(Duration::from_secs(10)))?;
        let sink: MessageSink = Arc::new(|_| {});
        let mut workers = workers.initialize(spec, &plan, &sink).map_err(to_error)?;
        let mut outputs = plan.outputs.clone();
        for worker in &mut workers {
            worker.start(&mut outputs).map_err(|lost| to_error(lost.failure))?;
        }
        Ok(Self { workers, plan, tick: 0, _home: home })
    }

    fn block(&mut self) -> Result<Duration, Box<dyn Error>> {
        let mut outputs = self.plan.outputs.clone();
        let begun = Instant::now();
        for tick in self.tick..self.tick + ROUNDS {
            let mut tickets = Vec::with_capacity(self.workers.len());
            for (group, worker) in self.workers.iter_mut().enumerate() {
                let order = Order { group, tick, inputs: &self.plan.inputs };
                tickets.push(worker.order(&order).map_err(|lost| to_error(lost.failure))?);
            }
            for (worker, ticket) in self.workers.iter_mut().zip(tickets) {
                worker.reply(ticket, tick + 1, &mut outputs).map_err(|lost| to_error(lost.failure))?;
            }
        }
        self.tick += ROUNDS;
        Ok(begun.elapsed())
    }

    fn end(mut self) -> Result<(), Box<dyn Error>> {
        let finish = |worker: &mut Box<dyn Worker + 'a>| worker.finish(self.tick, Shutdown::Orderly);
        self.workers.iter_mut().try_for_each(finish).map_err(|lost| to_error(lost.failure))
    }
}

/// A run of so many instances, all of whose inputs and outputs are transferred.
fn spec(unit: &Unit, count: usize) -> RunSpec {
    // The inputs of each are connected to the outputs of the next, those of the last to the first.
    let scenario = unit.linked(count, u64::MAX, (0..count).map(|target| ((target + 1) % count, target)));
    let (description, sha256) = (unit.description.clone(), String::new());
    let units = vec![UnitSpec { name: peer::UNIT.to_owned(), folder: unit.folder(), description, sha256 }];
    let (folder, board) = (unit.folder(), unit.folder().join("board"));
    RunSpec {
        scenario,
        units,
        folder,
        board,
        options: RunOptions::default(),
        worker_of: None,
        saves: Vec::new(),
        from: None,
    }
}
