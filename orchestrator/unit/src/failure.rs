//! Why a run broke: which instance, in which call, at which time, and what happened.

use fmi2::c::Status;
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
    /// The process of the instance gave no sign of life for this many seconds.
    Silent(f64),
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

impl Failure {
    /// Something that has to do with no unit.
    #[must_use]
    pub fn between_calls(time_s: f64, text: String) -> Self {
        Self { instance: None, doing: Doing::BetweenCalls, time_s: Some(time_s), cause: Cause::Other(text) }
    }

    /// What the user can do about it, where there is something.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match (&self.cause, self.doing) {
            (Cause::Hung(limit_s), _) => {
                Some(format!("--step-timeout {}s waits longer, --step-timeout 0 for ever", (limit_s * 6.0).ceil()))
            }
            (Cause::Signal(9), _) => Some("the system ends a process like this when memory runs out".to_owned()),
            (Cause::Status(_) | Cause::NoInstance, _) => {
                Some("the unit's own messages, if it had any, stand above".to_owned())
            }
            _ => None,
        }
    }
}

impl fmt::Display for Doing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Load => f.write_str("the loading of its library"),
            Self::Call(call) => f.write_str(call.name()),
            Self::BetweenCalls => f.write_str("no call"),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.instance {
            Some(name) => write!(f, "`{name}`")?,
            None if matches!(self.cause, Cause::Signal(_) | Cause::Exit(_)) => f.write_str("the stepping process")?,
            None => f.write_str("the run")?,
        }
        let place = match self.doing {
            Doing::BetweenCalls => "between calls".to_owned(),
            doing => format!("in {doing}"),
        };
        match &self.cause {
            Cause::Status(raw) => match Status::from_raw(*raw) {
                Some(status) => write!(f, ": {} returned {}", self.doing, status.name())?,
                None => write!(f, ": {} returned {raw}, which is no status of FMI 2.0,", self.doing)?,
            },
            Cause::NoInstance => f.write_str(": fmi2Instantiate returned NULL")?,
            Cause::Signal(signal) => {
                write!(f, " died of signal {signal}")?;
                if let Some(name) = signal_name(*signal) {
                    write!(f, " ({name})")?;
                }
                write!(f, " {place}")?;
            }
            Cause::Exit(code) => {
                let what = if self.instance.is_some() { "ended its process" } else { "ended" };
                write!(f, " {what} (exit code {code}) {place}")?;
            }
            Cause::Hung(limit_s) => write!(f, " has been {place} for {limit_s} s,")?,
            Cause::Silent(limit_s) => write!(f, ": no sign of life from its process for {limit_s} s, {place}")?,
            Cause::NonFinite { variable, value } => write!(f, ": `{variable}` is {value}")?,
            Cause::Other(text) => {
                let comma = if self.time_s.is_some() { "," } else { "" };
                write!(f, ": {text}{comma}")?;
            }
        }
        match self.time_s {
            Some(time_s) => write!(f, " at {time_s} s"),
            None if matches!(self.cause, Cause::Hung(_)) => f.write_str(" before the start"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(instance: &str, doing: Doing, time_s: Option<f64>, cause: Cause) -> String {
        let instance = (!instance.is_empty()).then(|| instance.to_owned());
        let failure = Failure { instance, doing, time_s, cause };
        let help = failure.help().map_or(String::new(), |help| format!("\nhelp: {help}"));
        format!("error: {failure}{help}\n")
    }

    #[test]
    fn a_failure_names_instance_call_and_time() {
        let step = Doing::Call(Call::DoStep);
        let texts = [
            told("quad", step, Some(12.34), Cause::Status(3)),
            told("quad", Doing::Call(Call::GetReal), Some(0.0), Cause::Status(77)),
            told("quad", Doing::Call(Call::Instantiate), Some(0.0), Cause::NoInstance),
            told("plan", step, Some(12.34), Cause::Signal(11)),
            told("plan", step, Some(12.34), Cause::Signal(9)),
            told("plan", step, Some(12.34), Cause::Signal(63)),
            told("plan", Doing::Load, None, Cause::Signal(6)),
            told("", Doing::BetweenCalls, Some(0.5), Cause::Exit(101)),
            told("plan", Doing::Call(Call::FreeInstance), Some(60.0), Cause::Exit(0)),
            told("plan", step, Some(12.34), Cause::Hung(10.0)),
            told("plan", Doing::Load, None, Cause::Hung(0.5)),
            told("plan", step, Some(12.34), Cause::Silent(2.0)),
            told(
                "quad",
                Doing::Call(Call::GetReal),
                Some(1.5),
                Cause::NonFinite { variable: "position.x".into(), value: "NaN".into() },
            ),
            told(
                "quad",
                step,
                Some(0.5),
                Cause::Other("fmi2DoStep returned fmi2Pending, but nobody asked for it".into()),
            ),
            told("quad", Doing::Load, None, Cause::Other("quad.fmu has no binary for linux64 (it has: win64)".into())),
        ];
        insta::assert_snapshot!(texts.concat());
    }
}
