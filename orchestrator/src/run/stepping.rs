//! Runs a specification: instantiates its units, runs the step loop and reports everything to a board.
//!
//! The stepping process holds all instances itself; a coordinator uses workers in other processes.

#[cfg(test)]
pub(crate) mod tests;

use super::board_observer::{self, BoardObserver};
use super::instantiate::{Instantiator, NewInstance, enter_initialization};
use super::pace::Pace;
use crate::run::message::{Finish, Message};
use crate::run::run_spec::RunSpec;
use crate::run::step_loop::StepLoop;
use crate::run::worker::{InProcess, Instantiated, Shutdown, Worker};
use flatten::wiring::Plan;
use std::sync::Arc;
use unit::board::Board;
use unit::failure::Failure;

/// Runs a specification with all instances in this process, see [`step_run_with`].
pub fn step_run(spec: &RunSpec, board: &Arc<Board>) {
    let mut made = Vec::new();
    step_run_with(spec, board, &vec![0; spec.scenario.instances.len()], |plan| {
        instantiate_all(spec, board, &mut made)?;
        let instances = std::mem::take(&mut made);
        let times = (plan.start_tick, plan.step_ns);
        Ok(vec![Box::new(InProcess::new(times, &plan.groups, &plan.ports, instances, board.note(0)))])
    });
}

/// Runs a specification with the workers that `make_workers` returns; `worker_of` gives for each instance the worker that
/// holds it. A failure is reported on the board before any unit is freed, so that a crash in the freeing cannot hide it.
pub fn step_run_with<'a>(
    spec: &'a RunSpec,
    board: &'a Board,
    worker_of: &[usize],
    make_workers: impl FnOnce(&Plan) -> Result<Vec<Box<dyn Worker + 'a>>, Failure>,
) {
    let plan = plan_of(spec, worker_of);
    let workers = match make_workers(&plan) {
        Ok(workers) => workers,
        Err(failure) => return report_end(board, Err(failure)),
    };
    let mut run = step_loop(spec, board, plan, workers);
    match run.run(spec.from.as_ref()) {
        Ok(finish) => report_end(board, run.close(Shutdown::Orderly).map(|()| finish)),
        Err(failure) => {
            report_end(board, Err(failure));
            run.close(Shutdown::Immediate).ok();
        }
    }
}

fn instantiate_all(spec: &RunSpec, board: &Arc<Board>, made: &mut Vec<Instantiated>) -> Result<(), Failure> {
    let instantiator = Instantiator {
        units: &spec.units,
        folder: &spec.folder,
        note: board.note(0),
        start_tick: spec.scenario.start_tick,
        step_ns: spec.scenario.step_ns,
        sink: board_observer::sink(board),
    };
    let instances = spec.scenario.instances.iter().enumerate();
    let instances = instances.map(|(index, instance)| {
        let (name, unit, presets) = (instance.name.as_str(), instance.unit, instance.presets.as_slice());
        NewInstance { index, name, unit, presets, log_calls: spec.options.logs_calls_of(name) }
    });
    instantiator.make(instances, made)?;
    enter_initialization(made, &instantiator.note, instantiator.start_tick, instantiator.step_ns)
}

fn plan_of(spec: &RunSpec, worker_of: &[usize]) -> Plan {
    let descriptions: Vec<_> =
        (0..spec.scenario.instances.len()).map(|instance| &spec.unit(instance).description).collect();
    Plan::new(&spec.scenario, &descriptions, worker_of)
}

fn step_loop<'a>(
    spec: &'a RunSpec,
    board: &'a Board,
    plan: Plan,
    workers: Vec<Box<dyn Worker + 'a>>,
) -> StepLoop<'a, BoardObserver<'a>> {
    let pace = spec.options.pace.map(|pace| Pace::new(pace, spec.scenario.step_ns));
    let observer = BoardObserver::new(board, pace, &spec.saves);
    StepLoop::new(plan, workers, spec.options.clone(), observer)
}

fn report_end(board: &Board, end: Result<Finish, Failure>) {
    board_observer::message(board, &end.map_or_else(Message::Broken, Message::Finished));
}
