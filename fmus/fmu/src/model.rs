//! What an author writes: how a unit starts and how it steps.

use crate::declaration::Ports;
use crate::step::{Samples, Step, due};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;

/// The behaviour of a unit; its ports come from `#[derive(Fmu)]`.
pub trait Model: Ports + Clone + Serialize + DeserializeOwned + Send + 'static {
    /// Computes hidden state and all calculated outputs from parameters, inputs and the start values of exact ports.
    ///
    /// It runs in initialization mode whenever an output is read after something was set, and once at the end of it: so
    /// it must not build on what an earlier run of it left behind.
    ///
    /// # Errors
    ///
    /// A [`Fault`] says why the unit cannot start with these values.
    fn init(&mut self, context: &mut Context) -> Result<(), Fault>;

    /// Brings states and outputs from the start of the step to its end.
    ///
    /// # Errors
    ///
    /// A [`Fault`] says why the unit cannot go on; it is over for this instance.
    fn step(&mut self, step: Step, context: &mut Context) -> Result<Outcome, Fault>;
}

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The end of the step is reached.
    Done,
    /// Only a part of the step could be made, up to this time in seconds; the states are those of this time.
    AcceptedUntil(f64),
    /// The unit has come to its end at this time in seconds.
    Terminated(f64),
}

/// Why a unit cannot start or go on, in words for the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault(String);

impl Fault {
    /// A fault with this reason.
    #[must_use]
    pub fn new(reason: impl Into<String>) -> Self {
        Self(reason.into())
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Fault {}

/// What surrounds a call of the model: the start of the run, and a way to the user's log.
#[derive(Debug, Default)]
pub struct Context {
    pub(crate) start_s: f64,
    pub(crate) events_wanted: bool,
    pub(crate) warnings: Vec<String>,
    pub(crate) events: Vec<String>,
}

impl Context {
    /// The time at which the run starts, in seconds.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// The numbers of the samples that fall due up to the start of the run, number 0 always among them.
    #[must_use]
    pub fn samples(&self, period_s: f64) -> Samples {
        0..due(self.start_s, period_s)
    }

    /// Warns the user; the call in progress answers `fmi2Warning`.
    pub fn warn(&mut self, message: impl Into<String>) {
        self.warnings.push(message.into());
    }

    /// Tells the user of an event, if event messages are wanted: the text is made only then.
    pub fn event(&mut self, message: impl FnOnce() -> String) {
        if self.events_wanted {
            self.events.push(message());
        }
    }
}
