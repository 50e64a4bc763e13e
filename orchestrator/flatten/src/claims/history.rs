//! Formulas in which a temporal operator that reaches to the end of the run is nested in another: their margins, which are
//! known when it has ended.
//!
//! Such an operator has one value for each tick, and the last sample can change all of them. So the values of its bounded
//! parts are stored, in memory allocated before the first sample, and joined afterwards in one pass for each operator.

use super::judged::{Decision, Join, Joined, Judged};
use super::memory::{ClaimsMemory, Layout};
use super::stream::{GateTest, Sample, Stream, gated, horizon, is_bounded, reach_of_body, reaches};
use super::until::UntilMemory;
use super::window::Window;
use crate::expression::SlotOf;
use dsl::scenario::{Formula, Gated, TickWindow, Until};

/// Every tick of a run.
pub(super) const ALL_TICKS: TickWindow = TickWindow { from: 0, to: None };

/// A formula of which the values of its bounded parts are stored.
#[derive(Debug)]
pub enum History {
    /// A bounded part, with the index of its history.
    Bounded(Stream, usize),
    /// `and`, `or`
    Junction(Join, Vec<History>),
    /// `always`, `eventually`, with the body's horizon.
    Temporal(Join, TickWindow, u64, Box<History>),
    /// `implies`, with its horizon.
    Gated(Box<GatedHistory>),
    /// `until`, with its window and the horizon of its parts.
    Until(TickWindow, Box<GatedHistory>),
    /// `finally`, with the index of its value at the last sample.
    Finally(Stream, usize),
}

/// The parts of `implies` or `until`.
#[derive(Debug)]
pub struct GatedHistory {
    join: Join,
    horizon: u64,
    body: History,
    gate: History,
    test: GateTest,
}

impl GatedHistory {
    fn new(
        (join, body, gate): (Join, &Formula, &Formula),
        (reach, window): (TickWindow, Option<TickWindow>),
        layout: &mut Layout,
        slot_of: &mut SlotOf<'_>,
    ) -> Self {
        let (horizon, [of_gate, of_body]) = (horizon(body).max(horizon(gate)), reaches(reach, window));
        let gate = History::new(gate, of_gate, layout, slot_of);
        let body = History::new(body, of_body, layout, slot_of);
        Self { join, horizon, body, gate, test: GateTest::new(reach, layout) }
    }

    fn values(&self, memory: &mut ClaimsMemory, last: u64, complete: bool) -> (Vec<Decision>, Vec<Decision>) {
        let gate = self.gate.values(memory, last, complete);
        let gate = gate.into_iter().map(|decision| decision.map(Judged::as_gate)).collect();
        (self.body.values(memory, last, complete), gate)
    }

    fn implies(&self, memory: &mut ClaimsMemory, last: u64, complete: bool) -> Vec<Decision> {
        let (body, gate) = self.values(memory, last, complete);
        for (at, &gate) in (0..=last.saturating_sub(self.horizon)).zip(&gate) {
            self.test.take(memory, self.join, at, gate);
        }
        body.into_iter().zip(gate).map(|parts| gated(self.join, parts)).collect()
    }

    fn until(&self, window: TickWindow, memory: &mut ClaimsMemory, last: u64, complete: bool) -> Vec<Decision> {
        let (body, gate) = self.values(memory, last, complete);
        let comes_at_once = |gate: Decision| window.from == 0 && gate.is_some_and(|gate| self.join.is_decided_by(gate));
        for (at, &gate) in (0..=last.saturating_sub(self.horizon)).zip(&gate) {
            if !comes_at_once(gate) {
                self.test.opened(memory, at);
            }
        }
        match window.to {
            Some(to) => bounded_until(self.join, (window.from, to), &body, &gate),
            None => unbounded_until(self.join, window.from, self.horizon, (&body, &gate), complete),
        }
    }
}

