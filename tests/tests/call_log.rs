//! `run --log-fmi-calls`: every call of an instance with its time, arguments and status, including one that crashes.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use tempfile::TempDir;
use tests::foreign::{CLAIMS_STATES, Foreign};
use tests::program::{PLACEMENTS, Said, run};

const SCRIPT: &str = "scenario \"A unit follows the time\"\nstep 100 ms\nstop 200 ms\n\
                      fmu probe = \"foreign.fmu\" { label = \"from A to B\" }\n\
                      time / 1 s -> probe.u\nat 100 ms { set probe.enabled = true }\nrecord probe.y, probe.count\n";

const CALLS: &str = "\
0 s  fmi2Instantiate(\"probe\", loggingOn = true) -> an instance
0 s  fmi2SetString(label = \"from A to B\") -> fmi2OK
0 s  fmi2SetupExperiment(toleranceDefined = fmi2False, tolerance = 0, startTime = 0, stopTimeDefined = fmi2False, stopTime = 0) -> fmi2OK
0 s  fmi2EnterInitializationMode() -> fmi2OK
0 s  fmi2GetReal(u, gain) -> fmi2OK, u = 0, gain = 2
0 s  fmi2GetBoolean(enabled) -> fmi2OK, enabled = fmi2False
0 s  fmi2SetReal(u = 0) -> fmi2OK
0 s  fmi2SetBoolean(enabled = fmi2False) -> fmi2OK
0 s  fmi2SetString(label = \"from A to B\") -> fmi2OK
0 s  fmi2SetReal(u = 0) -> fmi2OK
0 s  fmi2ExitInitializationMode() -> fmi2OK
0 s  fmi2GetBoolean(enabled) -> fmi2OK, enabled = fmi2False
0 s  fmi2GetString(label) -> fmi2OK, label = \"from A to B\"
0 s  fmi2GetReal(y) -> fmi2OK, y = 0
0 s  fmi2GetInteger(count) -> fmi2OK, count = 0
0 s  fmi2SetReal(u = 0) -> fmi2OK
0 s  fmi2SetBoolean(enabled = fmi2False) -> fmi2OK
0 s  fmi2DoStep(currentCommunicationPoint = 0, communicationStepSize = 0.1, noSetFMUStatePriorToCurrentPoint = fmi2True) -> fmi2OK
0.1 s  fmi2GetReal(y) -> fmi2OK, y = 0
0.1 s  fmi2GetInteger(count) -> fmi2OK, count = 1
0.1 s  fmi2SetReal(u = 0.1) -> fmi2OK
0.1 s  fmi2SetBoolean(enabled = fmi2True) -> fmi2OK
0.1 s  fmi2DoStep(currentCommunicationPoint = 0.1, communicationStepSize = 0.1, noSetFMUStatePriorToCurrentPoint = fmi2True) -> fmi2OK
0.2 s  fmi2GetReal(y) -> fmi2OK, y = 0.020000000000000004
0.2 s  fmi2GetInteger(count) -> fmi2OK, count = 2
0.2 s  fmi2Terminate() -> fmi2OK
0.2 s  fmi2FreeInstance() -> returned
";

/// Runs the unit with these defines and logs its calls; returns the last two lines of the log.
fn last_calls(defines: &[&str]) -> (Said, Vec<String>) {
    let (folder, said) = logged(defines, &["--log-fmi-calls", "probe"]);
    let calls = text(&folder, "fmi-calls.probe.log");
    let lines: Vec<_> = calls.lines().map(str::to_owned).collect();
    assert!(calls.ends_with('\n'), "{calls}");
    (said, lines[lines.len() - 2..].to_vec())
}

fn logged(defines: &[&str], arguments: &[&str]) -> (TempDir, Said) {
    let description: &[_] = if defines.contains(&"WITH_STATES") { &[CLAIMS_STATES] } else { &[] };
    let (folder, _) = Foreign { defines, description, ..Foreign::default() }.build();
    fs::write(folder.path().join("follow.scn"), SCRIPT).unwrap();
    let said = run(folder.path(), &[&["run", "follow.scn"], arguments].concat());
    (folder, said)
}

fn text(folder: &TempDir, file: &str) -> String {
    fs::read_to_string(folder.path().join("runs/follow").join(file)).unwrap()
}

#[test]
fn every_call_is_logged_with_time_arguments_and_status_in_every_placement() {
    for placement in PLACEMENTS {
        let (folder, said) = logged(&[], &[&["--log-fmi-calls", "probe"], placement].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert_eq!(text(&folder, "fmi-calls.probe.log"), CALLS, "{placement:?}");
        assert!(said.err.contains("step 1 of probe: y = 0.000000"), "debug logging of the unit was on: {}", said.err);
    }
}

#[test]
fn calls_that_save_and_restore_a_state_are_logged_too() {
    let saved = ["--save-at", "100ms", "saved", "--log-fmi-calls", "probe"];
    let (folder, said) = logged(&["WITH_STATES"], &saved);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let calls = text(&folder, "fmi-calls.probe.log");
    for call in ["fmi2GetFMUstate() -> fmi2OK\n", "fmi2SerializeFMUstate(size = ", "fmi2FreeFMUstate() -> fmi2OK\n"] {
        assert!(calls.contains(&format!("0.1 s  {call}")), "{call}: {calls}");
    }
    let said = run(folder.path(), &["run", "follow.scn", "--from", "saved", "--log-fmi-calls", "probe", "--isolate"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let calls = text(&folder, "fmi-calls.probe.log");
    assert!(
        calls.contains("fmi2DeSerializeFMUstate(size = ") && calls.contains("fmi2SetFMUstate() -> fmi2OK"),
        "{calls}"
    );
}

#[test]
fn a_run_whose_calls_are_logged_leaves_the_same_trace() {
    let (folder, _) = logged(&[], &["--log-fmi-calls", "probe"]);
    let read = |file: &str| fs::read(folder.path().join("runs/follow").join(file)).unwrap();
    let traces = || ["trace.csv", "trace.parquet", "verdict.json"].map(read);
    let with = traces();
    assert_eq!(run(folder.path(), &["run", "follow.scn"]).code, Some(0));
    assert!(traces() == with);
    assert!(!folder.path().join("runs/follow/fmi-calls.probe.log").exists(), "the log of the earlier run is gone");
}

#[test]
fn calls_are_logged_in_a_run_that_records_nothing() {
    let (folder, said) = logged(&[], &["--log-fmi-calls", "probe", "--record", "none"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(text(&folder, "fmi-calls.probe.log").lines().count(), CALLS.lines().count());
}

#[test]
fn the_last_line_is_the_call_that_crashed() {
    let from = "MISBEHAVE_FROM_S=0.05";
    let step = "0.1 s  fmi2DoStep(currentCommunicationPoint = 0.1, communicationStepSize = 0.1, \
                noSetFMUStatePriorToCurrentPoint = fmi2True)";
    for (call, last) in [("STEP", step), ("SET", "0.1 s  fmi2SetReal(u = 0.1)"), ("GET", "0.1 s  fmi2GetReal(y)")] {
        let (said, calls) = last_calls(&[&format!("MISBEHAVE_CALL={call}"), "MISBEHAVE_HOW=CRASH", from]);
        assert_eq!((said.code, calls[1].as_str()), (Some(3), last), "{}", said.err);
        assert!(calls[0].contains(" -> fmi2OK"), "{calls:?}");
    }
}

#[test]
fn the_status_calls_after_a_discarded_step_are_logged() {
    let (folder, said) = logged(&["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=TERMINATED"], &["--log-fmi-calls", "probe"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let calls = text(&folder, "fmi-calls.probe.log");
    let entries: Vec<_> =
        calls.lines().filter(|line| line.contains("Status(") || line.contains("fmi2Discard")).collect();
    assert!(entries[0].ends_with(" -> fmi2Discard"), "{calls}");
    assert_eq!(
        entries[1..],
        [
            "0 s  fmi2GetBooleanStatus(fmi2Terminated) -> fmi2OK, fmi2True",
            "0 s  fmi2GetRealStatus(fmi2LastSuccessfulTime) -> fmi2OK, 0.05"
        ]
    );
}

#[test]
fn a_failed_instantiation_is_logged() {
    let (folder, said) =
        logged(&["MISBEHAVE_CALL=INSTANTIATE", "MISBEHAVE_HOW=NO_INSTANCE"], &["--log-fmi-calls", "probe"]);
    assert_eq!(said.code, Some(3), "{}", said.err);
    assert_eq!(text(&folder, "fmi-calls.probe.log"), "0 s  fmi2Instantiate(\"probe\", loggingOn = true) -> NULL\n");
}

#[test]
fn an_unknown_instance_is_refused_with_the_nearest_name() {
    let (folder, said) = logged(&[], &["--log-fmi-calls", "prob"]);
    assert_eq!(said.code, Some(2));
    let help = "help: did you mean `probe`?\n";
    assert_eq!(said.err, format!("error: --log-fmi-calls prob: the script has no such instance\n{help}"));
    assert!(!folder.path().join("runs").exists(), "nothing was begun");
}
