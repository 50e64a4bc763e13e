//! The exit codes of a run, which scripts and CI systems rely on, and how a run comes to its own.

use crate::find::preparation::{OTHER_TMPDIR, Refusal};
use crate::host::execution::{ReadyRun, RunOutcome, carry_out};
use crate::host::supervise::{StartWorkers, SuperviseError};
use crate::run::interruption;
use results::TraceError;
use results::report;
use results::report::console::Style;
use results::verdict::Count;
use std::io;

/// All claims hold, or there are none.
const OK: u8 = 0;
/// A claim failed.
pub(super) const FAILED: u8 = 1;
/// The script or the command line is wrong: anything before the first unit is instantiated.
pub(super) const USAGE: u8 = 2;
/// The run broke: anything from there on.
pub(super) const BROKEN: u8 = interruption::BROKEN;
/// There are claims and none was judged.
const UNJUDGED: u8 = 4;
/// The user interrupted.
pub(super) const INTERRUPTED: u8 = interruption::INTERRUPTED;

/// What starts the workers of a run.
#[cfg(feature = "bus")]
const START_WORKERS: Option<StartWorkers> = Some(crate::bus::start_isolated);
#[cfg(not(feature = "bus"))]
const START_WORKERS: Option<StartWorkers> = None;

/// Carries out a prepared run, has its outcome printed, and returns the exit code; `strict` if untested claims count as
/// failed.
pub(super) fn reached(
    ready: Result<ReadyRun, Refusal>,
    style: Style,
    strict: bool,
    print: impl FnOnce(&RunOutcome) -> Result<(), TraceError>,
) -> u8 {
    let ready = match ready {
        Ok(ready) => ready,
        Err(refusal) => {
            report::diagnostics(refusal.0.trim_end());
            return USAGE;
        }
    };
    let code = carry_out(ready, style, START_WORKERS).and_then(|outcome| {
        print(&outcome).map_err(SuperviseError::Trace)?;
        Ok(of(outcome.ended.interrupted, outcome.ended.failure.is_some(), outcome.verdict.count(), strict))
    });
    code.unwrap_or_else(|error| {
        report::error(&error, help(&error));
        BROKEN
    })
}

/// Help where the system starts no process or thread.
pub(super) const MORE_PROCESSES: &str = "raise the limit of processes and threads (ulimit -u)";

/// What the user can do about a run that could not be supervised.
pub(super) fn help(error: &SuperviseError) -> Option<&'static str> {
    match error {
        SuperviseError::Trace(error) | SuperviseError::Broken { error, .. } => error.help(),
        SuperviseError::Start { error, .. } => match error.kind() {
            io::ErrorKind::FileTooLarge => Some("raise the limit of the size of files (ulimit -f)"),
            io::ErrorKind::WouldBlock => Some(MORE_PROCESSES),
            io::ErrorKind::QuotaExceeded | io::ErrorKind::StorageFull => Some(OTHER_TMPDIR),
            _ => None,
        },
    }
}

/// The code of a run that was started; where several fit, interrupted comes first, then broken, unjudged, failed.
fn of(interrupted: bool, broken: bool, claims: Count, strict: bool) -> u8 {
    let lost = claims.failed + claims.unjudged + if strict { claims.untested } else { 0 };
    if interrupted {
        INTERRUPTED
    } else if broken {
        BROKEN
    } else if lost > 0 && claims.ok + claims.failed + claims.untested == 0 {
        UNJUDGED
    } else if lost > 0 {
        FAILED
    } else {
        OK
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(ok: usize, failed: usize, unjudged: usize) -> Count {
        Count { ok, failed, unjudged, untested: 0 }
    }

    #[test]
    fn claims_decide_when_nothing_else_happened() {
        assert_eq!(of(false, false, count(0, 0, 0), false), OK);
        assert_eq!(of(false, false, count(2, 0, 0), false), OK);
        assert_eq!(of(false, false, count(2, 1, 0), false), FAILED);
        assert_eq!(of(false, false, count(2, 0, 1), false), FAILED);
        assert_eq!(of(false, false, count(0, 0, 2), false), UNJUDGED);
        assert_eq!(of(false, false, count(0, 1, 2), false), FAILED);
    }

    #[test]
    fn an_untested_claim_fails_a_strict_run_only() {
        let untested = Count { ok: 1, untested: 1, ..Count::default() };
        assert_eq!((of(false, false, untested, false), of(false, false, untested, true)), (OK, FAILED));
        let alone = Count { untested: 1, ..Count::default() };
        assert_eq!((of(false, false, alone, false), of(false, false, alone, true)), (OK, FAILED));
    }

    #[test]
    fn a_file_that_cannot_be_made_is_helped_by_a_higher_limit_or_by_another_folder() {
        let of = |kind: io::ErrorKind| help(&SuperviseError::Start { doing: "make the board", error: kind.into() });
        assert!(of(io::ErrorKind::WouldBlock).is_some_and(|help| help.ends_with("(ulimit -u)")));
        assert!(of(io::ErrorKind::FileTooLarge).is_some_and(|help| help.ends_with("(ulimit -f)")));
        assert_eq!(of(io::ErrorKind::StorageFull), Some(OTHER_TMPDIR));
        assert_eq!(of(io::ErrorKind::PermissionDenied), None);
    }

    #[test]
    fn an_interruption_comes_before_a_break_and_a_break_before_claims() {
        assert_eq!(of(true, true, count(0, 1, 1), false), INTERRUPTED);
        assert_eq!(of(false, true, count(0, 0, 2), false), BROKEN);
        assert_eq!(of(false, true, count(0, 1, 0), false), BROKEN);
    }
}
