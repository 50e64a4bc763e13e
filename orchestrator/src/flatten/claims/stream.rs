//! The value of a bounded formula at each tick, computed as soon as the samples that it depends on are available.

use super::judged::{Decision, Join, Joined, Judged};
use super::memory::{Piece, Visit};
use super::window::Window;
use crate::flatten::expression::{Moment, Program, SlotOf, Stack};
use dsl::scenario::Formula;

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
    Junction { join: Join, parts: Vec<(Stream, Delay)> },
    Temporal { body: Box<Stream>, window: Window },
}

impl Stream {
    /// Compiles the formula and allocates its memory.
    pub fn new(formula: &Formula, slot_of: &mut SlotOf<'_>) -> Self {
        let horizon = horizon(formula);
        let node = match formula {
            Formula::Margin(_) | Formula::Condition(_) => Node::Atom(Atom::new(formula, slot_of)),
            Formula::And(parts) => Node::junction(Join::All, parts, horizon, slot_of),
            Formula::Or(parts) => Node::junction(Join::Any, parts, horizon, slot_of),
            Formula::Always(window, body) | Formula::Eventually(window, body) => {
                let join = if matches!(formula, Formula::Always(..)) { Join::All } else { Join::Any };
                let to = window.to.unwrap_or_else(|| unreachable!("an unbounded word in a bounded formula"));
                let window = Window::new(join, (to + 1).saturating_sub(window.from));
                Node::Temporal { body: Box::new(Self::new(body, slot_of)), window }
            }
        };
        Self { horizon, node }
    }

    /// Takes the sample of `tick`, or `None` after the last, and returns the value at `tick - horizon`.
    pub fn take(&mut self, tick: u64, sample: Option<&Moment<'_>>) -> Decision {
        match &mut self.node {
            Node::Atom(atom) => sample.map(|moment| atom.judge(tick, moment)),
            Node::Junction { join, parts } => {
                let mut joined = Joined::new(*join);
                for (part, delay) in parts {
                    let decision = part.take(tick, sample);
                    joined.take(delay.pass(tick, decision));
                }
                joined.decision(true)
            }
            Node::Temporal { body, window } => {
                let decision = body.take(tick, sample);
                tick.checked_sub(body.horizon).and_then(|at| window.slide(at, decision))
            }
        }
    }

    /// Visits its memory.
    pub(super) fn visit(&mut self, each: &mut Visit<'_>) {
        match &mut self.node {
            Node::Atom(_) => {}
            Node::Junction { parts, .. } => {
                for (part, delay) in parts {
                    part.visit(each);
                    each(Piece::Decisions(&mut delay.0));
                }
            }
            Node::Temporal { body, window } => {
                body.visit(each);
                window.visit(each);
            }
        }
    }
}

impl Node {
    fn junction(join: Join, parts: &[Formula], horizon: u64, slot_of: &mut SlotOf<'_>) -> Self {
        let part = |part| {
            let stream = Stream::new(part, slot_of);
            let delay = Delay::new(horizon - stream.horizon);
            (stream, delay)
        };
        Self::Junction { join, parts: parts.iter().map(part).collect() }
    }
}

/// A comparison or a condition.
#[derive(Debug)]
pub struct Atom {
    program: Program,
    /// For a comparison, whether a margin of zero fails; `None` for a condition.
    strict: Option<bool>,
    stack: Stack,
}

impl Atom {
    /// Compiles an atom.
    pub fn new(formula: &Formula, slot_of: &mut SlotOf<'_>) -> Self {
        match formula {
            Formula::Margin(margin) => {
                let program = Program::compile_real(&margin.value, slot_of);
                Self { program, strict: Some(margin.strict), stack: Stack::default() }
            }
            Formula::Condition(condition) => {
                let program = Program::compile_condition(condition, slot_of);
                Self { program, strict: None, stack: Stack::default() }
            }
            _ => unreachable!("{formula:?} is no atom"),
        }
    }

    /// Its value at the tick of the sample.
    pub fn judge(&mut self, tick: u64, moment: &Moment<'_>) -> Judged {
        match self.strict {
            Some(strict) => Judged::margin(self.program.real(moment, &mut self.stack), strict, tick),
            None => Judged::condition(self.program.holds(moment, &mut self.stack), tick),
        }
    }
}

/// Delays values by some ticks, so that the parts of a junction with different horizons meet at the same tick.
#[derive(Debug)]
struct Delay(Vec<Decision>);

impl Delay {
    fn new(ticks: u64) -> Self {
        Self(vec![None; usize::try_from(ticks).unwrap_or(usize::MAX)])
    }

    fn pass(&mut self, tick: u64, decision: Decision) -> Decision {
        let length = self.0.len() as u64;
        match tick.checked_rem(length).and_then(|slot| self.0.get_mut(usize::try_from(slot).ok()?)) {
            Some(held) => std::mem::replace(held, decision),
            None => decision,
        }
    }
}
