//! Claims judged online: each takes one sample at every tick and has a standing at any time.
//!
//! A claim is a `claim::AtStart` over `stream::Stream`s. All memory is allocated before the first sample, so that taking
//! one allocates nothing. Next on the walk: `recorder.rs` and `report/` of the crate `results`.

mod claim;
mod history;
mod judged;
mod memory;
mod stream;
#[cfg(test)]
mod tests;
mod window;

pub use memory::Memory;

use crate::flatten::expression::{Moment, SlotOf};
use claim::AtStart;
use dsl::scenario::Claim;
use results::verdict::{ClaimInfo, Limit, MarginUnit, Standing, Verdict};

/// Whether a run came to its own end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// The run is complete, at its stop time or because a unit ended it: unbounded operators range up to its last sample.
    Complete,
    /// The run was cut off: an unbounded operator that its samples do not decide stays open.
    CutOff,
}

/// What reports say about a claim besides its standing.
#[must_use]
pub fn info(claim: &Claim) -> ClaimInfo {
    let unit = claim.unit.as_ref().map(|unit| MarginUnit { name: unit.name.clone(), factor: unit.factor });
    let limit = claim.limit.map(|limit| Limit { value: limit.value, upper: limit.upper });
    ClaimInfo { name: claim.name.clone(), text: claim.text.clone(), line: claim.line, unit, limit }
}

/// All claims of a script.
#[derive(Debug)]
pub struct Claims {
    monitors: Vec<Monitor>,
    lost: Option<usize>,
}

#[derive(Debug)]
struct Monitor {
    formula: AtStart,
    standing: Standing,
}

impl Claims {
    /// Compiles the claims and allocates memory for the samples of ticks 0 to `stop_tick`.
    pub fn new(claims: &[Claim], stop_tick: u64, slot_of: &mut SlotOf<'_>) -> Self {
        let monitor = |claim: &Claim| {
            let formula = AtStart::new(&claim.formula, stop_tick, slot_of);
            let standing = formula.standing(false);
            Monitor { formula, standing }
        };
        Self { monitors: claims.iter().map(monitor).collect(), lost: None }
    }

    /// Takes the sample of a tick; ticks come without gaps from 0. Calls `changed` for each claim whose standing changed.
    pub fn take(&mut self, tick: u64, moment: &Moment<'_>, mut changed: impl FnMut(usize, Standing)) {
        for (index, monitor) in self.monitors.iter_mut().enumerate() {
            if monitor.formula.take(tick, moment) {
                let standing = monitor.formula.standing(false);
                if standing != monitor.standing {
                    monitor.standing = standing;
                    changed(index, standing);
                    if standing.verdict == Verdict::Fails {
                        self.lost.get_or_insert(index);
                    }
                }
            }
        }
    }

    /// The standing of each claim.
    pub fn standings(&self) -> impl Iterator<Item = (usize, Standing)> + '_ {
        self.monitors.iter().map(|monitor| monitor.standing).enumerate()
    }

    /// The claim that was lost first.
    #[must_use]
    pub fn lost(&self) -> Option<usize> {
        self.lost
    }

    /// Judges all claims by the samples up to `last_tick`, or as unjudged without any sample, and calls `visit` for each;
    /// no claim is undecided afterwards.
    pub fn end(&mut self, last_tick: Option<u64>, completeness: Completeness, mut visit: impl FnMut(usize, Standing)) {
        for (index, monitor) in self.monitors.iter_mut().enumerate() {
            if let Some(last_tick) = last_tick {
                monitor.formula.end(last_tick, completeness);
            }
            monitor.standing = monitor.formula.standing(true);
            visit(index, monitor.standing);
        }
    }
}
