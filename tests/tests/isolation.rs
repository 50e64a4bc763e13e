//! Runs with a process for each instance: the same bytes for any script, and each lost process is reported.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;
use tempfile::TempDir;
use tests::flight::{Flight, is_alive, signal, until};
use tests::foreign::Foreign;
use tests::program::{Said, lockstep, repository, run};

/// Mixed periods, both kinds of connection, several waves, a slow unit beside fast ones, a window, claims of every
/// kind, log messages of units.
const MIXED: &str = "scenario \"Everything at once\"\nstep 10 ms\nstop 900 ms\n\
    fmu a = \"foreign.fmu\" { enabled = false }\nfmu b = \"foreign.fmu\" every 30 ms { enabled = false }\n\
    fmu c = \"foreign.fmu\"\n\
    fmu slow = \"foreign.fmu\" every 200 ms { enabled = false }\nfmu d = \"foreign.fmu\" every 20 ms { enabled = false }\n\
    1 + 0.5 * c.y + time / 1 s -> a.u\na.y => b.u\nb.y => c.u\na.y -> slow.u\nslow.y + a.y -> d.u\n\
    at 300 ms lasting 100 ms { set a.u = 7, set c.u = 3 }\nat 500 ms { set c.enabled = true }\n\
    assert bounded: always within 100..800 ms (c.y < 50 and b.y < 50)\n\
    assert rises: eventually within 600 ms hold for 50 ms a.y > 0.2\nassert lost: always a.y < 0.25\n\
    record a.y, a.u, b.y, c.y, c.gain, c.enabled, slow.y, d.y, d.count\n";
const LONG: &str = "scenario \"Two units fly for days\"\nstep 1 ms\nstop 100000 s\n\
    fmu probe = \"foreign.fmu\" { enabled = false }\nfmu other = \"foreign.fmu\" { enabled = false }\n\
    time / 1 s -> probe.u\nprobe.y -> other.u\nassert late: eventually probe.y < -1\n\
    record probe.y, probe.count, other.y\n";

/// A folder with the unit and a script of this name.
fn folder_with_unit(defines: &[&str], name: &str, script: &str) -> TempDir {
    let (folder, _) = Foreign { defines, ..Foreign::default() }.build();
    fs::write(folder.path().join(name), script).unwrap();
    folder
}

fn trace(out: &Path) -> PathBuf {
    let whole = out.join("trace.csv");
    if whole.is_file() { whole } else { out.join("trace.csv.partial") }
}

fn rows(out: &Path) -> usize {
    fs::read_to_string(trace(out)).unwrap_or_default().lines().count().saturating_sub(1)
}

fn state(out: &Path) -> String {
    let record: serde_json::Value = serde_json::from_slice(&fs::read(out.join("run.json")).unwrap()).unwrap();
    record["state"].as_str().unwrap().to_owned()
}

/// Waits for the end of a run, which must leave neither processes nor temporary folders.
fn ended(program: &mut Flight, workers: &[u32]) -> Said {
    let said = program.end();
    assert_eq!(program.temporary_folders(), Vec::<PathBuf>::new(), "temporary folders are gone: {}", said.err);
    until("the end of all workers", || !workers.iter().any(|&worker| is_alive(worker)));
    said
}

/// Lines with log messages of units, without progress.
fn messages(said: &Said) -> Vec<&str> {
    said.err.lines().filter(|line| line.contains(" s  ") && !line.contains('%')).collect()
}

#[test]
fn the_files_and_log_messages_of_a_script_are_the_same_with_and_without_isolation() {
    let folder = folder_with_unit(
        &["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=WARNING", "MISBEHAVE_FROM_S=0.35"],
        "mixed.scn",
        MIXED,
    );
    for more in [&[][..], &["--fail-fast"]] {
        let together = run(folder.path(), &[&["run", "mixed.scn", "--out", "together"], more].concat());
        let isolated = run(folder.path(), &[&["run", "mixed.scn", "--out", "isolated", "--isolate"], more].concat());
        assert_eq!((together.code, isolated.code), (Some(1), Some(1)), "{}{}", together.err, isolated.err);
        let diff = run(folder.path(), &["diff", "together", "isolated"]);
        assert_eq!(diff.code, Some(0), "{}", diff.out);
        for file in ["trace.csv", "trace.parquet", "signals.json", "verdict.json"] {
            let [one, other] =
                ["together", "isolated"].map(|out| fs::read(folder.path().join(out).join(file)).unwrap());
            assert!(one == other, "{file}");
        }
        assert!(messages(&together).len() > 8, "{}", together.err);
        assert_eq!(messages(&together), messages(&isolated));
    }
}

