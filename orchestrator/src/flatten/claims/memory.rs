//! The memory of claims between two samples: copied out for a checkpoint, put back when a run continues.
//!
//! One traversal of the formulas serves both directions, so that the two cannot disagree. The memory is a flat list,
//! however deep the formulas are, so that the bytes of a damaged checkpoint cannot cause deep recursion.

use super::Claims;
use super::judged::{Decision, Judged};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// One piece of a claim's memory, in place.
pub(super) enum Piece<'a> {
    /// A flag.
    Flag(&'a mut bool),
    /// A fixed number of values.
    Decisions(&'a mut [Decision]),
    /// A growing list of values, and the length that it must have now.
    Grown(&'a mut Vec<Decision>, u64),
    /// The values of a window that can still become its result, and their largest possible number.
    Candidates(&'a mut VecDeque<(u64, Judged)>, u64),
    /// A tick.
    Tick(&'a mut Option<u64>),
}

/// Called for each piece, in the order of the formulas.
pub(super) type Visit<'a> = dyn FnMut(Piece<'_>) + 'a;

/// A copy of a piece.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Saved {
    Flag(bool),
    Decisions(Vec<Decision>),
    Candidates(Vec<(u64, Judged)>),
    Tick(Option<u64>),
}

/// The memory of all claims of a script after a sample.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Memory {
    pieces: Vec<Saved>,
    lost: Option<usize>,
}

impl Saved {
    fn of(piece: Piece<'_>) -> Self {
        match piece {
            Piece::Flag(flag) => Self::Flag(*flag),
            Piece::Decisions(decisions) => Self::Decisions(decisions.to_vec()),
            Piece::Grown(decisions, _) => Self::Decisions(decisions.clone()),
            Piece::Candidates(candidates, _) => Self::Candidates(candidates.iter().copied().collect()),
            Piece::Tick(tick) => Self::Tick(*tick),
        }
    }

    /// Copies it back into a piece without allocating; false if it cannot be the state of this piece after so many
    /// samples.
    fn put_back(&self, piece: Piece<'_>, samples: u64) -> bool {
        let in_time = |decisions: &[Decision]| decisions.iter().flatten().all(|value| value.tick < samples);
        match (self, piece) {
            (Self::Flag(saved), Piece::Flag(flag)) => *flag = *saved,
            (Self::Decisions(saved), Piece::Decisions(decisions))
                if saved.len() == decisions.len() && in_time(saved) =>
            {
                decisions.copy_from_slice(saved);
            }
            (Self::Decisions(saved), Piece::Grown(decisions, count))
                if saved.len() as u64 == count && in_time(saved) =>
            {
                decisions.clear();
                decisions.extend_from_slice(saved);
            }
            (Self::Candidates(saved), Piece::Candidates(candidates, most))
                if saved.len() as u64 <= most
                    && saved.iter().all(|(at, value)| *at < samples && value.tick < samples) =>
            {
                candidates.clear();
                candidates.extend(saved);
            }
            (Self::Tick(saved), Piece::Tick(tick)) if saved.is_none_or(|saved| saved < samples) => *tick = *saved,
            _ => return false,
        }
        true
    }
}

impl Claims {
    /// Copies the memory of the claims. It changes nothing; `&mut` is due to the traversal shared with
    /// [`Claims::remember`].
    pub fn memory(&mut self) -> Memory {
        let mut pieces = Vec::new();
        self.visit(0, &mut |piece| pieces.push(Saved::of(piece)));
        Memory { pieces, lost: self.lost }
    }

    /// Restores the memory that these claims had after so many samples; returns false if it cannot be theirs, after which
    /// the claims must not be used.
    pub fn remember(&mut self, memory: &Memory, samples: u64) -> bool {
        let mut pieces = memory.pieces.iter();
        let mut fits = memory.lost.is_none_or(|claim| claim < self.monitors.len());
        self.visit(samples, &mut |piece| {
            fits = pieces.next().is_some_and(|saved| saved.put_back(piece, samples)) && fits;
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
