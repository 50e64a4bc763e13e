//! `run.json`: what was run, on which machine, how long it took and how it ended.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::time::{Duration, SystemTime};
use unit::failure::Failure;

/// The content of `run.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunRecord {
    /// The version of Lockstep that ran. A `run.json` is recognised by this key.
    pub lockstep: &'static str,
    /// The state of the run.
    pub state: RunState,
    /// The title in the `scenario` line.
    pub scenario: String,
    /// The script.
    pub script: HashedFile,
    /// The units in order of first use, each once.
    pub units: Vec<HashedFile>,
    /// The files named by `file("…")`, in order.
    pub files: Vec<HashedFile>,
    /// The checkpoint that the run continued from; `None` if it ran from the start.
    pub from: Option<Continued>,
    /// The parameters of the script with their values.
    pub parameters: Vec<Parameter>,
    /// The case of the script's sweep, if one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub case: Option<Case>,
    /// The computer.
    pub host: Host,
    /// The time at which it began, UTC.
    pub started: String,
    /// The wall time so far.
    pub wall_s: f64,
    /// Simulated seconds reached; `None` while it runs.
    pub simulated_s: Option<f64>,
    /// Why it broke; `None` if it did not.
    pub broken: Option<Broken>,
}

/// A parameter of the script with its value in this run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Parameter {
    /// The name.
    pub name: String,
    /// The value as it can be written after `--set name = `.
    pub value: String,
    /// Whether the command line set it.
    pub set: bool,
}

/// A case of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Case {
    /// Its number, from 0.
    pub number: u64,
    /// The seed that `--set seed = …` gave to the draws, where `seed` is an axis itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub draw_seed: Option<i64>,
}

/// The state of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RunState {
    /// It is running, or its computer stopped meanwhile: the lock on `run.json` is held only in the first case.
    Running,
    /// It reached its end.
    Finished,
    /// A failure of a unit or of the system ended it.
    Broken,
    /// The user ended it.
    Interrupted,
}

/// A file that the run depends on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HashedFile {
    /// As the script or the command line names it.
    pub name: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// Where a run continued from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Continued {
    /// The checkpoint's file.
    pub checkpoint: HashedFile,
    /// The simulated seconds at which it was saved.
    pub time_s: f64,
}

/// The computer that a run was executed on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Host {
    /// Its host name; empty if it has none.
    pub name: String,
    /// Its operating system.
    pub system: &'static str,
    /// Its processor architecture.
    pub processor: &'static str,
}

/// Why a run broke.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Broken {
    /// The instance; `None` if the failure is not about one instance.
    pub instance: Option<String>,
    /// The call; `None` if it happened between calls.
    pub call: Option<String>,
    /// Simulated time.
    pub time_s: Option<f64>,
    /// The whole message.
    pub message: String,
}

impl RunRecord {
    /// Whether the bytes are a `run.json` that a version of Lockstep wrote.
    #[must_use]
    pub fn is_one(bytes: &[u8]) -> bool {
        serde_json::from_slice::<serde_json::Value>(bytes).is_ok_and(|value| value.get("lockstep").is_some())
    }

    /// The text of the file.
    #[must_use]
    pub fn json(&self) -> String {
        super::json_text(self)
    }

    /// Completes the record at the end of the run.
    pub fn end(&mut self, state: RunState, simulated_s: f64, wall: Duration) {
        self.state = state;
        self.simulated_s = Some(simulated_s);
        self.wall_s = wall.as_secs_f64();
    }
}

impl Broken {
    /// A failure that is not about a unit.
    #[must_use]
    pub fn outside_of_calls(message: &impl std::fmt::Display) -> Self {
        Self { instance: None, call: None, time_s: None, message: message.to_string() }
    }
}

impl From<&Failure> for Broken {
    fn from(failure: &Failure) -> Self {
        use unit::failure::Doing;
        let call = (failure.doing != Doing::BetweenCalls).then(|| failure.doing.to_string());
        Self { instance: failure.instance.clone(), call, time_s: failure.time_s, message: failure.to_string() }
    }
}

impl Host {
    /// The computer that this process runs on.
    #[must_use]
    pub fn this() -> Self {
        let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        Self { name: name.trim_end().to_owned(), system: std::env::consts::OS, processor: std::env::consts::ARCH }
    }
}

/// The present time, as `run.json` contains it.
#[must_use]
pub fn now() -> String {
    humantime::format_rfc3339_seconds(SystemTime::now()).to_string()
}

/// SHA-256, hexadecimal.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use fmi2::calls::Call;
    use unit::failure::{Cause, Doing};

    pub(crate) fn record() -> RunRecord {
        let file = |name: &str| HashedFile { name: name.to_owned(), sha256: sha256(name.as_bytes()) };
        RunRecord {
            lockstep: "0.1.0",
            state: RunState::Running,
            scenario: "A unit goes up".to_owned(),
            script: file("up.scn"),
            units: vec![file("quadcopter")],
            files: vec![],
            from: None,
            parameters: vec![Parameter { name: "seed".to_owned(), value: "1".to_owned(), set: false }],
            case: None,
            host: Host { name: "here".to_owned(), system: "linux", processor: "x86_64" },
            started: "2030-01-02T03:04:05Z".to_owned(),
            wall_s: 0.0,
            simulated_s: None,
            broken: None,
        }
    }

    #[test]
    fn a_broken_run_is_recorded_with_instance_call_and_time() {
        let failure = Failure {
            instance: Some("quad".to_owned()),
            doing: Doing::Call(Call::DoStep),
            time_s: Some(12.34),
            cause: Cause::Signal(11),
        };
        let mut record = record();
        record.end(RunState::Broken, 12.335, Duration::from_millis(250));
        record.broken = Some(Broken::from(&failure));
        insta::assert_snapshot!(record.json());
    }

    #[test]
    fn only_a_record_of_lockstep_is_recognised() {
        assert!(RunRecord::is_one(record().json().as_bytes()));
        assert!(!RunRecord::is_one(b"{\"state\": \"running\"}"));
        assert!(!RunRecord::is_one(b"[1, 2]") && !RunRecord::is_one(b"not json"));
    }

    #[test]
    fn a_hash_is_written_as_sha256sum_writes_it() {
        assert_eq!(sha256(b""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    }
}
