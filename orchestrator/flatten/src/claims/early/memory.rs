//! What is known of the parts of a claim. A memory may come out of a damaged file, so nothing here trusts its numbers.

use super::Kind;
use serde::{Deserialize, Serialize};

/// What is known of a claim.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct EarlyMemory {
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
    marks: Vec<u64>,
    /// Of a window, by the ticks of its body: the length of a run of values that decide nothing, at both of its ends.
    runs: Vec<u64>,
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
        *count += 1;
        *count
    }

    /// The first tick that became known together with this one; `None` if this is not known.
    pub fn decided_from(&self, index: u64) -> Option<u64> {
        self.value(index)?;
        let mark = self.marks.get(usize::try_from(index).ok()?).copied().unwrap_or(0);
        Some(mark.checked_sub(1).unwrap_or(index))
    }

    /// Notes from where on ticks are known together with this one.
    pub fn note_decided(&mut self, index: u64, from: u64) {
        *at(&mut self.marks, index) = from + 1;
    }

    /// Adds a tick to the runs beside it; returns the first and the last tick of the run.
    pub fn join_run(&mut self, index: u64) -> (u64, u64) {
        let length = |index: Option<u64>| {
            let index = index.and_then(|index| usize::try_from(index).ok());
            index.and_then(|index| self.runs.get(index)).copied().unwrap_or(0)
        };
        let before = length(index.checked_sub(1)).min(index);
        let after = length(index.checked_add(1)).min(self.runs.len() as u64);
        let (first, last) = (index - before, index + after);
        *at(&mut self.runs, index) = 1;
        for end in [first, last] {
            *at(&mut self.runs, end) = last - first + 1;
        }
        (first, last)
    }

    pub fn reserve(&mut self, kind: &Kind, ticks: usize) {
        reserve(&mut self.known, ticks);
        if matches!(kind, Kind::Junction(..) | Kind::Window(..)) {
            reserve(&mut self.marks, ticks);
        }
        if matches!(kind, Kind::Window(..)) {
            reserve(&mut self.runs, ticks);
        }
    }

    pub fn fits(&self, samples: u64) -> bool {
        let lengths = [self.known.len(), self.marks.len(), self.runs.len()];
        lengths.iter().all(|length| *length as u64 <= samples)
    }
}

fn reserve<T>(values: &mut Vec<T>, count: usize) {
    values.reserve_exact(count.saturating_sub(values.len()));
}

/// The value at an index, up to which the list grows.
fn at<T: Clone + Default>(values: &mut Vec<T>, index: u64) -> &mut T {
    let index = usize::try_from(index).unwrap_or(usize::MAX);
    if index >= values.len() {
        values.resize(index + 1, T::default());
    }
    &mut values[index]
}
