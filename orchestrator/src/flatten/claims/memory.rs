//! What claims remember between two samples: taken out for a checkpoint, put back when a run continues.
//!
//! One walk over the formulas serves both ways, so that what is kept and what is put back cannot differ. What is kept is a
//! flat list, however deep the formulas: a checkpoint's bytes decide no depth of recursion.

use super::Claims;
use super::judged::{Decision, Judged};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// One thing that a claim remembers, where it stands.
pub(super) enum Piece<'a> {
    /// Something that is so or not.
    Flag(&'a mut bool),
    /// Values whose number stays the same.
    Decisions(&'a mut [Decision]),
    /// Values whose number has grown to this.
    Grown(&'a mut Vec<Decision>, u64),
    /// The values of a window that can still count, this many at most.
    Candidates(&'a mut VecDeque<(u64, Judged)>, u64),
    /// A tick.
    Tick(&'a mut Option<u64>),
}

/// Sees each piece, in the order of the formulas.
pub(super) type Visit<'a> = dyn FnMut(Piece<'_>) + 'a;

/// A piece by itself.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Kept {
    Flag(bool),
    Decisions(Vec<Decision>),
    Candidates(Vec<(u64, Judged)>),
    Tick(Option<u64>),
}

/// All that the claims of a script remember after a sample.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Memory {
    pieces: Vec<Kept>,
    lost: Option<usize>,
}

impl Kept {
    fn of(piece: Piece<'_>) -> Self {
        match piece {
            Piece::Flag(flag) => Self::Flag(*flag),
            Piece::Decisions(decisions) => Self::Decisions(decisions.to_vec()),
            Piece::Grown(decisions, _) => Self::Decisions(decisions.clone()),
            Piece::Candidates(candidates, _) => Self::Candidates(candidates.iter().copied().collect()),
            Piece::Tick(tick) => Self::Tick(*tick),
        }
    }

    /// Puts it back, within the memory that is there; false if it is none of this slot_of after so many samples.
    fn put_back(&self, piece: Piece<'_>, samples: u64) -> bool {
        let in_time = |decisions: &[Decision]| decisions.iter().flatten().all(|value| value.tick < samples);
        match (self, piece) {
            (Self::Flag(kept), Piece::Flag(flag)) => *flag = *kept,
            (Self::Decisions(kept), Piece::Decisions(decisions)) if kept.len() == decisions.len() && in_time(kept) => {
                decisions.copy_from_slice(kept);
            }
            (Self::Decisions(kept), Piece::Grown(decisions, count)) if kept.len() as u64 == count && in_time(kept) => {
                decisions.clear();
                decisions.extend_from_slice(kept);
            }
            (Self::Candidates(kept), Piece::Candidates(candidates, most))
                if kept.len() as u64 <= most
                    && kept.iter().all(|(at, value)| *at < samples && value.tick < samples) =>
            {
                candidates.clear();
                candidates.extend(kept);
            }
            (Self::Tick(kept), Piece::Tick(tick)) if kept.is_none_or(|kept| kept < samples) => *tick = *kept,
            _ => return false,
        }
        true
    }
}

impl Claims {
    /// What the claims remember. It is not changed: the walk is that of [`Claims::remember`].
    pub fn memory(&mut self) -> Memory {
        let mut pieces = Vec::new();
        self.visit(0, &mut |piece| pieces.push(Kept::of(piece)));
        Memory { pieces, lost: self.lost }
    }

    /// Goes on from what these claims remembered after so many samples; false, and of no more use, if they did not.
    pub fn remember(&mut self, memory: &Memory, samples: u64) -> bool {
        let mut pieces = memory.pieces.iter();
        let mut fits = memory.lost.is_none_or(|claim| claim < self.monitors.len());
        self.visit(samples, &mut |piece| {
            fits = pieces.next().is_some_and(|kept| kept.put_back(piece, samples)) && fits;
        });
        self.lost = memory.lost;
        for monitor in &mut self.monitors {
            monitor.standing = monitor.formula.standing(false);
        }
        fits && pieces.next().is_none()
    }

    fn visit(&mut self, samples: u64, each: &mut Visit<'_>) {
        self.monitors.iter_mut().for_each(|monitor| monitor.formula.visit(samples, each));
    }
}
