//! Runs that are interrupted, suspended or killed, or whose folder is in use or full, end as specified.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;
use tempfile::TempDir;
use tests::flight::{Flight, is_alive, signal, until};
use tests::foreign::{CLAIMS_STATES, Foreign};
use tests::program::{Said, lockstep, run};

/// A run that is too long to be waited for.
const LONG: &str = "scenario \"A unit flies for days\"\nstep 1 ms\nstop 100000 s\n\
                    fmu probe = \"foreign.fmu\" { enabled = false }\n\
                    time / 1 s -> probe.u\nassert early: eventually probe.count > 10\n\
                    assert late: eventually probe.y < -1\nrecord probe.y, probe.count\n";
/// From the fifth step on, `fmi2DoStep` does not return.
const HANGING: [&str; 3] = ["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=HANG", "MISBEHAVE_FROM_S=0.0045"];

/// A folder with the unit and `long.scn`.
fn folder_with_unit(defines: &[&str]) -> TempDir {
    let (folder, _) = Foreign { defines, ..Foreign::default() }.build();
    fs::write(folder.path().join("long.scn"), LONG).unwrap();
    folder
}

/// The trace of a run, complete or partial.
fn trace(out: &Path) -> PathBuf {
    let whole = out.join("trace.csv");
    if whole.is_file() { whole } else { out.join("trace.csv.partial") }
}

fn await_rows(out: &Path) {
    until("recorded rows", || fs::metadata(trace(out)).is_ok_and(|file| file.len() > 1000));
}

/// The number of rows of a trace; each must be complete.
fn whole_rows(out: &Path) -> usize {
    let text = fs::read_to_string(trace(out)).unwrap();
    assert!(text.ends_with('\n'), "the last line is whole");
    assert!(text.lines().all(|line| line.split(',').count() == 3), "each line has a cell for each column");
    text.lines().count() - 1
}

fn state(out: &Path) -> String {
    let record: serde_json::Value = serde_json::from_slice(&fs::read(out.join("run.json")).unwrap()).unwrap();
    record["state"].as_str().unwrap().to_owned()
}

/// Waits for the end of a run, which must have removed its temporary folders.
fn ended(program: &mut Flight) -> Said {
    let said = program.end();
    assert_eq!(program.temporary_folders(), Vec::<PathBuf>::new(), "temporary folders are gone");
    said
}

#[test]
fn a_signal_ends_a_run_cleanly_and_keeps_whole_rows() {
    let folder = folder_with_unit(&[]);
    let signals = [("INT", ""), ("TERM", ""), ("HUP", ""), ("QUIT", ""), ("HUP", "--isolate"), ("QUIT", "--isolate")];
    for (name, placement) in signals.into_iter().filter(|(name, _)| acts(name)) {
        let results = format!("{name}{placement}");
        let out = folder.path().join(&results);
        let arguments = ["run", "long.scn", "--out", &results, placement];
        let given: Vec<_> = arguments.into_iter().filter(|argument| !argument.is_empty()).collect();
        let mut program = Flight::start(folder.path(), &given);
        await_rows(&out);
        assert_eq!(program.temporary_folders().len(), 1);
        signal(name, program.id());
        let said = ended(&mut program);
        assert_eq!(said.code, Some(130), "{name}: {}", said.err);
        assert!(whole_rows(&out) > 10, "{name}");
        assert!(["trace.csv", "trace.parquet"].iter().all(|file| out.join(file).is_file()), "{name}");
        assert_eq!(state(&out), "interrupted", "{name}");
        let verdict: serde_json::Value = serde_json::from_slice(&fs::read(out.join("verdict.json")).unwrap()).unwrap();
        assert_eq!(verdict["end"], "interrupted", "{name}");
        let verdicts = [0, 1].map(|claim| verdict["claims"][claim]["verdict"].as_str());
        assert_eq!(verdicts, [Some("ok"), Some("unjudged")], "{name}: only what nothing can change any more is judged");
        assert!(said.out.contains("long.scn  interrupted at ") && said.out.contains("unjudged  late"), "{}", said.out);
    }
}