impl History {
    /// Compiles the formula, whose values are asked for at the ticks of `reach`.
    pub(super) fn new(formula: &Formula, reach: TickWindow, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> Self {
        if is_bounded(formula) {
            let stream = Stream::new(formula, reach, layout, slot_of);
            return Self::Bounded(stream, layout.history(horizon(formula)));
        }
        let join = Join::of(formula);
        match formula {
            Formula::And(parts) | Formula::Or(parts) => {
                Self::Junction(join, parts.iter().map(|part| Self::new(part, reach, layout, slot_of)).collect())
            }
            Formula::Always(window, body) | Formula::Eventually(window, body) => {
                let inner = Self::new(body, reach_of_body(reach, *window), layout, slot_of);
                Self::Temporal(join, *window, horizon(body), Box::new(inner))
            }
            Formula::Gated(Gated { gate, body, .. }) => {
                Self::Gated(Box::new(GatedHistory::new((join, body, gate), (reach, None), layout, slot_of)))
            }
            Formula::Until(Until { window, gate, body, .. }) => {
                let parts = GatedHistory::new((join, body, gate), (reach, Some(*window)), layout, slot_of);
                Self::Until(*window, Box::new(parts))
            }
            Formula::Finally(body) => {
                Self::Finally(Stream::new(body, ALL_TICKS, layout, slot_of), layout.decisions(1).start)
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
            Self::Gated(parts) | Self::Until(_, parts) => {
                parts.gate.take(memory, tick, sample);
                parts.body.take(memory, tick, sample);
            }
            Self::Finally(stream, index) => memory.decisions[*index] = stream.take(memory, tick, Some(sample)),
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
            Self::Gated(parts) => parts.implies(memory, last, complete),
            Self::Until(window, parts) => parts.until(*window, memory, last, complete),
            Self::Finally(_, index) => {
                let value = memory.decisions[*index].filter(|_| complete);
                vec![value; usize::try_from(last + 1).unwrap_or(usize::MAX)]
            }
        }
    }
}

/// The values of a bounded `until`; those of its parts after the last tick are not decided.
fn bounded_until(join: Join, window: (u64, u64), body: &[Decision], gate: &[Decision]) -> Vec<Decision> {
    let mut until = UntilMemory::default();
    until.reserve(window.1);
    let parts = body.iter().copied().zip(gate.iter().copied());
    let open = std::iter::repeat_n((None, None), usize::try_from(window.1).unwrap_or(usize::MAX));
    let starts = (0..).zip(parts.chain(open)).filter_map(|(at, parts)| until.take(join, window, at, parts));
    starts.map(|(decision, _)| decision).collect()
}

/// The values of an unbounded `until`, from the last to the first: at a tick, g or else φ and the value at the next tick.
fn unbounded_until(
    join: Join,
    from: u64,
    horizon: u64,
    (body, gate): (&[Decision], &[Decision]),
    complete: bool,
) -> Vec<Decision> {
    let [from, horizon] = [from, horizon].map(|ticks| usize::try_from(ticks).unwrap_or(usize::MAX));
    let judgeable = body.len().saturating_sub(horizon);
    // Where it begins at once: no g came in what is left of the run.
    let mut at_once = vec![None; judgeable + 1];
    at_once[judgeable] = complete.then(|| join.of_nothing(judgeable.saturating_sub(1) as u64));
    for tick in (0..judgeable).rev() {
        let rest = gated(join.opposite(), (body[tick], at_once[tick + 1]));
        at_once[tick] = gated(join, (rest, gate[tick]));
    }
    // Before the window begins, φ counts alone.
    let mut before = Window::default();
    before.reserve(from as u64);
    let mut values = vec![None; body.len()];
    for tick in (0..body.len()).rev() {
        // The window slides backwards, so its ticks are counted from the end.
        let turned = (body.len() - 1 - tick) as u64;
        let known = if tick < judgeable { body[tick] } else { None };
        let whole = before.slide(join.opposite(), from as u64, turned, known);
        let begins = tick.saturating_add(from);
        let rest = if begins < judgeable { at_once[begins] } else { None };
        values[tick] = if from == 0 { rest } else { gated(join.opposite(), (whole, rest)) };
    }
    values
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
