//! The value of a claim: of its formula at tick 0, with what is known of it at any time.

use super::Completeness;
use super::history::History;
use super::judged::{Decision, Join, Joined};
use super::memory::{Piece, Visit};
use super::stream::{Atom, Stream, is_bounded};
use crate::flatten::expression::{Moment, SlotOf};
use dsl::scenario::{Formula, TickWindow};
use results::verdict::{Standing, Verdict};

/// A formula whose value at tick 0 is asked for.
#[derive(Debug)]
pub enum AtStart {
    /// A comparison or a condition.
    Atom(Atom, Decision),
    /// `and`, `or`
    Junction(Join, Vec<AtStart>),
    /// `always`, `eventually` over a bounded formula.
    Word(Word),
    /// The same over a formula that reaches to the end of the run, and its value once the run has ended.
    History(History, Decision),
}

/// A temporal word that looks from tick 0: it needs no window that slides.
#[derive(Debug)]
pub struct Word {
    window: TickWindow,
    body: Stream,
    joined: Joined,
    complete: bool,
}

impl AtStart {
    /// Prepares for samples of ticks 0 to `stop_tick`.
    pub fn new(formula: &Formula, stop_tick: u64, slot_of: &mut SlotOf<'_>) -> Self {
        let mut parts = |parts: &[Formula]| parts.iter().map(|part| Self::new(part, stop_tick, slot_of)).collect();
        match formula {
            Formula::And(formulas) => Self::Junction(Join::All, parts(formulas)),
            Formula::Or(formulas) => Self::Junction(Join::Any, parts(formulas)),
            Formula::Margin(_) | Formula::Condition(_) => Self::Atom(Atom::new(formula, slot_of), None),
            Formula::Always(window, body) | Formula::Eventually(window, body) if is_bounded(body) => {
                let join = if matches!(formula, Formula::Always(..)) { Join::All } else { Join::Any };
                let body = Stream::new(body, slot_of);
                Self::Word(Word { window: *window, body, joined: Joined::new(join), complete: false })
            }
            Formula::Always(..) | Formula::Eventually(..) => {
                Self::History(History::new(formula, stop_tick, slot_of), None)
            }
        }
    }

    /// Takes the sample of a tick; returns whether what is known may have changed.
    pub fn take(&mut self, tick: u64, moment: &Moment<'_>) -> bool {
        match self {
            Self::Atom(atom, decision) if tick == 0 => {
                *decision = Some(atom.judge(tick, moment));
                true
            }
            Self::Atom(..) => false,
            Self::Junction(_, parts) => parts.iter_mut().fold(false, |changed, part| part.take(tick, moment) | changed),
            Self::Word(word) => !word.complete && word.take(tick, Some(moment)),
            Self::History(history, _) => {
                history.take(tick, Some(moment));
                false
            }
        }
    }

    /// Shows what it remembers after so many samples of a run that goes on.
    pub(super) fn visit(&mut self, samples: u64, each: &mut Visit<'_>) {
        match self {
            Self::Atom(_, decision) => each(Piece::Decisions(std::slice::from_mut(decision))),
            Self::Junction(_, parts) => parts.iter_mut().for_each(|part| part.visit(samples, each)),
            Self::Word(word) => {
                word.body.visit(each);
                word.joined.visit(each);
                each(Piece::Flag(&mut word.complete));
            }
            // Its decision is found when the run has ended.
            Self::History(history, _) => history.visit(samples, each),
        }
    }

    /// The last sample was that of `last_tick`.
    pub fn end(&mut self, last_tick: u64, completeness: Completeness) {
        match self {
            Self::Atom(..) => {}
            Self::Junction(_, parts) => parts.iter_mut().for_each(|part| part.end(last_tick, completeness)),
            Self::Word(word) => word.end(last_tick, completeness),
            Self::History(history, decision) => {
                *decision =
                    history.values(last_tick, completeness == Completeness::Complete).first().copied().flatten();
            }
        }
    }

    /// How it stands; `ended` tells that no more samples come.
    pub fn standing(&self, ended: bool) -> Standing {
        let decision = self.decision();
        let verdict = match decision {
            Some(value) if value.holds() => Verdict::Holds,
            Some(_) => Verdict::Fails,
            None if ended => Verdict::Unjudged,
            None => Verdict::Undecided,
        };
        match decision.or_else(|| self.so_far()) {
            Some(value) => Standing { verdict, margin: value.told(), worst_tick: value.tick },
            None => Standing { verdict, margin: f64::NAN, worst_tick: 0 },
        }
    }

    /// Its value, if the samples so far decide it.
    pub fn decision(&self) -> Decision {
        match self {
            Self::Atom(_, decision) | Self::History(_, decision) => *decision,
            Self::Junction(join, parts) => joined(*join, parts.iter().map(Self::decision)).decision(true),
            Self::Word(word) => word.joined.decision(word.complete),
        }
    }

    /// The value that counts among the samples so far, decided or not.
    fn so_far(&self) -> Decision {
        match self {
            Self::Atom(_, decision) | Self::History(_, decision) => *decision,
            Self::Junction(join, parts) => joined(*join, parts.iter().map(Self::so_far)).counting(),
            Self::Word(word) => word.joined.counting(),
        }
    }
}

impl Word {
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
            // The rest of the run is over, but a range without a tick stays open.
            self.complete = completeness == Completeness::Complete;
            return;
        }
        // A window that was cut short may be decided by what is known of its last ticks.
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