/// The program waits for a pipe before the run begins: for the script, and for a checkpoint after the units were unpacked.
#[test]
fn a_signal_before_the_run_ends_the_program_without_a_word_and_leaves_nothing() {
    let (folder, _) = Foreign { description: &[CLAIMS_STATES], ..Foreign::default() }.build();
    fs::write(folder.path().join("long.scn"), LONG).unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe")).status().unwrap().success());
    for name in ["INT", "TERM", "HUP", "QUIT"].into_iter().filter(|name| acts(name)) {
        for (arguments, folders) in [(&["run", "pipe"][..], 0), (&["run", "long.scn", "--from", "pipe"], 1)] {
            let mut program = Flight::start(folder.path(), arguments);
            let unpacked = |home: &Path| home.join("unit0/binaries").is_dir();
            until("what precedes the pipe", || {
                handles_signals(program.id())
                    && program.temporary_folders().iter().filter(|f| unpacked(f)).count() == folders
            });
            signal(name, program.id());
            let said = ended(&mut program);
            assert_eq!((said.code, said.err.as_str()), (Some(130), ""), "{name} {arguments:?}");
            assert!(!folder.path().join("runs").exists());
        }
    }
}

/// Whether a process has a handler for SIGTERM, the 15th signal.
fn handles_signals(process: u32) -> bool {
    signal_set(&process.to_string(), "SigCgt:\t") & (1 << 14) != 0
}

/// Whether a signal acts on programs that these tests start: SIGHUP, the first signal, does not where `nohup` started the
/// tests.
fn acts(signal: &str) -> bool {
    signal != "HUP" || signal_set("self", "SigIgn:\t") & 1 == 0
}

/// The set of signals that the system shows for a process under a name.
fn signal_set(process: &str, name: &str) -> u64 {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let set = status.lines().find_map(|line| line.strip_prefix(name)).unwrap();
    u64::from_str_radix(set, 16).unwrap()
}

#[test]
fn a_run_that_nohup_starts_goes_on_when_the_terminal_is_gone() {
    let folder = folder_with_unit(&[]);
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$0\" run long.scn"]).arg(lockstep()).current_dir(folder.path());
    let mut program = Flight::of(shell);
    await_rows(&folder.path().join("runs/long"));
    signal("HUP", program.id());
    let rows = whole_rows(&folder.path().join("runs/long"));
    until("more rows", || whole_rows(&folder.path().join("runs/long")) > rows);
    signal("TERM", program.id());
    assert_eq!(ended(&mut program).code, Some(130));
}

#[test]
fn a_second_ctrl_c_ends_a_unit_whose_call_does_not_return() {
    let folder = folder_with_unit(&HANGING);
    let out = folder.path().join("runs/long");
    let mut program = Flight::start(folder.path(), &["run", "long.scn", "--step-timeout", "0"]);
    until("the rows before the unit hangs", || fs::read_to_string(trace(&out)).is_ok_and(|t| t.lines().count() > 5));
    let stepping = program.stepping_process();
    signal("INT", program.id());
    until("the message about the first Ctrl-C", || program.said().contains("once more ends at once"));
    assert!(!program.is_over(), "the first Ctrl-C waits for the step");
    signal("INT", program.id());
    let said = ended(&mut program);
    assert_eq!(said.code, Some(130), "{}", said.err);
    assert_eq!((whole_rows(&out), state(&out).as_str()), (5, "interrupted"));
    assert!(!is_alive(stepping));
}

/// The stepping process is stopped in a step of which the parent knows, and is still in it when the parent continues
/// first.
#[test]
fn a_run_that_was_suspended_for_longer_than_the_step_timeout_continues() {
    let folder = folder_with_unit(&["STEP_TAKES_US=5000"]);
    let out = folder.path().join("runs/long");
    fs::write(folder.path().join("long.scn"), LONG.replace("100000 s", "200 ms")).unwrap();
    let mut program = Flight::start(folder.path(), &["run", "long.scn", "--step-timeout", "600ms"]);
    let (parent, stepping) = (program.id(), program.stepping_process());
    until("the first step", || program.said().contains("probe  info"));
    signal("STOP", stepping);
    sleep(Duration::from_millis(50));
    signal("STOP", parent);
    sleep(Duration::from_millis(900));
    assert!(!program.is_over(), "it is suspended in mid-run");
    signal("CONT", parent);
    sleep(Duration::from_millis(50));
    signal("CONT", stepping);
    let said = ended(&mut program);
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.out.contains("FAILED  late ") && said.out.contains("ok      early "), "{}", said.out);
    assert_eq!(whole_rows(&out), 201);
}