#[test]
fn a_unit_that_terminates_ends_the_run_at_the_same_row() {
    for from_s in ["0.35", "0.4"] {
        let from = format!("MISBEHAVE_FROM_S={from_s}");
        let folder = folder_with_unit(&["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=TERMINATED", &from], "mixed.scn", MIXED);
        for (out, more) in [("together", &[][..]), ("isolated", &["--isolate"])] {
            let said = run(folder.path(), &[&["run", "mixed.scn", "--out", out], more].concat());
            assert!(said.code.is_some_and(|code| [0, 1, 4].contains(&code)), "{}", said.err);
        }
        let diff = run(folder.path(), &["diff", "together", "isolated"]);
        assert_eq!(diff.code, Some(0), "{}", diff.out);
    }
}

#[test]
fn ctrl_c_ends_all_workers_and_keeps_whole_rows() {
    let folder = folder_with_unit(&[], "long.scn", LONG);
    for name in ["INT", "TERM"] {
        let out = folder.path().join(name);
        let mut program = Flight::start(folder.path(), &["run", "long.scn", "--isolate", "--out", name]);
        let workers = program.children(2);
        until("recorded rows", || rows(&out) > 20);
        signal(name, program.id());
        let said = ended(&mut program, &workers);
        assert_eq!((said.code, state(&out).as_str()), (Some(130), "interrupted"), "{}", said.err);
        assert!(out.join("trace.csv").is_file());
    }
}

#[test]
fn a_second_ctrl_c_ends_workers_whose_calls_do_not_return() {
    let defines = ["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=HANG", "MISBEHAVE_FROM_S=0.0045"];
    let folder = folder_with_unit(&defines, "long.scn", LONG);
    let mut program = Flight::start(folder.path(), &["run", "long.scn", "--isolate", "--step-timeout", "0"]);
    let workers = program.children(2);
    until("the rows before the unit hangs", || rows(&folder.path().join("runs/long")) > 4);
    signal("INT", program.id());
    until("the message about the first Ctrl-C", || program.said().contains("once more ends at once"));
    signal("INT", program.id());
    let said = ended(&mut program, &workers);
    assert_eq!(said.code, Some(130), "{}", said.err);
    let out = folder.path().join("runs/long");
    assert_eq!(state(&out), "interrupted");
    let verdict: serde_json::Value = serde_json::from_slice(&fs::read(out.join("verdict.json")).unwrap()).unwrap();
    assert_eq!(verdict["end"], "interrupted");
    assert!(!said.err.contains("error: "), "failures after the user ended the run are not reported: {}", said.err);
}

#[test]
fn a_temporary_folder_whose_path_is_too_long_for_a_socket_is_refused_before_the_run() {
    let folder = folder_with_unit(&[], "short.scn", &LONG.replace("100000 s", "10 ms"));
    let long = folder.path().join("x".repeat(90));
    fs::create_dir(&long).unwrap();
    let mut command = tests::program::command(folder.path(), &["run", "short.scn", "--isolate"]);
    let said = Said::from(command.env("TMPDIR", &long).output().unwrap());
    assert_eq!(said.code, Some(3), "{}", said.err);
    let error = said.err.lines().find(|line| line.starts_with("error: ")).unwrap();
    assert!(error.starts_with("error: cannot start the workers: ") && error.contains("set TMPDIR"), "{}", said.err);
    assert_eq!(fs::read_dir(&long).unwrap().count(), 0);
}

