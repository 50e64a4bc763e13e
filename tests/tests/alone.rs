//! A unit alone: what `simulate` records, in which formats, and where it says that its command line is wrong.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use tempfile::TempDir;
use tests::foreign::Generic;
use tests::program::{Said, names, run};

const VARIABLES: &str = r#"
<ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
<ScalarVariable name="gain" valueReference="1" causality="parameter" variability="tunable"><Real start="2"/></ScalarVariable>
<ScalarVariable name="mass" valueReference="2" causality="parameter" variability="fixed"><Real unit="kg" start="3"/></ScalarVariable>
<ScalarVariable name="x[1]" valueReference="3" causality="local" initial="exact"><Real start="0"/></ScalarVariable>
<ScalarVariable name="x[2]" valueReference="4" causality="local" initial="exact"><Real start="0"/></ScalarVariable>
<ScalarVariable name="label" valueReference="0" causality="local" variability="discrete" initial="exact"><String start="a"/></ScalarVariable>
<ScalarVariable name="y" valueReference="5" causality="output" initial="exact"><Real start="0"/></ScalarVariable>"#;

const UNITS: &str = "<UnitDefinitions><Unit name=\"kg\"><BaseUnit kg=\"1\"/></Unit></UnitDefinitions>";

fn with_unit(variables: &str) -> TempDir {
    let step = ("STEP_CODE", "R[5] = R[1] * R[0]; R[3] = R[5] + 1; R[4] = R[2];");
    let code = [("INSTANTIATE_CODE", "R[1] = 2; R[2] = 3;"), step];
    Generic { variables, definitions: UNITS, code: &code, ..Generic::default() }.build("plant")
}

fn simulate(folder: &TempDir, arguments: &[&str]) -> Said {
    let common = ["simulate", "plant.fmu", "--stop", "1s", "--step", "500ms", "--out", "out"];
    run(folder.path(), &[&common, arguments].concat())
}

fn trace(folder: &TempDir, arguments: &[&str]) -> String {
    let said = simulate(folder, arguments);
    assert_eq!(said.code, Some(0), "{}", said.err);
    fs::read_to_string(folder.path().join("out/trace.csv")).unwrap()
}

#[test]
fn variables_of_any_causality_are_recorded_by_name_and_pattern() {
    let folder = with_unit(VARIABLES);
    assert_eq!(trace(&folder, &["--set", "u = 1"]), "time,y,u\n0,0,1\n0.5,2,1\n1,2,1\n");
    assert_eq!(
        trace(&folder, &["--set", "u = 1", "--set", "mass = 4 kg", "--record", "mass,x[*],gain", "--record", "y"]),
        "time,mass,x[1],x[2],gain,y\n0,4,0,0,2,0\n0.5,4,3,4,2,2\n1,4,3,4,2,2\n"
    );
    assert_eq!(trace(&folder, &["--record", "x"]).lines().next(), Some("time,x[1],x[2]"));
    let all = simulate(&folder, &["--record", "all"]);
    assert!(all.err.contains("note: 1 String is not recorded: a trace holds numbers"), "{}", all.err);
    for (name, words) in [
        ("masss", "error: --record masss: the unit has no such variable\nhelp: did you mean `mass`?"),
        ("z*", "error: --record z*: no variable fits this pattern\n"),
        ("label", "error: --record label: only Strings have this name, and a trace holds numbers\n"),
    ] {
        let wrong = simulate(&folder, &["--record", name]);
        assert!(wrong.code == Some(2) && wrong.err.contains(words), "{}", wrong.err);
    }
}

#[test]
fn a_parameter_that_the_input_drives_is_recorded_as_it_acts() {
    let folder = with_unit(VARIABLES);
    fs::write(folder.path().join("in.csv"), "time,u,gain\n0,1,2\n0.5,1,5\n").unwrap();
    assert_eq!(trace(&folder, &["--input", "in.csv"]), "time,y,u,gain\n0,0,1,2\n0.5,2,1,5\n1,5,1,5\n");
}

