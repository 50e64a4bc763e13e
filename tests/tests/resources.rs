//! A system that gives too little, and files that are something else than expected: one clear error and exit code 2 or 3.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;
use tests::flight::Flight;
use tests::foreign::{Generic, OUTPUT};
use tests::program::{Said, command, lockstep};

const SCRIPT: &str =
    "scenario \"Two units\"\nstep 100 ms\nstop 1 s\nfmu a = \"a.fmu\"\nfmu b = \"a.fmu\"\nrecord a.y, b.y\n";

/// A folder with a unit and a script.
fn folder_with_unit() -> TempDir {
    let folder = Generic { variables: OUTPUT, ..Generic::default() }.build("a");
    fs::write(folder.path().join("a.scn"), SCRIPT).unwrap();
    folder
}

/// Runs the script after a line of a shell that may mount; `None` if the line fails.
fn after(folder: &Path, line: &str, arguments: &str) -> Option<Said> {
    let mut shell = Command::new(if line.starts_with("mount") { "unshare" } else { "env" });
    shell.args(if line.starts_with("mount") { &["-m"][..] } else { &[] });
    let line = format!("{line} || exit 99; exec \"$0\" run a.scn {arguments}");
    shell.args(["sh", "-c", &line]).arg(lockstep()).current_dir(folder).env_remove("RUST_BACKTRACE");
    let said = Flight::of(shell).end();
    (said.code != Some(99) && !said.err.starts_with("unshare: ")).then_some(said)
}

/// One error, with or without a line of help, unless all went well.
fn assert_clear(said: &Said, case: &str) {
    let errors = said.err.lines().filter(|line| line.starts_with("error: ")).count();
    let rest =
        said.err.lines().filter(|line| ["error: ", "help: ", "live: "].iter().all(|begin| !line.starts_with(begin)));
    let others: Vec<_> = rest.filter(|line| !line.contains(" %  ")).collect();
    let expected = match said.code {
        Some(0) => errors == 0,
        Some(2 | 3) => errors == 1,
        _ => false,
    };
    assert!(expected && others.is_empty(), "{case}: {:?}\n{}", said.code, said.err);
}

#[test]
fn few_file_descriptors_are_one_error() {
    let folder = folder_with_unit();
    for option in ["", "--isolate", "--live"] {
        for limit in (6..=48).step_by(6) {
            let said = after(folder.path(), &format!("ulimit -n {limit}"), option).unwrap();
            assert_clear(&said, &format!("{limit} descriptors {option}"));
        }
    }
    let said = after(folder.path(), "ulimit -n 24", "--isolate").unwrap();
    assert!(said.code == Some(3) && said.err.contains("raise the limit (ulimit -n)"), "{}", said.err);
    assert!(fs::read_to_string(folder.path().join("runs/a/run.json")).unwrap().contains("\"state\": \"broken\""));
    assert_eq!(after(folder.path(), "ulimit -n 64", "--isolate").unwrap().code, Some(0));
}

#[test]
fn little_address_space_is_one_error() {
    let folder = folder_with_unit();
    for option in ["", "--isolate", "--live"] {
        for limit in [60, 160, 300, 1000] {
            let said = after(folder.path(), &format!("ulimit -v {limit}000"), option).unwrap();
            assert_clear(&said, &format!("{limit} MB of address space {option}"));
        }
    }
    let said = after(folder.path(), "ulimit -v 60000", "").unwrap();
    assert!(said.code == Some(2) && said.err.contains("raise the limit (ulimit -v)"), "{}", said.err);
}

