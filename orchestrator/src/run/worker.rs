//! SuperviseRequest in, replies out: the trait that every placement of instances implements.
//!
//! A worker knows instances and blocks of values, nothing of what the script says. An order hands over the inputs of a
//! group and lets it step; the reply, asked for when it is due, brings the group's outputs. Between the two a worker may
//! compute beside others. Blocks are complete: an order carries every input of its group, a reply every output.

mod in_process;

pub use in_process::{InProcess, Instantiated};

use crate::flatten::values::Values;
use crate::flatten::wiring::VariableSlot;
use serde::{Deserialize, Serialize};
use unit::failure::Failure;

/// Inputs for one group, and the word to step from `tick` on for the group's period.
#[derive(Clone, Copy, Debug)]
pub struct Order<'a> {
    /// The group, as the worker was told of it when it was opened.
    pub group: usize,
    /// The tick at which the step begins.
    pub tick: u64,
    /// All inputs; the group's lie where its ports say.
    pub inputs: &'a Values,
}

/// What a reply is asked for by. A group has at most one order under way, so its index says it all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ticket {
    /// The group.
    pub group: usize,
}

/// What a reply says besides its values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reply {
    /// The instances that are done for good.
    pub terminated: Vec<Terminated>,
}

/// An instance has ended by itself (`fmi2Discard` with `fmi2Terminated`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Terminated {
    /// The instance.
    pub instance: usize,
    /// How far it came.
    pub last_successful_time_s: f64,
}

/// A step that brought nothing: the run breaks, when the result would have been due.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lost {
    /// The instance: where several are lost at once, the first in the script is told.
    pub instance: usize,
    /// Instance, call, time and cause.
    pub failure: Failure,
}

/// How a run takes leave of its workers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shutdown {
    /// It came to its end: whatever goes wrong now counts.
    Orderly,
    /// It broke: nobody is waited for.
    Immediate,
}

/// Holds instances for a run. Made with its instances set up and in initialization mode; the time that a reply may take
/// is its own affair.
pub trait Worker {
    /// During initialization: sets inputs of one instance.
    ///
    /// # Errors
    /// The unit refuses, or the worker is gone.
    fn set_initial(&mut self, instance: usize, picks: &[VariableSlot], inputs: &Values) -> Result<(), Lost>;

    /// During initialization: reads variables of one instance.
    ///
    /// # Errors
    /// The unit refuses, or the worker is gone.
    fn get_initial(&mut self, instance: usize, picks: &[VariableSlot], outputs: &mut Values) -> Result<(), Lost>;

    /// Ends initialization and brings the outputs of all its instances at tick 0.
    ///
    /// # Errors
    /// A unit refuses, or the worker is gone.
    fn start(&mut self, outputs: &mut Values) -> Result<(), Lost>;

    /// Lets a group step. The worker may do it at once or begin it; what goes wrong in a step is told by its reply.
    ///
    /// # Errors
    /// The worker is gone.
    fn order(&mut self, order: &Order<'_>) -> Result<Ticket, Lost>;

    /// Awaits the end of an order and brings the group's outputs, all of them also beside an instance that is done for
    /// good. `due_tick` is when the result counts.
    ///
    /// # Errors
    /// The first instance in the script's order whose step failed, or the worker is gone.
    fn reply(&mut self, ticket: Ticket, due_tick: u64, outputs: &mut Values) -> Result<Reply, Lost>;

    /// Between two ticks, when no order is under way: the state of each of its instances, with the instance.
    ///
    /// # Errors
    /// The first instance in the script's order that refuses, or the worker is gone.
    fn save(&mut self, tick: u64) -> Result<Vec<(usize, Vec<u8>)>, Lost>;

    /// After initialization: takes each of its instances to a state that [`Worker::save`] brought at this tick, maybe of
    /// another worker.
    ///
    /// # Errors
    /// The first instance in the script's order that refuses, or the worker is gone.
    fn restore(&mut self, tick: u64, states: &[(usize, &[u8])]) -> Result<(), Lost>;

    /// Terminates and frees all instances that still allow it; nothing can be asked afterwards.
    ///
    /// # Errors
    /// The first that refused, after all others were freed.
    fn finish(&mut self, tick: u64, shutdown: Shutdown) -> Result<(), Lost>;
}
