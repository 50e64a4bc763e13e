//! The value of `φ until g` in a bounded window at each tick.
//!
//! At a start t it is that of φ from t to the tick before the first g in the window: both ends move forward only, so the
//! values of φ between them are a sliding window.

use super::judged::{Decision, Join, Joined, Judged};
use super::window::Window;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// The memory of an `until` with a bounded window.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct UntilMemory {
    /// The values of φ that are in no window yet, of the ticks from `next` on.
    waiting: VecDeque<Decision>,
    next: u64,
    /// Those between the current start and the current end.
    window: Window,
    /// The ticks at which g is not known to be false.
    gates: VecDeque<(u64, Decision)>,
}

/// The value at a start, and whether g came at once.
pub type Started = (Decision, bool);

impl UntilMemory {
    /// Allocates memory for a window that ends `to` ticks after its start.
    pub fn reserve(&mut self, to: u64) {
        let width = to.saturating_add(1);
        self.window.reserve(width);
        let capacity = usize::try_from(width).unwrap_or(usize::MAX);
        self.waiting.reserve_exact(capacity.saturating_sub(self.waiting.len()));
        self.gates.reserve_exact(capacity.saturating_sub(self.gates.len()));
    }

    /// Takes the values of φ and g at tick `at`, without gaps from 0; returns the value at the start `at - to`, if there is one.
    pub fn take(
        &mut self,
        join: Join,
        (from, to): (u64, u64),
        at: u64,
        (body, gate): (Decision, Decision),
    ) -> Option<Started> {
        let start = at.checked_sub(to);
        // What is before the start, or was in a window already, is not needed any more.
        while self.next < start.unwrap_or(0) && self.waiting.pop_front().is_some() {
            self.next += 1;
        }
        let oldest_gate = start.unwrap_or(0) + from;
        while self.gates.front().is_some_and(|&(tick, _)| tick < oldest_gate) {
            self.gates.pop_front();
        }
        self.waiting.push_back(body);
        if gate.is_none_or(|gate| join.is_decided_by(gate)) && at >= oldest_gate {
            self.gates.push_back((at, gate));
        }
        start.map(|start| self.value(join, start, from))
    }

    fn value(&mut self, join: Join, start: u64, from: u64) -> Started {
        let Some(&(first, gate)) = self.gates.front() else {
            return (Some(join.of_nothing(start + from)), false);
        };
        while self.next < first {
            let body = self.waiting.pop_front().flatten();
            self.window.push(join.opposite(), self.next, body);
            self.next += 1;
        }
        self.window.drop_before(start);
        let before = if first > start {
            self.window.value(join.opposite(), start)
        } else {
            Some(join.opposite().of_nothing(start))
        };
        match gate {
            Some(gate) if first == start => (Some(gate), true),
            Some(_) => (before, false),
            None => (before.filter(|&value| !holds(join, value)).or_else(|| self.later(join, start)), false),
        }
    }

    /// The value by a g that comes for certain, after one that is not decided.
    fn later(&self, join: Join, start: u64) -> Decision {
        let &(end, _) = self.gates.iter().find(|(_, gate)| gate.is_some())?;
        let mut joined = Joined::new(true);
        if self.window.is_open_since(start) {
            joined.take(join.opposite(), None);
        }
        if let Some(value) = self.window.counting() {
            joined.take(join.opposite(), Some(value));
        }
        let count = usize::try_from(end.saturating_sub(self.next)).unwrap_or(usize::MAX);
        self.waiting.iter().take(count).for_each(|&value| _ = joined.take(join.opposite(), value));
        joined.decision(join.opposite()).filter(|&value| holds(join, value))
    }

    /// Whether it can be that of a window that ends `to` ticks after its start, after so many samples.
    pub fn fits(&self, to: u64, samples: u64) -> bool {
        let in_time = |decision: &Decision| decision.is_none_or(|value| value.tick < samples);
        self.waiting.len() as u64 <= to.saturating_add(1)
            && self.next <= samples
            && self.waiting.len() as u64 <= samples - self.next
            && self.waiting.iter().all(in_time)
            && self.window.fits(to.saturating_add(1), samples)
            && self.gates.len() as u64 <= to.saturating_add(1)
            && self.gates.iter().all(|(at, gate)| *at < samples && in_time(gate))
            && self.gates.iter().zip(self.gates.iter().skip(1)).all(|(one, next)| one.0 < next.0)
    }
}

/// Whether the value decides the `until` as one that g ended.
fn holds(join: Join, value: Judged) -> bool {
    join.is_decided_by(value)
}
