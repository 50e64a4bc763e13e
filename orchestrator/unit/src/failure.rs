//! Why a run broke: the instance, the call, the time and the cause.

use fmi2::c::{RawStatus, Status};
use fmi2::calls::Call;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Why a run broke. Names are filled in when it happens, so that printing needs no other data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// The instance's name in the script; `None` if the failure is not about one instance.
    pub instance: Option<String>,
    /// What the process was doing.
    pub doing: Doing,
    /// Simulated time in seconds; `None` before the first instance exists.
    pub time_s: Option<f64>,
    /// The cause.
    pub cause: Cause,
}

/// What a process was doing when the run broke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Doing {
    /// Loading the unit's library.
    Load,
    /// A call of a function of the standard.
    Call(Call),
    /// No call of a unit.
    BetweenCalls,
}

/// The cause of a failure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Cause {
    /// The call returned this status, which is neither `fmi2OK` nor `fmi2Warning`.
    Status(i32),
    /// `fmi2Instantiate` returned NULL.
    NoInstance,
    /// The process was ended by this signal.
    Signal(i32),
    /// An exception, or the end of the thread, left the call, so that the process ended.
    Unwound,
    /// The process ended with this exit code without reporting that the run was complete.
    Exit(i32),
    /// The call did not return within this many seconds.
    Hung(f64),
    /// The process of the instance sent no heartbeat for this many seconds.
    Silent(f64),
    /// The call returned in a copy of its process too (`fork`).
    Copied,
    /// The process has been stopped (`SIGSTOP`) for this many seconds.
    Stopped(f64),
    /// An output is another one than in the run that saved the instance: its name and both values.
    NotRestored(String),
    /// A variable got a value that is not a finite number.
    NonFinite {
        /// The variable.
        variable: String,
        /// The value: `NaN`, `inf` or `-inf`.
        value: String,
    },
    /// Anything else, as text.
    Other(String),
}

/// The name of a signal that often ends a process; `None` for others.
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
    /// A variable of an instance has a value that is not finite.
    #[must_use]
    pub fn non_finite(instance: String, time_s: f64, variable: String, value: f64) -> Self {
        let (doing, cause) = (Doing::Call(Call::GetReal), Cause::NonFinite { variable, value: value.to_string() });
        Self { instance: Some(instance), doing, time_s: Some(time_s), cause }
    }

    /// An instance has other outputs than in the run that saved it; `change` names the first, with both values.
    #[must_use]
    pub fn not_restored(instance: String, time_s: f64, change: String) -> Self {
        let (doing, cause) = (Doing::BetweenCalls, Cause::NotRestored(change));
        Self { instance: Some(instance), doing, time_s: Some(time_s), cause }
    }

    /// A failure that is not about a unit.
    #[must_use]
    pub fn between_calls(time_s: f64, text: String) -> Self {
        Self { instance: None, doing: Doing::BetweenCalls, time_s: Some(time_s), cause: Cause::Other(text) }
    }

    /// Whether a unit refused a call by a status after which others may go on.
    #[must_use]
    pub fn is_refusal(&self) -> bool {
        [Status::Discard, Status::Error].iter().any(|&status| self.cause == Cause::Status(status as RawStatus))
    }

    /// What the user can do about it, if anything.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match (&self.cause, self.doing) {
            (Cause::Hung(limit_s), _) => {
                Some(format!("--step-timeout {}s waits longer, --step-timeout 0 for ever", (limit_s * 6.0).ceil()))
            }
            (Cause::Stopped(_), _) => Some("--step-timeout 0 waits for ever, for a debugger".to_owned()),
            (Cause::NotRestored(_), _) => {
                Some("the state that the unit saves is incomplete: run from the start, without --from".to_owned())
            }
            (Cause::Signal(9), _) => Some("the system ends a process like this when memory runs out".to_owned()),
            (Cause::Signal(_), Doing::BetweenCalls) if self.instance.is_none() => {
                Some("a unit may have written where it must not; --isolate shows which".to_owned())
            }
            (Cause::Status(_) | Cause::NoInstance, _) => {
                Some("the unit's own messages, if it had any, are above".to_owned())
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
            None if matches!(self.cause, Cause::Signal(_) | Cause::Exit(_) | Cause::Stopped(_)) => {
                f.write_str("the stepping process")?
            }
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
            Cause::Unwound => {
                write!(
                    f,
                    " left {} by an exception or the end of its thread (pthread_exit): its process ended",
                    self.doing
                )?;
            }
            Cause::Exit(code) => {
                let what = if self.instance.is_some() { "ended its process" } else { "ended" };
                write!(f, " {what} (exit code {code}) {place}")?;
            }
            Cause::Hung(limit_s) => write!(f, " has been {place} for {limit_s} s,")?,
            Cause::Silent(limit_s) => write!(f, ": no sign of life from its process for {limit_s} s, {place}")?,
            Cause::Copied => write!(f, " copied its process (fork), and both returned from {}", self.doing)?,
            Cause::Stopped(limit_s) => {
                let what = if self.instance.is_some() { ": its process has been" } else { " has been" };
                write!(f, "{what} stopped (SIGSTOP) for {limit_s} s, {place},")?;
            }
            Cause::NotRestored(change) => write!(f, " did not come back as it was saved: {change},")?,
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

    fn message(instance: &str, doing: Doing, time_s: Option<f64>, cause: Cause) -> String {
        let instance = (!instance.is_empty()).then(|| instance.to_owned());
        let failure = Failure { instance, doing, time_s, cause };
        let help = failure.help().map_or(String::new(), |help| format!("\nhelp: {help}"));
        format!("error: {failure}{help}\n")
    }

    #[test]
    fn a_failure_names_instance_call_and_time() {
        let step = Doing::Call(Call::DoStep);
        let texts = [
            message("quad", step, Some(12.34), Cause::Status(3)),
            message("quad", Doing::Call(Call::GetReal), Some(0.0), Cause::Status(77)),
            message("quad", Doing::Call(Call::Instantiate), Some(0.0), Cause::NoInstance),
            message("plan", step, Some(12.34), Cause::Signal(11)),
            message("plan", step, Some(12.34), Cause::Signal(9)),
            message("plan", step, Some(12.34), Cause::Signal(63)),
            message("plan", Doing::Load, None, Cause::Signal(6)),
            message("plan", step, Some(12.34), Cause::Unwound),
            message("", Doing::BetweenCalls, Some(0.5), Cause::Exit(101)),
            message("", Doing::BetweenCalls, Some(0.5), Cause::Signal(6)),
            message("plan", Doing::Call(Call::FreeInstance), Some(60.0), Cause::Exit(0)),
            message("plan", step, Some(12.34), Cause::Hung(10.0)),
            message("plan", Doing::Load, None, Cause::Hung(0.5)),
            message("plan", step, Some(12.34), Cause::Silent(2.0)),
            message("plan", step, Some(12.34), Cause::Copied),
            message("plan", step, Some(12.34), Cause::Stopped(1.0)),
            message("", Doing::BetweenCalls, Some(12.34), Cause::Stopped(1.0)),
            message(
                "quad",
                Doing::Call(Call::GetReal),
                Some(1.5),
                Cause::NonFinite { variable: "position.x".into(), value: "NaN".into() },
            ),
            message(
                "quad",
                step,
                Some(0.5),
                Cause::Other("fmi2DoStep returned fmi2Pending, but nobody asked for it".into()),
            ),
            message(
                "quad",
                Doing::Load,
                None,
                Cause::Other("quad.fmu has no binary for linux64 (it has: win64)".into()),
            ),
        ];
        insta::assert_snapshot!(texts.concat());
    }
}
