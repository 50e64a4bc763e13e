//! The smallest or largest value in a window that slides over a stream.

use super::judged::{Decision, Join, Judged};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// The memory of a sliding window: a monotonic queue of the values that can still become its result.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Window {
    candidates: VecDeque<(u64, Judged)>,
    /// The last tick whose value was not decided.
    last_open: Option<u64>,
}

impl Window {
    /// Allocates memory for a window over this many consecutive ticks.
    pub fn reserve(&mut self, width: u64) {
        let capacity = usize::try_from(width).unwrap_or(usize::MAX);
        self.candidates.reserve_exact(capacity.saturating_sub(self.candidates.len()));
    }

    /// Moves the window of this width to `tick`, takes its value and returns the value of the window that ends there.
    pub fn slide(&mut self, join: Join, width: u64, tick: u64, decision: Decision) -> Decision {
        let first = (tick + 1).saturating_sub(width);
        self.drop_before(first);
        self.push(join, tick, decision);
        self.value(join, first)
    }

    /// Removes the values of ticks before `first`.
    pub fn drop_before(&mut self, first: u64) {
        while self.candidates.front().is_some_and(|&(at, _)| at < first) {
            self.candidates.pop_front();
        }
    }

    /// Takes the value of a tick later than all others.
    pub fn push(&mut self, join: Join, tick: u64, decision: Decision) {
        let Some(value) = decision else { return self.last_open = Some(tick) };
        while self.candidates.back().is_some_and(|&(_, earlier)| join.prefers(value, earlier)) {
            self.candidates.pop_back();
        }
        self.candidates.push_back((tick, value));
    }

    /// The joined value from the tick `first` on, before which values were removed; that of nothing is none.
    pub fn value(&self, join: Join, first: u64) -> Decision {
        self.counting().filter(|&value| !self.is_open_since(first) || join.is_decided_by(value))
    }

    /// The joined value of those that are decided.
    pub fn counting(&self) -> Decision {
        self.candidates.front().map(|&(_, value)| value)
    }

    /// Whether a value from this tick on is not decided.
    pub fn is_open_since(&self, first: u64) -> bool {
        self.last_open.is_some_and(|at| at >= first)
    }

    /// Whether it can be that of a window of this width after so many samples.
    pub fn fits(&self, width: u64, samples: u64) -> bool {
        self.candidates.len() as u64 <= width
            && self.candidates.iter().all(|(at, value)| *at < samples && value.tick < samples)
            && self.last_open.is_none_or(|at| at < samples)
    }
}

#[test]
fn a_full_window_allocates_no_more_memory() {
    let mut window = Window::default();
    window.reserve(4);
    let capacity = window.candidates.capacity();
    for tick in 0..100_u32 {
        let smallest = window.slide(Join::All, 4, tick.into(), Some(Judged::margin(tick.into(), true, tick.into())));
        assert_eq!(smallest.map(|value| value.tick), Some(u64::from(tick.saturating_sub(3))));
    }
    assert_eq!(window.candidates.capacity(), capacity);
}
