//! Paths that are not UTF-8 in every command, and the lines to paste that name them; colours that the user refuses.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tests::foreign::Generic;
use tests::program::{Said, lockstep};

const SCRIPT: &str = "scenario \"A file\"\nstep 10 ms\nstop 100 ms\nfmu a = \"reader.fmu\" { table = file(\"table.csv\") }\n\
    assert reads: always after 20 ms a.y > 0.5\nrecord a.y\n";

/// A unit whose output is 1 if it can open the file that its parameter names.
fn reader(folder: &Path) -> PathBuf {
    let unit = Generic {
        variables: "<ScalarVariable name=\"y\" valueReference=\"0\" causality=\"output\"><Real/></ScalarVariable>\
            <ScalarVariable name=\"table\" valueReference=\"0\" causality=\"parameter\" variability=\"fixed\">\
            <String start=\"\"/></ScalarVariable>",
        code: &[
            ("STEP_CODE", "FILE *f = fopen(S[0], \"r\"); R[0] = f != 0; if (f) fclose(f);"),
            ("INCLUDES", "<stdio.h>"),
        ],
        ..Generic::default()
    };
    unit.pack(folder, "reader")
}

fn run(folder: &Path, arguments: &[&OsStr]) -> Said {
    Command::new(lockstep()).args(arguments).current_dir(folder).stdin(Stdio::null()).output().unwrap().into()
}

#[test]
fn a_path_that_is_not_utf_8_works_in_every_command() {
    let home = tempfile::tempdir().unwrap();
    let odd = OsStr::from_bytes(b"b\xe4d 'n");
    let folder = home.path().join(odd);
    fs::create_dir(&folder).unwrap();
    let unit = reader(&folder);
    let odd_unit = folder.join(OsStr::from_bytes(b"\xe4.fmu"));
    fs::copy(&unit, &odd_unit).unwrap();
    fs::write(folder.join("table.csv"), "").unwrap();
    let script = folder.join(OsStr::from_bytes(b"\xe4.scn"));
    fs::write(&script, SCRIPT).unwrap();
    let (first, second) = (folder.join(OsStr::from_bytes(b"\xe41")), folder.join(OsStr::from_bytes(b"\xe42")));
    let text = OsStr::new;
    let path = Path::as_os_str;
    for arguments in [
        vec![text("check"), path(&script), path(&unit), path(&odd_unit)],
        vec![text("run"), path(&script), text("--out"), path(&first)],
        vec![text("run"), path(&script), text("--isolate"), text("--out"), path(&second)],
        vec![text("plot"), path(&first)],
        vec![text("diff"), path(&first), path(&second)],
        vec![text("simulate"), path(&unit), text("--out"), path(&second)],
        vec![text("simulate"), path(&odd_unit), text("--units"), path(&folder)],
        vec![text("describe"), path(&unit)],
        vec![text("describe"), path(&odd_unit)],
        vec![text("describe"), text("--units"), path(&folder)],
    ] {
        let said = run(home.path(), &arguments);
        assert_eq!(said.code, Some(0), "{arguments:?} {}{}", said.out, said.err);
    }
    assert!(first.join("plot.svg").is_file());
    let described = run(home.path(), &[text("describe"), path(&unit)]).out;
    assert!(described.ends_with("\nto paste into a script beside it\n  fmu reader = \"reader.fmu\"\n"), "{described}");
    let described = run(home.path(), &[text("describe"), path(&odd_unit)]).out;
    assert!(described.ends_with("\na script cannot name this file; rename it\n"), "{described}");
}

