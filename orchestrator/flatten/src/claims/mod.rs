//! Claims judged online: each takes one sample at every tick and has a standing at any time.
//!
//! A claim is a `claim::AtStart` over `stream::Stream`s, which never change; what changes is in a `ClaimsMemory`. All of
//! it is allocated before the first sample, so that taking one allocates nothing; only a list of what becomes known early
//! grows with the most that one sample makes known. Where margins are late, `early::Early` knows the verdict at the first
//! sample that determines it. Next on the walk: `recorder.rs` and
//! `report/` of the crate `results`.

mod claim;
mod comparisons;
mod early;
mod history;
#[cfg(test)]
mod judge;
mod judged;
mod memory;
mod stream;
#[cfg(test)]
mod tests;
mod until;
mod window;

pub use comparisons::comparisons;
pub use memory::ClaimsMemory;

use crate::expression::{Moment, SlotOf, Stack};
use claim::AtStart;
use dsl::scenario::Claim;
use early::Early;
use memory::Layout;
use results::verdict::{ClaimInfo, ClaimPart, Limit, MarginUnit, Standing, Verdict};
use std::ops::Range;
use stream::Sample;

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
    let part = |part: &dsl::scenario::ClaimPart| ClaimPart {
        text: part.text.clone(),
        window: part.window.clone(),
        signals: part.signals.clone(),
    };
    ClaimInfo {
        name: claim.name.clone(),
        text: claim.text.clone(),
        part_file: claim.part_file.clone(),
        line: claim.line,
        unit,
        limit,
        parts: claim.parts.iter().map(part).collect(),
        gates: claim.gates.clone(),
    }
}

/// All claims of a script, compiled.
#[derive(Debug)]
pub struct Claims {
    formulas: Vec<Compiled>,
    layout: Layout,
    stop_tick: u64,
}

/// A claim, compiled.
#[derive(Debug)]
struct Compiled {
    formula: AtStart,
    /// The indices of its gates.
    gates: Range<usize>,
    /// Where its verdict would be late otherwise, with the index of its memory.
    early: Option<(Early, usize)>,
}

impl Compiled {
    /// Its standing while samples come.
    fn standing(&self, memory: &ClaimsMemory) -> Standing {
        let standing = self.formula.standing(memory, false);
        let early = self.early.as_ref().and_then(|(_, index)| memory.earlies[*index].holds);
        match (standing.verdict, early) {
            // Margin and time are known later.
            (Verdict::Undecided, Some(true)) => Standing { verdict: Verdict::Holds, ..Standing::UNKNOWN },
            (Verdict::Undecided, Some(false)) => Standing { verdict: Verdict::Fails, ..Standing::UNKNOWN },
            _ => standing,
        }
    }

    /// Takes the sample of a tick; returns whether the standing may have changed.
    fn take(&self, memory: &mut ClaimsMemory, tick: u64, sample: &mut Sample<'_>) -> bool {
        let changed = self.formula.take(memory, tick, sample);
        let Some((early, index)) = &self.early else { return changed };
        changed | early.take(&mut memory.earlies[*index], tick, sample)
    }
}

impl Claims {
    /// Compiles the claims for a run that ends at `stop_tick`.
    pub fn new(claims: &[Claim], stop_tick: u64, slot_of: &mut SlotOf<'_>) -> Self {
        let mut layout = Layout::default();
        let formula = |claim: &Claim| {
            layout.begin_claim();
            let first = layout.gates();
            let formula = AtStart::new(&claim.formula, &mut layout, slot_of);
            let gates = first..layout.gates();
            let early = Early::new(&claim.formula, &mut layout, slot_of);
            Compiled { formula, gates, early: early.map(|early| (early, layout.early())) }
        };
        let formulas = claims.iter().map(formula).collect();
        Self { formulas, layout, stop_tick }
    }

    /// Takes the sample of a tick; ticks come without gaps from 0. Calls `changed` for each claim whose standing may have
    /// changed.
    pub fn take(
        &self,
        memory: &mut ClaimsMemory,
        tick: u64,
        moment: &Moment<'_>,
        stack: &mut Stack,
        mut changed: impl FnMut(usize, Standing),
    ) {
        let mut sample = Sample { moment, stack };
        for (index, claim) in self.formulas.iter().enumerate() {
            if claim.take(memory, tick, &mut sample) {
                let standing = claim.standing(memory);
                changed(index, standing);
                if standing.verdict == Verdict::Fails {
                    memory.lost.get_or_insert(index);
                }
            }
        }
    }

    /// The standing of each claim.
    pub fn standings(&self, memory: &ClaimsMemory) -> impl Iterator<Item = (usize, Standing)> {
        self.formulas.iter().map(|claim| claim.standing(memory)).enumerate()
    }

    /// Judges all claims by the samples up to `last_tick`, or as unjudged without any sample, and calls `visit` for each;
    /// no claim is undecided afterwards.
    pub fn end(
        &self,
        memory: &mut ClaimsMemory,
        last_tick: Option<u64>,
        completeness: Completeness,
        mut visit: impl FnMut(usize, Standing),
    ) {
        for (index, Compiled { formula, gates, .. }) in self.formulas.iter().enumerate() {
            if let Some(last_tick) = last_tick {
                formula.end(memory, last_tick, completeness);
            }
            let standing = formula.standing(memory, true);
            let closed = memory.opened[gates.clone()].iter().position(|opened| !opened);
            visit(
                index,
                match closed.and_then(|gate| u32::try_from(gate).ok()) {
                    Some(part) if standing.verdict == Verdict::Holds => {
                        Standing { verdict: Verdict::Untested, part, ..standing }
                    }
                    _ => standing,
                },
            );
        }
    }
}
