//! `lockstep fmt` as users call it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::io::Write;
use std::process::Stdio;
use tests::program::{Said, command, names, run};

const SCRIPT: &str = "step   5 ms # why\nstop 3s\n";
const STYLED: &str = "step 5 ms  # why\nstop 3 s\n";

#[test]
fn a_script_is_formatted_in_place_and_nothing_else_is_left() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.scn"), SCRIPT).unwrap();
    let said = run(folder.path(), &["fmt", "a.scn"]);
    assert_eq!((said.code, said.out, said.err), (Some(0), String::new(), String::new()));
    assert_eq!(fs::read_to_string(folder.path().join("a.scn")).unwrap(), STYLED);
    assert_eq!(names(folder.path()), ["a.scn"]);
}

#[test]
fn a_check_names_what_has_another_style_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.scn"), SCRIPT).unwrap();
    fs::write(folder.path().join("b.scn"), STYLED).unwrap();
    let said = run(folder.path(), &["fmt", "--check", "a.scn", "b.scn"]);
    assert_eq!(said.code, Some(1));
    assert!(said.out.starts_with("a.scn: not formatted\n  line 1\n  - step   5 ms # why\n"), "{}", said.out);
    assert!(!said.out.contains("b.scn"), "{}", said.out);
    assert_eq!(fs::read_to_string(folder.path().join("a.scn")).unwrap(), SCRIPT);
    assert_eq!(run(folder.path(), &["fmt", "--check", "b.scn"]).code, Some(0));
}

#[test]
fn a_script_with_errors_is_left_as_it_is_and_the_others_are_formatted() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.scn"), "step  5\nlet a 3\n").unwrap();
    fs::write(folder.path().join("b.scn"), SCRIPT).unwrap();
    let said = run(folder.path(), &["fmt", "none.scn", "a.scn", "b.scn"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("cannot read none.scn") && said.err.contains("a.scn:2:7"), "{}", said.err);
    assert_eq!(fs::read_to_string(folder.path().join("a.scn")).unwrap(), "step  5\nlet a 3\n");
    assert_eq!(fs::read_to_string(folder.path().join("b.scn")).unwrap(), STYLED);
}

#[test]
fn standard_input_becomes_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let piped = |text: &str, arguments: &[&str]| {
        let mut program = command(folder.path(), arguments);
        program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = program.spawn().unwrap();
        child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
        Said::from(child.wait_with_output().unwrap())
    };
    let said = piped(SCRIPT, &["fmt", "-"]);
    assert_eq!((said.code, &*said.out), (Some(0), STYLED));
    assert_eq!(piped(STYLED, &["fmt", "-"]).out, STYLED);
    assert_eq!(piped(SCRIPT, &["fmt", "--check", "-"]).code, Some(1));
    let said = piped("let a 3\n", &["fmt", "-"]);
    assert_eq!((said.code, &*said.out), (Some(2), ""));
    assert!(said.err.contains("standard input:1:7"), "{}", said.err);
}
