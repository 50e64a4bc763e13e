//! Checks the contract of a unit about states: `init` does not depend on earlier calls, a serialized state is complete.

use super::Findings;
use super::subject::Subject;
use crate::library::Library;

/// Steps before and after a state is serialized.
const STEPS: u32 = 5;

/// Checks that `init` gives the same unit however often it runs, and whatever values were set before earlier calls.
///
/// # Errors
///
/// The effects that remained of an earlier `init`.
pub fn init_can_be_repeated(library: &'static Library) -> Result<(), Findings> {
    let mut subject = Subject::new(library);
    let broken = |cause: String| Findings(vec![cause]);
    let init = |subject: &mut Subject| {
        subject.init(0.0).map_err(|fault| broken(format!("the unit does not start with its start values: {fault}")))?;
        subject.bytes().map_err(|error| broken(format!("the state cannot be written: {error}")))
    };
    let once = init(&mut subject)?;
    let mut found = Vec::new();
    if init(&mut subject)? != once {
        found.push("calling `init` twice gives different values".to_owned());
    }
    for known in subject.variables(|variable| variable.has_start()) {
        let start = subject.get(known);
        for other in subject.others(known) {
            subject.set(known, &other);
            // A unit may reject the value; effects before the rejection must not remain either.
            let refused = subject.init(0.0).is_err();
            subject.set(known, &start);
            if init(&mut subject)? != once {
                let name = subject.name(known);
                let refused = if refused { " and refused" } else { "" };
                found.push(format!(
                    "the result of `init` depends on an earlier value of `{name}`, which was {other:?}{refused}"
                ));
            }
        }
    }
    Findings::none_or(found)
}

/// Checks that a unit that is serialized during a run and read again continues with the same bits.
///
/// # Errors
///
/// Which of `Clone` and `Serialize` is incomplete, or why the unit cannot run or be serialized.
pub fn a_saved_state_goes_on_bit_for_bit(library: &'static Library) -> Result<(), Findings> {
    let mut subject = Subject::new(library);
    let broken = |cause: String| Findings(vec![cause]);
    let fault = |fault: crate::model::Fault| broken(format!("the unit does not run with its start values: {fault}"));
    let unwritten = |error: postcard::Error| broken(format!("the state cannot be written and read: {error}"));
    subject.init(0.0).map_err(fault)?;
    let run = |subject: &mut Subject, mut steps: std::ops::Range<u32>| {
        steps.try_for_each(|n| subject.step(f64::from(n) * subject.step_s, subject.step_s))
    };
    run(&mut subject, 0..STEPS).map_err(fault)?;
    let (written, kept) = (subject.bytes().map_err(unwritten)?, subject.save());
    run(&mut subject, STEPS..2 * STEPS).map_err(fault)?;
    let end = subject.bytes().map_err(unwritten)?;
    let mut found = Vec::new();
    subject.restore(&*kept);
    run(&mut subject, STEPS..2 * STEPS).map_err(fault)?;
    if subject.bytes().map_err(unwritten)? != end {
        found.push("a restored unit gives other results: `Clone` leaves something out".to_owned());
    }
    let mut other = Subject::new(library);
    other.read_bytes(&written).map_err(unwritten)?;
    run(&mut other, STEPS..2 * STEPS).map_err(fault)?;
    if other.bytes().map_err(unwritten)? != end {
        found.push("a unit read from bytes gives other results: `Serialize` leaves something out".to_owned());
    }
    Findings::none_or(found)
}

/// Target for generated input: reading any bytes as the state of a unit terminates without a panic.
pub fn read_foreign_state(library: &'static Library, bytes: &[u8]) {
    // The checksum of a serialized state would reject most inputs earlier, so it is left out.
    let _ = Subject::new(library).read_bytes(bytes);
}

/// The bytes of a unit at its start values, as a seed for generated input.
///
/// # Errors
///
/// Why the state cannot be written.
pub fn written_state(library: &'static Library) -> Result<Vec<u8>, Findings> {
    Subject::new(library).bytes().map_err(|error| Findings(vec![format!("the state cannot be written: {error}")]))
}
