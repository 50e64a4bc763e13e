//! Units that crash, hang, exit or return errors end a run with exit code 3; call and time are named, no row is lost.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::Path;
use tests::foreign::Foreign;
use tests::program::{PLACEMENTS, Said, repository, run};

const SCRIPT: &str = "scenario \"A unit misbehaves\"\nstep 100 ms\nstop 1 s\n\
                      fmu rogue = \"foreign.fmu\" { enabled = false }\n\
                      time -> rogue.u\nassert small: always rogue.y < 100\n";

/// Runs a unit that misbehaves in `call` as given by `how`; in calls during the run, from half a second on.
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

/// The number of rows that were kept, without the header.
fn rows(folder: &Path) -> usize {
    let whole = folder.join("runs/rogue/trace.csv");
    let kept = if whole.is_file() { whole } else { whole.with_extension("csv.partial") };
    std::fs::read_to_string(kept).unwrap_or_default().lines().skip(1).count()
}

/// The call in `unit.c`, its name in the message, the time in the message, and the number of rows that are kept.
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

fn each_call(how: &str, reasons: &[&str]) {
    PLACEMENTS.iter().for_each(|placement| each_call_of(how, reasons, placement));
}

/// The error must contain one of the `reasons`.
fn each_call_of(how: &str, reasons: &[&str], placement: &[&str]) {
    for (call, name, time, kept_rows) in CALLS {
        let (folder, said) = misbehaving(call, how, placement);
        let error = said.err.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
        let expected = ["`rogue`", name, time].iter().all(|part| error.contains(part));
        let has_reason = reasons.iter().any(|reason| error.contains(reason));
        assert!(said.code == Some(3) && expected && has_reason, "{call} {how}: {:?}\n{}", said.code, said.err);
        // With a process of its own, a failure is detected when the result is due, not when the call is ordered.
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
fn an_exit_with_code_0_in_any_call_is_a_failure() {
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
fn an_error_status_breaks_the_run() {
    let failures = [
        ("STEP", "ERROR_STATUS", "fmi2DoStep returned fmi2Error at 0.5 s"),
        ("STEP", "FATAL", "fmi2DoStep returned fmi2Fatal at 0.5 s"),
        ("STEP", "STATUS_42", "fmi2DoStep returned 42, which is no status of FMI 2.0, at 0.5 s"),
        ("SET", "ERROR_STATUS", "fmi2SetReal returned fmi2Error at 0.5 s"),
        ("ENTER", "ERROR_STATUS", "fmi2EnterInitializationMode returned fmi2Error"),
        ("INSTANTIATE", "NO_INSTANCE", "fmi2Instantiate returned NULL"),
    ];
    for (call, how, message) in failures {
        for placement in PLACEMENTS {
            let (folder, said) = misbehaving(call, how, placement);
            assert_eq!(said.code, Some(3), "{call} {how}: {}", said.err);
            assert!(said.err.contains(&format!("error: `rogue`: {message}")), "{call} {how}: {}", said.err);
            assert!(said.err.contains("rogue  ") || call == "INSTANTIATE", "{call} {how}: it says why: {}", said.err);
            // A status takes effect when the result is due, in every placement.
            let kept_rows = if ["STEP", "SET"].contains(&call) { 6 } else { 0 };
            assert_eq!(rows(folder.path()), kept_rows, "{call} {how} {placement:?}: rows");
        }
    }
}

#[test]
fn the_unit_that_fails_during_initialization_is_named_even_if_another_crashes_when_it_is_freed() {
    let (folder, _) =
        Foreign { defines: &["MISBEHAVE_CALL=FREE", "MISBEHAVE_HOW=CRASH"], ..Foreign::default() }.build();
    let failures = [
        ("INSTANTIATE", "NO_INSTANCE", "fmi2Instantiate returned NULL"),
        ("SETUP", "ERROR_STATUS", "fmi2SetupExperiment returned fmi2Error"),
        ("ENTER", "ERROR_STATUS", "fmi2EnterInitializationMode returned fmi2Error"),
    ];
    for (call, how, message) in failures {
        let defines = [format!("MISBEHAVE_CALL={call}"), format!("MISBEHAVE_HOW={how}")];
        let (other, fmu) = Foreign { defines: &[&defines[0], &defines[1]], ..Foreign::default() }.build();
        std::fs::copy(fmu, folder.path().join("other.fmu")).unwrap();
        drop(other);
        let script = "scenario \"Two units\"\nstep 100 ms\nstop 1 s\n\
                      fmu crash = \"foreign.fmu\" { enabled = false }\nfmu late = \"other.fmu\" { enabled = false }\n\
                      time -> crash.u\ntime -> late.u\nassert small: always late.y < 100\n";
        std::fs::write(folder.path().join("two.scn"), script).unwrap();
        for placement in PLACEMENTS {
            let said = run(folder.path(), &[&["run", "two.scn"], placement].concat());
            assert_eq!(said.code, Some(3), "{call}: {}", said.err);
            assert!(said.err.contains(&format!("error: `late`: {message}")), "{call}: {}", said.err);
        }
    }
}

#[test]
fn a_value_that_is_nan_is_named_with_its_variable() {
    for placement in PLACEMENTS {
        let (_folder, said) = misbehaving("STEP", "NOT_A_NUMBER", placement);
        assert_eq!(said.code, Some(3), "{}", said.err);
        assert!(said.err.contains("error: `rogue`: `y` is NaN at 0.6 s"), "{}", said.err);
    }
}

#[test]
fn a_value_that_a_unit_of_ours_refuses_ends_the_run_with_the_units_own_message() {
    let folder = tempfile::tempdir().unwrap();
    let script = "scenario \"A rotor better than new\"\nstep 10 ms\nstop 2 s\n\
                  fmu quad = \"quadcopter\" { airborne = true, position0.z = 10 m }\n\
                  let rest = 0.5 + time / 1 s\nrest -> quad.effectiveness[1]\n";
    let path = folder.path().join("rotor.scn");
    std::fs::write(&path, script).unwrap();
    for placement in PLACEMENTS {
        let out = folder.path().join(format!("out{}", placement.len()));
        let arguments = ["run", path.to_str().unwrap(), "--out", out.to_str().unwrap()];
        let said = run(&repository(), &[&arguments, placement].concat());
        assert_eq!(said.code, Some(3));
        let discarded = "0.51 s  quad  discard  fmi2SetReal: 1.01 is no value for `effectiveness[1]`, which lies between 0 and 1; \
                         nothing was set\nerror: `quad`: fmi2SetReal returned fmi2Discard at 0.51 s\n";
        assert!(said.err.contains(discarded), "{}", said.err);
        let trace = std::fs::read_to_string(out.join("trace.csv")).unwrap();
        assert_eq!(trace.lines().count(), 1 + 52, "the rows up to 0.51 s are kept");
    }
}

#[test]
fn a_warning_is_logged_and_the_run_continues() {
    let messages = PLACEMENTS.map(|placement| {
        let (folder, said) = misbehaving("STEP", "WARNING", placement);
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert!(said.err.contains("asked to return 1 at 0.500 s"), "{}", said.err);
        assert_eq!(rows(folder.path()), 11);
        let lines = said.err.lines().filter(|line| line.contains(" s  rogue  ")).map(str::to_owned);
        lines.collect::<Vec<_>>()
    });
    assert!(
        messages[0].len() > 5 && messages[0] == messages[1],
        "messages are the same in every placement: {messages:?}"
    );
}
