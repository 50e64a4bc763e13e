//! What units and files say is printed so that it cannot be taken for a line of the program, and repetitions are counted.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::{Generic, OUTPUT};
use tests::program::{Said, run};

const SCRIPT: &str = "scenario \"A unit that says much\"\nstep 1 ms\nstop 1 s\nfmu a = \"talker.fmu\"\nrecord a.y\n";

fn talker(variables: &str, code: &str) -> TempDir {
    let folder = Generic { variables, code: &[("STEP_CODE", code)], ..Generic::default() }.build("talker");
    fs::write(folder.path().join("a.scn"), SCRIPT).unwrap();
    folder
}

/// The lines of standard error that are messages of units, equal in both placements.
fn said(folder: &Path) -> Vec<String> {
    let messages = |said: &Said| -> Vec<String> {
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.err.lines().filter(|line| !line.contains('%') || line.contains("  a  ")).map(str::to_owned).collect()
    };
    let together = messages(&run(folder, &["run", "a.scn"]));
    assert_eq!(messages(&run(folder, &["run", "a.scn", "--isolate"])), together);
    together
}

#[test]
fn a_message_that_a_unit_repeats_is_printed_once_and_counted() {
    let folder = talker(OUTPUT, "SAY(1, \"low battery\"); if (STEPS == 500) SAY(0, \"half\");");
    let expected = [
        "0 s  a  warning  low battery",
        "0.499 s  a  info  half",
        "0.999 s  a  warning  and 999 more like it until 0.999 s: low battery",
    ];
    assert_eq!(said(folder.path()), expected);
}

#[test]
fn a_message_of_a_unit_forges_no_line_and_commands_no_terminal() {
    let folder = talker(OUTPUT, "if (STEPS == 1) SAY(0, \"a\\nerror: forged\\r\\033[2J\\302\\233m\");");
    assert_eq!(said(folder.path()), ["0 s  a  info  a", "  | error: forged\u{fffd}\u{fffd}[2J\u{fffd}m"]);
}

#[test]
fn a_wide_field_among_the_arguments_of_a_message_does_not_delay_the_run() {
    let folder = talker(OUTPUT, "SAY(0, \"%*d|%.*f\", 2000000000, 1, 2000000000, 0.5);");
    let lines = said(folder.path());
    assert_eq!(lines[0], "0 s  a  info  %*d|%.*f (format refused: a width beyond a million)");
    assert_eq!(lines.len(), 2, "{lines:?}");
}

#[test]
fn a_name_in_a_description_forges_no_line_in_any_command() {
    let forging = OUTPUT.replace("\"y\"", "\"y&#10;error: forged&#x9b;m\" description=\"b&#10;error: forged\"");
    let input = forging.replace("\"y&", "\"u&").replace("=\"0\"", "=\"1\"").replace("output", "input");
    let folder = talker(&(forging + &input.replace("<Real/>", "<Real start=\"1\"/>")), "R[0] = T;");
    fs::copy(folder.path().join("talker.fmu"), folder.path().join("b\nerror: forged\u{1b}[2J.fmu")).unwrap();
    fs::write(folder.path().join("b\nerror: forged\u{1b}[2J.scn"), SCRIPT).unwrap();
    let check = |said: Said| {
        let text = said.out + &said.err;
        assert!(!text.lines().any(|line| line.starts_with("error: forged")), "{text}");
        assert!(!text.contains(|letter: char| letter.is_control() && letter != '\n'), "{text:?}");
    };
    let commands: [&[&str]; 17] = [
        &["describe", "talker.fmu"],
        &["describe", "b\nerror: forged\u{1b}[2J.fmu"],
        &["describe", "--units", "."],
        &["check", "talker.fmu"],
        &["check", "a.scn", "-v"],
        &["check", "b\nerror: forged\u{1b}[2J.scn"],
        &["check", "b\nerror: forged\u{1b}[2J.fmu"],
        &["run", "a.scn"],
        &["simulate", "talker.fmu", "--out", "runs/a"],
        &["run", "b\nerror: forged\u{1b}[2J.scn"],
        &["run", "none\nerror: forged\u{1b}[2J.scn"],
        &["simulate", "talker.fmu", "--out", "runs/b"],
        &["simulate", "b\nerror: forged\u{1b}[2J.fmu"],
        &["plot", "runs/a", "nothing"],
        &["plot", "runs/b\nerror: forged\u{1b}[2J"],
        &["diff", "runs/a", "runs/b"],
        &["diff", "runs/a", "runs/none\nerror: forged\u{1b}[2J"],
    ];
    for command in commands {
        check(run(folder.path(), command));
    }
    assert!(
        folder.path().join("runs/a/trace.parquet").is_file() && folder.path().join("runs/b/trace.parquet").is_file()
    );
}
