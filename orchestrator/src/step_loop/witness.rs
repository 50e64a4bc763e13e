//! Who sees a run while it goes on: the board, or a test.

use crate::claims::Standing;

/// Takes what the loop tells. Each of these is called often and must be quick.
pub trait Witness {
    /// The run has reached a tick.
    fn reached(&mut self, tick: u64);
    /// Whether somebody wishes the run to end.
    fn stop_requested(&self) -> bool;
    /// A row is complete.
    fn row(&mut self, tick: u64, row: &[u64]);
    /// A claim stands differently than before.
    fn claim(&mut self, claim: usize, standing: Standing);
}
