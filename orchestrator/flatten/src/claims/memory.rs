//! The memory of claims between two samples: flat arrays, however deep the formulas are, so that a checkpoint contains it
//! as it is and the bytes of a damaged one cannot cause deep recursion.

use super::Claims;
use super::early::{Early, EarlyMemory};
use super::judged::{Decision, Joined};
use super::until::UntilMemory;
use super::window::Window;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The most values that memory is allocated for in advance. A longer run grows its memory during the run: few runs with
/// such a stop time are meant to reach it.
const MAX_INITIAL_CAPACITY: usize = 10_000_000;

/// All that changes in the claims of a script from sample to sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ClaimsMemory {
    /// Values of atoms at tick 0, and values that wait for others of their tick.
    pub(super) decisions: Vec<Decision>,
    /// Values of temporal operators that are evaluated at tick 0 only.
    pub(super) temporals: Vec<Joined>,
    pub(super) windows: Vec<Window>,
    pub(super) untils: Vec<UntilMemory>,
    /// Values at all ticks so far.
    pub(super) histories: Vec<Vec<Decision>>,
    /// Whether each gate was open when the claim asked for it, and each `until` did not end at once.
    pub(super) opened: Vec<bool>,
    pub(super) lost: Option<usize>,
    /// What is known early of claims.
    pub(super) earlies: Vec<EarlyMemory>,
}

/// The shape of the memory: it gives out the indices while claims are compiled.
#[derive(Debug, Default)]
pub(super) struct Layout {
    decisions: usize,
    temporals: usize,
    /// The width of each window.
    windows: Vec<u64>,
    /// The last tick of the window of each `until`, counted from its start.
    untils: Vec<u64>,
    /// By how many ticks the values of each history are late.
    histories: Vec<u64>,
    gates: usize,
    earlies: usize,
    /// The parts of the current claim.
    parts: u32,
}

impl ClaimsMemory {
    /// The claim that was lost first.
    #[must_use]
    pub fn lost(&self) -> Option<usize> {
        self.lost
    }
}

impl Layout {
    pub fn decisions(&mut self, count: u64) -> Range<usize> {
        let first = self.decisions;
        self.decisions = first.saturating_add(usize::try_from(count).unwrap_or(usize::MAX));
        first..self.decisions
    }

    pub fn temporal(&mut self) -> usize {
        self.temporals += 1;
        self.temporals - 1
    }

    pub fn window(&mut self, width: u64) -> usize {
        self.windows.push(width);
        self.windows.len() - 1
    }

    pub fn until(&mut self, to: u64) -> usize {
        self.untils.push(to);
        self.untils.len() - 1
    }

    pub fn gate(&mut self) -> usize {
        self.gates += 1;
        self.gates - 1
    }

    /// The next memory of what is known early.
    pub fn early(&mut self) -> usize {
        self.earlies += 1;
        self.earlies - 1
    }

    /// How many gates there are so far.
    pub fn gates(&self) -> usize {
        self.gates
    }

    /// Begins a claim: its parts are counted from 0.
    pub fn begin_claim(&mut self) {
        self.parts = 0;
    }

    pub fn part(&mut self) -> u32 {
        self.parts += 1;
        self.parts - 1
    }

    pub fn history(&mut self, horizon: u64) -> usize {
        self.histories.push(horizon);
        self.histories.len() - 1
    }
}

impl Claims {
    /// The memory before the first sample.
    #[must_use]
    pub fn memory(&self) -> ClaimsMemory {
        let mut memory = ClaimsMemory {
            decisions: vec![None; self.layout.decisions],
            temporals: vec![Joined::new(false); self.layout.temporals],
            windows: vec![Window::default(); self.layout.windows.len()],
            untils: vec![UntilMemory::default(); self.layout.untils.len()],
            histories: vec![Vec::new(); self.layout.histories.len()],
            opened: vec![false; self.layout.gates],
            lost: None,
            earlies: self.early().map(Early::memory).collect(),
        };
        self.reserve(&mut memory);
        memory
    }

    /// Allocates what the rest of the run needs; memory out of a checkpoint has no more than its content.
    pub fn reserve(&self, memory: &mut ClaimsMemory) {
        memory.windows.iter_mut().zip(&self.layout.windows).for_each(|(window, &width)| window.reserve(width));
        memory.untils.iter_mut().zip(&self.layout.untils).for_each(|(until, &to)| until.reserve(to));
        for (values, horizon) in memory.histories.iter_mut().zip(&self.layout.histories) {
            let count = self.stop_tick.saturating_add(1).saturating_sub(*horizon);
            let capacity = usize::try_from(count).unwrap_or(usize::MAX).min(MAX_INITIAL_CAPACITY);
            values.reserve_exact(capacity.saturating_sub(values.len()));
        }
        for (early, memory) in self.early().zip(&mut memory.earlies) {
            early.reserve(memory, self.stop_tick, MAX_INITIAL_CAPACITY);
        }
    }

    /// Whether the memory, of whatever origin, can be that of these claims after so many samples: of the same shape, with
    /// nothing from the future.
    #[must_use]
    pub fn fits(&self, memory: &ClaimsMemory, samples: u64) -> bool {
        let Layout { decisions, temporals, windows, untils, histories, gates, earlies, .. } = &self.layout;
        let in_time = |decision: &Decision| decision.is_none_or(|value| value.tick < samples);
        let count = |horizon: &u64| samples.saturating_sub(*horizon);
        (memory.decisions.len(), memory.temporals.len()) == (*decisions, *temporals)
            && (memory.windows.len(), memory.histories.len()) == (windows.len(), histories.len())
            && (memory.untils.len(), memory.opened.len()) == (untils.len(), *gates)
            && memory.decisions.iter().all(in_time)
            && memory.temporals.iter().all(|joined| {
                in_time(&joined.counting()) && joined.first_failure.is_none_or(|(tick, _)| tick < samples)
            })
            && memory.windows.iter().zip(windows).all(|(window, width)| window.fits(*width, samples))
            && memory.untils.iter().zip(untils).all(|(until, to)| until.fits(*to, samples))
            && memory.histories.iter().map(|values| values.len() as u64).eq(histories.iter().map(count))
            && memory.histories.iter().flatten().all(in_time)
            && memory.lost.is_none_or(|claim| claim < self.formulas.len())
            && memory.earlies.len() == *earlies
            && self.early().zip(&memory.earlies).all(|(early, memory)| early.fits(memory, samples))
    }

    /// Those that know verdicts early, in the order of their memory.
    fn early(&self) -> impl Iterator<Item = &Early> {
        self.formulas.iter().filter_map(|claim| claim.early.as_ref()).map(|(early, _)| early)
    }
}
