//! `lockstep check` and `lockstep simulate` as a user starts them, on the foreign unit in C.
#![allow(clippy::unwrap_used, reason = "a test ends where something is not as it should be")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use tests::foreign::Foreign;

/// Exit code, standard output and standard error of a `lockstep` started in `folder`.
fn lockstep(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lockstep"));
    let output = command.args(arguments).current_dir(folder).stdin(Stdio::null()).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// The rows of a trace and its header.
fn trace(path: &Path) -> (String, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let rows = rows.lines().map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect());
    (header.to_owned(), rows.collect())
}

const SCRIPT: &str = "\
scenario \"One foreign unit\"
step 100 ms
stop 1 s
fmu tank = \"foreign.fmu\" { enabled = false }
1 -> tank.u
assert rises: eventually tank.y > 0.5
";

#[test]
fn check_tells_scripts_and_units_apart_and_its_exit_code_counts_all_files() {
    let (folder, _) = Foreign::default().build();
    fs::write(folder.path().join("good.scn"), SCRIPT).unwrap();
    fs::write(folder.path().join("bad.scn"), SCRIPT.replace("tank.u", "tank.v").replace("stop 1 s", "stop 1 m"))
        .unwrap();
    let (code, told, _) = lockstep(folder.path(), &["check", "good.scn", "foreign.fmu"]);
    assert!(told.starts_with("good.scn: ok  1 unit, 1 connection, 1 claim"), "{told}");
    assert!(told.contains("\nforeign.fmu: ok  foreign, 6 variables"), "{told}");
    assert_eq!(code, Some(0), "{told}");
    let (code, told, _) = lockstep(folder.path(), &["check", "bad.scn", "good.scn"]);
    assert!(told.contains("bad.scn: 2 errors\n") && told.contains("good.scn: ok"), "{told}");
    assert_eq!(code, Some(2));
    let (code, told, error) = lockstep(folder.path(), &["check", "none.scn", "good.scn"]);
    assert!(error.contains("none.scn: No such file") && told.contains("good.scn: ok"), "{told}{error}");
    assert_eq!(code, Some(2));
}

#[test]
fn check_shows_the_plan_when_asked_and_counts_warnings_when_strict() {
    let (folder, _) = Foreign { description: &[("<Real start=\"0\"/>", "<Real/>")], ..Foreign::default() }.build();
    let script = SCRIPT.replace("1 -> tank.u\n", "");
    fs::write(folder.path().join("loose.scn"), script).unwrap();
    let (code, told, _) = lockstep(folder.path(), &["check", "loose.scn"]);
    assert!(code == Some(0) && told.contains("warning[W02]") && told.contains("(1 warning)"), "{told}");
    assert_eq!(lockstep(folder.path(), &["check", "loose.scn", "--strict"]).0, Some(2));
    let (_, told, _) = lockstep(folder.path(), &["check", "loose.scn", "-v"]);
    assert!(told.contains("wave 0  tank  \"foreign.fmu\"  every 100 ms"), "{told}");
    let (code, told, _) = lockstep(folder.path(), &["check", "foreign.fmu"]);
    assert!(code == Some(2) && told.contains("foreign.fmu/modelDescription.xml:12:5: error[2.2.7]: `u`"), "{told}");
}

#[test]
fn a_unit_alone_follows_its_table_and_its_settings() {
    let (folder, _) = Foreign::default().build();
    fs::write(folder.path().join("in.csv"), "time,u,enabled\n0,1,0\n0.5,2,1\n").unwrap();
    let arguments = ["simulate", "foreign.fmu", "--set", "gain = 3", "--input", "in.csv", "--output", "out.csv"];
    let (code, told, error) = lockstep(folder.path(), &arguments);
    assert_eq!(code, Some(0), "{error}");
    assert!(told.starts_with("foreign.fmu  1 s in ") && told.contains("runs/foreign-alone"), "{told}");
    let (header, rows) = trace(&folder.path().join("out.csv"));
    assert_eq!(header, "time,y,count,u,enabled");
    let mut y = 0.0;
    for (tick, row) in (0..).zip(&rows) {
        let time_s = f64::from(tick) / 10.0;
        let weight = (0.5 - time_s) / 0.5;
        let u = if time_s < 0.5 { weight * 1.0 + (1.0 - weight) * 2.0 } else { 2.0 };
        let held = if time_s < 0.5 { 0.0 } else { 1.0 };
        // Nothing acts any more at the last point: its row repeats the inputs of the one before.
        let last = [time_s, y, f64::from(tick), rows[9][3], rows[9][4]];
        let expected = if tick < 10 { [time_s, y, f64::from(tick), u, held] } else { last };
        assert_eq!(row.as_slice(), expected, "at tick {tick}");
        y += 0.1 * (3.0 * u - y);
    }
    assert_eq!(rows.len(), 11);
}

#[test]
fn a_unit_that_crashes_alone_is_named_and_its_rows_are_kept() {
    let defines = ["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=CRASH", "MISBEHAVE_FROM_S=0.45"];
    let (folder, _) = Foreign { defines: &defines, ..Foreign::default() }.build();
    let (code, _, error) = lockstep(folder.path(), &["simulate", "foreign.fmu", "--out", "here"]);
    assert_eq!(code, Some(3), "{error}");
    assert!(error.contains("`foreign` died of signal 11 (SIGSEGV) in fmi2DoStep at 0.5 s"), "{error}");
    assert_eq!(trace(&folder.path().join("here/trace.csv")).1.len(), 5);
}

#[test]
fn what_is_wrong_before_the_first_step_is_usage_and_leaves_no_folder() {
    let (folder, _) = Foreign::default().build();
    fs::write(folder.path().join("in.csv"), "time,v\n0,1\n").unwrap();
    let wrong = [
        (vec!["--input", "in.csv"], "error: in.csv:1:6: the unit has no variable `v`"),
        (vec!["--input", "none.csv"], "error: cannot read none.csv: No such file"),
        (vec!["--set", "y2 = 1"], "`foreign` has no variable `y2`"),
        (vec!["--step", "100ms", "--stop", "0.25s"], "--stop"),
        (vec!["--stop", "soon"], "expected a time such as 10s"),
    ];
    for (arguments, words) in wrong {
        let (code, _, error) = lockstep(folder.path(), &[&["simulate", "foreign.fmu"], arguments.as_slice()].concat());
        assert!(code == Some(2) && error.contains(words), "{error}");
    }
    assert!(!folder.path().join("runs").exists());
}
