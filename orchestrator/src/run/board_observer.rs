//! The observer of the step loop that writes to the board.

use super::pace::Pace;
use crate::run::message::{Message, MessageSink};
use crate::run::run_spec::SaveSpec;
use crate::run::step_loop::{Checkpoint, Observer};
use flatten::wiring::{Change, InputLimits};
use fmi2::printable;
use results::shortest_decimal;
use results::verdict::Standing;
use std::sync::Arc;
use unit::board::{Board, ClaimNote, RowWriter};
use unit::logger::LogMessage;

/// Writes rows, claims and checkpoints of a run.
pub struct BoardObserver<'a> {
    board: &'a Board,
    pace: Option<Pace>,
    saves: &'a [SaveSpec],
}

impl<'a> BoardObserver<'a> {
    /// Writes to this board, waits for the pace if there is one, and saves the run at the ticks of `saves`.
    pub fn new(board: &'a Board, pace: Option<Pace>, saves: &'a [SaveSpec]) -> Self {
        Self { board, pace, saves }
    }
}

impl Observer for BoardObserver<'_> {
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
    fn row(&mut self, tick: u64, fill: impl FnOnce(RowWriter<'_>)) {
        self.board.write_row(tick, fill);
    }

    #[inline]
    fn wants_checkpoint(&self, tick: u64) -> bool {
        self.saves.iter().any(|save| save.tick == tick)
    }

    fn checkpoint(&mut self, checkpoint: &Checkpoint) -> Result<(), String> {
        let bytes = postcard::to_stdvec(checkpoint).map_err(|error| format!("cannot encode a checkpoint: {error}"))?;
        for save in self.saves.iter().filter(|save| save.tick == checkpoint.tick) {
            // Renamed when it is complete: the parent may read an earlier one meanwhile.
            let partial = save.file.with_extension("partial");
            let written = std::fs::write(&partial, &bytes).and_then(|()| std::fs::rename(&partial, &save.file));
            written.map_err(|error| format!("cannot write {}: {error}", printable::path(&save.file)))?;
        }
        message(self.board, &Message::Saved(checkpoint.tick));
        Ok(())
    }

    #[cold]
    fn missed_limits(&mut self, input: &InputLimits, value: f64, tick: u64) {
        let InputLimits { name, unit, limits, .. } = input;
        let space = if unit.is_empty() { "" } else { " " };
        let value = shortest_decimal(value);
        let text = format!("`{name}` gets {value}{space}{unit}, and its description says {limits} (reported once)");
        message(self.board, &Message::Log(LogMessage::warning(input.port.instance, (tick, tick), text)));
    }

    #[cold]
    fn window(&mut self, change: Change) {
        message(self.board, &Message::Window(change));
    }

    fn claim(&mut self, claim: usize, standing: Standing) {
        let Standing { verdict, margin, worst_tick, first_tick, part } = standing;
        self.board.set_claim(claim, &ClaimNote { verdict: verdict as u8, margin, worst_tick, first_tick, part });
    }
}

/// The sink that puts messages of this process on the board.
#[must_use]
pub fn sink(board: &Arc<Board>) -> MessageSink {
    let board = Arc::clone(board);
    Arc::new(move |sent| message(&board, &sent))
}

/// Puts a message on the board.
pub fn message(board: &Board, message: &Message) {
    match postcard::to_stdvec(message) {
        Ok(bytes) => assert!(board.push_message(&bytes), "a message of {} bytes is longer than the ring", bytes.len()),
        Err(error) => unreachable!("a message could not be encoded: {error}"),
    }
}
