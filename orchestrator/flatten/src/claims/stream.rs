//! The value of a bounded formula at each tick, computed as soon as the samples that it depends on are available.

use super::judged::{Decision, Join, Joined, Judged};
use super::memory::{ClaimsMemory, Layout};
use crate::expression::{Moment, Program, SlotOf, Stack};
use dsl::scenario::{Formula, Gated, TickWindow, Until};
use std::ops::Range;

/// How many ticks a formula looks ahead: 0 for a comparison; a bounded operator adds its upper bound, an unbounded one
/// the beginning of its window, behind which its range is not empty.
#[must_use]
pub fn horizon(formula: &Formula) -> u64 {
    match formula {
        Formula::Margin(_) | Formula::Condition(_) | Formula::Finally(_) => 0,
        Formula::And(parts) | Formula::Or(parts) => parts.iter().map(horizon).max().unwrap_or(0),
        Formula::Always(window, body) | Formula::Eventually(window, body) => least_ahead(*window) + horizon(body),
        Formula::Gated(Gated { gate, body, .. }) => horizon(gate).max(horizon(body)),
        Formula::Until(Until { window, gate, body, .. }) => least_ahead(*window) + horizon(gate).max(horizon(body)),
    }
}

/// How far a window reaches ahead at least.
fn least_ahead(window: TickWindow) -> u64 {
    window.to.unwrap_or(window.from)
}

/// Whether no temporal operator in it reaches to the end of the run.
#[must_use]
pub fn is_bounded(formula: &Formula) -> bool {
    match formula {
        Formula::Margin(_) | Formula::Condition(_) => true,
        Formula::Finally(_) => false,
        Formula::And(parts) | Formula::Or(parts) => parts.iter().all(is_bounded),
        Formula::Always(window, body) | Formula::Eventually(window, body) => window.to.is_some() && is_bounded(body),
        Formula::Gated(Gated { gate, body, .. }) => is_bounded(gate) && is_bounded(body),
        Formula::Until(Until { window, gate, body, .. }) => window.to.is_some() && is_bounded(gate) && is_bounded(body),
    }
}

/// The ticks at which the body of an operator with this window is asked for, if the operator is at those of `reach`.
#[must_use]
pub fn reach_of_body(reach: TickWindow, window: TickWindow) -> TickWindow {
    let to = reach.to.zip(window.to).map(|(reach, to)| reach.saturating_add(to));
    TickWindow { from: reach.from.saturating_add(window.from), to }
}

/// The same for the body of an `until`, which is asked for from its start on.
#[must_use]
pub fn reach_before(reach: TickWindow, window: TickWindow) -> TickWindow {
    reach_of_body(reach, TickWindow { from: 0, ..window })
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
    Junction(Join, Vec<Part>),
    /// The body with width and index of the window.
    Temporal(Join, Box<Stream>, u64, usize),
    Gated(Box<GatedParts>),
    /// The parts with both ends of the window and the index of its memory.
    Until(Box<GatedParts>, (u64, u64), usize),
}

/// A part of an operator, whose values meet those of other parts of the same tick.
#[derive(Debug)]
pub struct Part {
    stream: Stream,
    /// The place of its delay among the decisions.
    delay: Range<usize>,
}

/// The parts of `implies` or `until`.
#[derive(Debug)]
pub struct GatedParts {
    /// How gate and body are joined.
    pub join: Join,
    /// `φ`
    pub body: Part,
    /// `g`
    pub gate: Part,
    /// What is known of the gate.
    pub test: GateTest,
}

/// Where it is noted that a gate opened.
#[derive(Clone, Copy, Debug)]
pub struct GateTest {
    /// The index of the gate.
    index: usize,
    /// The ticks that count.
    reach: TickWindow,
}

impl GateTest {
    /// A gate that is asked for at these ticks.
    pub(super) fn new(reach: TickWindow, layout: &mut Layout) -> Self {
        Self { index: layout.gate(), reach }
    }

    /// Notes that the gate opened at a tick, if that is asked for.
    pub(super) fn opened(self, memory: &mut ClaimsMemory, at: u64) {
        if self.reach.from <= at && self.reach.to.is_none_or(|to| at <= to) {
            memory.opened[self.index] = true;
        }
    }

    /// Notes that a gate of `implies` has this value at a tick.
    pub(super) fn take(self, memory: &mut ClaimsMemory, join: Join, at: u64, gate: Decision) {
        if gate.is_some_and(|gate| !join.is_decided_by(gate)) {
            self.opened(memory, at);
        }
    }
}

impl Part {
    /// Compiles a part whose value is needed so many ticks late.
    pub(super) fn new(
        formula: &Formula,
        (horizon, reach): (u64, TickWindow),
        layout: &mut Layout,
        slot_of: &mut SlotOf<'_>,
    ) -> Self {
        let stream = Stream::new(formula, reach, layout, slot_of);
        let delay = layout.decisions(horizon - stream.horizon);
        Self { stream, delay }
    }

    /// As [`Stream::take`].
    pub(super) fn take(&self, memory: &mut ClaimsMemory, tick: u64, sample: Option<&mut Sample<'_>>) -> Decision {
        let decision = self.stream.take(memory, tick, sample);
        delayed(&mut memory.decisions[self.delay.clone()], tick, decision)
    }
}

/// The ticks at which gate and body of `implies` (without a window) or `until` are asked for.
pub(super) fn reaches(reach: TickWindow, window: Option<TickWindow>) -> [TickWindow; 2] {
    window.map_or([reach; 2], |window| [reach_of_body(reach, window), reach_before(reach, window)])
}

