//! Units that crash, hang, exit or lie end a run with exit code 3, are named with call and time, and cost no row.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::Path;
use tests::foreign::Foreign;
use tests::program::{Said, run};

const SCRIPT: &str = "scenario \"A unit misbehaves\"\nstep 100 ms\nstop 1 s\nfmu rogue = \"foreign.fmu\"\n\
                      time -> rogue.u\nassert small: always rogue.y < 100\n";

/// All instances in one process, and each in one of its own.
const PLACEMENTS: [&[&str]; 2] = [&[], &["--isolate"]];

/// Runs a unit that misbehaves in `call` as `how` says, from half a second on where that can be said.
fn misbehaving(call: &str, how: &str, placement: &[&str]) -> (tempfile::TempDir, Said) {
    let defines =
        [format!("MISBEHAVE_CALL={call}"), format!("MISBEHAVE_HOW={how}"), "MISBEHAVE_FROM_S=0.45".to_owned()];
    let defines: Vec<_> = defines.iter().map(String::as_str).collect();
    let from_start = ["LOAD", "INSTANTIATE", "SETUP", "ENTER", "EXIT", "TERMINATE", "FREE"].contains(&call);
    let defines = if from_start { &defines[..2] } else { &defines[..] };
    let (folder, _) = Foreign { defines, ..Foreign::default() }.build();
    std::fs::write(folder.path().join("rogue.scn"), SCRIPT).unwrap();
    let said = run(folder.path(), &[&["run", "rogue.scn", "--step-timeout", "500ms"], placement].concat());
    (folder, said)
}

/// The rows that were kept, header left out.
fn rows(folder: &Path) -> usize {
    let whole = folder.join("runs/rogue/trace.csv");
    let kept = if whole.is_file() { whole } else { whole.with_extension("csv.partial") };
    std::fs::read_to_string(kept).unwrap_or_default().lines().skip(1).count()
}

/// What the standard calls it, the time that the message names, and how many rows are kept.
const CALLS: [(&str, &str, &str, usize); 10] = [
    ("LOAD", "the loading of its library", "", 0),
    ("INSTANTIATE", "fmi2Instantiate", "", 0),
    ("SETUP", "fmi2SetupExperiment", "", 0),
    ("ENTER", "fmi2EnterInitializationMode", "", 0),
    ("EXIT", "fmi2ExitInitializationMode", "", 0),
    ("GET", "fmi2GetReal", "at 0.5 s", 5),
    ("SET", "fmi2SetReal", "at 0.5 s", 5),
    ("STEP", "fmi2DoStep", "at 0.5 s", 5),
    ("TERMINATE", "fmi2Terminate", "at 1 s", 11),
    ("FREE", "fmi2FreeInstance", "at 1 s", 11),
];

fn each_call(how: &str, words: &[&str]) {
    PLACEMENTS.iter().for_each(|placement| each_call_of(how, words, placement));
}

fn each_call_of(how: &str, words: &[&str], placement: &[&str]) {
    for (call, name, time, kept_rows) in CALLS {
        let (folder, said) = misbehaving(call, how, placement);
        let error = said.err.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
        let expected = ["`rogue`", name, time].iter().all(|part| error.contains(part));
        let told = words.iter().any(|word| error.contains(word));
        assert!(said.code == Some(3) && expected && told, "{call} {how}: {:?}\n{}", said.code, said.err);
        // A process of its own is missed when its result is due, not when it was ordered.
        let more_rows = usize::from(!placement.is_empty() && ["SET", "STEP"].contains(&call));
        assert_eq!(rows(folder.path()), kept_rows + more_rows, "{call} {how}: rows");
        let record = std::fs::read_to_string(folder.path().join("runs/rogue/run.json")).unwrap();
        assert!(record.contains("\"state\": \"broken\""), "{call} {how}: {record}");
    }
}

#[test]
fn a_crash_in_any_call_is_named() {
    each_call("CRASH", &["died of signal 11 (SIGSEGV)"]);
}

#[test]
fn an_abort_in_any_call_is_named() {
    each_call("ABORT", &["died of signal 6 (SIGABRT)"]);
}

#[test]
fn an_exit_with_code_0_in_any_call_is_no_success() {
    each_call("EXIT_0", &["ended its process (exit code 0)"]);
}

#[test]
fn an_exit_with_another_code_in_any_call_is_named() {
    each_call("EXIT_3", &["ended its process (exit code 3)"]);
}

#[test]
fn a_stack_overflow_in_any_call_is_named() {
    each_call("OVERFLOW_STACK", &["died of signal 11 (SIGSEGV)", "died of signal 6 (SIGABRT)"]);
}

