//! The value of a claim, which is the value of its formula at tick 0, as far as the samples so far determine it.

use super::Completeness;
use super::history::{ALL_TICKS, History};
use super::judged::{Decision, Join, Joined, Judged};
use super::memory::{ClaimsMemory, Layout};
use super::stream::{Atom, GateTest, GatedParts, Sample, Stream, is_bounded, reach_of_body};
use crate::expression::SlotOf;
use dsl::scenario::{Formula, Gated, TickWindow, Until};
use results::verdict::{Standing, Verdict};

/// A formula that is evaluated at tick 0 only.
#[derive(Debug)]
pub enum AtStart {
    /// A comparison or a condition, with the index of its decision.
    Atom(Atom, usize),
    /// `and`, `or`
    Junction(Join, Vec<AtStart>),
    /// `always`, `eventually` with a bounded formula as body.
    Temporal(Temporal),
    /// `implies`: how its parts are joined, `φ`, the gate, and what is known of it.
    Gated(Join, Box<(AtStart, AtStart)>, GateTest),
    /// `until` with bounded formulas.
    Until(Box<UntilAtStart>),
    /// `finally`, with the indices of its value at the last sample and of whether that is final.
    Finally(Stream, usize, usize),
    /// The same with a body that reaches to the end of the run, and the index of the history that has its values when the
    /// run has ended.
    History(History, usize),
}

/// A temporal operator that is evaluated at tick 0 only, so it needs no sliding window.
#[derive(Debug)]
pub struct Temporal {
    join: Join,
    window: TickWindow,
    body: Stream,
    /// The index of its joined value.
    index: usize,
}

/// An `until` that is evaluated at tick 0 only.
#[derive(Debug)]
pub struct UntilAtStart {
    window: TickWindow,
    parts: GatedParts,
    /// The index of the joined value of φ so far.
    before: usize,
    /// The index of the joined value of the whole.
    whole: usize,
}

/// Which value of a claim is asked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Asked {
    /// The value that no later sample changes from holding to failing or back.
    Decided,
    /// The value of the samples so far.
    SoFar,
}

impl Asked {
    fn of(self, joined: &Joined, join: Join) -> Decision {
        if self == Self::Decided { joined.decision(join) } else { joined.counting() }
    }
}

const AT_START: TickWindow = TickWindow { from: 0, to: Some(0) };