impl GatedParts {
    /// Compiles the parts of `implies` (without a window) or `until`.
    pub(super) fn new(
        (join, body, gate): (Join, &Formula, &Formula),
        (reach, window): (TickWindow, Option<TickWindow>),
        layout: &mut Layout,
        slot_of: &mut SlotOf<'_>,
    ) -> Self {
        let (horizon, [of_gate, of_body]) = (horizon(body).max(horizon(gate)), reaches(reach, window));
        let gate = Part::new(gate, (horizon, of_gate), layout, slot_of);
        let body = Part::new(body, (horizon, of_body), layout, slot_of);
        Self { join, body, gate, test: GateTest::new(reach, layout) }
    }

    /// The values of body and gate of one tick.
    pub(super) fn take(
        &self,
        memory: &mut ClaimsMemory,
        tick: u64,
        mut sample: Option<&mut Sample<'_>>,
    ) -> (Decision, Decision) {
        let gate = self.gate.take(memory, tick, sample.as_deref_mut());
        (self.body.take(memory, tick, sample), gate.map(Judged::as_gate))
    }

    /// The ticks after which both values of a tick are there.
    pub fn horizon(&self) -> u64 {
        self.body.stream.horizon.max(self.gate.stream.horizon)
    }
}

/// The value of `implies` from those of its parts.
pub fn gated(join: Join, (body, gate): (Decision, Decision)) -> Decision {
    let mut joined = Joined::new(true);
    joined.take(join, body);
    joined.take(join, gate);
    joined.decision(join)
}

impl Stream {
    /// Compiles the formula, whose values are asked for at the ticks of `reach`.
    pub(super) fn new(formula: &Formula, reach: TickWindow, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> Self {
        let (horizon, join) = (horizon(formula), Join::of(formula));
        let node = match formula {
            Formula::Margin(_) | Formula::Condition(_) => Node::Atom(Atom::new(formula, layout, slot_of)),
            Formula::And(parts) | Formula::Or(parts) => {
                let part = |part| Part::new(part, (horizon, reach), layout, slot_of);
                Node::Junction(join, parts.iter().map(part).collect())
            }
            Formula::Always(window, body) | Formula::Eventually(window, body) => {
                let width = (last_of(*window) + 1).saturating_sub(window.from);
                let body = Self::new(body, reach_of_body(reach, *window), layout, slot_of);
                Node::Temporal(join, Box::new(body), width, layout.window(width))
            }
            Formula::Gated(Gated { gate, body, .. }) => {
                Node::Gated(Box::new(GatedParts::new((join, body, gate), (reach, None), layout, slot_of)))
            }
            Formula::Until(Until { window, gate, body, .. }) => {
                let parts = GatedParts::new((join, body, gate), (reach, Some(*window)), layout, slot_of);
                let to = last_of(*window);
                Node::Until(Box::new(parts), (window.from, to), layout.until(to))
            }
            Formula::Finally(_) => unreachable!("`finally` reaches to the end of the run"),
        };
        Self { horizon, node }
    }

    /// Takes the sample of `tick`, or `None` after the last, and returns the value at `tick - horizon`.
    pub(super) fn take(&self, memory: &mut ClaimsMemory, tick: u64, mut sample: Option<&mut Sample<'_>>) -> Decision {
        match &self.node {
            Node::Atom(atom) => sample.map(|sample| atom.judge(tick, sample)),
            Node::Junction(join, parts) => {
                let mut joined = Joined::new(true);
                for part in parts {
                    joined.take(*join, part.take(memory, tick, sample.as_deref_mut()));
                }
                joined.decision(*join)
            }
            Node::Temporal(join, body, width, window) => {
                let decision = body.take(memory, tick, sample);
                let at = tick.checked_sub(body.horizon)?;
                memory.windows[*window].slide(*join, *width, at, decision)
            }
            Node::Gated(parts) => {
                let taken = parts.take(memory, tick, sample);
                parts.test.take(memory, parts.join, tick.checked_sub(self.horizon)?, taken.1);
                gated(parts.join, taken)
            }
            Node::Until(parts, window, until) => {
                let taken = parts.take(memory, tick, sample);
                let at = tick.checked_sub(parts.horizon())?;
                let (decision, at_once) = memory.untils[*until].take(parts.join, *window, at, taken)?;
                if !at_once {
                    parts.test.opened(memory, at - window.1);
                }
                decision
            }
        }
    }
}

fn last_of(window: TickWindow) -> u64 {
    window.to.unwrap_or_else(|| unreachable!("an unbounded word in a bounded formula"))
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
    /// Its number in the claim.
    part: u32,
}

impl Atom {
    /// Compiles an atom.
    pub(super) fn new(formula: &Formula, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> Self {
        let (program, strict) = match formula {
            Formula::Margin(margin) => (Program::compile_real(&margin.value, slot_of), Some(margin.strict)),
            Formula::Condition(condition) => (Program::compile_condition(condition, slot_of), None),
            _ => unreachable!("{formula:?} is no atom"),
        };
        Self { program, strict, part: layout.part() }
    }

    /// Its value at the tick of the sample.
    pub fn judge(&self, tick: u64, sample: &mut Sample<'_>) -> Judged {
        let judged = match self.strict {
            Some(strict) => Judged::margin(self.program.real(sample.moment, sample.stack), strict, tick),
            None => Judged::condition(self.program.holds(sample.moment, sample.stack), tick),
        };
        judged.of(self.part)
    }
}
