//! The reasons why a call is refused.

use crate::model::Fault;
use fmi2::c::Status;
use fmi2::calls::{Call, State};
use std::fmt;

/// Why a call returned `fmi2Error` or `fmi2Discard`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Refusal {
    /// The state table forbids the call.
    NotAllowed { state: State },
    /// The unit panicked before.
    Poisoned,
    /// The unit panicked in this call.
    Panic { text: String },
    /// `fmi2SetupExperiment` was called twice.
    SetUpBefore,
    /// The unit does not support the call, according to its capability flags.
    NotSupported { capability: &'static str },
    /// A mandatory pointer is null.
    Null { argument: &'static str },
    /// No port of the base type has the value reference.
    NoSuchPort { base_type: &'static str, reference: u32, count: usize },
    /// The port may not be set in this state, or never.
    NotSettable { port: String, state: State },
    /// NaN or an infinity for a port.
    NotFinite { port: String, value: f64 },
    /// A value below `min` or above `max`.
    OutOfBounds { port: String, value: f64, min: f64, max: f64 },
    /// No item of the enumeration has the value.
    NoSuchItem { port: String, value: i32 },
    /// A string that is not UTF-8.
    NotUtf8 { port: String },
    /// A time of the experiment that is not finite, or a stop before the start.
    Experiment { start_s: f64, stop_s: Option<f64> },
    /// A step without a positive length.
    StepLength { length_s: f64 },
    /// A step that does not begin where the last one ended.
    CommunicationPoint { expected_s: f64, found_s: f64 },
    /// A step that ends after the stop time.
    BeyondStop { end_s: f64, stop_s: f64 },
    /// The model could not start.
    Start { fault: Fault },
    /// The model could not step.
    Step { start_s: f64, length_s: f64, fault: Fault },
    /// The model could not compute its outputs after a set.
    Outputs { time_s: f64, fault: Fault },
    /// The model reported a time outside its step.
    OutsideStep { start_s: f64, end_s: f64, found_s: f64 },
    /// The model made a part of the step.
    Discarded { start_s: f64, end_s: f64, until_s: f64 },
    /// The model has terminated.
    Ended { at_s: f64 },
    /// The requested status is of another type, or belongs to asynchronous steps.
    NoSuchStatus { kind: i32 },
    /// The handle is not of a state that this instance saved.
    UnknownState,
    /// The buffer for a serialized state is too small.
    BufferTooSmall { size: usize, needed: usize },
    /// The state could not be written.
    Serialize { cause: String },
    /// The bytes are not a state of this unit.
    Deserialize { cause: String },
}

impl Refusal {
    /// The status that the call returns.
    pub(crate) fn status(&self) -> Status {
        match self {
            Self::Discarded { .. } | Self::Ended { .. } | Self::NoSuchStatus { .. } => Status::Discard,
            // Nothing was set and the instance goes on as before.
            Self::NotFinite { .. } | Self::OutOfBounds { .. } | Self::NoSuchItem { .. } => Status::Discard,
            _ => Status::Error,
        }
    }

    /// The message for the log.
    pub(crate) fn message(&self, call: Call) -> String {
        format!("{}: {self}", call.name())
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotAllowed { state } => match state {
                State::Error => f.write_str("not allowed after an error; the unit can be read, reset and freed"),
                _ => write!(f, "not allowed in state `{}`", state.name()),
            },
            Self::Poisoned => f.write_str("the unit panicked before; it can be read, reset and freed"),
            Self::Panic { text } => write!(f, "the unit panicked (a bug in the unit): {text}"),
            Self::SetUpBefore => f.write_str("the experiment is set up already"),
            Self::NotSupported { capability } => write!(f, "not supported: {capability}"),
            Self::Null { argument } => write!(f, "`{argument}` is a null pointer"),
            Self::NoSuchPort { base_type, reference, count } => {
                write!(
                    f,
                    "there is no {base_type} with value reference {reference}; the unit has {count}, counted from 0"
                )
            }
            Self::NotSettable { port, state } => {
                write!(f, "`{port}` cannot be set in state `{}`; nothing was set", state.name())
            }
            Self::NotFinite { port, value } => {
                write!(f, "`{port}` cannot be {value}: only finite numbers are accepted; nothing was set")
            }
            Self::OutOfBounds { port, value, min, max } => {
                write!(f, "`{port}` cannot be {}: it must be ", number(*value))?;
                match (*min == f64::MIN, *max == f64::MAX) {
                    (true, _) => write!(f, "at most {}", number(*max))?,
                    (_, true) => write!(f, "at least {}", number(*min))?,
                    _ => write!(f, "between {} and {}", number(*min), number(*max))?,
                }
                f.write_str("; nothing was set")
            }
            Self::NoSuchItem { port, value } => {
                write!(f, "`{port}` is an enumeration without an item of value {value}; nothing was set")
            }
            Self::NotUtf8 { port } => write!(f, "the text for `{port}` is not UTF-8; nothing was set"),
            Self::NoSuchStatus { kind } => write!(f, "there is no such status of kind {kind}; steps are synchronous"),
            Self::UnknownState => f.write_str("the handle is not of a state that this instance saved and still has"),
            Self::BufferTooSmall { size, needed } => write!(f, "{size} bytes are too few, the state needs {needed}"),
            Self::Serialize { cause } => write!(f, "the state cannot be written: {cause}"),
            Self::Deserialize { cause } => write!(f, "the bytes are not a state of this unit: {cause}"),
            _ => self.time(f),
        }
    }
}

/// A number in few characters: `10`, `0.5`, `1e-6`.
fn number(value: f64) -> String {
    let is_short = value.fract() == 0.0 && value.abs() < 1e9;
    if is_short { format!("{value}") } else { format!("{value:?}") }
}

impl Refusal {
    /// Messages about time and the model.
    fn time(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Experiment { start_s, stop_s: Some(stop_s) } => {
                write!(f, "the stop time {stop_s} s is before the start time {start_s} s, or one of them is not finite")
            }
            Self::Experiment { start_s, .. } => write!(f, "a run cannot start at {start_s} s"),
            Self::StepLength { length_s } => {
                write!(f, "the length of a step must be positive and finite, found {length_s} s")
            }
            Self::CommunicationPoint { expected_s, found_s } => {
                write!(f, "the step begins at {found_s} s, but the time of the unit is {expected_s} s")
            }
            Self::BeyondStop { end_s, stop_s } => {
                write!(f, "the step ends at {end_s} s, after the stop time {stop_s} s")
            }
            Self::Start { fault } => write!(f, "the unit cannot start: {fault}"),
            Self::Step { start_s, length_s, fault } => {
                write!(f, "the step of {length_s} s from {start_s} s failed: {fault}")
            }
            Self::Outputs { time_s, fault } => write!(f, "there are no outputs at {time_s} s: {fault}"),
            Self::OutsideStep { start_s, end_s, found_s } => {
                write!(f, "the unit reports {found_s} s in a step from {start_s} s to {end_s} s (a bug in the unit)")
            }
            Self::Discarded { start_s, end_s, until_s } => {
                write!(f, "the step from {start_s} s to {end_s} s was made until {until_s} s only")
            }
            Self::Ended { at_s } => write!(f, "the unit terminated the simulation at {at_s} s"),
            _ => unreachable!("all others are written in `fmt`"),
        }
    }
}
