//! The value of a bounded formula at each tick, computed as soon as the samples that it depends on are available.

use super::judged::{Decision, Join, Joined, Judged};
use super::memory::{ClaimsMemory, Layout};
use crate::expression::{Moment, Program, SlotOf, Stack};
use dsl::scenario::Formula;
use std::ops::Range;

/// How many ticks a formula looks ahead: 0 for a comparison; a bounded operator adds its upper bound, an unbounded one
/// nothing.
#[must_use]
pub fn horizon(formula: &Formula) -> u64 {
    match formula {
        Formula::Margin(_) | Formula::Condition(_) => 0,
        Formula::And(parts) | Formula::Or(parts) => parts.iter().map(horizon).max().unwrap_or(0),
        Formula::Always(window, body) | Formula::Eventually(window, body) => window.to.unwrap_or(0) + horizon(body),
    }
}

/// Whether no temporal operator in it reaches to the end of the run.
#[must_use]
pub fn is_bounded(formula: &Formula) -> bool {
    match formula {
        Formula::Margin(_) | Formula::Condition(_) => true,
        Formula::And(parts) | Formula::Or(parts) => parts.iter().all(is_bounded),
        Formula::Always(window, body) | Formula::Eventually(window, body) => window.to.is_some() && is_bounded(body),
    }
}

/// What claims take at a tick.
#[derive(Debug)]
pub struct Sample<'a> {
    /// What programs read.
    pub moment: &'a Moment<'a>,
    /// What they compute with.
    pub stack: &'a mut Stack,
}

/// A bounded formula that converts samples to values, each `horizon` ticks late.
#[derive(Debug)]
pub struct Stream {
    /// The delay of a value after the tick that it belongs to, in ticks.
    pub horizon: u64,
    node: Node,
}

#[derive(Debug)]
enum Node {
    Atom(Atom),
    /// Each part with the place of its delay among the decisions.
    Junction(Join, Vec<(Stream, Range<usize>)>),
    /// The body with width and index of the window.
    Temporal(Join, Box<Stream>, u64, usize),
}

impl Stream {
    /// Compiles the formula.
    pub(super) fn new(formula: &Formula, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> Self {
        let (horizon, join) = (horizon(formula), Join::of(formula));
        let node = match formula {
            Formula::Margin(_) | Formula::Condition(_) => Node::Atom(Atom::new(formula, slot_of)),
            Formula::And(parts) | Formula::Or(parts) => {
                // The parts of a junction with different horizons meet at the same tick.
                let part = |part| {
                    let stream = Self::new(part, layout, slot_of);
                    let delay = layout.decisions(horizon - stream.horizon);
                    (stream, delay)
                };
                Node::Junction(join, parts.iter().map(part).collect())
            }
            Formula::Always(window, body) | Formula::Eventually(window, body) => {
                let to = window.to.unwrap_or_else(|| unreachable!("an unbounded word in a bounded formula"));
                let width = (to + 1).saturating_sub(window.from);
                Node::Temporal(join, Box::new(Self::new(body, layout, slot_of)), width, layout.window(width))
            }
        };
        Self { horizon, node }
    }

    /// Takes the sample of `tick`, or `None` after the last, and returns the value at `tick - horizon`.
    pub(super) fn take(&self, memory: &mut ClaimsMemory, tick: u64, mut sample: Option<&mut Sample<'_>>) -> Decision {
        match &self.node {
            Node::Atom(atom) => sample.map(|sample| atom.judge(tick, sample)),
            Node::Junction(join, parts) => {
                let mut joined = Joined::new(true);
                for (part, delay) in parts {
                    let decision = part.take(memory, tick, sample.as_deref_mut());
                    joined.take(*join, delayed(&mut memory.decisions[delay.clone()], tick, decision));
                }
                joined.decision(*join)
            }
            Node::Temporal(join, body, width, window) => {
                let decision = body.take(memory, tick, sample);
                let at = tick.checked_sub(body.horizon)?;
                memory.windows[*window].slide(*join, *width, at, decision)
            }
        }
    }
}

/// Stores a value and returns the one that was stored as many ticks ago as the delay is long.
fn delayed(delay: &mut [Decision], tick: u64, decision: Decision) -> Decision {
    let slot = tick.checked_rem(delay.len() as u64).and_then(|slot| delay.get_mut(usize::try_from(slot).ok()?));
    slot.map_or(decision, |held| std::mem::replace(held, decision))
}

/// A comparison or a condition.
#[derive(Debug)]
pub struct Atom {
    program: Program,
    /// For a comparison, whether a margin of zero fails; `None` for a condition.
    strict: Option<bool>,
}

impl Atom {
    /// Compiles an atom.
    pub fn new(formula: &Formula, slot_of: &mut SlotOf<'_>) -> Self {
        match formula {
            Formula::Margin(margin) => {
                Self { program: Program::compile_real(&margin.value, slot_of), strict: Some(margin.strict) }
            }
            Formula::Condition(condition) => {
                Self { program: Program::compile_condition(condition, slot_of), strict: None }
            }
            _ => unreachable!("{formula:?} is no atom"),
        }
    }

    /// Its value at the tick of the sample.
    pub fn judge(&self, tick: u64, sample: &mut Sample<'_>) -> Judged {
        match self.strict {
            Some(strict) => Judged::margin(self.program.real(sample.moment, sample.stack), strict, tick),
            None => Judged::condition(self.program.holds(sample.moment, sample.stack), tick),
        }
    }
}