#[test]
fn a_stepping_process_does_not_outlive_a_killed_parent_and_the_rows_stay_readable() {
    for defines in [&[][..], &HANGING[..]] {
        let folder = folder_with_unit(defines);
        let out = folder.path().join("runs/long");
        let mut program = Flight::start(folder.path(), &["run", "long.scn", "--step-timeout", "0"]);
        let stepping = program.stepping_process();
        until("recorded rows", || fs::read_to_string(trace(&out)).is_ok_and(|text| text.lines().count() > 5));
        signal("KILL", program.id());
        assert_eq!(program.end().code, None);
        until("the end of the stepping process", || !is_alive(stepping));
        assert_eq!(state(&out), "running");
        let plot = run(folder.path(), &["plot", "runs/long"]);
        assert_eq!((plot.code, plot.out.as_str()), (Some(0), "runs/long/plot.svg\n"), "{}", plot.err);
        assert!(plot.err.starts_with("note: this run did not come to its end"), "{}", plot.err);
        assert_eq!(run(folder.path(), &["diff", "runs/long", "runs/long"]).code, Some(0));
        fs::write(folder.path().join("short.scn"), LONG.replace("100000 s", "3 ms")).unwrap();
        let again = run(folder.path(), &["run", "short.scn", "--out", "runs/long"]);
        assert_eq!((again.code, whole_rows(&out)), (Some(1), 4), "the folder is free again: {}", again.err);
    }
}

#[test]
fn a_killed_stepping_process_breaks_the_run_and_the_signal_is_named() {
    let folder = folder_with_unit(&[]);
    let out = folder.path().join("runs/long");
    let mut program = Flight::start(folder.path(), &["run", "long.scn"]);
    await_rows(&out);
    signal("KILL", program.stepping_process());
    let said = ended(&mut program);
    assert_eq!(said.code, Some(3), "{}", said.err);
    assert!(said.err.contains(" died of signal 9 (SIGKILL) "), "{}", said.err);
    assert!(whole_rows(&out) > 10);
    assert_eq!(state(&out), "broken");
}

#[test]
fn a_run_into_the_folder_of_another_running_one_is_refused() {
    let folder = folder_with_unit(&[]);
    let out = folder.path().join("runs/long");
    let mut first = Flight::start(folder.path(), &["run", "long.scn"]);
    await_rows(&out);
    let mut second = Flight::start(folder.path(), &["run", "long.scn"]);
    let refused = ended(&mut second);
    assert_eq!(refused.code, Some(2), "{}", refused.err);
    assert_eq!(
        refused.err,
        "error: another run is writing into runs/long\n\
         help: wait for it, or give this run a folder of its own with --out DIR\n"
    );
    signal("INT", first.id());
    assert_eq!(ended(&mut first).code, Some(130));
    assert!(whole_rows(&out) > 10, "the first run was not affected");
}

#[test]
fn a_folder_with_other_files_is_refused_and_not_changed() {
    let folder = folder_with_unit(&[]);
    fs::create_dir(folder.path().join("thesis")).unwrap();
    fs::write(folder.path().join("thesis/chapter.tex"), "words").unwrap();
    let said = run(folder.path(), &["run", "long.scn", "--out", "thesis"]);
    assert_eq!(said.code, Some(2));
    assert_eq!(
        said.err,
        "error: thesis is not empty and holds no run.json of ours\n\
         help: only a folder of an earlier run is replaced; choose another with --out DIR\n"
    );
    assert_eq!(fs::read_dir(folder.path().join("thesis")).unwrap().count(), 1);
}

/// Beyond a limit on the file size of 8 to 16 MB writes fail as on a full disk, and SIGXFSZ is no reason to end.
#[test]
fn a_trace_that_cannot_grow_breaks_the_run_and_the_written_rows_stay_readable() {
    let folder = folder_with_unit(&[]);
    let out = folder.path().join("runs/long");
    let mut shell = Command::new("sh");
    shell.args(["-c", "ulimit -f 16384; exec \"$0\" run long.scn"]).arg(lockstep());
    shell.current_dir(folder.path());
    let said = ended(&mut Flight::of(shell));
    assert_eq!(said.code, Some(3), "{}", said.err);
    assert!(said.err.contains("error: cannot write runs/long/trace.csv.partial: File too large"), "{}", said.err);
    assert_eq!(state(&out), "broken");
    let kept = run(folder.path(), &["diff", "runs/long", "runs/long"]);
    let rows = kept.out.strip_prefix("identical: ").and_then(|rest| rest.split(' ').next()?.parse::<usize>().ok());
    assert!(kept.code == Some(0) && rows.is_some_and(|rows| rows > 100_000), "{}{}", kept.out, kept.err);
}
