//! Claims judged online: each takes one sample a tick and always knows how it stands.
//!
//! A claim is a `claim::AtStart` over `stream::Stream`s. All memory is there before the first sample, so that
//! taking one allocates nothing. Next on the walk: `trace/` and `report/`.

mod claim;
mod history;
mod judged;
mod memory;
mod stream;
#[cfg(test)]
mod tests;
mod window;

pub use memory::Memory;

use crate::expression::{Moment, Place};
use claim::AtStart;
use dsl::scenario::Claim;

/// How a claim stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Verdict {
    /// The samples so far do not decide it.
    Undecided = 0,
    /// It holds, whatever may come.
    Holds = 1,
    /// It fails, whatever may come.
    Fails = 2,
    /// The run ended before it was decided.
    Unjudged = 3,
}

impl Verdict {
    /// The verdict of a number, or `None` if no verdict has it.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        [Self::Undecided, Self::Holds, Self::Fails, Self::Unjudged].into_iter().find(|&verdict| verdict as u8 == number)
    }
}

/// A claim's verdict with the margin over the samples so far.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    /// The verdict.
    pub verdict: Verdict,
    /// The margin, SI; infinite for conditions, not-a-number while no sample counted.
    pub margin: f64,
    /// The tick of the sample that the margin comes from.
    pub worst_tick: u64,
}

impl PartialEq for Standing {
    fn eq(&self, other: &Self) -> bool {
        (self.verdict, self.margin.to_bits(), self.worst_tick)
            == (other.verdict, other.margin.to_bits(), other.worst_tick)
    }
}

/// How the samples of a run came to an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The run is complete, at its stop time or where a unit ended it: unbounded words range up to here.
    Complete,
    /// The run was cut off: what is not decided stays open.
    CutOff,
}

/// All claims of a script.
#[derive(Debug)]
pub struct Claims {
    monitors: Vec<Monitor>,
    lost: Option<usize>,
}

#[derive(Debug)]
struct Monitor {
    formula: AtStart,
    standing: Standing,
}

impl Claims {
    /// Prepares for samples of ticks 0 to `stop_tick`.
    pub fn new(claims: &[Claim], stop_tick: u64, place: &mut Place<'_>) -> Self {
        let monitor = |claim: &Claim| {
            let formula = AtStart::new(&claim.formula, stop_tick, place);
            let standing = formula.standing(false);
            Monitor { formula, standing }
        };
        Self { monitors: claims.iter().map(monitor).collect(), lost: None }
    }

    /// Takes the sample of a tick; ticks come without gaps from 0. Tells each claim whose standing changed.
    pub fn take(&mut self, tick: u64, moment: &Moment<'_>, mut changed: impl FnMut(usize, Standing)) {
        for (index, monitor) in self.monitors.iter_mut().enumerate() {
            if monitor.formula.take(tick, moment) {
                let standing = monitor.formula.standing(false);
                if standing != monitor.standing {
                    monitor.standing = standing;
                    changed(index, standing);
                    if standing.verdict == Verdict::Fails {
                        self.lost.get_or_insert(index);
                    }
                }
            }
        }
    }

    /// How each claim stands.
    pub fn standings(&self) -> impl Iterator<Item = (usize, Standing)> + '_ {
        self.monitors.iter().map(|monitor| monitor.standing).enumerate()
    }

    /// The claim that was lost first.
    #[must_use]
    pub fn lost(&self) -> Option<usize> {
        self.lost
    }

    /// Decides what the samples up to `last_tick` decide, or up to none; nothing of it is undecided afterwards.
    pub fn end(&mut self, last_tick: Option<u64>, ending: Ending, mut told: impl FnMut(usize, Standing)) {
        for (index, monitor) in self.monitors.iter_mut().enumerate() {
            if let Some(last_tick) = last_tick {
                monitor.formula.end(last_tick, ending);
            }
            monitor.standing = monitor.formula.standing(true);
            told(index, monitor.standing);
        }
    }
}
