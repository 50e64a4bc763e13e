//! Tests a unit by running it: each test is one or two stepping processes, supervised like a run.

use crate::host::supervise::{SuperviseError, start_error, supervise};
use crate::run::exercise::{Exercise, take_difference};
use crate::run::run_spec::RunSpec;
use fmi2::description::CoSimulation;
use results::checkpoint::Saving;
use results::recorder::Recorder;
use results::report::console::{Console, Style};
use std::path::Path;
use unit::process::Descendants;

/// How a test came out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TestResult {
    /// Every row was that of a run in which nothing special happened.
    Passed,
    /// What differed or broke.
    Failed(String),
    /// The unit does not declare what the test needs.
    NotSupported(&'static str),
    /// An earlier failure leaves nothing to compare with.
    NotRun(&'static str),
}

/// A test with its result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tested {
    /// What was tested.
    pub name: &'static str,
    /// How it came out.
    pub result: TestResult,
    /// What the unit logged during a test that failed, a line for each message.
    pub log: String,
}

/// A test: its name, what it does, and why a unit may not support it.
struct Test {
    name: &'static str,
    exercises: &'static [Exercise],
    not_supported: fn(&CoSimulation) -> Option<&'static str>,
}

/// In the order in which they run: the first one leaves the rows that the others compare with.
const TESTS: [Test; 6] = [
    Test { name: "two runs", exercises: &[Exercise::Record(0), Exercise::Repeat], not_supported: |_| None },
    Test { name: "save and restore", exercises: &[Exercise::Return], not_supported: without_states },
    Test { name: "save and restore as bytes", exercises: &[Exercise::Restore], not_supported: without_bytes },
    Test {
        name: "restore in a new process",
        exercises: &[Exercise::Leave, Exercise::Continue],
        not_supported: without_bytes,
    },
    Test { name: "reset", exercises: &[Exercise::Reset], not_supported: |_| None },
    Test {
        name: "two instances in one process",
        exercises: &[Exercise::Record(1), Exercise::Together],
        not_supported: |unit| {
            unit.can_be_instantiated_only_once_per_process.then_some("canBeInstantiatedOnlyOncePerProcess is true")
        },
    },
];

fn without_states(unit: &CoSimulation) -> Option<&'static str> {
    (!unit.can_get_and_set_fmu_state).then_some("canGetAndSetFMUstate is false")
}

fn without_bytes(unit: &CoSimulation) -> Option<&'static str> {
    without_states(unit).or_else(|| (!unit.can_serialize_fmu_state).then_some("canSerializeFMUstate is false"))
}

/// Runs all tests of the unit of a spec, whose scenario has it twice; `done` gets each one as soon as it is over.
///
/// # Errors
/// A stepping process could not be started.
pub fn test_unit(spec: &RunSpec, program: &Path, mut done: impl FnMut(&Tested)) -> Result<(), SuperviseError> {
    let capabilities = spec.unit(0).description.co_simulation.clone().unwrap_or_default();
    let mut skipped = None;
    for (nth, Test { name, exercises, not_supported }) in TESTS.iter().enumerate() {
        let mut log = String::new();
        let result = if let Some(why) = not_supported(&capabilities) {
            TestResult::NotSupported(why)
        } else if let Some(why) = skipped {
            TestResult::NotRun(why)
        } else {
            failure_of(spec, program, exercises, &mut log)?.map_or(TestResult::Passed, TestResult::Failed)
        };
        if nth == 0 && matches!(result, TestResult::Failed(_)) {
            skipped = Some("there are no two equal runs to compare with");
        }
        done(&Tested { name, result, log });
    }
    Ok(())
}

/// Does exercises in turn, each in a process of its own, up to the first that fails; returns why.
fn failure_of(
    spec: &RunSpec,
    program: &Path,
    exercises: &[Exercise],
    log: &mut String,
) -> Result<Option<String>, SuperviseError> {
    let home = spec.board.parent().unwrap_or(Path::new("."));
    for &exercise in exercises {
        let mut spec = spec.clone();
        spec.options.exercise = Some(exercise);
        let mut console = Console::new(Vec::new(), Style::Never);
        // What the unit started ends with the exercise, as with a run.
        let _descendants = Descendants::adopt().map_err(start_error("adopt the processes of units"))?;
        let ended = supervise(&spec, &Saving::default(), program, None, Recorder::default(), None, &mut console);
        // The next process makes a board of its own under this name.
        std::fs::remove_file(&spec.board).ok();
        let ended = ended?;
        // A difference is found before the unit is freed, so it comes before what happens then.
        let failed = take_difference(home).or_else(|| ended.failure.as_ref().map(ToString::to_string));
        if let Some(failed) = failed {
            *log = String::from_utf8_lossy(&console.into_inner()).into_owned();
            return Ok(Some(failed));
        }
    }
    Ok(None)
}
