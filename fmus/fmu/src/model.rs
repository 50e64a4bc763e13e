//! The trait that a unit's author implements: how the unit starts and how it steps.

use crate::declaration::Ports;
use crate::step::{Step, due};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt;

/// The behaviour of a unit; its ports come from `#[derive(Fmu)]`.
pub trait Model: Ports + Clone + Serialize + DeserializeOwned + Send + 'static {
    /// Computes hidden state from parameters, inputs and the start values of exact ports, and every output that
    /// [`outputs`](Self::outputs) does not compute.
    ///
    /// It runs in initialization mode whenever an output is read after a value was set, and once at the end of that
    /// mode. Therefore its result must not depend on an earlier call of it.
    ///
    /// # Errors
    ///
    /// A [`Fault`] with the reason why the unit cannot start with these values.
    fn init(&mut self, context: &mut Context) -> Result<(), Fault>;

    /// Advances states from the start of the step to its end, and every output that [`outputs`](Self::outputs) does not
    /// compute.
    ///
    /// # Errors
    ///
    /// A [`Fault`] with the reason why the unit cannot continue; the instance makes no further step.
    fn step(&mut self, step: Step, context: &mut Context) -> Result<Outcome, Fault>;

    /// Computes outputs from states, parameters and inputs at this time in seconds; it changes no state.
    ///
    /// It runs after each `init` and each `step`, and when a value is read after another one was set between two steps:
    /// an output that follows directly from an input is computed here. A unit whose outputs change in `step` only, such as
    /// a sampled controller, does not need it.
    ///
    /// # Errors
    ///
    /// A [`Fault`] with the reason why there are no outputs; the instance makes no further step.
    fn outputs(&mut self, time_s: f64) -> Result<(), Fault> {
        let _ = time_s;
        Ok(())
    }
}

/// The number of samples before the start of a run that are drawn, so that a late start does not hang: with samples of 10 ms
/// a start after 27 hours.
const MOST_PAST_SAMPLES: u64 = 10_000_000;

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The end of the step is reached.
    Done,
    /// Only a part of the step was made, up to this time in seconds; the states are those of this time.
    AcceptedUntil(f64),
    /// The unit terminated at this time in seconds.
    Terminated(f64),
}

/// Why a unit cannot start or continue, as a message for the user.
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

/// The context of a call of the model: the start of the run, and the user's log.
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

    /// How many samples after number 0 are due up to the start of the run.
    ///
    /// # Errors
    ///
    /// A [`Fault`] if they are more than can be drawn in reasonable time.
    pub fn past_samples(&self, period_s: f64) -> Result<u64, Fault> {
        let past = due(self.start_s, period_s).saturating_sub(1);
        if past <= MOST_PAST_SAMPLES {
            return Ok(past);
        }
        let start_s = self.start_s;
        Err(Fault::new(format!(
            "a run that starts at {start_s} s comes after {past} samples of {period_s} s, and at most {MOST_PAST_SAMPLES} are drawn"
        )))
    }

    /// Warns the user; the call in progress returns `fmi2Warning`.
    pub fn warn(&mut self, message: impl Into<String>) {
        self.warnings.push(message.into());
    }

    /// Logs an event if event messages are enabled; only then the text is formatted.
    pub fn event(&mut self, message: impl FnOnce() -> String) {
        if self.events_wanted {
            self.events.push(message());
        }
    }
}
