//! The stepping process: takes its plan from standard input, flies it, and tells its parent by the board.
//!
//! Standard input stays open as long as the parent lives; when it closes, so does this process.

mod boarding;
mod pace;
#[cfg(test)]
mod tests;
mod told;

use crate::claims::Claims;
use crate::failure::Failure;
use crate::message::{Finish, Message};
use crate::plan::Plan;
use crate::step_loop::{StepLoop, Wishes};
use crate::unit::board::Board;
use crate::unit::exit;
use crate::wiring::Wiring;
use crate::worker::{InProcess, Seating, Worker};
use pace::Pace;
use std::io::{self, Read};
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
    end_with_parent();
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

/// Flies a plan and tells the board everything but that it is over. What broke is told before any unit is freed: it
/// counts, whatever happens to the units afterwards.
pub fn fly(plan: &Plan, board: &Arc<Board>) {
    let mut aboard = Vec::new();
    if let Err(failure) = boarding::instances(plan, board, &mut aboard) {
        return tell_end(board, Err(failure));
    }
    let mut run = step_loop(plan, board, aboard);
    match run.run() {
        Ok(finish) => tell_end(board, run.close().map(|()| finish)),
        Err(failure) => {
            tell_end(board, Err(failure));
            run.close().ok();
        }
    }
}

fn step_loop<'a>(plan: &'a Plan, board: &'a Board, aboard: Vec<Seating>) -> StepLoop<'a, Told<'a>> {
    let scenario = &plan.scenario;
    let descriptions: Vec<_> = plan.unit_of.iter().map(|&unit| &plan.units[unit].description).collect();
    let wiring = Wiring::new(scenario, &descriptions, &vec![0; scenario.instances.len()]);
    let claims = Claims::new(&scenario.claims, scenario.stop_tick, &mut |port| wiring.place(port));
    let worker: Box<dyn Worker> = Box::new(InProcess::new(&wiring, aboard, board.note(0)));
    let pace = plan.pace.map(|pace| Pace::new(pace, scenario.step_ns));
    let told = Told::new(board, pace);
    let wishes = Wishes { fail_fast: plan.fail_fast, record: plan.hands_over_rows() };
    StepLoop::new(wiring, claims, vec![worker], wishes, told)
}

fn tell_end(board: &Board, end: Result<Finish, Failure>) {
    told::message(board, &end.map_or_else(Message::Broken, Message::Finished));
}

/// Ends this process when its standard input closes.
fn end_with_parent() {
    std::thread::spawn(|| {
        // Whatever else comes is of no interest; neither is why it ends.
        io::copy(&mut io::stdin(), &mut io::sink()).ok();
        exit::at_once(1);
    });
}
