//! The trait of those that observe a run while it goes on, besides the recorder.

use results::run_record::RunState;
use std::fmt::Debug;
use std::sync::Arc;
use unit::board::Board;

/// Takes what the run shows while it goes on. The calls must not block and cannot change the run.
pub trait LiveObserver: Debug {
    /// The run begins; how far it is and how its claims stand is on this board.
    fn begin(&mut self, board: &Arc<Board>);
    /// A row is complete.
    fn row(&mut self, tick: u64, slots: &[u64]);
    /// The run is over; no row follows.
    fn end(self: Box<Self>, state: RunState);
}
