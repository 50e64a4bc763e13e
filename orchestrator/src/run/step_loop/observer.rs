//! Who sees a run while it goes on: the board, or a test.

use super::Checkpoint;
use results::verdict::Standing;

/// Takes what the loop tells. Each of these is called often and must be quick.
pub trait Observer {
    /// The run has reached a tick.
    fn reached(&mut self, tick: u64);
    /// Whether somebody wishes the run to end.
    fn stop_requested(&self) -> bool;
    /// A row is complete.
    fn row(&mut self, tick: u64, row: &[u64]);
    /// Whether the run is to be kept as it is when the row of this tick is complete.
    fn wants_checkpoint(&self, tick: u64) -> bool;
    /// Keeps the run as it is.
    ///
    /// # Errors
    /// What keeps it from being kept.
    fn checkpoint(&mut self, checkpoint: &Checkpoint) -> Result<(), String>;
    /// A claim stands differently than before.
    fn claim(&mut self, claim: usize, standing: Standing);
}
