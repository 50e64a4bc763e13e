//! What is known of the parts of a claim. A memory may come out of a damaged file, so nothing here trusts its numbers.

use serde::{Deserialize, Serialize};

/// What is known of a claim.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct EarlyMemory {
    /// Whether the claim holds, if that is known; the nodes are forgotten then.
    pub holds: Option<bool>,
    pub(super) nodes: Vec<NodeMemory>,
    /// What has become known and is to be passed on; empty between two samples.
    #[serde(skip)]
    pub(super) updates: Vec<Update>,
}

/// A value that has become known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Update {
    pub node: usize,
    pub tick: u64,
    pub holds: bool,
}

/// What is known of a part, by the ticks from the first one that counts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct NodeMemory {
    known: Vec<Option<bool>>,
    /// Of a junction: how many of its parts are known and decide nothing. Of a window: from where on it is known together
    /// with this tick, and one; 0 if that was not noted.
    marks: Vec<u32>,
    /// Of a window, by the ticks of its body: the length of a run of values that decide nothing, at both of its ends.
    runs: Vec<u32>,
}

impl NodeMemory {
    pub fn value(&self, index: u64) -> Option<bool> {
        self.known.get(usize::try_from(index).ok()?).copied().flatten()
    }

    /// Notes a value; returns whether it was not known.
    pub fn learn(&mut self, index: u64, holds: bool) -> bool {
        let is_new = self.value(index).is_none();
        if is_new {
            *at(&mut self.known, index) = Some(holds);
        }
        is_new
    }

    /// Counts one more part of a junction.
    pub fn count(&mut self, index: u64) -> u64 {
        let count = at(&mut self.marks, index);
        *count = count.saturating_add(1);
        u64::from(*count)
    }

    /// The first tick that became known together with this one; `None` if this is not known.
    pub fn decided_from(&self, index: u64) -> Option<u64> {
        self.value(index)?;
        let mark = self.marks.get(usize::try_from(index).ok()?).copied().unwrap_or(0);
        Some(mark.checked_sub(1).map_or(index, u64::from))
    }

    /// Notes from where on ticks are known together with this one; what is noted already may reach further.
    pub fn note_decided(&mut self, index: u64, from: u64) {
        let (mark, from) = (at(&mut self.marks, index), narrow(from).saturating_add(1));
        *mark = if *mark == 0 { from } else { from.min(*mark) };
    }

    /// Adds a tick to the runs beside it; returns the first and the last tick of the run.
    pub fn join_run(&mut self, index: u64) -> (u64, u64) {
        let length = |index: Option<u64>| {
            let index = index.and_then(|index| usize::try_from(index).ok());
            u64::from(index.and_then(|index| self.runs.get(index)).copied().unwrap_or(0))
        };
        let before = length(index.checked_sub(1)).min(index);
        let after = length(index.checked_add(1)).min(self.runs.len() as u64);
        let (first, last) = (index - before, index + after);
        *at(&mut self.runs, index) = 1;
        for end in [first, last] {
            *at(&mut self.runs, end) = narrow(last - first + 1);
        }
        (first, last)
    }

    pub fn reserve(&mut self, known: usize, marks: usize, runs: usize) {
        self.known.reserve_exact(known.saturating_sub(self.known.len()));
        self.marks.reserve_exact(marks.saturating_sub(self.marks.len()));
        self.runs.reserve_exact(runs.saturating_sub(self.runs.len()));
    }

    pub fn fits(&self, samples: u64) -> bool {
        let lengths = [self.known.len(), self.marks.len(), self.runs.len()];
        lengths.iter().all(|length| *length as u64 <= samples)
    }
}

/// A number of ticks; memory for more than these does not exist.
fn narrow(ticks: u64) -> u32 {
    u32::try_from(ticks).unwrap_or(u32::MAX)
}

/// The value at an index, up to which the list grows.
fn at<T: Clone + Default>(values: &mut Vec<T>, index: u64) -> &mut T {
    let index = usize::try_from(index).unwrap_or(usize::MAX);
    if index >= values.len() {
        values.resize(index + 1, T::default());
    }
    &mut values[index]
}
