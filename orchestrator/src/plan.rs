//! What the parent of a run hands to the process that steps it.

use dsl::scenario::Scenario;
use fmi2::description::ModelDescription;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Everything that the stepping process needs; it reads no script and looks for no unit.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// What to run.
    pub scenario: Scenario,
    /// The units, each once.
    pub units: Vec<PlannedUnit>,
    /// For each instance of the scenario the index of its unit.
    pub unit_of: Vec<usize>,
    /// The folder that `file("…")` is relative to, the script's.
    pub folder: PathBuf,
    /// The board's file.
    pub board: PathBuf,
    /// End as soon as a claim is lost.
    pub fail_fast: bool,
    /// Record nothing (`--record none`).
    pub record: bool,
}

/// A unit, unpacked by the parent.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PlannedUnit {
    /// What messages call it: the path or name as the script wrote it.
    pub name: String,
    /// Its folder: `modelDescription.xml`, `binaries/`, `resources/`.
    pub folder: PathBuf,
    /// What its `modelDescription.xml` says.
    pub description: ModelDescription,
}
