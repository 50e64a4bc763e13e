//! A run that can begin: what preparation hands to the process that supervises the run.

use super::home::Home;
use super::interruption::Completion;
use super::run_spec::RunSpec;
use results::checkpoint::Saving;
use results::run_folder::RunFolder;
use results::run_record::RunRecord;
use std::sync::Arc;

/// A run that can begin.
#[derive(Debug)]
pub struct PreparedRun {
    /// What is run.
    pub spec: RunSpec,
    /// The checkpoints that it is to leave.
    pub saving: Saving,
    /// What `run.json` says so far.
    pub record: RunRecord,
    /// The folder of the results, locked.
    pub folder: RunFolder,
    /// The private folder with unpacked units and the board; removed when the last value that refers to it is dropped.
    pub home: Arc<Home>,
    /// Until it is dropped, a signal lets the run complete its results.
    pub completion: Completion,
    /// The script as the user named it.
    pub script: String,
}