#[test]
fn a_unit_without_inputs_and_outputs_leaves_its_local_variables() {
    let inner: Vec<_> = VARIABLES.lines().filter(|line| !line.contains("put\"")).collect();
    let folder = with_unit(&inner.join("\n"));
    assert_eq!(trace(&folder, &[]), "time,x[1],x[2]\n0,0,0\n0.5,1,3\n1,1,3\n");
    let said = simulate(&folder, &[]);
    let note = "note: the unit has no inputs and outputs that are numbers: its 2 local variables are recorded\n";
    assert!(said.err.contains(note), "{}", said.err);
    let parameters: Vec<_> = inner.into_iter().filter(|line| !line.contains("local")).collect();
    let folder = with_unit(&parameters.join("\n"));
    assert_eq!(trace(&folder, &[]), "time,gain,mass\n0,2,3\n0.5,2,3\n1,2,3\n");
}

#[test]
fn formats_are_chosen_and_options_that_contradict_each_other_are_refused() {
    let folder = with_unit(VARIABLES);
    let out = folder.path().join("out");
    let of = |arguments: &[&str]| {
        let said = simulate(&folder, arguments);
        assert_eq!(said.code, Some(0), "{}", said.err);
        names(&out)
    };
    assert_eq!(of(&["--format", "parquet"]), ["run.json", "signals.json", "trace.parquet", "verdict.json"]);
    assert_eq!(run(folder.path(), &["plot", "out"]).code, Some(0), "without text, columns are drawn");
    assert_eq!(of(&["--format", "csv"]), ["run.json", "signals.json", "trace.csv", "verdict.json"]);
    let all = ["run.json", "signals.json", "trace.csv", "trace.parquet", "verdict.json"];
    assert_eq!(of(&["--format", "parquet,csv"]), all);
    assert_eq!(of(&["--record", "none"]), ["run.json", "verdict.json"]);
    for arguments in [
        ["--record", "none", "--format", "csv"],
        ["--record", "none", "--output", "a.csv"],
        ["--format", "parquet", "--output", "a.csv"],
    ] {
        let said = simulate(&folder, &arguments);
        assert!(said.code == Some(2) && said.err.contains("help: leave one of them out"), "{}", said.err);
    }
    let said = simulate(&folder, &["--format", "mcap"]);
    assert!(said.code == Some(2) && said.err.contains("`mcap` is no format of traces"), "{}", said.err);
    let script = "scenario \"Plant\"\nstep 1 s\nstop 2 s\nfmu p = \"plant.fmu\" { u = 1 }\nrecord p.y\n";
    fs::write(folder.path().join("p.scn"), script).unwrap();
    let ran = run(folder.path(), &["run", "p.scn", "--format", "parquet"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert_eq!(names(&folder.path().join("runs/p")), ["run.json", "signals.json", "trace.parquet", "verdict.json"]);
    let both = run(folder.path(), &["run", "p.scn", "--format", "csv", "--record", "none"]);
    assert!(both.code == Some(2) && both.err.contains("cannot be used with"), "{}", both.err);
}

#[test]
fn what_is_wrong_with_a_setting_is_said_at_its_place_in_the_command_line() {
    let folder = with_unit(VARIABLES);
    for (setting, message, line) in [
        ("mas = 2", "error[E01]: `plant` has no variable `mas`", "1 | mas = 2"),
        ("mass = 2 m", "error[E02]: cannot set a mass to a length", "1 | mass = 2 m"),
        ("mass = 2 kg } fmu x", "error[E00]: ", "1 | mass = 2 kg } fmu x"),
        ("mass", "error[E00]: ", "1 | mass"),
        ("mass = ", "error[E00]: ", "1 | mass ="),
    ] {
        let said = simulate(&folder, &["--set", setting]);
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert!(
            said.err.contains(message) && said.err.contains("--> --set:1:") && said.err.contains(line),
            "{}",
            said.err
        );
        for inner in ["simulate:", "fmu unit", "scenario", "braces"] {
            assert!(!said.err.contains(inner), "{inner}: {}", said.err);
        }
    }
}
