//! The trait of those that observe a run while it goes on: the board, or a test.

use super::Checkpoint;
use flatten::wiring::{Change, InputLimits};
use results::verdict::Standing;
use unit::board::RowWriter;

/// Receives what the loop reports. The loop waits for each of these calls, so they must be quick.
pub trait Observer {
    /// The run has reached a tick.
    fn reached(&mut self, tick: u64);
    /// Whether the run is to end early.
    fn stop_requested(&self) -> bool;
    /// The row of a tick is due; `fill` sets all its columns.
    fn row(&mut self, tick: u64, fill: impl FnOnce(RowWriter<'_>));
    /// Whether the run is to be saved after the row of this tick.
    fn wants_checkpoint(&self, tick: u64) -> bool;
    /// Stores the checkpoint, in place of an earlier one of its tick.
    ///
    /// # Errors
    /// Why it could not be stored.
    fn checkpoint(&mut self, checkpoint: &Checkpoint) -> Result<(), String>;
    /// An input gets its first value that its unit's description does not allow, just before it is set at this tick.
    fn missed_limits(&mut self, input: &InputLimits, value: f64, tick: u64);
    /// A window has opened or closed; a run that continues passes on first what happened before.
    fn window(&mut self, change: Change);
    /// The standing of a claim has changed, or the run has ended.
    fn claim(&mut self, claim: usize, standing: Standing);
}
