//! Why a run broke: which instance, in which call, at which time, and what happened.

use fmi2::calls::Call;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A broken run. Names are filled in when it happens, so that whoever prints it needs nothing else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// The instance's name in the script; `None` if no instance was concerned.
    pub instance: Option<String>,
    /// What was being done.
    pub doing: Doing,
    /// Simulated time in seconds; `None` before the first instance exists.
    pub time_s: Option<f64>,
    /// What happened.
    pub cause: Cause,
}

/// What was being done when a run broke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Doing {
    /// Loading the unit's library.
    Load,
    /// A call of the standard.
    Call(Call),
    /// Nothing of a unit's: between calls.
    BetweenCalls,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Cause {
    /// The call returned this, `fmi2Error` or an unknown number.
    Status(i32),
    /// `fmi2Instantiate` returned NULL.
    NoInstance,
    /// The process was ended by this signal.
    Signal(i32),
    /// The process ended with this exit code without saying that it was done.
    Exit(i32),
    /// The call did not return within this many seconds.
    Hung(f64),
    /// A variable got a value that is no number.
    NonFinite {
        /// The variable.
        variable: String,
        /// The value, `NaN` or `inf`.
        value: String,
    },
    /// Anything else, told in words.
    Other(String),
}

/// The name of a signal, where it has one that people know.
#[must_use]
pub fn signal_name(signal: i32) -> Option<&'static str> {
    Some(match signal {
        4 => "SIGILL",
        6 => "SIGABRT",
        7 => "SIGBUS",
        8 => "SIGFPE",
        9 => "SIGKILL",
        11 => "SIGSEGV",
        15 => "SIGTERM",
        _ => return None,
    })
}

impl fmt::Display for Doing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Load => f.write_str("loading its library"),
            Self::Call(call) => f.write_str(call.name()),
            Self::BetweenCalls => f.write_str("no call"),
        }
    }
}