impl AtStart {
    /// Compiles the formula.
    pub(super) fn new(formula: &Formula, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> Self {
        let join = Join::of(formula);
        match formula {
            Formula::And(parts) | Formula::Or(parts) => {
                Self::Junction(join, parts.iter().map(|part| Self::new(part, layout, slot_of)).collect())
            }
            Formula::Margin(_) | Formula::Condition(_) => {
                Self::Atom(Atom::new(formula, layout, slot_of), layout.decisions(1).start)
            }
            Formula::Always(window, body) | Formula::Eventually(window, body) if is_bounded(body) => {
                let body = Stream::new(body, reach_of_body(AT_START, *window), layout, slot_of);
                Self::Temporal(Temporal { join, window: *window, body, index: layout.temporal() })
            }
            Formula::Gated(Gated { gate, body, .. }) => {
                let gate = Self::new(gate, layout, slot_of);
                let body = Self::new(body, layout, slot_of);
                Self::Gated(join, Box::new((body, gate)), GateTest::new(AT_START, layout))
            }
            Formula::Until(Until { window, gate, body, .. }) if is_bounded(body) && is_bounded(gate) => {
                let parts = GatedParts::new((join, body, gate), (AT_START, Some(*window)), layout, slot_of);
                let (before, whole) = (layout.temporal(), layout.temporal());
                Self::Until(Box::new(UntilAtStart { window: *window, parts, before, whole }))
            }
            Formula::Finally(body) => {
                let body = Stream::new(body, ALL_TICKS, layout, slot_of);
                Self::Finally(body, layout.decisions(1).start, layout.temporal())
            }
            // No samples make a value of it before the run has ended.
            Formula::Always(..) | Formula::Eventually(..) | Formula::Until(_) => {
                Self::History(History::new(formula, AT_START, layout, slot_of), layout.history(u64::MAX))
            }
        }
    }

    /// Takes the sample of a tick; returns whether the standing may have changed.
    pub(super) fn take(&self, memory: &mut ClaimsMemory, tick: u64, sample: &mut Sample<'_>) -> bool {
        match self {
            Self::Atom(atom, index) if tick == 0 => {
                memory.decisions[*index] = Some(atom.judge(tick, sample));
                true
            }
            Self::Atom(..) => false,
            Self::Junction(_, parts) => {
                parts.iter().fold(false, |changed, part| part.take(memory, tick, sample) | changed)
            }
            Self::Temporal(temporal) => temporal.take(memory, tick, Some(sample)),
            Self::Gated(_, parts, _) => {
                let (body, gate) = &**parts;
                gate.take(memory, tick, sample) | body.take(memory, tick, sample)
            }
            Self::Until(until) => until.take(memory, tick, Some(sample)),
            Self::Finally(body, index, _) => {
                memory.decisions[*index] = body.take(memory, tick, Some(sample));
                true
            }
            Self::History(history, _) => {
                history.take(memory, tick, sample);
                false
            }
        }
    }

    /// Completes the value; the last sample was that of `last_tick`.
    pub(super) fn end(&self, memory: &mut ClaimsMemory, last_tick: u64, completeness: Completeness) {
        match self {
            Self::Atom(..) => {}
            Self::Junction(_, parts) => parts.iter().for_each(|part| part.end(memory, last_tick, completeness)),
            Self::Temporal(temporal) => temporal.end(memory, last_tick, completeness),
            Self::Gated(join, parts, test) => {
                let (body, gate) = &**parts;
                gate.end(memory, last_tick, completeness);
                body.end(memory, last_tick, completeness);
                let gate = gate.value(memory, Asked::Decided);
                test.take(memory, *join, 0, gate);
            }
            Self::Until(until) => until.end(memory, last_tick, completeness),
            Self::Finally(_, _, index) => memory.temporals[*index].complete = completeness == Completeness::Complete,
            Self::History(history, index) => {
                let values = history.values(memory, last_tick, completeness == Completeness::Complete);
                memory.histories[*index] = values;
            }
        }
    }

    /// Its standing; `ended` means that no more samples come.
    pub(super) fn standing(&self, memory: &ClaimsMemory, ended: bool) -> Standing {
        let decision = self.value(memory, Asked::Decided);
        let verdict = match decision {
            Some(value) if value.holds() => Verdict::Holds,
            Some(_) => Verdict::Fails,
            None if ended => Verdict::Unjudged,
            None => Verdict::Undecided,
        };
        // The margin is that among the samples so far, whether the claim is decided or not.
        match decision.or_else(|| self.value(memory, Asked::SoFar)) {
            Some(value) => Standing {
                verdict,
                margin: value.reported_margin(),
                worst_tick: value.tick,
                first_tick: self.first_failure(memory, value.part).unwrap_or(value.tick),
                part: value.part,
            },
            None => Standing { verdict, ..Standing::UNKNOWN },
        }
    }

    fn value(&self, memory: &ClaimsMemory, asked: Asked) -> Decision {
        match self {
            Self::Atom(_, index) => memory.decisions[*index],
            Self::Junction(join, parts) => {
                let mut joined = Joined::new(true);
                parts.iter().for_each(|part| _ = joined.take(*join, part.value(memory, asked)));
                asked.of(&joined, *join)
            }
            Self::Temporal(temporal) => asked.of(&memory.temporals[temporal.index], temporal.join),
            Self::Gated(join, parts, _) => {
                let mut joined = Joined::new(true);
                joined.take(*join, parts.0.value(memory, asked));
                joined.take(*join, parts.1.value(memory, Asked::Decided).map(Judged::as_gate));
                asked.of(&joined, *join)
            }
            Self::Until(until) => until.value(memory, asked),
            Self::Finally(_, index, is_final) => {
                memory.decisions[*index].filter(|_| asked == Asked::SoFar || memory.temporals[*is_final].complete)
            }
            Self::History(_, index) => memory.histories[*index].first().copied().flatten(),
        }
    }

    /// The tick of the first sample that fails what must hold throughout, if it was this part of the claim that failed.
    fn first_failure(&self, memory: &ClaimsMemory, part: u32) -> Option<u64> {
        let first = match self {
            Self::Junction(Join::All, parts) => {
                return parts.iter().filter_map(|each| each.first_failure(memory, part)).min();
            }
            Self::Gated(_, parts, _) => return parts.0.first_failure(memory, part),
            Self::Temporal(Temporal { join: Join::All, index, .. }) => memory.temporals[*index].first_failure,
            Self::Until(until) if until.parts.join == Join::Any => memory.temporals[until.before].first_failure,
            _ => None,
        };
        first.filter(|(_, failed)| *failed == part).map(|(tick, _)| tick)
    }
}

impl UntilAtStart {
    fn take(&self, memory: &mut ClaimsMemory, tick: u64, sample: Option<&mut Sample<'_>>) -> bool {
        if memory.temporals[self.whole].complete {
            return false;
        }
        let (body, gate) = self.parts.take(memory, tick, sample);
        let Some(at) = tick.checked_sub(self.parts.horizon()) else { return false };
        let join = self.parts.join;
        let comes = at >= self.window.from && gate.is_some_and(|gate| join.is_decided_by(gate));
        if at == 0 && !comes {
            self.parts.test.opened(memory, at);
        }
        if at >= self.window.from {
            // What the whole is if this is the tick of g.
            let mut ended = memory.temporals[self.before].completed();
            ended.take(join.opposite(), gate);
            let ended = ended.decision(join.opposite());
            let whole = &mut memory.temporals[self.whole];
            whole.take(join, ended);
            whole.complete = self.window.to.is_some_and(|to| at >= to) || comes && ended.is_some() && !whole.is_open();
        }
        memory.temporals[self.before].take(join.opposite(), body);
        true
    }

