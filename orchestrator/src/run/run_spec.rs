//! What the parent of a run hands to the process that steps it.

use crate::run::run_options::RunOptions;
use crate::run::step_loop::Checkpoint;
use dsl::scenario::Scenario;
use fmi2::description::ModelDescription;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use unit::time::seconds;

/// Everything that the stepping process needs; it reads no script and looks for no unit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RunSpec {
    /// What to run.
    pub scenario: Scenario,
    /// The units, in the order of [`Scenario::units`].
    pub units: Vec<UnitSpec>,
    /// The folder that `file("…")` is relative to, the script's.
    #[serde(with = "path_bytes")]
    pub folder: PathBuf,
    /// The board's file.
    #[serde(with = "path_bytes")]
    pub board: PathBuf,
    /// How it is run.
    pub options: RunOptions,
    /// For each instance the worker process that holds it, numbered from 0 without gaps; `None` if one child process holds
    /// all instances and the loop.
    pub worker_of: Option<Vec<usize>>,
    /// When the run is to be saved; each tick occurs once.
    pub saves: Vec<SaveSpec>,
    /// Where the run continues; `None` for the start.
    pub from: Option<Checkpoint>,
}

impl RunSpec {
    /// The unit of an instance.
    #[must_use]
    pub fn unit(&self, instance: usize) -> &UnitSpec {
        &self.units[self.scenario.instances[instance].unit]
    }

    /// The simulated seconds at which the run begins.
    #[must_use]
    pub fn from_s(&self) -> f64 {
        let tick = self.from.as_ref().map_or(self.scenario.start_tick, |checkpoint| checkpoint.tick);
        seconds(tick, self.scenario.step_ns)
    }
}

/// A checkpoint that is to be made.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SaveSpec {
    /// After the row of this tick.
    pub tick: u64,
    /// The private file through which it is passed to the parent.
    #[serde(with = "path_bytes")]
    pub file: PathBuf,
}

/// A unit, unpacked by the parent.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct UnitSpec {
    /// What messages call it: the path or name as the script wrote it.
    pub name: String,
    /// Its folder: `modelDescription.xml`, `binaries/`, `resources/`.
    #[serde(with = "path_bytes")]
    pub folder: PathBuf,
    /// What its `modelDescription.xml` says.
    pub description: ModelDescription,
    /// SHA-256 of its archive.
    pub sha256: String,
}

/// Serializes paths as bytes: not every path is UTF-8.
pub(crate) mod path_bytes {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::ffi::OsString;
    use std::os::unix::ffi::{OsStrExt, OsStringExt};
    use std::path::{Path, PathBuf};

    pub fn serialize<S: Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
        path.as_os_str().as_bytes().serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PathBuf, D::Error> {
        Vec::deserialize(deserializer).map(|bytes| OsString::from_vec(bytes).into())
    }
}

#[test]
fn a_path_that_is_not_utf_8_is_preserved() {
    use std::os::unix::ffi::OsStrExt;
    let folder = PathBuf::from(std::ffi::OsStr::from_bytes(b"/tmp/caf\xe9"));
    let (name, description, sha256) = ("a".to_owned(), ModelDescription::default(), String::new());
    let unit = UnitSpec { name, folder, description, sha256 };
    let read: UnitSpec = postcard::from_bytes(&postcard::to_stdvec(&unit).unwrap()).unwrap();
    assert_eq!(read.folder, unit.folder);
}
