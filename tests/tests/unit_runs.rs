//! `lockstep check --run`: units with planted faults, each found by the test that is for it.
#![allow(clippy::expect_used, reason = "a test that cannot go on has failed")]

use std::path::Path;
use tests::foreign::{CLAIMS_STATES, Foreign, Generic, STATES};
use tests::program::{Said, run};

/// An integrator: y is the integral of u.
const INTEGRATOR: &str = r#"
<ScalarVariable name="u" valueReference="0" causality="input"><Real start="1"/></ScalarVariable>
<ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>"#;
const STEPS: &str = "R[1] += H * R[0];";
/// Memory of an instance that is in no state and that `fmi2Reset` leaves as it is.
const BESIDE: &str = "((double *)unit->name)[20]";

fn check(folder: &Path, unit: &Path, more: &[&str]) -> Said {
    let arguments = ["check", unit.to_str().expect("a path in UTF-8"), "--run", "--step", "10ms", "--stop", "1s"];
    run(folder, &[&arguments, more].concat())
}

/// The exit code and the results of the tests of a unit whose calls run this code, without its path.
fn tested(capabilities: &str, code: &[(&str, &str)]) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let unit = Generic { capabilities, variables: INTEGRATOR, code, ..Generic::default() }.pack(folder.path(), "lag");
    results(&check(folder.path(), &unit, &["--step-timeout", "300ms"]))
}

fn results(said: &Said) -> (Option<i32>, String) {
    let lines = said.out.lines().filter_map(|line| line.strip_prefix("  "));
    let lines: Vec<_> = lines.map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    assert!(lines.len() == 6, "{said:?}");
    (said.code, lines.join("\n"))
}

#[test]
fn a_sound_unit_passes_all_tests() {
    let (code, lines) = tested(STATES, &[("STEP_CODE", STEPS), ("WITH_STATES", "1")]);
    let passed = "\
two runs pass
save and restore pass
save and restore as bytes pass
restore in a new process pass
reset pass
two instances in one process pass";
    assert_eq!((code, lines.as_str()), (Some(0), passed));
}

#[test]
fn what_a_unit_does_not_declare_is_not_supported_and_no_failure() {
    let (code, lines) = tested("canBeInstantiatedOnlyOncePerProcess=\"true\"", &[("STEP_CODE", STEPS)]);
    let expected = "\
two runs pass
save and restore not supported: canGetAndSetFMUstate is false
save and restore as bytes not supported: canGetAndSetFMUstate is false
restore in a new process not supported: canGetAndSetFMUstate is false
reset pass
two instances in one process not supported: canBeInstantiatedOnlyOncePerProcess is true";
    assert_eq!((code, lines.as_str()), (Some(0), expected));
}