#[test]
fn a_unit_that_hangs_in_any_call_is_ended_and_named() {
    each_call("HANG", &["has been in"]);
}

#[test]
fn a_unit_that_computes_for_ever_is_ended_and_named() {
    for placement in PLACEMENTS {
        let (_folder, said) = misbehaving("STEP", "SPIN", placement);
        assert_eq!(said.code, Some(3), "{}", said.err);
        assert!(said.err.contains("`rogue` has been in fmi2DoStep for 0.5 s, at 0.5 s"), "{}", said.err);
    }
}

#[test]
fn a_status_that_is_no_success_breaks_the_run() {
    let told = [
        ("STEP", "ERROR_STATUS", "fmi2DoStep returned fmi2Error at 0.5 s"),
        ("STEP", "FATAL", "fmi2DoStep returned fmi2Fatal at 0.5 s"),
        ("STEP", "STATUS_42", "fmi2DoStep returned 42, which is no status of FMI 2.0, at 0.5 s"),
        ("SET", "ERROR_STATUS", "fmi2SetReal returned fmi2Error at 0.5 s"),
        ("ENTER", "ERROR_STATUS", "fmi2EnterInitializationMode returned fmi2Error"),
        ("INSTANTIATE", "NO_INSTANCE", "fmi2Instantiate returned NULL"),
    ];
    for (call, how, words) in told {
        for placement in PLACEMENTS {
            let (folder, said) = misbehaving(call, how, placement);
            assert_eq!(said.code, Some(3), "{call} {how}: {}", said.err);
            assert!(said.err.contains(&format!("error: `rogue`: {words}")), "{call} {how}: {}", said.err);
            assert!(said.err.contains("rogue  ") || call == "INSTANTIATE", "{call} {how}: it says why: {}", said.err);
            // A status counts when the result is due, in every placement.
            let kept_rows = if ["STEP", "SET"].contains(&call) { 6 } else { 0 };
            assert_eq!(rows(folder.path()), kept_rows, "{call} {how} {placement:?}: rows");
        }
    }
}

#[test]
fn the_unit_that_fails_while_boarding_is_named_even_if_another_crashes_when_it_is_freed() {
    let (folder, _) =
        Foreign { defines: &["MISBEHAVE_CALL=FREE", "MISBEHAVE_HOW=CRASH"], ..Foreign::default() }.build();
    let failures = [
        ("INSTANTIATE", "NO_INSTANCE", "fmi2Instantiate returned NULL"),
        ("SETUP", "ERROR_STATUS", "fmi2SetupExperiment returned fmi2Error"),
        ("ENTER", "ERROR_STATUS", "fmi2EnterInitializationMode returned fmi2Error"),
    ];
    for (call, how, words) in failures {
        let defines = [format!("MISBEHAVE_CALL={call}"), format!("MISBEHAVE_HOW={how}")];
        let (other, fmu) = Foreign { defines: &[&defines[0], &defines[1]], ..Foreign::default() }.build();
        std::fs::copy(fmu, folder.path().join("other.fmu")).unwrap();
        drop(other);
        let script = "scenario \"Two units\"\nstep 100 ms\nstop 1 s\nfmu crash = \"foreign.fmu\"\nfmu late = \"other.fmu\"\n\
                      time -> crash.u\ntime -> late.u\nassert small: always late.y < 100\n";
        std::fs::write(folder.path().join("two.scn"), script).unwrap();
        for placement in PLACEMENTS {
            let said = run(folder.path(), &[&["run", "two.scn"], placement].concat());
            assert_eq!(said.code, Some(3), "{call}: {}", said.err);
            assert!(said.err.contains(&format!("error: `late`: {words}")), "{call}: {}", said.err);
        }
    }
}

#[test]
fn a_value_that_is_no_number_is_named_with_its_variable() {
    for placement in PLACEMENTS {
        let (_folder, said) = misbehaving("STEP", "NOT_A_NUMBER", placement);
        assert_eq!(said.code, Some(3), "{}", said.err);
        assert!(said.err.contains("error: `rogue`: `y` is NaN at 0.6 s"), "{}", said.err);
    }
}

#[test]
fn a_warning_is_told_and_the_run_goes_on() {
    let told = PLACEMENTS.map(|placement| {
        let (folder, said) = misbehaving("STEP", "WARNING", placement);
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert!(said.err.contains("asked to return 1 at 0.500 s"), "{}", said.err);
        assert_eq!(rows(folder.path()), 11);
        let words = said.err.lines().filter(|line| line.contains(" s  rogue  ")).map(str::to_owned);
        words.collect::<Vec<_>>()
    });
    assert!(told[0].len() > 5 && told[0] == told[1], "words are the same in every placement: {told:?}");
}
