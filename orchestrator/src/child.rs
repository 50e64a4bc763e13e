//! The stepping process: takes its plan from standard input, flies it, and tells its parent by the board.
//!
//! Standard input stays open as long as the parent lives; when it closes, so does this process.

pub mod boarding;
mod pace;
#[cfg(test)]
pub(crate) mod tests;
pub mod told;

use crate::claims::Claims;
use crate::failure::Failure;
use crate::message::{Finish, Message};
use crate::plan::Plan;
use crate::preparation::remove_home;
use crate::step_loop::{StepLoop, Wishes};
use crate::unit::board::Board;
use crate::unit::exit;
use crate::wiring::Wiring;
use crate::worker::{InProcess, Leaving, Seating, Worker};
use boarding::{Gate, Passenger, enter_initialization};
use pace::Pace;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;
use told::Told;

/// A plan larger than this is none.
const LONGEST_PLAN: u64 = 1 << 30;

/// Flies the plan that stands on standard input. What comes of it stands on the board, also where the run breaks.
///
/// # Errors
/// There is no plan, or the board that it names cannot be opened: then there is nobody to tell.
pub fn run() -> io::Result<()> {
    let plan = read_plan(&mut io::stdin().lock())?;
    let board = Arc::new(Board::open(&plan.board)?);
    end_with_parent(&plan);
    fly(&plan, &board);
    Ok(())
}

/// Reads a plan: its length as 8 bytes, the lowest first, then the plan itself.
///
/// # Errors
/// The input ends early or holds no plan.
pub fn read_plan(input: &mut impl Read) -> io::Result<Plan> {
    let mut length = [0; 8];
    input.read_exact(&mut length)?;
    let length = u64::from_le_bytes(length);
    let mut bytes = Vec::new();
    if length > LONGEST_PLAN || input.take(length).read_to_end(&mut bytes)? as u64 != length {
        return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the plan on standard input is cut short"));
    }
    postcard::from_bytes(&bytes)
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, format!("no plan on standard input: {error}")))
}

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
    let gate = Gate { units: &plan.units, folder: &plan.folder, note: note.clone(), step_ns, sink: told::sink(board) };
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
    told::message(board, &end.map_or_else(Message::Broken, Message::Finished));
}

/// Ends this process when its standard input closes, and takes away what the parent would have taken away.
fn end_with_parent(plan: &Plan) {
    let home = plan.board.parent().map(Path::to_owned);
    std::thread::spawn(move || {
        // Whatever else comes is of no interest; neither is why it ends.
        io::copy(&mut io::stdin(), &mut io::sink()).ok();
        home.as_deref().inspect(|home| remove_home(home));
        exit::at_once(1);
    });
}
