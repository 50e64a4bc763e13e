//! Measures the step loop in comparison with a hand-written loop through the same function pointers.
//!
//! `cargo bench -p orchestrator --bench chain` builds trivial units, chains them by `->` and steps the chain by both loops
//! in turn, nothing recorded. The hand-written loop makes one set, one step and one get for each unit and tick on plain
//! arrays. Units in C, which check and convert nothing, show the loop's own cost and have a limit of their own. The time of
//! one step of one unit is reported.
#![expect(unsafe_code, reason = "the hand-written loop calls through raw function pointers, as it must")]
#![expect(clippy::print_stdout, reason = "this is what a benchmark is for")]

#[path = "../peer/mod.rs"]
#[expect(dead_code, reason = "shared with the other benchmarks")]
mod peer;

use flatten::wiring::{Change, InputLimits, Plan};
use orchestrator::run::run_options::RunOptions;
use orchestrator::run::start_values::StartValues;
use orchestrator::run::step_loop::{Checkpoint, Observer, StepLoop};
use orchestrator::run::worker::{InProcess, Instantiated, Worker};
use peer::table::{Row, Table, alternate};
use peer::{Unit, to_error};
use results::verdict::Standing;
use std::cell::OnceCell;
use std::error::Error;
use std::time::{Duration, Instant};
use unit::board::{Board, RowWriter};

const BLOCKS: usize = 151;
/// Steps of units in one block.
const BLOCK_STEPS: u64 = 100_000;
/// How many times as long as the loop by hand the step loop may take, with units of the export layer.
const LIMIT: f64 = 1.25;
/// The same with empty units in C.
const LIMIT_IN_C: f64 = 1.35;

fn main() -> Result<(), Box<dyn Error>> {
    let table = Table::begin("a step of a unit; the step loop, beside one by hand");
    for ports in [1, 30] {
        for (kind, unit, limit) in [("exported", Unit::exported(ports)?, LIMIT), ("C", Unit::in_c(ports)?, LIMIT_IN_C)]
        {
            let mut of_few = None;
            for units in [10, 1000] {
                let ticks = BLOCK_STEPS / units as u64;
                let name = format!("{kind} units, {ports} in and {ports} out, chain of {units}");
                let measure = || alternate(BLOCKS, || by_loop(&unit, units, ticks), || unit.by_hand(units, ticks));
                let row = table.row(&name, Some(limit), || Ok(measure()?.each(BLOCK_STEPS)))?;
                let Some(Row { ours_s, .. }) = row else { continue };
                if let Some(peer_s) = of_few.replace(ours_s) {
                    let name = format!("{kind} units, {ports} in and {ports} out, one of 1000 beside one of 10");
                    table.row(&name, None, || Ok(Row { ours_s, peer_s, ratio: ours_s / peer_s }))?;
                }
            }
        }
    }
    Ok(())
}

fn by_loop(unit: &Unit, units: usize, ticks: u64) -> Result<Duration, Box<dyn Error>> {
    let scenario = unit.linked(units, ticks, (1..units).map(|target| (target - 1, target)));
    let plan = Plan::new(&scenario, &vec![&unit.description; units], &vec![0; units]);
    let instances = unit.instances(units)?.into_iter().enumerate();
    let instances = instances
        .map(|(index, instance)| Instantiated { index, instance, start_values: StartValues::default() })
        .collect();
    let worker: Box<dyn Worker> =
        Box::new(InProcess::new((0, plan.step_ns), &plan.groups, &plan.ports, instances, unit.board.note(0)));
    let begun = OnceCell::new();
    let observer = BoardOnly { board: &unit.board, begun: &begun };
    let mut run = StepLoop::new(plan, vec![worker], RunOptions::default(), observer);
    let finish = run.run(None);
    let ended = Instant::now();
    assert_eq!(finish.map_err(to_error)?.last_tick, ticks, "the run of the benchmark is complete");
    let begun: Instant = begun.into_inner().ok_or("the run of the benchmark has reached no tick")?;
    Ok(ended - begun)
}

/// Records nothing. As in a run, the tick is written to the board and the request to stop is read there.
struct BoardOnly<'a> {
    board: &'a Board,
    /// When the first tick began: the loop by hand is timed without initialization too.
    begun: &'a OnceCell<Instant>,
}

impl Observer for BoardOnly<'_> {
    fn reached(&mut self, tick: u64) {
        self.begun.get_or_init(Instant::now);
        self.board.set_tick(tick);
    }
    fn stop_requested(&self) -> bool {
        self.board.stop_requested()
    }
    fn row(&mut self, _: u64, _: impl FnOnce(RowWriter<'_>)) {}
    fn wants_checkpoint(&self, _: u64) -> bool {
        false
    }
    fn checkpoint(&mut self, _: &Checkpoint) -> Result<(), String> {
        Ok(())
    }
    fn missed_limits(&mut self, _: &InputLimits, _: f64, _: u64) {}
    fn window(&mut self, _: Change) {}
    fn claim(&mut self, _: usize, _: Standing) {}
}
