//! Start values: what units are given at initialization, and warnings where a unit holds something else.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::Generic;
use tests::program::{PLACEMENTS, Said, run};

/// An input, a tunable parameter and a fixed one, and their sum.
const VARIABLES: &str = r#"
  <ScalarVariable name="u" valueReference="0" causality="input"><Real start="2.5"/></ScalarVariable>
  <ScalarVariable name="gain" valueReference="1" causality="parameter" variability="tunable"><Real start="20"/></ScalarVariable>
  <ScalarVariable name="mass" valueReference="2" causality="parameter" variability="fixed"><Real unit="kg" start="100"/></ScalarVariable>
  <ScalarVariable name="mode" valueReference="0" causality="input" variability="discrete"><Integer start="3"/></ScalarVariable>
  <ScalarVariable name="sum" valueReference="3" causality="output"><Real/></ScalarVariable>"#;
const UNITS: &str = r#"<UnitDefinitions><Unit name="kg"><BaseUnit kg="1"/></Unit></UnitDefinitions>"#;
const SUM: (&str, &str) = ("GET_CODE", "R[3] = R[0] + R[1] + R[2] + 1000 * I[0];");
/// The library starts as the description says.
const AGREES: &str = "R[0] = 2.5; R[1] = 20; R[2] = 100; I[0] = 3;";

/// The unit `a.fmu` in a folder of its own.
fn unit(variables: &str, code: &[(&str, &str)]) -> TempDir {
    let code = [&[SUM], code].concat();
    Generic { definitions: UNITS, variables, code: &code, ..Generic::default() }.build("a")
}

