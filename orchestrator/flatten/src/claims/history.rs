//! Formulas in which a temporal operator that reaches to the end of the run is nested in another: judged when it has ended.
//!
//! Such an operator has one value for each tick, and the last sample can change all of them. So the values of its bounded
//! parts are stored, in memory allocated before the first sample, and joined afterwards in one pass for each operator.

use super::judged::{Decision, Join, Joined};
use super::memory::{ClaimsMemory, Layout};
use super::stream::{Sample, Stream, horizon, is_bounded};
use super::window::Window;
use crate::expression::SlotOf;
use dsl::scenario::{Formula, TickWindow};

/// A formula of which the values of its bounded parts are stored.
#[derive(Debug)]
pub enum History {
    /// A bounded part, with the index of its history.
    Bounded(Stream, usize),
    /// `and`, `or`
    Junction(Join, Vec<History>),
    /// `always`, `eventually`, with the body's horizon.
    Temporal(Join, TickWindow, u64, Box<History>),
}

impl History {
    /// Compiles the formula.
    pub(super) fn new(formula: &Formula, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> Self {
        if is_bounded(formula) {
            return Self::Bounded(Stream::new(formula, layout, slot_of), layout.history(horizon(formula)));
        }
        let join = Join::of(formula);
        match formula {
            Formula::And(parts) | Formula::Or(parts) => {
                Self::Junction(join, parts.iter().map(|part| Self::new(part, layout, slot_of)).collect())
            }
            Formula::Always(window, body) | Formula::Eventually(window, body) => {
                Self::Temporal(join, *window, horizon(body), Box::new(Self::new(body, layout, slot_of)))
            }
            Formula::Margin(_) | Formula::Condition(_) => unreachable!("an atom is bounded"),
        }
    }

    /// Takes the sample of a tick.
    pub(super) fn take(&self, memory: &mut ClaimsMemory, tick: u64, sample: &mut Sample<'_>) {
        match self {
            Self::Bounded(stream, history) => {
                let decision = stream.take(memory, tick, Some(sample));
                if tick >= stream.horizon {
                    memory.histories[*history].push(decision);
                }
            }
            Self::Junction(_, parts) => parts.iter().for_each(|part| part.take(memory, tick, sample)),
            Self::Temporal(_, _, _, body) => body.take(memory, tick, sample),
        }
    }

    /// The values at ticks 0 to `last`, the tick of the last sample.
    pub(super) fn values(&self, memory: &mut ClaimsMemory, last: u64, complete: bool) -> Vec<Decision> {
        match self {
            Self::Bounded(stream, history) => {
                let mut values = std::mem::take(&mut memory.histories[*history]);
                let late = (last + 1..=last + stream.horizon).map(|tick| (tick, stream.take(memory, tick, None)));
                values.extend(late.filter(|(tick, _)| *tick >= stream.horizon).map(|(_, decision)| decision));
                values
            }
            Self::Junction(join, parts) => {
                let parts: Vec<_> = parts.iter().map(|part| part.values(memory, last, complete)).collect();
                let at = |tick: usize| {
                    let mut joined = Joined::new(true);
                    parts.iter().for_each(|part| _ = joined.take(*join, part[tick]));
                    joined.decision(*join)
                };
                (0..parts[0].len()).map(at).collect()
            }
            Self::Temporal(join, window, horizon, body) => {
                let body = body.values(memory, last, complete);
                match window.to {
                    Some(to) => bounded(*join, window.from, to, &body),
                    None => unbounded(*join, window.from, *horizon, &body, complete),
                }
            }
        }
    }
}

/// The values of a bounded operator; the values of its body after the last tick are not decided.
fn bounded(join: Join, from: u64, to: u64, body: &[Decision]) -> Vec<Decision> {
    let width = (to + 1).saturating_sub(from);
    let mut window = Window::default();
    window.reserve(width);
    let open = std::iter::repeat_n(&None, usize::try_from(to).unwrap_or(usize::MAX));
    let ends = (0..).zip(body.iter().chain(open)).map(|(tick, decision)| window.slide(join, width, tick, *decision));
    ends.skip(usize::try_from(to).unwrap_or(usize::MAX)).collect()
}

/// The values of an unbounded operator: each ranges over the rest of the run, as far as the body could be judged.
fn unbounded(join: Join, from: u64, horizon: u64, body: &[Decision], complete: bool) -> Vec<Decision> {
    let [from, horizon] = [from, horizon].map(|ticks| usize::try_from(ticks).unwrap_or(usize::MAX));
    let judgeable = body.len().saturating_sub(horizon);
    let mut values = vec![None; body.len()];
    let mut joined = Joined::new(complete);
    for first in (from..judgeable).rev() {
        joined.take_earlier(join, body[first]);
        values[first - from] = joined.decision(join);
    }
    values
}
