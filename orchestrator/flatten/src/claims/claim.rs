//! The value of a claim, which is the value of its formula at tick 0, as far as the samples so far determine it.

use super::Completeness;
use super::history::History;
use super::judged::{Decision, Join, Joined};
use super::memory::{ClaimsMemory, Layout};
use super::stream::{Atom, Sample, Stream, is_bounded};
use crate::expression::SlotOf;
use dsl::scenario::{Formula, TickWindow};
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

impl AtStart {
    /// Compiles the formula.
    pub(super) fn new(formula: &Formula, layout: &mut Layout, slot_of: &mut SlotOf<'_>) -> Self {
        let join = Join::of(formula);
        match formula {
            Formula::And(parts) | Formula::Or(parts) => {
                Self::Junction(join, parts.iter().map(|part| Self::new(part, layout, slot_of)).collect())
            }
            Formula::Margin(_) | Formula::Condition(_) => {
                Self::Atom(Atom::new(formula, slot_of), layout.decisions(1).start)
            }
            Formula::Always(window, body) | Formula::Eventually(window, body) if is_bounded(body) => {
                let body = Stream::new(body, layout, slot_of);
                Self::Temporal(Temporal { join, window: *window, body, index: layout.temporal() })
            }
            // No samples make a value of it before the run has ended.
            Formula::Always(..) | Formula::Eventually(..) => {
                Self::History(History::new(formula, layout, slot_of), layout.history(u64::MAX))
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
            Self::History(history, index) => {
                let values = history.values(memory, last_tick, completeness == Completeness::Complete);
                memory.histories[*index] = values;
            }
        }
    }

    /// Its standing; `ended` means that no more samples come.
    pub(super) fn standing(&self, memory: &ClaimsMemory, ended: bool) -> Standing {
        let decision = self.value(memory, Joined::decision);
        let verdict = match decision {
            Some(value) if value.holds() => Verdict::Holds,
            Some(_) => Verdict::Fails,
            None if ended => Verdict::Unjudged,
            None => Verdict::Undecided,
        };
        // The margin is that among the samples so far, whether the claim is decided or not.
        match decision.or_else(|| self.value(memory, |joined, _| joined.counting())) {
            Some(value) => Standing { verdict, margin: value.reported_margin(), worst_tick: value.tick },
            None => Standing { verdict, margin: f64::NAN, worst_tick: 0 },
        }
    }

    fn value(&self, memory: &ClaimsMemory, of: fn(&Joined, Join) -> Decision) -> Decision {
        match self {
            Self::Atom(_, index) => memory.decisions[*index],
            Self::Junction(join, parts) => {
                let mut joined = Joined::new(true);
                parts.iter().for_each(|part| _ = joined.take(*join, part.value(memory, of)));
                of(&joined, *join)
            }
            Self::Temporal(temporal) => of(&memory.temporals[temporal.index], temporal.join),
            Self::History(_, index) => memory.histories[*index].first().copied().flatten(),
        }
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