#[test]
fn a_state_that_is_incomplete_is_found_with_variable_values_and_time() {
    let hidden = format!("{BESIDE} += H * R[0]; R[1] = {BESIDE};");
    let cleared = format!("{BESIDE} = 0;");
    let code = [("STEP_CODE", hidden.as_str()), ("RESET_CODE", cleared.as_str()), ("WITH_STATES", "1")];
    insta::assert_snapshot!(tested(STATES, &code).1, @r"
    two runs pass
    save and restore fail: after the state was restored: y is 1.035171783810137, was 0.5233483756591881, at 0.51 s
    save and restore as bytes fail: after the state was restored: y is 1.035171783810137, was 0.5233483756591881, at 0.51 s
    restore in a new process fail: after the state was restored: y is 0.010142954332625962, was 0.5233483756591881, at 0.51 s
    reset pass
    two instances in one process pass
    ");
}

#[test]
fn a_reset_that_is_incomplete_is_found() {
    let counts = format!("{BESIDE} += 1; R[1] += H * R[0]; if (STEPS == 1) R[1] += {BESIDE};");
    insta::assert_snapshot!(tested("", &[("STEP_CODE", &counts)]).1, @r"
    two runs pass
    save and restore not supported: canGetAndSetFMUstate is false
    save and restore as bytes not supported: canGetAndSetFMUstate is false
    restore in a new process not supported: canGetAndSetFMUstate is false
    reset fail: after fmi2Reset: y is 101.01025, was 1.01025, at 0.01 s
    two instances in one process pass
    ");
}

#[test]
fn memory_that_instances_share_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let header = folder.path().join("shared.h");
    std::fs::write(&header, "static double input;\n").expect("a header");
    let include = format!("\"{}\"", header.display());
    let code = [("INCLUDES", include.as_str()), ("SET_CODE", "input = R[0];"), ("STEP_CODE", "R[1] += H * input;")];
    insta::assert_snapshot!(tested("", &code).1, @r"
    two runs pass
    save and restore not supported: canGetAndSetFMUstate is false
    save and restore as bytes not supported: canGetAndSetFMUstate is false
    restore in a new process not supported: canGetAndSetFMUstate is false
    reset pass
    two instances in one process fail: beside another instance: y is 0.010486575021921853, was 0.010249999999999999, at 0.01 s
    ");
}

#[test]
fn a_unit_that_ends_its_process_or_does_not_return_fails_the_test_by_name_of_the_call() {
    let only_one = "static int made; if (made++) { free(unit); return NULL; }";
    let faults = [
        ("RESET_CODE", "abort();"),
        ("RESET_CODE", "for (;;) sleep(1);"),
        ("RESET_CODE", "exit(0);"),
        ("RESET_CODE", "status = ERROR;"),
        ("FREE_CODE", "if (STEPS > 1) abort();"),
        ("INSTANTIATE_CODE", only_one),
    ];
    let shown = faults.map(|fault| {
        let (code, lines) = tested("", &[("STEP_CODE", STEPS), fault]);
        assert_eq!(code, Some(1), "{lines}");
        lines.lines().filter(|line| line.contains("fail")).map(|line| format!("{line}\n")).collect::<String>()
    });
    insta::assert_snapshot!(shown.concat(), @r"
    reset fail: `lag` died of signal 6 (SIGABRT) in fmi2Reset at 1 s
    reset fail: `lag` has been in fmi2Reset for 0.3 s, at 1 s
    reset fail: `lag` ended its process (exit code 0) in fmi2Reset at 1 s
    reset fail: `lag`: fmi2Reset returned fmi2Error at 1 s
    two runs fail: `lag` died of signal 6 (SIGABRT) in fmi2FreeInstance at 1 s
    two instances in one process fail: `lag_2`: fmi2Instantiate returned NULL at 0 s
    ");
}

#[test]
fn two_runs_that_differ_leave_nothing_to_compare_with() {
    let (code, lines) = tested(STATES, &[("STEP_CODE", "R[1] = getpid();"), ("WITH_STATES", "1")]);
    assert_eq!(code, Some(1));
    assert!(lines.starts_with("two runs fail: y is "), "{lines}");
    let rest = ": there are no two equal runs to compare with";
    assert_eq!(lines.lines().filter(|line| line.contains(" not run") && line.ends_with(rest)).count(), 5, "{lines}");
}

#[test]
fn a_unit_that_ends_its_run_itself_is_tested_up_to_there() {
    let defines = ["WITH_STATES", "MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=TERMINATED", "MISBEHAVE_FROM_S=0.5"];
    let (folder, unit) = Foreign { defines: &defines, description: &[CLAIMS_STATES], ..Foreign::default() }.build();
    let (code, lines) = results(&check(folder.path(), &unit, &[]));
    assert_eq!((code, lines.matches("pass").count()), (Some(0), 6), "{lines}");
}

#[test]
fn the_units_messages_are_shown_with_a_test_that_fails() {
    let defines = ["WITH_STATES", "MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=ERROR_STATUS", "MISBEHAVE_FROM_S=0.5"];
    let (folder, unit) = Foreign { defines: &defines, ..Foreign::default() }.build();
    let said = check(folder.path(), &unit, &[]);
    assert!(said.out.contains("two runs                      fail: `foreign`: fmi2DoStep returned fmi2Error at 0.5 s"));
    assert!(said.err.contains("asked to return 3 at 0.500 s"), "{}", said.err);
}

#[test]
fn options_of_the_run_need_it_and_scripts_are_not_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = run(folder.path(), &["check", "lag.fmu", "--step", "1ms"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("--run"), "{}", said.err);
    let said = run(folder.path(), &["check", "lag.fmu", "--run"]);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""));
}