    fn end(&self, memory: &mut ClaimsMemory, last_tick: u64, completeness: Completeness) {
        if self.window.to.is_none() {
            memory.temporals[self.whole].complete |= completeness == Completeness::Complete;
            return;
        }
        for tick in last_tick + 1..=last_tick + self.parts.horizon() {
            self.take(memory, tick, None);
        }
    }

    fn value(&self, memory: &ClaimsMemory, asked: Asked) -> Decision {
        let (whole, before) = (&memory.temporals[self.whole], &memory.temporals[self.before]);
        let is_over = whole.complete && whole.counting().is_some();
        let join = self.parts.join;
        let decided = whole.decision(join);
        // As long as g has not come, a failed φ decides; whenever it comes, the value is that of φ so far at best.
        let failed = || {
            let failed = before.decision(join.opposite()).filter(|_| !is_over && !whole.is_open())?;
            Some(whole.counting().filter(|&earlier| join.prefers(earlier, failed)).unwrap_or(failed))
        };
        decided.or_else(failed).or_else(|| before.counting().filter(|_| asked == Asked::SoFar))
    }
}

impl Temporal {
    fn take(&self, memory: &mut ClaimsMemory, tick: u64, sample: Option<&mut Sample<'_>>) -> bool {
        if memory.temporals[self.index].complete {
            return false;
        }
        let decision = self.body.take(memory, tick, sample);
        let Some(at) = tick.checked_sub(self.body.horizon).filter(|&at| at >= self.window.from) else { return false };
        let joined = &mut memory.temporals[self.index];
        joined.complete = self.window.to.is_some_and(|to| at >= to);
        joined.take(self.join, decision) | joined.complete
    }

    fn end(&self, memory: &mut ClaimsMemory, last_tick: u64, completeness: Completeness) {
        if self.window.to.is_none() {
            // No more ticks follow; an operator whose range has no tick has no value and stays open all the same.
            memory.temporals[self.index].complete = completeness == Completeness::Complete;
            return;
        }
        // The values of the last ticks depend on samples that are missing; those that are known all the same may decide.
        for tick in last_tick + 1..=last_tick + self.body.horizon {
            self.take(memory, tick, None);
        }
    }
}