/// Stops some of `count` workers during the run and expects that their loss breaks the run.
fn assert_loss_is_reported(folder: &TempDir, count: usize, stopped: Range<usize>) {
    let mut program = Flight::start(folder.path(), &["run", "long.scn", "--isolate"]);
    let workers = program.children(count);
    until("recorded rows", || rows(&folder.path().join("runs/long")) > 20);
    workers[stopped].iter().for_each(|&worker| signal("STOP", worker));
    let said = ended(&mut program, &workers);
    assert_eq!((said.code, state(&folder.path().join("runs/long")).as_str()), (Some(3), "broken"), "{}", said.err);
    assert!(said.err.contains(": no sign of life from its process for 2 s, "), "{}", said.err);
}

#[test]
fn the_loss_of_a_stopped_worker_is_reported_within_seconds() {
    assert_loss_is_reported(&folder_with_unit(&[], "long.scn", LONG), 2, 1..2);
}

#[test]
fn the_loss_of_a_stopped_worker_is_reported_within_seconds_if_messages_are_long() {
    let description = &[(
        "causality=\"parameter\" variability=\"fixed\">\n      <String",
        "causality=\"input\" variability=\"discrete\">\n      <String",
    )];
    let (folder, _) = Foreign { description, ..Foreign::default() }.build();
    let longer_than_a_socket_buffer = "x".repeat(300_000);
    let script = LONG.replace("record", &format!("\"{longer_than_a_socket_buffer}\" -> other.label\nrecord"));
    fs::write(folder.path().join("long.scn"), script).unwrap();
    assert_loss_is_reported(&folder, 2, 1..2);
}

#[test]
fn the_loss_of_all_workers_is_reported_and_none_stays_alive() {
    let units: String = (0..6).map(|i| format!("fmu u{i} = \"foreign.fmu\"\ntime / 1 s -> u{i}.u\n")).collect();
    let script = format!("scenario \"Six\"\nstep 1 ms\nstop 100000 s\n{units}record u0.y, u1.y\n");
    assert_loss_is_reported(&folder_with_unit(&[], "long.scn", &script), 6, 0..6);
}

#[test]
fn a_run_that_was_suspended_continues() {
    let folder = folder_with_unit(&["STEP_TAKES_US=5000"], "long.scn", &LONG.replace("100000 s", "300 ms"));
    let mut program = Flight::start(folder.path(), &["run", "long.scn", "--isolate", "--step-timeout", "600ms"]);
    let workers = program.children(2);
    until("recorded rows", || program.said().contains("other  info"));
    for process in workers.iter().chain([&program.id()]) {
        signal("STOP", *process);
    }
    sleep(Duration::from_millis(2500));
    assert!(!program.is_over(), "it is suspended in mid-run");
    for process in std::iter::once(&program.id()).chain(&workers) {
        signal("CONT", *process);
        sleep(Duration::from_millis(100));
    }
    let said = ended(&mut program, &workers);
    assert_eq!((said.code, rows(&folder.path().join("runs/long"))), (Some(1), 301), "{}", said.err);
}

#[test]
fn workers_do_not_outlive_a_killed_coordinator_and_temporary_folders_are_removed() {
    for defines in [&[][..], &["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=HANG", "MISBEHAVE_FROM_S=0.0045"]] {
        let folder = folder_with_unit(defines, "long.scn", LONG);
        for placement in [&["--isolate"][..], &[]] {
            let arguments = [&["run", "long.scn", "--step-timeout", "0"], placement].concat();
            let mut program = Flight::start(folder.path(), &arguments);
            let workers = program.children(if placement.is_empty() { 1 } else { 2 });
            until("recorded rows", || rows(&folder.path().join("runs/long")) > 4);
            signal("KILL", program.id());
            let said = ended_after_kill(&mut program, &workers);
            assert_eq!(said.code, None);
        }
    }
}

fn ended_after_kill(program: &mut Flight, workers: &[u32]) -> Said {
    let said = program.end();
    until("the end of all workers", || !workers.iter().any(|&worker| is_alive(worker)));
    until("the end of temporary folders", || program.temporary_folders().is_empty());
    said
}

