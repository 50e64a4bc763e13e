//! The smallest or largest value in a window that slides over a stream.

use super::judged::{Decision, Join, Judged};
use super::memory::{Piece, Visit};
use std::collections::VecDeque;

/// A sliding window: a monotonic queue of the values that can still become its result.
#[derive(Debug)]
pub struct Window {
    join: Join,
    width: u64,
    candidates: VecDeque<(u64, Judged)>,
    /// The last tick whose value was not decided.
    last_open: Option<u64>,
}

impl Window {
    /// A window over this many consecutive ticks.
    #[must_use]
    pub fn new(join: Join, width: u64) -> Self {
        let capacity = usize::try_from(width).unwrap_or(usize::MAX);
        Self { join, width, candidates: VecDeque::with_capacity(capacity), last_open: None }
    }

    /// Moves the window to `tick`, takes its value and returns the value of the window that ends there.
    pub fn slide(&mut self, tick: u64, decision: Decision) -> Decision {
        let first = (tick + 1).saturating_sub(self.width);
        while self.candidates.front().is_some_and(|&(at, _)| at < first) {
            self.candidates.pop_front();
        }
        match decision {
            None => self.last_open = Some(tick),
            Some(value) => {
                while self.candidates.back().is_some_and(|&(_, earlier)| self.join.prefers(value, earlier)) {
                    self.candidates.pop_back();
                }
                self.candidates.push_back((tick, value));
            }
        }
        let open = self.last_open.is_some_and(|at| at >= first);
        let counts = self.candidates.front().map(|&(_, value)| value);
        counts.filter(|&value| !open || self.join.is_decided_by(value))
    }

    /// Visits its memory.
    pub(super) fn visit(&mut self, each: &mut Visit<'_>) {
        each(Piece::Candidates(&mut self.candidates, self.width));
        each(Piece::Tick(&mut self.last_open));
    }
}

#[test]
fn a_full_window_allocates_no_more_memory() {
    let mut window = Window::new(Join::All, 4);
    let capacity = window.candidates.capacity();
    for tick in 0..100_u32 {
        let smallest = window.slide(tick.into(), Some(Judged::margin(tick.into(), true, tick.into())));
        assert_eq!(smallest.map(|value| value.tick), Some(u64::from(tick.saturating_sub(3))));
    }
    assert_eq!(window.candidates.capacity(), capacity);
}
