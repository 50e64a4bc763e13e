//! A plan flown: units brought on board, the step loop run, all of it told to a board.
//!
//! The stepping process flies with all instances in itself; a coordinator flies with workers in other processes.

#[cfg(test)]
pub(crate) mod tests;

use super::board_observer::{self, Told};
use super::instantiate::{Gate, Passenger, enter_initialization};
use super::pace::Pace;
use crate::flatten::claims::Claims;
use crate::flatten::wiring::Wiring;
use crate::run::message::{Finish, Message};
use crate::run::run_spec::Plan;
use crate::run::step_loop::{StepLoop, Wishes};
use crate::run::worker::{InProcess, Leaving, Seating, Worker};
use std::sync::Arc;
use unit::board::Board;
use unit::failure::Failure;

/// Flies a plan with all instances in this process, see [`fly_with`].
pub fn fly(plan: &Plan, board: &Arc<Board>) {
    let mut aboard = Vec::new();
    fly_with(plan, board, &vec![0; plan.scenario.instances.len()], |wiring| {
        board_all(plan, board, &mut aboard)?;
        let seatings = std::mem::take(&mut aboard);
        Ok(vec![Box::new(InProcess::new(wiring.step_ns, &wiring.groups, &wiring.members, seatings, board.note(0)))])
    });
}

/// Flies a plan with workers that `crew` makes, `worker_of` telling for each instance which of them holds it, and tells
/// the board everything but that it is over. What broke is told before any unit is freed: it counts, whatever happens to
/// the units afterwards.
pub fn fly_with<'a>(
    plan: &'a Plan,
    board: &'a Board,
    worker_of: &[usize],
    crew: impl FnOnce(&Wiring) -> Result<Vec<Box<dyn Worker + 'a>>, Failure>,
) {
    let wiring = wire(plan, worker_of);
    let workers = match crew(&wiring) {
        Ok(workers) => workers,
        Err(failure) => return tell_end(board, Err(failure)),
    };
    let mut run = step_loop(plan, board, wiring, workers);
    match run.run(plan.from.as_ref()) {
        Ok(finish) => tell_end(board, run.close(Leaving::InPeace).map(|()| finish)),
        Err(failure) => {
            tell_end(board, Err(failure));
            run.close(Leaving::AtOnce).ok();
        }
    }
}

fn board_all(plan: &Plan, board: &Arc<Board>, aboard: &mut Vec<Seating>) -> Result<(), Failure> {
    let note = board.note(0);
    let step_ns = plan.scenario.step_ns;
    let gate = Gate {
        units: &plan.units,
        folder: &plan.folder,
        note: note.clone(),
        step_ns,
        sink: board_observer::sink(board),
    };
    let passengers = plan.scenario.instances.iter().zip(&plan.unit_of).enumerate();
    let passengers = passengers.map(|(index, (instance, &unit))| {
        let (name, presets) = (instance.name.as_str(), instance.presets.as_slice());
        Passenger { index, name, unit, presets, log_calls: plan.log_calls.contains(&index) }
    });
    gate.admit(passengers, aboard)?;
    enter_initialization(aboard, &note)
}

fn wire(plan: &Plan, worker_of: &[usize]) -> Wiring {
    let descriptions: Vec<_> = plan.unit_of.iter().map(|&unit| &plan.units[unit].description).collect();
    Wiring::new(&plan.scenario, &descriptions, worker_of)
}

fn step_loop<'a>(
    plan: &'a Plan,
    board: &'a Board,
    wiring: Wiring,
    workers: Vec<Box<dyn Worker + 'a>>,
) -> StepLoop<'a, Told<'a>> {
    let scenario = &plan.scenario;
    let claims = Claims::new(&scenario.claims, scenario.stop_tick, &mut |port| wiring.place(port));
    let pace = plan.pace.map(|pace| Pace::new(pace, scenario.step_ns));
    let told = Told::new(board, pace, &plan.saves);
    let wishes = Wishes { fail_fast: plan.fail_fast, record: plan.hands_over_rows() };
    StepLoop::new(wiring, claims, workers, wishes, told)
}

fn tell_end(board: &Board, end: Result<Finish, Failure>) {
    board_observer::message(board, &end.map_or_else(Message::Broken, Message::Finished));
}