#[test]
fn the_lines_to_paste_name_the_right_folder() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join(OsStr::from_bytes(b"b\xe4d 'n\n"));
    fs::create_dir(&folder).unwrap();
    reader(&folder);
    fs::write(folder.join("table.csv"), "").unwrap();
    let script = folder.join("a.scn");
    fs::write(&script, SCRIPT.replace("> 0.5", "> 2")).unwrap();
    let out = folder.join(OsStr::from_bytes(b"\xe4"));
    let arguments = [OsStr::new("run"), script.as_os_str(), OsStr::new("--out"), out.as_os_str()];
    let said = run(home.path(), &arguments);
    assert_eq!(said.code, Some(1), "{}", said.err);
    // The program was started by its path, and the lines name it so.
    let pasted =
        |line: &str| Said::from(Command::new("bash").args(["-c", line]).current_dir(home.path()).output().unwrap());
    let begins = |command: &str| format!("  {} {command} ", lockstep().display());
    let plot = said.out.lines().find(|line| line.starts_with(&begins("plot"))).unwrap();
    assert_eq!(pasted(plot).code, Some(0), "{plot}");
    assert!(out.join("plot.svg").is_file());
    let diff = said.out.lines().find(|line| line.starts_with(&begins("diff"))).unwrap();
    assert_eq!(pasted(&diff.replace("OTHER", &plot[begins("plot").len()..])).code, Some(0), "{diff}");
    let replay = said.out.lines().find_map(|line| line.strip_suffix(" replays it")).unwrap();
    let again = pasted(replay.split_once("  ").unwrap().1);
    assert_eq!(again.code, Some(1), "{replay} {}", again.err);
}

#[test]
fn colours_need_a_terminal_that_has_them_and_a_user_who_wants_them() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.scn"), "step\n").unwrap();
    let colours = |variables: &[(&str, &str)], command: &str| {
        let command = format!("{} {command} a.scn", lockstep().to_str().unwrap());
        let mut terminal = Command::new("script");
        terminal.args(["-qec", &command, "/dev/null"]).current_dir(folder.path()).stdin(Stdio::null());
        terminal.env_remove("NO_COLOR").env("TERM", "xterm").envs(variables.iter().copied());
        let said = Said::from(terminal.output().unwrap());
        assert!(said.out.contains("error"), "{}{}", said.out, said.err);
        said.out.contains('\u{1b}')
    };
    for command in ["check", "run"] {
        assert!(colours(&[], command) && colours(&[("NO_COLOR", "")], command));
        assert!(!colours(&[("NO_COLOR", "1")], command) && !colours(&[("TERM", "dumb")], command));
    }
}

#[test]
fn units_are_found_in_the_folders_of_an_environment_variable_after_those_of_the_command_line() {
    let home = tempfile::tempdir().unwrap();
    for folder in ["first", "second"] {
        fs::create_dir(home.path().join(folder)).unwrap();
    }
    fs::write(home.path().join("table.csv"), "").unwrap();
    fs::write(home.path().join("a.scn"), SCRIPT.replace("reader.fmu", "reader")).unwrap();
    reader(&home.path().join("second"));
    let check = |folders: &str, arguments: &[&str]| {
        let mut command = tests::program::command(home.path(), &[&["check", "a.scn"][..], arguments].concat());
        Said::from(command.env("LOCKSTEP_UNITS", folders).output().unwrap())
    };
    let said = check("first::second", &[]);
    assert_eq!(
        (said.code, said.out.as_str()),
        (Some(0), "a.scn: ok  1 unit, 0 connections, 1 claim\n"),
        "{}",
        said.err
    );
    let said = check("first", &[]);
    assert!(said.out.contains("there is no unit `reader`"), "{}", said.out);
    let said = check("second:third", &[]);
    assert_eq!(said.code, Some(2));
    assert!(said.out.contains("LOCKSTEP_UNITS names third, which is no folder"), "{}", said.out);
    let mut describe = tests::program::command(home.path(), &["describe", "reader"]);
    let said = Said::from(describe.env("LOCKSTEP_UNITS", "second").output().unwrap());
    assert_eq!(said.code, Some(0), "{}", said.err);
    fs::write(home.path().join("first/reader.fmu"), "no archive").unwrap();
    let said = check("second", &["--units", "first"]);
    assert_eq!(said.code, Some(2), "{}: the folder of the command line comes first", said.out);
}
