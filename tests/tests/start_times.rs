//! Runs that begin where a unit's experiment does, and warnings where they begin elsewhere or take other steps.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::Generic;
use tests::program::{PLACEMENTS, Said, run};

const VARIABLES: &str = r#"
  <ScalarVariable name="u" valueReference="2" causality="input"><Real start="0"/></ScalarVariable>
  <ScalarVariable name="start" valueReference="0" causality="output"><Real/></ScalarVariable>
  <ScalarVariable name="reached" valueReference="1" causality="output"><Real/></ScalarVariable>"#;
const EXPERIMENT: &str = r#"<DefaultExperiment startTime="20" stopTime="30" stepSize="0.5"/>"#;
const CODE: [(&str, &str); 2] = [("SETUP_CODE", "R[0] = R[1] = START;"), ("STEP_CODE", "R[1] = T + H;")];

/// The unit `late.fmu`, whose experiment lasts from 20 s to 30 s, in a folder of its own.
fn late(capabilities: &str) -> TempDir {
    let unit =
        Generic { variables: VARIABLES, experiment: EXPERIMENT, capabilities, code: &CODE, ..Generic::default() };
    unit.build("late")
}

fn simulate(folder: &Path, options: &[&str]) -> (Said, Vec<String>) {
    let said = run(folder, &[&["simulate", "late.fmu", "--out", "out"], options].concat());
    let trace = fs::read_to_string(folder.join("out/trace.csv")).unwrap_or_default();
    (said, trace.lines().map(str::to_owned).collect())
}

#[test]
fn simulate_begins_where_the_experiment_of_the_unit_does() {
    let folder = late("");
    let (said, rows) = simulate(folder.path(), &[]);
    assert_eq!((said.code, said.err.contains("warning")), (Some(0), false), "{}", said.err);
    assert_eq!(rows[..3], ["time,start,reached,u", "20,20,20,0", "20.5,20,20.5,0"]);
    assert_eq!((rows.len(), rows[21].as_str()), (22, "30,20,30,0"));
    let record = fs::read_to_string(folder.path().join("out/run.json")).unwrap();
    assert!(record.contains("\"simulated_s\""), "{record}");
}

#[test]
fn simulate_begins_where_the_user_says() {
    let folder = late("");
    for (options, first, last) in [
        (&["--start", "0"][..], "0,0,0,0", "30,0,30,0"),
        (&["--start", "25s", "--stop", "26s"], "25,25,25,0", "26,25,26,0"),
        (&["--start", "40"], "40,40,40,0", "41,40,41,0"),
    ] {
        let (said, rows) = simulate(folder.path(), options);
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert_eq!((rows[1].as_str(), rows[rows.len() - 1].as_str()), (first, last));
    }
    let (said, _) = simulate(folder.path(), &["--stop", "10"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("--stop 10 s is not after the start at 20 s"), "{}", said.err);
}

#[test]
fn inputs_over_time_are_those_of_the_time_at_which_the_run_begins() {
    let folder = late("");
    fs::write(folder.path().join("in.csv"), "time,u\n0,0\n40,80\n").unwrap();
    let (said, rows) = simulate(folder.path(), &["--input", "in.csv"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(rows[1..3], ["20,20,20,40", "20.5,20,20.5,41"]);
}

#[test]
fn a_unit_that_fails_at_its_start_is_reported_with_its_time() {
    let code = [("ENTER_CODE", "status = ERROR;")];
    let unit = Generic { variables: VARIABLES, experiment: EXPERIMENT, code: &code, ..Generic::default() };
    let folder = unit.build("late");
    let (said, _) = simulate(folder.path(), &[]);
    assert_eq!(said.code, Some(3));
    assert!(said.err.contains("fmi2EnterInitializationMode returned fmi2Error at 20 s"), "{}", said.err);
}

#[test]
fn run_and_check_warn_of_an_experiment_that_begins_elsewhere() {
    let folder = late("");
    let script =
        "scenario \"s\"\nstep 500 ms\nstop 1 s\nfmu a = \"late.fmu\"\nfmu b = \"late.fmu\"\nrecord a.reached\n";
    fs::write(folder.path().join("s.scn"), script).unwrap();
    let warning = "the DefaultExperiment of unit `late.fmu` begins at 20 s, the run of a script at 0 s";
    let checked = run(folder.path(), &["check", "s.scn"]);
    assert_eq!((checked.code, checked.out.matches(warning).count()), (Some(0), 1), "{}", checked.out);
    for placement in PLACEMENTS {
        let said = run(folder.path(), &[&["run", "s.scn"], placement].concat());
        assert_eq!((said.code, said.err.matches(warning).count()), (Some(0), 1), "{}", said.err);
        let trace = fs::read_to_string(folder.path().join("runs/s/trace.csv")).unwrap();
        assert!(trace.lines().nth(1).is_some_and(|row| row == "0,0"), "{trace}");
    }
    assert_eq!(run(folder.path(), &["check", "--strict", "s.scn"]).code, Some(2));
}

#[test]
fn a_unit_with_a_fixed_step_is_warned_of_at_another_step() {
    let folder = late("canHandleVariableCommunicationStepSize=\"false\"");
    let check = |lines: &str| {
        fs::write(folder.path().join("s.scn"), format!("scenario \"s\"\n{lines}\n")).unwrap();
        run(folder.path(), &["check", "s.scn"]).out
    };
    let warning = "warning[W08]: `a` takes steps of 0.5 s only, as canHandleVariableCommunicationStepSize is false, but here \
                   it takes steps of 250 ms";
    let checked = check("step 250 ms\nstop 1 s\nfmu a = \"late.fmu\"");
    assert!(checked.contains(warning) && checked.contains("write `every 0.5 s` or `step 0.5 s`"), "{checked}");
    let said = run(folder.path(), &["run", "s.scn", "--isolate"]);
    assert!(said.code == Some(0) && said.err.contains(warning), "{}", said.err);
    for lines in
        ["step 250 ms\nstop 1 s\nfmu a = \"late.fmu\" every 500 ms", "step 500 ms\nstop 1 s\nfmu a = \"late.fmu\""]
    {
        assert!(!check(lines).contains("W08"));
    }
    let (said, _) = simulate(folder.path(), &["--step", "0.25"]);
    assert!(said.code == Some(0) && said.err.contains("warning: the unit takes steps of 0.5 s only"), "{}", said.err);
    assert!(!simulate(folder.path(), &[]).0.err.contains("warning"));
}