/// The limit counts all that a user runs, and not for root: the test needs root, to run the program as a user without others.
#[test]
fn few_processes_are_one_error() {
    const USER: &str = "64321";
    let folder = folder_with_unit();
    if fs::metadata(folder.path()).unwrap().uid() != 0 {
        return;
    }
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o1777)).unwrap();
    fs::copy(lockstep(), folder.path().join("lockstep")).unwrap();
    for option in ["", "--isolate", "--live"] {
        let mut codes = BTreeSet::new();
        for limit in (1..=45).step_by(4) {
            let (user, limited) = (format!("--reuid={USER}"), format!("--nproc={limit}"));
            let mut shell = Command::new("setpriv");
            shell.args([&user, "--clear-groups", "prlimit", &limited, "env", "TMPDIR=.", "./lockstep", "run", "a.scn"]);
            shell.args(option.split_whitespace());
            shell.current_dir(folder.path()).env_remove("RUST_BACKTRACE");
            let said = Flight::of(shell).end();
            assert_clear(&said, &format!("{limit} processes {option}"));
            assert!(said.code == Some(0) || said.err.contains("(ulimit -u)"), "{}", said.err);
            codes.insert(said.code);
        }
        assert!(codes.contains(&Some(0)) && codes.len() > 1, "{option}: {codes:?}");
    }
}

#[test]
fn a_folder_for_temporary_files_whose_name_has_a_line_break_is_one_line() {
    let folder = folder_with_unit();
    let temporary = folder.path().join("a\nb");
    fs::create_dir(&temporary).unwrap();
    let run =
        |arguments: &[&str]| Said::from(command(folder.path(), arguments).env("TMPDIR", &temporary).output().unwrap());
    let said = run(&["run", "a.scn"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let said = run(&["run", "a.scn", "--isolate"]);
    assert!(said.code == Some(3) && said.err.lines().count() == 1 && said.err.contains("set TMPDIR"), "{}", said.err);
    assert_eq!(fs::read_dir(&temporary).unwrap().count(), 0);
}

#[test]
fn no_room_in_the_folder_for_temporary_files_is_one_error() {
    let folder = folder_with_unit();
    fs::create_dir(folder.path().join("small")).unwrap();
    for (kilobytes, code) in [(4, 2), (500, 3)] {
        for option in ["", "--isolate"] {
            let line = format!("mount -t tmpfs -o size={kilobytes}k tmpfs small && export TMPDIR=$PWD/small");
            // Without the right to mount there is nothing to test.
            let Some(said) = after(folder.path(), &line, option) else { return };
            assert_clear(&said, &line);
            assert_eq!(said.code, Some(code), "{}", said.err);
            assert!(said.err.contains("No space left on device"), "{}", said.err);
        }
    }
}

#[test]
fn a_file_system_from_which_no_library_can_be_loaded_is_named() {
    let folder = folder_with_unit();
    fs::create_dir(folder.path().join("closed")).unwrap();
    let line = "mount -t tmpfs -o noexec tmpfs closed && export TMPDIR=$PWD/closed";
    for option in ["", "--isolate"] {
        let Some(said) = after(folder.path(), line, option) else { return };
        assert_eq!(said.code, Some(2), "{}", said.err);
        assert!(said.err.contains("closed: its file system is mounted noexec\nhelp: set TMPDIR"), "{}", said.err);
    }
}

#[test]
fn a_pipe_is_neither_a_record_of_a_run_nor_a_unit() {
    let folder = folder_with_unit();
    fs::create_dir_all(folder.path().join("foreign")).unwrap();
    fs::write(folder.path().join("foreign/trace.csv"), "numbers").unwrap();
    for pipe in ["foreign/run.json", "pipe.fmu"] {
        assert!(Command::new("mkfifo").arg(folder.path().join(pipe)).status().unwrap().success());
    }
    let said = Flight::start(folder.path(), &["run", "a.scn", "--out", "foreign"]).end();
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert!(said.err.contains("foreign is not empty and holds no run.json of ours"), "{}", said.err);
    fs::remove_file(folder.path().join("foreign/run.json")).unwrap();
    fs::write(folder.path().join("foreign/run.json"), "").unwrap();
    assert_eq!(Flight::start(folder.path(), &["run", "a.scn", "--out", "foreign"]).end().code, Some(2));
    assert_eq!(fs::read_to_string(folder.path().join("foreign/trace.csv")).unwrap(), "numbers");
    for command in ["check", "describe", "simulate"] {
        assert_eq!(Flight::start(folder.path(), &[command, "pipe.fmu"]).end().code, Some(2), "{command}");
    }
}
