//! The loop's witness in a run: the board.

use super::pace::Pace;
use crate::claims::Standing;
use crate::message::Message;
use crate::step_loop::Witness;
use crate::unit::board::{Board, ClaimNote};

/// Tells the board.
pub struct Told<'a> {
    board: &'a Board,
    pace: Option<Pace>,
    tick: u64,
}

impl<'a> Told<'a> {
    /// Tells this board, no faster than this pace.
    pub fn new(board: &'a Board, pace: Option<Pace>) -> Self {
        Self { board, pace, tick: 0 }
    }
}

impl Witness for Told<'_> {
    #[inline]
    fn reached(&mut self, tick: u64) {
        if let Some(pace) = &mut self.pace {
            pace.wait_for(tick, || self.board.stop_requested());
        }
        self.tick = tick;
        self.board.set_tick(tick);
    }

    #[inline]
    fn stop_requested(&self) -> bool {
        self.board.stop_requested()
    }

    #[inline]
    fn row(&mut self, tick: u64, row: &[u64]) {
        // A row that nobody waits for any more is dropped, and the wish to stop stands on the board already.
        self.board.push_row(tick, row);
    }

    fn claim(&mut self, claim: usize, standing: Standing) {
        let Standing { verdict, margin, worst_tick } = standing;
        self.board.set_claim(claim, &ClaimNote { verdict: verdict as u8, margin, worst_tick, tested: self.tick + 1 });
    }
}

/// Puts a message on the board.
pub fn message(board: &Board, message: &Message) {
    match postcard::to_stdvec(message) {
        Ok(bytes) => {
            board.push_message(&bytes);
        }
        Err(error) => unreachable!("a message could not be encoded: {error}"),
    }
}
