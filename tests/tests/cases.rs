//! `--case`: one case of a script's sweep, as a user runs and replays it; and a tolerance of time in a claim.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::{Generic, STATES};
use tests::program::{PLACEMENTS, run};

const SCRIPT: &str = "scenario \"Cases\"
step 100 ms
stop 1 s
param gain = 1
param push = 0
fmu ramp = \"ramp.fmu\" { gain = gain, push = push }
assert slow: always ramp.y < 25
record ramp.y
sweep {
  gain in [2, 3]
  seed in 1..3
  push ~ uniform(-1, 1)
}
";

/// A unit that counts its steps, times `gain`, plus `push`.
fn ramp(script: &str) -> TempDir {
    let variable = |name: &str, reference: u32, rest: &str| {
        format!("<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" {rest}</ScalarVariable>")
    };
    let parameter = "causality=\"parameter\" variability=\"fixed\"><Real start=\"0\"/>";
    let output = "causality=\"output\"><Real/>";
    let variables = [variable("gain", 0, parameter), variable("push", 1, parameter), variable("y", 2, output)].concat();
    let code = [("STEP_CODE", "R[2] = R[0] * STEPS + R[1];"), ("WITH_STATES", "1")];
    let folder =
        Generic { variables: &variables, capabilities: STATES, code: &code, ..Generic::default() }.build("ramp");
    fs::write(folder.path().join("a.scn"), script).unwrap();
    folder
}

fn read(folder: &Path, file: &str) -> String {
    fs::read_to_string(folder.join("runs/a").join(file)).unwrap()
}

fn last_value(folder: &Path) -> f64 {
    read(folder, "trace.csv").lines().last().unwrap().split(',').nth(1).unwrap().parse().unwrap()
}

#[test]
fn a_case_gives_parameters_their_values_in_both_placements_and_its_line_replays_it() {
    let folder = ramp(SCRIPT);
    let home = folder.path();
    let said = run(home, &["run", "a.scn"]);
    assert_eq!((said.code, last_value(home)), (Some(0), 10.0), "{}{}", said.out, said.err);
    assert!(!read(home, "verdict.json").contains("case"), "this was none");
    let mut traces = Vec::new();
    for placement in PLACEMENTS {
        let said = run(home, &[&["run", "a.scn", "--case", "4"][..], placement].concat());
        assert_eq!(said.code, Some(1), "{}{}", said.out, said.err);
        assert!(said.out.starts_with("a.scn  1 s in ") && said.out.contains("seed 2, gain 3, push "), "{}", said.out);
        assert!(said.out.contains("\n1 of 1 claims failed.  lockstep run a.scn --case 4 replays it\n"), "{}", said.out);
        traces.push((read(home, "trace.csv"), read(home, "verdict.json")));
    }
    assert!(traces[0] == traces[1]);
    let drawn = last_value(home) - 30.0;
    assert!(drawn.abs() <= 1.0 && drawn != 0.0, "{drawn}");
    let verdict: serde_json::Value = serde_json::from_str(&traces[0].1).unwrap();
    assert_eq!(verdict["case"], serde_json::json!({ "number": 4 }));
    let said = run(home, &["run", "a.scn", "--case", "4", "--set", "seed = 9"]);
    assert!(said.out.contains("run a.scn --case 4 --set 'seed = 9' replays it\n"), "{}", said.out);
    assert_ne!(last_value(home) - 30.0, drawn, "other draws");
    assert!(said.out.contains("seed 2, gain 3"), "{}", said.out);
}

#[test]
fn a_run_continues_in_its_own_case_only() {
    let folder = ramp(SCRIPT);
    let home = folder.path();
    let saved = run(home, &["run", "a.scn", "--case", "4", "--save-at", "500ms", "half"]);
    assert_eq!(saved.code, Some(1), "{}{}", saved.out, saved.err);
    let whole = read(home, "trace.csv");
    assert_eq!(run(home, &["run", "a.scn", "--case", "4", "--from", "half"]).code, Some(1));
    assert!(read(home, "trace.csv").lines().skip(1).eq(whole.lines().skip(1 + 6)), "the rows behind 0.5 s");
    let said = run(home, &["run", "a.scn", "--case", "5", "--from", "half"]);
    assert_eq!(said.code, Some(2), "{}{}", said.out, said.err);
    assert!(said.err.contains("push"), "{}", said.err);
    assert!(said.err.contains("continue with --case 4, or save anew"), "{}", said.err);
}

#[test]
fn check_counts_the_cases_and_checks_one() {
    let folder = ramp(SCRIPT);
    let said = run(folder.path(), &["check", "a.scn"]);
    assert!(said.out.ends_with("a.scn: ok  1 unit, 0 connections, 1 claim, 6 cases  (1 warning)\n"), "{}", said.out);
    assert!(said.out.starts_with("warning[W06]: `seed` is not used"), "{}", said.out);
    let wrong = SCRIPT.replace("stop 1 s", "param n = 1\nstop 10 s / n").replace("gain in [2, 3]", "n in [1, 3]");
    let folder = ramp(&wrong.replace("{ gain = gain,", "{ gain = gain * 1,"));
    assert_eq!(run(folder.path(), &["check", "a.scn"]).code, Some(0));
    let said = run(folder.path(), &["check", "a.scn", "--case", "5"]);
    assert_eq!(said.code, Some(2));
    assert!(said.out.contains("error[E08]"), "{}{}", said.out, said.err);
}

#[test]
fn a_late_signal_is_near_its_reference_within_a_tolerance_of_time() {
    // The ramp grows by 10 a second, its reference is 200 ms ahead.
    let script = "scenario \"Near\"\nstep 100 ms\nstop 1 s\nfmu ramp = \"ramp.fmu\" { gain = 1, push = 0 }\n\
                  let ahead = curve(\"ahead.csv\", \"y\")\n\
                  assert late: always ramp.y == ahead ± 0.5\n\
                  assert near: always ramp.y == ahead ± 0.5 within 150 ms\n\
                  assert same: always ahead == ramp.y ± 0.5 within 250 ms\n";
    let folder = ramp(script);
    fs::write(folder.path().join("ahead.csv"), "time,y\n0,2\n0.8,10\n").unwrap();
    for placement in PLACEMENTS {
        let said = run(folder.path(), &[&["run", "a.scn"][..], placement].concat());
        assert_eq!(said.code, Some(1), "{}{}", said.out, said.err);
        let verdict: serde_json::Value = serde_json::from_str(&read(folder.path(), "verdict.json")).unwrap();
        let of = |claim: usize| verdict["claims"][claim]["margin"].as_f64().unwrap();
        // At 0 s the curve is never below 2.
        assert!((0..3).all(|claim| (of(claim) - (0.5 - 2.0)).abs() < 1e-9), "{}", said.out);
    }
    let after = script.replace("always", "always after 300 ms");
    fs::write(folder.path().join("a.scn"), after).unwrap();
    let said = run(folder.path(), &["run", "a.scn"]);
    let verdict: serde_json::Value = serde_json::from_str(&read(folder.path(), "verdict.json")).unwrap();
    let margins: Vec<_> = (0..3).map(|claim| verdict["claims"][claim]["margin"].as_f64().unwrap()).collect();
    let expected = [0.5 - 2.0, 0.5 - 0.5, 0.5];
    assert!(
        margins.iter().zip(expected).all(|(is, expected)| (is - expected).abs() < 1e-9),
        "{margins:?} {}",
        said.out
    );
}

#[test]
fn a_time_in_milliseconds_is_that_of_its_tick_and_truth_is_held() {
    let script = "scenario \"Exact\"\nstep 100 ms\nstop 2 s\nfmu ramp = \"ramp.fmu\" { gain = 1, push = 0 }\n\
                  let up = curve(\"on.csv\", \"on\")\n\
                  assert late: always (time >= 0.7 s implies time >= 700 ms)\n\
                  assert lasts: finally duration(time < 0.3 s) <= 0.3 s\n\
                  assert steps: always (up < 0.1 or up > 0.9)\nrecord ramp.y, up\n";
    let folder = ramp(script);
    fs::write(folder.path().join("on.csv"), "time,on\n0,TRUE\n1,FALSE\n2,true\n").unwrap();
    let said = run(folder.path(), &["run", "a.scn"]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    let taken = run(folder.path(), &["run", "a.scn", "--save-at", "1s", "on.csv"]);
    assert_eq!(taken.code, Some(2));
    assert!(
        taken.err.starts_with("error: --save-at on.csv: this is no checkpoint, and would be lost"),
        "{}",
        taken.err
    );
}

#[test]
fn a_quantity_is_what_a_unit_gives_in_the_same_unit() {
    let variables =
        "<ScalarVariable name=\"y\" valueReference=\"0\" causality=\"output\"><Real unit=\"ms\"/></ScalarVariable>";
    let definitions =
        "<UnitDefinitions><Unit name=\"ms\"><BaseUnit s=\"1\" factor=\"0.001\"/></Unit></UnitDefinitions>";
    let unit = Generic { variables, definitions, code: &[("STEP_CODE", "R[0] = 1000 + STEPS;")], ..Generic::default() };
    let folder = unit.build("clock");
    let script = "scenario \"Same\"\nstep 100 ms\nstop 20 s\nfmu a = \"clock.fmu\"\n\
                  assert first: always within 100 ms a.y <= 1001 ms\nassert ends: finally a.y <= 1200 ms\n";
    fs::write(folder.path().join("a.scn"), script).unwrap();
    let said = run(folder.path(), &["run", "a.scn"]);
    assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
}
