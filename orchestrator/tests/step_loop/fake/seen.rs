//! What a run reports, kept for the test.

use flatten::wiring::{Change, InputLimits};
use orchestrator::run::step_loop::{Checkpoint, Observer};
use results::verdict::Standing;
use std::sync::atomic::AtomicU64;
use unit::board::RowWriter;

/// What a run reported.
pub struct Seen {
    pub columns: usize,
    pub rows: Vec<Vec<f64>>,
    pub first_row: u64,
    pub standings: Vec<Option<Standing>>,
    pub tick: u64,
    pub stop_at: Option<u64>,
    pub saves: Vec<u64>,
    pub checkpoints: Vec<Checkpoint>,
    pub changes: Vec<Change>,
}

impl Observer for &mut Seen {
    fn reached(&mut self, tick: u64) {
        self.tick = tick;
    }
    fn stop_requested(&self) -> bool {
        self.stop_at.is_some_and(|at| self.tick >= at)
    }
    fn row(&mut self, tick: u64, fill: impl FnOnce(RowWriter<'_>)) {
        assert_eq!(tick, self.first_row + self.rows.len() as u64, "rows come without gaps");
        let row: Vec<_> = (0..self.columns).map(|_| AtomicU64::new(u64::MAX)).collect();
        fill(RowWriter::new(&row));
        self.rows.push(row.into_iter().map(|bits| f64::from_bits(bits.into_inner())).collect());
    }
    fn wants_checkpoint(&self, tick: u64) -> bool {
        self.saves.contains(&tick)
    }
    fn checkpoint(&mut self, checkpoint: &Checkpoint) -> Result<(), String> {
        match self.checkpoints.iter_mut().find(|stored| stored.tick == checkpoint.tick) {
            Some(stored) => stored.clone_from(checkpoint),
            None => self.checkpoints.push(checkpoint.clone()),
        }
        Ok(())
    }
    fn missed_limits(&mut self, _: &InputLimits, _: f64, _: u64) {}
    fn window(&mut self, change: Change) {
        self.changes.push(change);
    }
    fn claim(&mut self, claim: usize, standing: Standing) {
        self.standings[claim] = Some(standing);
    }
}
