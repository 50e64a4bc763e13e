//! The messages that a run sends through the message ring of a board, besides rows and claims.
//!
//! A stepping process sends them to its parent, a loop to the thread that supervises it, a worker to its coordinator.

use dsl::scenario::Scenario;
use flatten::wiring::Change;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use unit::failure::Failure;
use unit::logger::LogMessage;

/// One record, encoded by postcard.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Message {
    /// A unit's own log message, printf arguments already in place.
    Log(LogMessage),
    /// The checkpoint after the row of this tick is in the file that the specification names.
    Saved(u64),
    /// The next piece of the log of an instance's calls.
    Calls(CallPiece),
    /// The run ended by itself; nothing follows.
    Finished(Finish),
    /// The run broke; only log messages and calls of units that are freed follow.
    Broken(Failure),
    /// A window has opened or closed.
    Window(Change),
}

/// Where messages go; called by any thread.
pub type MessageSink = Arc<dyn Fn(Message) + Send + Sync>;

/// A piece of the log of an instance's calls.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CallPiece {
    /// Index of the instance.
    pub instance: usize,
    /// The next bytes of the file.
    pub bytes: Vec<u8>,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finish {
    /// The tick of the last row.
    pub last_tick: u64,
    /// Why.
    pub reason: Reason,
}

/// Why a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reason {
    /// The stop time was reached.
    StopTime,
    /// This instance terminated (`fmi2Discard` with `fmi2Terminated`).
    Terminated(usize),
    /// `--fail-fast` and this claim was lost.
    ClaimLost(usize),
    /// The user interrupted.
    Interrupted,
    /// The condition of `stop when` held.
    StopWhen,
}

impl Reason {
    /// Why a run ended, as results show it.
    #[must_use]
    pub fn text(&self, scenario: &Scenario) -> String {
        match self {
            Self::StopTime => "stop time".to_owned(),
            Self::Terminated(instance) => format!("`{}` terminated", scenario.instances[*instance].name),
            Self::ClaimLost(claim) => format!("claim `{}` lost", scenario.claims[*claim].name),
            Self::Interrupted => "interrupted".to_owned(),
            Self::StopWhen => {
                let condition = scenario.stop_when.as_ref().map_or("", |stop| stop.text.as_str());
                format!("stop when {condition}")
            }
        }
    }
}
