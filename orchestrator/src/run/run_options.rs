//! The options of a run besides its script.

use crate::run::exercise::Exercise;
use results::recorder::Formats;
use results::run_record::HashedFile;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Duration;

/// The options of a run, from the command line to the process that steps it. Paths that only the parent uses are not
/// serialized, as a path need not be UTF-8.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunOptions {
    /// The folder of the results.
    #[serde(skip)]
    pub out: PathBuf,
    /// End as soon as a claim is lost.
    pub fail_fast: bool,
    /// Write the trace; not with `--record none`.
    pub record: bool,
    /// The formats of the trace (`--format`).
    pub formats: Formats,
    /// The run may be watched: the loop hands rows over even if they are not written.
    pub live: bool,
    /// Simulated seconds for each second of the wall clock (`--pace`); `None` for as fast as it goes.
    pub pace: Option<f64>,
    /// The times at which the run is saved (`--save-at`), with the files.
    #[serde(skip)]
    pub save_at: Vec<(Duration, PathBuf)>,
    /// The checkpoint file from which the run continues (`--from`).
    #[serde(skip)]
    pub from: Option<PathBuf>,
    /// The names of the instances whose calls are logged (`--log-fmi-calls`).
    pub log_calls: Vec<String>,
    /// The limit of a call of a unit; `None` waits without limit.
    pub step_timeout: Option<Duration>,
    /// Each instance has a worker process of its own.
    pub isolate: bool,
    /// The test of a unit that takes the place of the run.
    pub exercise: Option<Exercise>,
    /// The files that the run reads besides those in the script.
    pub files: Vec<HashedFile>,
}

impl RunOptions {
    /// Whether the loop hands over rows.
    #[must_use]
    pub fn hands_over_rows(&self) -> bool {
        self.record || self.live
    }

    /// Whether the calls of the instance of this name are logged.
    #[must_use]
    pub fn logs_calls_of(&self, name: &str) -> bool {
        self.log_calls.iter().any(|logged| logged == name)
    }
}
