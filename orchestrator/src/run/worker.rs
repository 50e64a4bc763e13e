//! The trait of workers, which take orders and return replies wherever their instances are.
//!
//! A worker knows instances and arrays of values, but not the script. An order passes the inputs of a group and starts its
//! step; the reply, awaited when it is due, returns the group's outputs. Between the two, workers may compute in parallel.
//! An order always carries every input of its group, a reply every output.

mod in_process;
pub(super) mod scattered;

pub use in_process::{InProcess, Instantiated};

use flatten::values::Values;
use flatten::wiring::VariableSlot;
use serde::{Deserialize, Serialize};
use unit::failure::Failure;

/// The order that one group step from `tick` on for its period, with its inputs.
#[derive(Clone, Copy, Debug)]
pub struct Order<'a> {
    /// The index of the group, as given to the worker when it was made.
    pub group: usize,
    /// The tick at which the step begins.
    pub tick: u64,
    /// All inputs; the ports of the group's instances say which of them are theirs.
    pub inputs: &'a Values,
}

/// Identifies an order whose reply is awaited. A group has at most one order under way, so its index suffices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ticket {
    /// The group.
    pub group: usize,
}

/// What a reply contains besides values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reply {
    /// The instances that have terminated.
    pub terminated: Vec<Terminated>,
}

/// An instance has ended by itself (`fmi2Discard` with `fmi2Terminated`).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Terminated {
    /// The instance.
    pub instance: usize,
    /// The simulated time that it reached.
    pub last_successful_time_s: f64,
}

/// A step without a result: the run breaks at the tick at which the result would have been due.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lost {
    /// The instance: where several fail at once, the first in the script is reported.
    pub instance: usize,
    /// Instance, call, time and cause.
    pub failure: Failure,
}

/// How a run shuts its workers down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shutdown {
    /// The run ended by itself: a failure of the shutdown still breaks it.
    Orderly,
    /// The run broke: no worker is waited for.
    Immediate,
}

/// Holds instances for a run. It is made with its instances in initialization mode, and limits the time of its replies
/// itself.
pub trait Worker {
    /// During initialization: sets inputs of one instance.
    ///
    /// # Errors
    /// The unit refuses, or the worker is gone.
    fn set_initial(&mut self, instance: usize, slots: &[VariableSlot], inputs: &Values) -> Result<(), Lost>;

    /// During initialization: reads variables of one instance.
    ///
    /// # Errors
    /// The unit refuses, or the worker is gone.
    fn get_initial(&mut self, instance: usize, slots: &[VariableSlot], outputs: &mut Values) -> Result<(), Lost>;

    /// Ends initialization and returns the outputs of all its instances at the first tick.
    ///
    /// # Errors
    /// A unit refuses, or the worker is gone.
    fn start(&mut self, outputs: &mut Values) -> Result<(), Lost>;

    /// Orders a group to step. The worker may complete the step or only begin it; its reply reports a failed step.
    ///
    /// # Errors
    /// The worker is gone, or a unit returned `fmi2Fatal`, after which its library may not be called any more.
    fn order(&mut self, order: &Order<'_>) -> Result<Ticket, Lost>;

    /// Awaits the end of an order and returns all outputs of the group, even if one of its instances has terminated.
    /// `due_tick` is the tick at which the result becomes visible.
    ///
    /// # Errors
    /// The first instance in the script's order whose step failed, or the worker is gone.
    fn reply(&mut self, ticket: Ticket, due_tick: u64, outputs: &mut Values) -> Result<Reply, Lost>;

    /// Between two ticks, when no order is under way: the state of each of its instances, with the instance.
    ///
    /// # Errors
    /// The first instance in the script's order that refuses, or the worker is gone.
    fn save(&mut self, tick: u64) -> Result<Vec<(usize, Vec<u8>)>, Lost>;

    /// After initialization: restores each of its instances from a state that [`Worker::save`], possibly of another
    /// worker, returned at this tick.
    ///
    /// # Errors
    /// The first instance in the script's order that refuses, or the worker is gone.
    fn restore(&mut self, tick: u64, states: &[(usize, &[u8])]) -> Result<(), Lost>;

    /// Terminates and frees all instances that still allow it; the worker must not be used afterwards.
    ///
    /// # Errors
    /// The first that refused, after all others were freed.
    fn finish(&mut self, tick: u64, shutdown: Shutdown) -> Result<(), Lost>;
}
