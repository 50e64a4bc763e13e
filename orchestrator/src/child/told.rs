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
}

impl<'a> Told<'a> {
    /// Tells this board, no faster than this pace.
    pub fn new(board: &'a Board, pace: Option<Pace>) -> Self {
        Self { board, pace }
    }
}

impl Witness for Told<'_> {
    #[inline]
    fn reached(&mut self, tick: u64) {
        if let Some(pace) = &mut self.pace {
            pace.wait_for(tick, || self.board.stop_requested());
        }
        self.board.set_tick(tick);
    }

    #[inline]
    fn stop_requested(&self) -> bool {
        self.board.stop_requested()
    }

    #[inline]
    fn row(&mut self, tick: u64, row: &[u64]) {
        self.board.push_row(tick, row);
    }

    fn claim(&mut self, claim: usize, standing: Standing) {
        let Standing { verdict, margin, worst_tick } = standing;
        self.board.set_claim(claim, &ClaimNote { verdict: verdict as u8, margin, worst_tick });
    }
}

/// Puts a message on the board.
pub fn message(board: &Board, message: &Message) {
    match postcard::to_stdvec(message) {
        Ok(bytes) => assert!(board.push_message(&bytes), "a message of {} bytes is longer than the ring", bytes.len()),
        Err(error) => unreachable!("a message could not be encoded: {error}"),
    }
}
