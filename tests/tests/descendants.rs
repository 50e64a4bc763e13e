//! Programs that units start end with the run, whatever group or session they are in.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;
use tests::flight::{Flight, is_alive, signal, until};
use tests::foreign::{Generic, OUTPUT};
use tests::program::{PLACEMENTS, command, lockstep};

const SCRIPT: &str = "scenario \"A unit starts programs\"\nstep 100 ms\nstop 1 s\nfmu a = \"a.fmu\"\nrecord a.y\n";
/// Starts programs that run for hours: one in the group of the process, one in a session of its own whose parent ends at
/// once, and one by a fork that keeps all files open. `ids` has the ids of the first two.
const STARTS: &str = r#"system("sleep 7777 & echo $! >> ids"); system("setsid sh -c 'sleep 7777 & echo $! >> ids'");
    if (!fork()) { setsid(); if (!fork()) { for (;;) pause(); } _exit(0); }"#;

/// A folder with a script and a unit that starts programs when it is instantiated.
fn folder_with_unit(step: &str) -> TempDir {
    let code = [("INSTANTIATE_CODE", STARTS), ("STEP_CODE", step)];
    let folder = Generic { variables: OUTPUT, code: &code, ..Generic::default() }.build("a");
    fs::write(folder.path().join("a.scn"), SCRIPT).unwrap();
    folder
}

/// The ids of the programs that the unit has started.
fn started(folder: &Path) -> Vec<u32> {
    let text = fs::read_to_string(folder.join("ids")).unwrap_or_default();
    text.lines().filter_map(|line| line.parse().ok()).collect()
}

fn assert_all_ended(folder: &Path, case: &str) {
    let ids = started(folder);
    assert_eq!(ids.len(), 2, "{case}: the unit started its programs");
    until(case, || !ids.iter().any(|&id| is_alive(id)));
    fs::remove_file(folder.join("ids")).unwrap();
}

#[test]
fn they_end_with_a_run_that_ends_well_or_breaks_and_hold_no_pipe_open() {
    for (step, code) in [("", 0), ("*(volatile int *)0 = 1;", 3), ("status = ERROR;", 3), ("_exit(0);", 3)] {
        let folder = folder_with_unit(step);
        for placement in PLACEMENTS {
            let mut run = command(folder.path(), &[&["run", "a.scn"], placement].concat());
            // Returns when the pipes have no writer left.
            let said = run.stdout(Stdio::piped()).stderr(Stdio::piped()).output().unwrap();
            assert_eq!(said.status.code(), Some(code), "{step} {placement:?}: {said:?}");
            assert_all_ended(folder.path(), &format!("{step} {placement:?}"));
        }
    }
}

#[test]
fn they_end_with_a_unit_that_hangs_and_with_a_run_that_is_interrupted_twice() {
    let folder = folder_with_unit("for (;;) pause();");
    for placement in PLACEMENTS {
        let arguments = [&["run", "a.scn", "--step-timeout", "300ms"], placement].concat();
        assert_eq!(command(folder.path(), &arguments).output().unwrap().status.code(), Some(3));
        assert_all_ended(folder.path(), "a call that hangs");
        let arguments = [&["run", "a.scn", "--step-timeout", "0"], placement].concat();
        let mut program = Flight::start(folder.path(), &arguments);
        until("the programs of the unit", || started(folder.path()).len() == 2);
        for _ in 0..2 {
            signal("TERM", program.id());
        }
        // Two signals that come at the same time may count as one.
        until("the second signal", || program.is_over() || (signal("INT", program.id()), false).1);
        assert_eq!(program.end().code, Some(130));
        assert_all_ended(folder.path(), "an interrupted run");
    }
}

#[test]
fn those_in_the_group_of_the_unit_end_with_a_run_that_is_killed() {
    let folder = folder_with_unit("usleep(300000);");
    for placement in PLACEMENTS {
        let program = Flight::start(folder.path(), &[&["run", "a.scn"], placement].concat());
        until("the programs of the unit", || started(folder.path()).len() == 2);
        signal("KILL", program.id());
        let [in_group, in_session] = <[u32; 2]>::try_from(started(folder.path())).unwrap();
        until("the end of the program", || !is_alive(in_group));
        if is_alive(in_session) {
            signal("KILL", in_session);
        }
        fs::remove_file(folder.path().join("ids")).unwrap();
    }
}

#[test]
fn a_unit_that_starts_a_program_in_each_step_leaves_no_zombies() {
    let step = "if (!fork()) { if (!fork()) _exit(0); _exit(0); } while (wait(0) > 0); usleep(20000);";
    let step = format!("int wait(int *); {step}");
    let unit = Generic { variables: OUTPUT, code: &[("STEP_CODE", &step)], ..Generic::default() };
    let folder = unit.build("a");
    fs::write(folder.path().join("a.scn"), SCRIPT.replace("stop 1 s", "stop 1000 s")).unwrap();
    let program = Flight::start(folder.path(), &["run", "a.scn"]);
    let trace = folder.path().join("runs/a/trace.csv.partial");
    until("rows", || fs::read_to_string(&trace).is_ok_and(|text| text.lines().count() > 20));
    until("no zombie but those that have just ended", || zombies(program.id()) < 3);
}

/// How many children of a process have ended and are not waited for.
fn zombies(parent: u32) -> usize {
    let state = format!(") Z {parent} ");
    let texts = fs::read_dir("/proc").unwrap().flatten().map(|entry| fs::read_to_string(entry.path().join("stat")));
    texts.flatten().filter(|text| text.contains(&state)).count()
}

#[test]
fn programs_that_were_there_before_the_run_go_on() {
    let folder = folder_with_unit("");
    let mut shell = Command::new("sh");
    shell.args(["-c", "sleep 7777 > /dev/null 2>&1 & echo $! > before; exec \"$0\" run a.scn"]).arg(lockstep());
    shell.current_dir(folder.path());
    let said = Flight::of(shell).end();
    assert_eq!(said.code, Some(0), "{}", said.err);
    let before: u32 = fs::read_to_string(folder.path().join("before")).unwrap().trim().parse().unwrap();
    assert!(is_alive(before));
    signal("KILL", before);
    assert_all_ended(folder.path(), "after the run");
}
