//! `run.json`: what was run, on which machine, how long it took and how it ended.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::time::{Duration, SystemTime};
use unit::failure::Failure;

/// The content of `run.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunRecord {
    /// The version of Lockstep that ran; that this key is there makes the file ours.
    pub lockstep: &'static str,
    /// Where the run stands.
    pub state: RunState,
    /// The words of the `scenario` line.
    pub scenario: String,
    /// The script.
    pub script: HashedFile,
    /// The units, each once, in order of first use.
    pub units: Vec<HashedFile>,
    /// What `file("…")` named, in order.
    pub files: Vec<HashedFile>,
    /// The checkpoint that it continued from, unless it ran from the start.
    pub from: Option<Continued>,
    /// The parameters of the script with their values.
    pub parameters: Vec<Parameter>,
    /// The machine.
    pub host: Host,
    /// When it began, UTC.
    pub started: String,
    /// How long it took so far.
    pub wall_s: f64,
    /// Simulated seconds reached; `None` while it runs.
    pub simulated_s: Option<f64>,
    /// Why it broke, if it did.
    pub broken: Option<Broken>,
}

/// A parameter of the script with its value in this run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Parameter {
    /// The name.
    pub name: String,
    /// The value as it can be typed after `--set name = `.
    pub value: String,
    /// Whether the command line set it.
    pub set: bool,
}

/// Where a run stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RunState {
    /// It goes on, or its machine went down: a run that lives holds the lock.
    Running,
    /// It ended by itself.
    Finished,
    /// A unit, the machine or a full disk ended it.
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

/// The machine that a run happened on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Host {
    /// Its name in the network; empty if it has none.
    pub name: String,
    /// Its system.
    pub system: &'static str,
    /// Its kind of processor.
    pub processor: &'static str,
}

/// Why a run broke.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Broken {
    /// The instance, if one was concerned.
    pub instance: Option<String>,
    /// The call, if it happened in one.
    pub call: Option<String>,
    /// Simulated time.
    pub time_s: Option<f64>,
    /// The whole sentence.
    pub message: String,
}

impl RunRecord {
    /// Whether the bytes are a `run.json` that some version of Lockstep wrote.
    #[must_use]
    pub fn is_one(bytes: &[u8]) -> bool {
        serde_json::from_slice::<serde_json::Value>(bytes).is_ok_and(|value| value.get("lockstep").is_some())
    }

    /// The text of the file.
    #[must_use]
    pub fn json(&self) -> String {
        super::json_text(self)
    }

    /// Ends the record.
    pub fn end(&mut self, state: RunState, simulated_s: f64, wall: Duration) {
        self.state = state;
        self.simulated_s = Some(simulated_s);
        self.wall_s = wall.as_secs_f64();
    }
}

impl Broken {
    /// Something broke that has to do with no unit.
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
    /// The machine this runs on.
    #[must_use]
    pub fn this() -> Self {
        let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
        Self { name: name.trim_end().to_owned(), system: std::env::consts::OS, processor: std::env::consts::ARCH }
    }
}

/// Now, as `run.json` writes it.
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
    fn only_a_record_of_ours_is_taken_for_one() {
        assert!(RunRecord::is_one(record().json().as_bytes()));
        assert!(!RunRecord::is_one(b"{\"state\": \"running\"}"));
        assert!(!RunRecord::is_one(b"[1, 2]") && !RunRecord::is_one(b"not json"));
    }

    #[test]
    fn a_hash_is_written_as_sha256sum_writes_it() {
        assert_eq!(sha256(b""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    }
}
