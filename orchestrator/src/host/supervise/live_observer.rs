//! Who sees a run go on besides its trace.

use results::run_record::RunState;
use std::fmt::Debug;
use std::sync::Arc;
use unit::board::Board;

/// Takes what the run shows while it goes on. None of it may wait for anybody, and nothing of it changes the run.
pub trait LiveObserver: Debug {
    /// The run begins; how far it is and how its claims stand is on this board.
    fn begin(&mut self, board: &Arc<Board>);
    /// A row is complete.
    fn row(&mut self, tick: u64, slots: &[u64]);
    /// The run is over, and the last row was told.
    fn end(self: Box<Self>, state: RunState);
}
