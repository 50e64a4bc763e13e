//! Runs of a foreign unit in worker processes that hold several instances each.
#![cfg(feature = "bus")]
#![allow(clippy::unwrap_used, reason = "a test ends where something is not as it should be")]

use dsl::scenario::{Column, Connection, Drive, Instance, Port, Preset, Scenario, Unit, Value};
use fmi2::calls::Call;
use fmi2::description::ModelDescription;
use orchestrator::bus::start_isolated;
use orchestrator::run::message::{Finish, Message, Reason};
use orchestrator::run::run_options::RunOptions;
use orchestrator::run::run_spec::{RunSpec, SaveSpec, UnitSpec};
use orchestrator::run::step_loop::Checkpoint;
use orchestrator::run::stepping::step_run;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tests::foreign::{CLAIMS_STATES, Foreign};
use unit::archive::unpack;
use unit::board::{Board, BoardLayout};
use unit::failure::{Cause, Doing};

/// Variables of the foreign unit.
const U: usize = 0;
const GAIN: usize = 1;
const Y: usize = 2;
const COUNT: usize = 3;

const STOP_TICK: u64 = 20;
const SAVED_TICK: u64 = 7;
const TWO_WORKERS: [usize; 4] = [0, 0, 1, 1];
const FOUR_WORKERS: [usize; 4] = [0, 1, 2, 3];

/// A ring of four instances with `=>` from `b` to `c`, so that each of two workers has two groups. The last steps of `c` and
/// `d` end after the run, and the one of `c`, whose group comes later, is ordered first.
fn scenario() -> Scenario {
    let instance = |(name, unit, every, wave, gain): (&str, usize, u64, usize, f64)| Instance {
        name: name.to_owned(),
        unit,
        every,
        wave,
        presets: vec![
            Preset { variable: GAIN, value: Value::Real(gain) },
            Preset { variable: U, value: Value::Real(1.0) },
        ],
    };
    let port = |instance, variable| Port { instance, variable };
    let connection =
        |(source, target, direct)| Connection { target: port(target, U), source: Drive::Copy(port(source, Y)), direct };
    let columns = (0..4).flat_map(|index| [U, Y, COUNT].map(|variable| port(index, variable)));
    Scenario {
        title: "Four units".to_owned(),
        step_ns: 500_000_000,
        start_tick: 0,
        stop_tick: STOP_TICK,
        parameters: Vec::new(),
        sweep: None,
        units: ["foreign.fmu", "other.fmu"].map(|name| Unit { name: name.to_owned() }).to_vec(),
        instances: [("a", 0, 1, 0, 0.5), ("b", 0, 1, 0, 0.25), ("c", 1, 6, 1, 0.125), ("d", 0, 19, 0, 0.75)]
            .map(instance)
            .to_vec(),
        initialization: Vec::new(),
        connections: [(3, 0, false), (0, 1, false), (1, 2, true), (2, 3, false)].map(connection).to_vec(),
        events: Vec::new(),
        stop_when: None,
        seed: 0,
        conditions: Vec::new(),
        shared: Vec::new(),
        claims: Vec::new(),
        columns: columns.map(|port| Column::of_port("", port)).collect(),
    }
}

/// The foreign unit as it is, unpacked below a folder, and one with these defines.
fn units(folder: &Path, defines: &[&str]) -> Vec<UnitSpec> {
    let unit = |(name, defines): (&str, &[&str])| {
        let foreign = Foreign { defines, description: &[CLAIMS_STATES], ..Foreign::default() };
        let (_built, fmu) = foreign.build();
        let unpacked = unpack(&fmu, &folder.join(name)).unwrap();
        UnitSpec {
            name: name.to_owned(),
            folder: unpacked.folder,
            description: unpacked.description,
            sha256: unpacked.sha256,
        }
    };
    let defines = [&["WITH_STATES"], defines].concat();
    [("foreign.fmu", &["WITH_STATES"][..]), ("other.fmu", &defines)].map(unit).to_vec()
}

/// A run that saves at one tick; `c` is an instance of the second unit.
fn spec(folder: &Path, units: &[UnitSpec], worker_of: Option<&[usize]>) -> RunSpec {
    RunSpec {
        scenario: scenario(),
        units: units.to_vec(),
        worker_of: worker_of.map(<[usize]>::to_vec),
        folder: folder.to_owned(),
        board: folder.join("board"),
        options: RunOptions { record: true, step_timeout: Some(Duration::from_secs(10)), ..RunOptions::default() },
        saves: vec![SaveSpec { tick: SAVED_TICK, file: folder.join("checkpoint") }],
        from: None,
    }
}