/// Runs the unit with these braces and further lines; returns the column `a.sum` besides what the program said.
fn sums(folder: &Path, braces: &str, lines: &str, placement: &[&str]) -> (Said, Vec<f64>) {
    let script =
        format!("scenario \"s\"\nstep 100 ms\nstop 400 ms\nfmu a = \"a.fmu\" {braces}\n{lines}\nrecord a.sum, a.u\n");
    fs::write(folder.join("s.scn"), script).unwrap();
    let said = run(folder, &[&["run", "s.scn"], placement].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    let trace = fs::read_to_string(folder.join("runs/s/trace.csv")).unwrap();
    let sums = trace.lines().skip(1).map(|row| row.split(',').nth(1).unwrap().parse().unwrap());
    (said, sums.collect())
}

#[test]
fn an_input_that_nothing_drives_is_given_its_declared_start_value() {
    let folder = unit(VARIABLES, &[("INSTANTIATE_CODE", "R[1] = 20; R[2] = 100;")]);
    for placement in PLACEMENTS {
        let (said, without) = sums(folder.path(), "", "", placement);
        assert_eq!(without, [3122.5; 5], "{placement:?}");
        let warning = "0 s  a  warning  its library and its modelDescription.xml differ in start values: \
                       u is 0, declared 2.5; mode is 0, declared 3";
        assert!(said.err.contains(warning), "{placement:?}: {}", said.err);
        let (_, with) = sums(folder.path(), "", "at 200 ms { set a.u = 7\n set a.mode = 4 }", placement);
        assert_eq!(with, [3122.5, 3122.5, 3122.5, 4127.0, 4127.0], "an event changes nothing before it");
    }
    let said = run(folder.path(), &["simulate", "a.fmu", "--stop", "1"]);
    assert!(said.code == Some(0) && said.err.contains("u is 0, declared 2.5"), "{}", said.err);
    let trace = fs::read_to_string(folder.path().join("runs/a-alone/trace.csv")).unwrap();
    assert!(trace.lines().nth(1).is_some_and(|row| row == "0,3122.5,2.5,3"), "{trace}");
}

#[test]
fn a_parameter_keeps_the_value_of_its_library_until_it_is_set() {
    let folder = unit(VARIABLES, &[("INSTANTIATE_CODE", "R[0] = 2.5; R[1] = 30; R[2] = 100; I[0] = 3;")]);
    for placement in PLACEMENTS {
        let (said, without) = sums(folder.path(), "", "", placement);
        assert!(said.err.contains("differ in start values: gain is 30, declared 20"), "{}", said.err);
        assert_eq!(without, [3132.5; 5], "{placement:?}");
        let event = "at 200 ms lasting 100 ms { set a.gain = 0 }";
        let (_, with) = sums(folder.path(), "", event, placement);
        assert_eq!(with, [3132.5, 3132.5, 3132.5, 3102.5, 3132.5], "before and after the window: {placement:?}");
    }
}

#[test]
fn an_input_without_start_value_keeps_what_its_library_has() {
    let variables = VARIABLES.replace(r#"<Real start="2.5"/>"#, "<Real/>");
    let folder = unit(&variables, &[("INSTANTIATE_CODE", AGREES)]);
    for placement in PLACEMENTS {
        let (_, with) = sums(folder.path(), "", "at 200 ms lasting 100 ms { set a.u = 0 }", placement);
        assert_eq!(with, [3122.5, 3122.5, 3122.5, 3120.0, 3122.5], "{placement:?}");
        let trace = fs::read_to_string(folder.path().join("runs/s/trace.csv")).unwrap();
        assert!(trace.lines().nth(1).is_some_and(|row| row == "0,3122.5,2.5"), "{trace}");
    }
}

#[test]
fn values_of_the_braces_are_set_again_in_initialization_mode() {
    let folder = unit(VARIABLES, &[("INSTANTIATE_CODE", AGREES), ("ENTER_CODE", "R[0] = 0; R[1] = 0; R[2] = 0;")]);
    for placement in PLACEMENTS {
        let (said, sums) = sums(folder.path(), "{ mass = 69 kg\n gain = 1\n u = 0.5 }", "", placement);
        assert_eq!(sums, [3070.5; 5], "{placement:?}");
        assert!(!said.err.contains("warning  "), "{}", said.err);
    }
    let set = ["simulate", "a.fmu", "--stop", "1", "--set", "mass = 69 kg", "--set", "gain = 1", "--set", "u = 0.5"];
    assert_eq!(run(folder.path(), &set).code, Some(0));
    let trace = fs::read_to_string(folder.path().join("runs/a-alone/trace.csv")).unwrap();
    assert!(trace.lines().nth(1).is_some_and(|row| row.starts_with("0,3070.5,")), "{trace}");
}

#[test]
fn a_unit_that_holds_another_value_than_the_one_set_is_warned_of() {
    let folder = unit(VARIABLES, &[("INSTANTIATE_CODE", AGREES), ("EXIT_CODE", "R[2] = 0; I[0] = 2;")]);
    for placement in PLACEMENTS {
        let (said, _) = sums(folder.path(), "{ mass = 69 kg\n gain = 1 }", "", placement);
        let warning = "0 s  a  warning  it does not hold the start values that were set: \
                       mass is 0 kg, was set to 69 kg; mode is 2, was set to 3\n";
        assert!(said.err.contains(warning), "{placement:?}: {}", said.err);
    }
}

#[test]
fn a_connected_input_is_not_compared_with_its_start_value() {
    let folder = unit(VARIABLES, &[("INSTANTIATE_CODE", AGREES)]);
    for placement in PLACEMENTS {
        let (said, sums) = sums(folder.path(), "{ u = 8 }", "time / 1 s -> a.u", placement);
        assert!(!said.err.contains("warning  "), "{}", said.err);
        assert_eq!(sums[0], 3120.0);
    }
}

#[test]
fn a_unit_that_cannot_be_read_in_initialization_mode_runs_with_a_warning() {
    for status in ["DISCARD", "ERROR"] {
        let get = format!("R[3] = R[0]; if (MODE == 1) status = {status};");
        let code = [("INSTANTIATE_CODE", AGREES), ("GET_CODE", &get)];
        let unit = Generic { definitions: UNITS, variables: VARIABLES, code: &code, ..Generic::default() };
        let folder = unit.build("a");
        for placement in PLACEMENTS {
            let (said, sums) = sums(folder.path(), "", "", placement);
            assert_eq!(sums, [2.5; 5]);
            let warning = "0 s  a  warning  its start values cannot be compared: `a`: fmi2GetReal returned ";
            assert!(said.err.contains(warning), "{}", said.err);
        }
    }
}

#[test]
fn a_fatal_read_of_start_values_ends_the_run() {
    let code = [("GET_CODE", "status = FATAL;")];
    let folder = Generic { definitions: UNITS, variables: VARIABLES, code: &code, ..Generic::default() }.build("a");
    fs::write(folder.path().join("s.scn"), "scenario \"s\"\nstep 100 ms\nstop 1 s\nfmu a = \"a.fmu\"\n").unwrap();
    for placement in PLACEMENTS {
        let said = run(folder.path(), &[&["run", "s.scn"], placement].concat());
        assert_eq!(said.code, Some(3), "{}", said.err);
        assert!(said.err.contains("`a`: fmi2GetReal returned fmi2Fatal"), "{}", said.err);
    }
}
