//! The value of a claim, which is the value of its formula at tick 0, as far as the samples so far determine it.

use super::Completeness;
use super::history::History;
use super::judged::{Decision, Join, Joined};
use super::memory::{Piece, Visit};
use super::stream::{Atom, Stream, is_bounded};
use crate::flatten::expression::{Moment, SlotOf};
use dsl::scenario::{Formula, TickWindow};
use results::verdict::{Standing, Verdict};

/// A formula that is evaluated at tick 0 only.
#[derive(Debug)]
pub enum AtStart {
    /// A comparison or a condition.
    Atom(Atom, Decision),
    /// `and`, `or`
    Junction(Join, Vec<AtStart>),
    /// `always`, `eventually` with a bounded formula as body.
    Temporal(Temporal),
    /// The same with a body that reaches to the end of the run, and its value once the run has ended.
    History(History, Decision),
}

/// A temporal operator that is evaluated at tick 0 only, so it needs no sliding window.
#[derive(Debug)]
pub struct Temporal {
    window: TickWindow,
    body: Stream,
    joined: Joined,
    complete: bool,
}

impl AtStart {
    /// Compiles the formula and allocates memory for the samples of ticks 0 to `stop_tick`.
    pub fn new(formula: &Formula, stop_tick: u64, slot_of: &mut SlotOf<'_>) -> Self {
        let mut parts = |parts: &[Formula]| parts.iter().map(|part| Self::new(part, stop_tick, slot_of)).collect();
        match formula {
            Formula::And(formulas) => Self::Junction(Join::All, parts(formulas)),
            Formula::Or(formulas) => Self::Junction(Join::Any, parts(formulas)),
            Formula::Margin(_) | Formula::Condition(_) => Self::Atom(Atom::new(formula, slot_of), None),
            Formula::Always(window, body) | Formula::Eventually(window, body) if is_bounded(body) => {
                let join = if matches!(formula, Formula::Always(..)) { Join::All } else { Join::Any };
                let body = Stream::new(body, slot_of);
                Self::Temporal(Temporal { window: *window, body, joined: Joined::new(join), complete: false })
            }
            Formula::Always(..) | Formula::Eventually(..) => {
                Self::History(History::new(formula, stop_tick, slot_of), None)
            }
        }
    }

    /// Takes the sample of a tick; returns whether the standing may have changed.
    pub fn take(&mut self, tick: u64, moment: &Moment<'_>) -> bool {
        match self {
            Self::Atom(atom, decision) if tick == 0 => {
                *decision = Some(atom.judge(tick, moment));
                true
            }
            Self::Atom(..) => false,
            Self::Junction(_, parts) => parts.iter_mut().fold(false, |changed, part| part.take(tick, moment) | changed),
            Self::Temporal(temporal) => !temporal.complete && temporal.take(tick, Some(moment)),
            Self::History(history, _) => {
                history.take(tick, Some(moment));
                false
            }
        }
    }

    /// Visits its memory after so many samples of a run that goes on.
    pub(super) fn visit(&mut self, samples: u64, each: &mut Visit<'_>) {
        match self {
            Self::Atom(_, decision) => each(Piece::Decisions(std::slice::from_mut(decision))),
            Self::Junction(_, parts) => parts.iter_mut().for_each(|part| part.visit(samples, each)),
            Self::Temporal(temporal) => {
                temporal.body.visit(each);
                temporal.joined.visit(each);
                each(Piece::Flag(&mut temporal.complete));
            }
            // Its decision is not part of the memory: it is computed when the run has ended.
            Self::History(history, _) => history.visit(samples, each),
        }
    }

    /// Completes the value; the last sample was that of `last_tick`.
    pub fn end(&mut self, last_tick: u64, completeness: Completeness) {
        match self {
            Self::Atom(..) => {}
            Self::Junction(_, parts) => parts.iter_mut().for_each(|part| part.end(last_tick, completeness)),
            Self::Temporal(temporal) => temporal.end(last_tick, completeness),
            Self::History(history, decision) => {
                *decision =
                    history.values(last_tick, completeness == Completeness::Complete).first().copied().flatten();
            }
        }
    }

    /// Its standing; `ended` means that no more samples come.
    pub fn standing(&self, ended: bool) -> Standing {
        let decision = self.decision();
        let verdict = match decision {
            Some(value) if value.holds() => Verdict::Holds,
            Some(_) => Verdict::Fails,
            None if ended => Verdict::Unjudged,
            None => Verdict::Undecided,
        };
        match decision.or_else(|| self.so_far()) {
            Some(value) => Standing { verdict, margin: value.reported_margin(), worst_tick: value.tick },
            None => Standing { verdict, margin: f64::NAN, worst_tick: 0 },
        }
    }

    /// Its value, if the samples so far determine it.
    pub fn decision(&self) -> Decision {
        match self {
            Self::Atom(_, decision) | Self::History(_, decision) => *decision,
            Self::Junction(join, parts) => joined(*join, parts.iter().map(Self::decision)).decision(true),
            Self::Temporal(temporal) => temporal.joined.decision(temporal.complete),
        }
    }

    /// The value that determines the margin among the samples so far, whether the claim is decided or not.
    fn so_far(&self) -> Decision {
        match self {
            Self::Atom(_, decision) | Self::History(_, decision) => *decision,
            Self::Junction(join, parts) => joined(*join, parts.iter().map(Self::so_far)).counting(),
            Self::Temporal(temporal) => temporal.joined.counting(),
        }
    }
}

impl Temporal {
    fn take(&mut self, tick: u64, sample: Option<&Moment<'_>>) -> bool {
        let decision = self.body.take(tick, sample);
        let Some(at) = tick.checked_sub(self.body.horizon) else { return false };
        if at < self.window.from {
            return false;
        }
        self.complete = self.window.to.is_some_and(|to| at >= to);
        self.joined.take(decision) | self.complete
    }

    fn end(&mut self, last_tick: u64, completeness: Completeness) {
        if self.window.to.is_none() {
            // No more ticks follow; an operator whose range has no tick has no value and stays open all the same.
            self.complete = completeness == Completeness::Complete;
            return;
        }
        // The values of the last ticks depend on samples that are missing; those that are known all the same may decide.
        for tick in last_tick + 1..=last_tick + self.body.horizon {
            if !self.complete {
                self.take(tick, None);
            }
        }
    }
}

fn joined(join: Join, decisions: impl Iterator<Item = Decision>) -> Joined {
    let mut joined = Joined::new(join);
    for decision in decisions {
        joined.take(decision);
    }
    joined
}
