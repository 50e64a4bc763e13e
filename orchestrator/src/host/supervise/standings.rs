//! How the claims of a run stand, read from the board.

use crate::run::run_spec::RunSpec;
use flatten::claims::info;
use results::verdict::{JudgedClaim, Standing, Verdict};
use unit::board::{Board, ClaimNote};

/// The claims that say something already, for the progress line. One that is open shows the margin so far.
pub(super) fn standing_claims(board: &Board, spec: &RunSpec) -> Vec<JudgedClaim> {
    let claims = spec.scenario.claims.iter().enumerate();
    let shown = claims.filter_map(|(i, claim)| {
        let standing = standing(&board.claim(i)?);
        let verdict = if standing.verdict == Verdict::Fails { Verdict::Fails } else { Verdict::Holds };
        Some(JudgedClaim::new(&info(claim), &Standing { verdict, ..standing }, spec.scenario.step_ns))
    });
    shown.collect()
}

/// How the first so many claims stand.
pub(crate) fn standings(board: &Board, claims: usize) -> Vec<Standing> {
    (0..claims).map(|i| board.claim(i).map_or(Standing::UNKNOWN, |note| standing(&note))).collect()
}

/// A claim's note; a number that is no verdict decides nothing.
fn standing(note: &ClaimNote) -> Standing {
    let verdict = Verdict::from_number(note.verdict).unwrap_or(Verdict::Undecided);
    let ClaimNote { margin, worst_tick, first_tick, part, .. } = *note;
    Standing { verdict, margin, worst_tick, first_tick, part }
}
