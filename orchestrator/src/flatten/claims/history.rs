//! Formulas in which a temporal operator that reaches to the end of the run is nested in another: judged when it has ended.
//!
//! Such an operator has one value for each tick, and the last sample can change all of them. So the values of its bounded
//! parts are stored, in memory allocated before the first sample, and joined afterwards in one pass for each operator.

use super::judged::{Decision, Join, Joined};
use super::memory::{Piece, Visit};
use super::stream::{Stream, horizon, is_bounded};
use super::window::Window;
use crate::flatten::expression::{Moment, SlotOf};
use dsl::scenario::{Formula, TickWindow};

/// The most values that memory is allocated for in advance. A longer run grows its memory during the run: few runs with
/// such a stop time are meant to reach it.
const MAX_INITIAL_CAPACITY: usize = 10_000_000;

/// A formula with the values of its bounded parts so far.
#[derive(Debug)]
pub enum History {
    /// A bounded part.
    Bounded(Stream, Vec<Decision>),
    /// `and`, `or`
    Junction(Join, Vec<History>),
    /// `always`, `eventually`, with the body's horizon.
    Temporal(Join, TickWindow, u64, Box<History>),
}

impl History {
    /// Compiles the formula and allocates memory for the samples of ticks 0 to `stop_tick`.
    pub fn new(formula: &Formula, stop_tick: u64, slot_of: &mut SlotOf<'_>) -> Self {
        if is_bounded(formula) {
            let ticks = usize::try_from(stop_tick.saturating_add(1)).unwrap_or(usize::MAX);
            let values = Vec::with_capacity(ticks.min(MAX_INITIAL_CAPACITY));
            return Self::Bounded(Stream::new(formula, slot_of), values);
        }
        match formula {
            Formula::And(parts) | Formula::Or(parts) => {
                let join = if matches!(formula, Formula::And(_)) { Join::All } else { Join::Any };
                Self::Junction(join, parts.iter().map(|part| Self::new(part, stop_tick, slot_of)).collect())
            }
            Formula::Always(window, body) | Formula::Eventually(window, body) => {
                let join = if matches!(formula, Formula::Always(..)) { Join::All } else { Join::Any };
                Self::Temporal(join, *window, horizon(body), Box::new(Self::new(body, stop_tick, slot_of)))
            }
            Formula::Margin(_) | Formula::Condition(_) => unreachable!("an atom is bounded"),
        }
    }

    /// Takes the sample of a tick, or `None` after the last.
    pub fn take(&mut self, tick: u64, sample: Option<&Moment<'_>>) {
        match self {
            Self::Bounded(stream, values) => {
                let decision = stream.take(tick, sample);
                if tick >= stream.horizon {
                    values.push(decision);
                }
            }
            Self::Junction(_, parts) => parts.iter_mut().for_each(|part| part.take(tick, sample)),
            Self::Temporal(_, _, _, body) => body.take(tick, sample),
        }
    }

    /// Visits its memory after so many samples.
    pub(super) fn visit(&mut self, samples: u64, each: &mut Visit<'_>) {
        match self {
            Self::Bounded(stream, values) => {
                stream.visit(each);
                each(Piece::Grown(values, samples.saturating_sub(stream.horizon)));
            }
            Self::Junction(_, parts) => parts.iter_mut().for_each(|part| part.visit(samples, each)),
            Self::Temporal(_, _, _, body) => body.visit(samples, each),
        }
    }

    /// The values at ticks 0 to `last`, the tick of the last sample.
    pub fn values(&mut self, last: u64, complete: bool) -> Vec<Decision> {
        match self {
            Self::Bounded(stream, values) => {
                for tick in last + 1..=last + stream.horizon {
                    let decision = stream.take(tick, None);
                    if tick >= stream.horizon {
                        values.push(decision);
                    }
                }
                std::mem::take(values)
            }
            Self::Junction(join, parts) => {
                let parts: Vec<_> = parts.iter_mut().map(|part| part.values(last, complete)).collect();
                let at = |tick: usize| {
                    let mut joined = Joined::new(*join);
                    for part in &parts {
                        joined.take(part[tick]);
                    }
                    joined.decision(true)
                };
                (0..parts[0].len()).map(at).collect()
            }
            Self::Temporal(join, window, horizon, body) => {
                let body = body.values(last, complete);
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
    let mut window = Window::new(join, (to + 1).saturating_sub(from));
    let open = std::iter::repeat_n(&None, usize::try_from(to).unwrap_or(usize::MAX));
    let ends = (0..).zip(body.iter().chain(open)).map(|(tick, decision)| window.slide(tick, *decision));
    ends.skip(usize::try_from(to).unwrap_or(usize::MAX)).collect()
}

/// The values of an unbounded operator: each ranges over the rest of the run, as far as the body could be judged.
fn unbounded(join: Join, from: u64, horizon: u64, body: &[Decision], complete: bool) -> Vec<Decision> {
    let [from, horizon] = [from, horizon].map(|ticks| usize::try_from(ticks).unwrap_or(usize::MAX));
    let judgeable = body.len().saturating_sub(horizon);
    let mut values = vec![None; body.len()];
    let mut joined = Joined::new(join);
    for first in (from..judgeable).rev() {
        joined.take_earlier(body[first]);
        values[first - from] = joined.decision(complete);
    }
    values
}