struct Ran {
    rows: Vec<(u64, Vec<u64>)>,
    end: Message,
}

/// Runs to the end that is reported on the board, which has room for all rows.
fn run(spec: &RunSpec) -> Ran {
    run_with(Path::new(env!("CARGO_BIN_EXE_lockstep")), spec)
}

/// The same with another program as worker.
fn run_with(program: &Path, spec: &RunSpec) -> Ran {
    let board = Board::private(&BoardLayout { notes: 1, columns: spec.scenario.columns.len(), claims: 0 });
    let board = Arc::new(board.unwrap());
    let stepping = match spec.worker_of {
        Some(_) => Some(start_isolated(program, spec, &board).unwrap()),
        None => {
            step_run(spec, &board);
            None
        }
    };
    let (mut rows, mut end, began) = (Vec::new(), None, Instant::now());
    while end.is_none() {
        assert!(began.elapsed() < Duration::from_secs(60), "the run ends");
        board.pop_messages(|bytes| match postcard::from_bytes(bytes).unwrap() {
            Message::Log(_) | Message::Calls(_) | Message::Saved(_) | Message::Window(_) => {}
            message => end = Some(message),
        });
        sleep(Duration::from_millis(1));
    }
    board.pop_rows(|tick, row| rows.push((tick, row.to_vec())));
    drop(stepping);
    Ran { rows, end: end.unwrap() }
}

#[test]
fn a_run_has_the_same_rows_in_one_process_in_two_workers_and_in_four() {
    let units_folder = tempfile::tempdir().unwrap();
    let units = units(units_folder.path(), &[]);
    let finished = Message::Finished(Finish { last_tick: STOP_TICK, reason: Reason::StopTime });
    let placements = [None, Some(&TWO_WORKERS[..]), Some(&FOUR_WORKERS)];
    let ran = placements.map(|worker_of| {
        let folder = tempfile::tempdir().unwrap();
        let ran = run(&spec(folder.path(), &units, worker_of));
        assert_eq!(ran.end, finished, "{worker_of:?}");
        (ran.rows, fs::read(folder.path().join("checkpoint")).unwrap())
    });
    assert_eq!(ran[0].0.len() as u64, STOP_TICK + 1);
    for index in 1..placements.len() {
        assert!(ran[index] == ran[0], "rows and checkpoint in {:?}", placements[index]);
    }
    let descriptions: Vec<&ModelDescription> = [0, 0, 1, 0].map(|unit: usize| &units[unit].description).to_vec();
    for worker_of in placements {
        let folder: TempDir = tempfile::tempdir().unwrap();
        let from = Checkpoint::read(&ran[1].1, &scenario(), &descriptions).unwrap();
        let continued = run(&RunSpec { from: Some(from), ..spec(folder.path(), &units, worker_of) });
        assert_eq!(continued.end, finished, "continued in {worker_of:?}");
        let expected = ran[0].0.iter().filter(|(tick, _)| *tick > SAVED_TICK);
        assert!(continued.rows.iter().eq(expected), "rows continued in {worker_of:?}");
    }
}

#[test]
fn the_instance_that_breaks_a_worker_of_several_is_named() {
    for (how, cause) in [("CRASH", Cause::Signal(11)), ("HANG", Cause::Hung(0.5)), ("ERROR_STATUS", Cause::Status(3))] {
        let folder = tempfile::tempdir().unwrap();
        let how = format!("MISBEHAVE_HOW={how}");
        let units = units(folder.path(), &["MISBEHAVE_CALL=STEP", &how, "MISBEHAVE_FROM_S=1.9"]);
        let mut spec = spec(folder.path(), &units, Some(&TWO_WORKERS));
        spec.options.step_timeout = Some(Duration::from_millis(500));
        let ran = run(&spec);
        let Message::Broken(failure) = ran.end else { panic!("{how} ended with {:?}", ran.end) };
        assert_eq!((failure.instance.as_deref(), failure.time_s), (Some("c"), Some(3.0)), "{how}");
        assert_eq!((failure.doing, failure.cause), (Doing::Call(Call::DoStep), cause), "{how}");
    }
}

#[test]
fn a_worker_that_is_stopped_before_it_listens_ends_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("stops");
    fs::write(&program, "#!/bin/sh\nkill -STOP $$\n").unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o700)).unwrap();
    let ran = run_with(&program, &spec(folder.path(), &units(folder.path(), &[]), Some(&TWO_WORKERS)));
    let Message::Broken(failure) = ran.end else { panic!("{:?}", ran.end) };
    assert_eq!((failure.instance.as_deref(), failure.doing), (Some("a"), Doing::BetweenCalls));
    assert_eq!(failure.cause, Cause::Stopped(1.0));
}