/// The moments are spread over the run by a generator with a seed.
#[test]
fn a_worker_killed_at_any_moment_is_named_and_nothing_is_left() {
    let folder = folder_with_unit(&["STEP_TAKES_US=200"], "short.scn", &LONG.replace("100000 s", "400 ms"));
    let mut random_state = 20_260_801_u64;
    let mut broken = 0;
    for moment in 0..20 {
        random_state = random_state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let wait_ms = (random_state >> 33) % 350;
        let out = format!("kill{moment}");
        let mut program = Flight::start(folder.path(), &["run", "short.scn", "--isolate", "--out", &out]);
        let workers = program.children(2);
        sleep(Duration::from_millis(wait_ms));
        let worker = workers[moment % 2];
        // The worker may have ended already, which is not an error.
        let _ = Command::new("kill").args(["-s", "KILL", &worker.to_string()]).output();
        let said = ended(&mut program, &workers);
        match said.code {
            Some(1) => assert_eq!(rows(&folder.path().join(&out)), 401, "{wait_ms} ms: {}", said.err),
            Some(3) => {
                broken += 1;
                let error = said.err.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
                let name = error.contains("`probe` died of signal 9") || error.contains("`other` died of signal 9");
                assert!(name && error.contains(" at "), "{wait_ms} ms: {}", said.err);
                assert_eq!(state(&folder.path().join(&out)), "broken");
            }
            code => panic!("{wait_ms} ms: {code:?} {}", said.err),
        }
    }
    assert!(broken >= 5, "{broken} of 20 kills hit a run");
}

#[test]
fn twenty_simultaneous_runs_do_not_affect_each_other() {
    let folder = folder_with_unit(&[], "short.scn", &LONG.replace("100000 s", "100 ms"));
    let out = |number: usize| format!("run{number}");
    let start = |number| Flight::start(folder.path(), &["run", "short.scn", "--isolate", "--out", &out(number)]);
    let mut programs: Vec<_> = (0..20).map(start).collect();
    for program in &mut programs {
        let said = ended(program, &[]);
        assert_eq!(said.code, Some(1), "{}", said.err);
    }
    let traces: Vec<_> =
        (0..20).map(|number| fs::read(folder.path().join(out(number)).join("trace.csv")).unwrap()).collect();
    assert!(traces.iter().all(|trace| trace == &traces[0]) && rows(&folder.path().join("run0")) == 101);
}

/// A small disk in its own mount namespace, where the system permits one.
#[test]
fn a_full_disk_breaks_the_run_and_the_written_rows_stay_readable() {
    let permitted = Command::new("unshare").args(["--mount", "--map-root-user", "true"]).status();
    if !permitted.is_ok_and(|status| status.success()) {
        eprintln!("note: skipped, because the system permits no mount namespace");
        return;
    }
    let folder = folder_with_unit(&[], "long.scn", LONG);
    for placement in ["", "--isolate"] {
        let script = format!(
            "mkdir -p disk && mount -t tmpfs -o size=96k none disk && \"$0\" run long.scn {placement} --out disk/run; \
             echo \"code $?\"; rm -rf kept; cp -r disk/run kept; df disk | tail -1"
        );
        let mut shell = Command::new("unshare");
        shell.args(["--mount", "--map-root-user", "sh", "-c", &script]).arg(lockstep()).current_dir(folder.path());
        let said = Flight::of(shell).end();
        assert!(said.out.contains("code 3\n"), "{}{}", said.out, said.err);
        assert!(said.err.contains("error: cannot write disk/run/trace.csv.partial: No space left"), "{}", said.err);
        let kept = run(folder.path(), &["diff", "kept", "kept"]);
        assert!(kept.code == Some(0) && kept.out.starts_with("identical: "), "{}{}", kept.out, kept.err);
    }
}

#[test]
fn a_worker_reports_why_it_cannot_start_even_if_its_folder_is_empty() {
    let home = tempfile::tempdir().unwrap();
    let said = run(&repository(), &["worker", "--once", "--home", home.path().to_str().unwrap(), "3"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.starts_with("error: cannot open the worker's board: "), "{}", said.err);
}
