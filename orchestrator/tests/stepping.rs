//! Whole runs of a foreign unit in C, from the spec to the board, in this process.
#![allow(clippy::unwrap_used, reason = "a test ends where something is not as it should be")]

use dsl::scenario::{
    BooleanExpression, Column, Connection, Drive, Event, Instance, Port, Preset, Scenario, Set, Unit, Value,
};
use fmi2::calls::Call;
use orchestrator::run::message::{Finish, Message, Reason};
use orchestrator::run::run_options::RunOptions;
use orchestrator::run::run_spec::{RunSpec, UnitSpec};
use orchestrator::run::stepping;
use std::path::PathBuf;
use std::sync::Arc;
use tests::foreign::Foreign;
use unit::archive::unpack;
use unit::board::{Board, BoardLayout};
use unit::failure::{Cause, Doing};

/// Variables of the foreign unit.
const U: usize = 0;
const GAIN: usize = 1;
const Y: usize = 2;
const COUNT: usize = 3;
const ENABLED: usize = 4;
const LABEL: usize = 5;

const STEP_S: f64 = 0.5;

fn port(instance: usize, variable: usize) -> Port {
    Port { instance, variable }
}

/// `a` gets 3 from 1 s to 2 s, `b` follows `a`; ten steps of half a second.
fn scenario() -> Scenario {
    let instance = |name: &str, gain| Instance {
        name: name.to_owned(),
        unit: 0,
        every: 1,
        wave: 0,
        presets: vec![
            Preset { variable: GAIN, value: Value::Real(gain) },
            Preset { variable: LABEL, value: Value::String("label".to_owned()) },
            Preset { variable: U, value: Value::Real(1.0) },
        ],
    };
    let set = |variable, value| Set { target: port(0, variable), value };
    let column = |(instance, variable)| Column::of_port("", port(instance, variable));
    Scenario {
        title: "Two units".to_owned(),
        step_ns: 500_000_000,
        start_tick: 0,
        stop_tick: 10,
        parameters: Vec::new(),
        sweep: None,
        units: vec![Unit { name: "foreign.fmu".to_owned() }],
        instances: vec![instance("a", 2.0), instance("b", 1.0)],
        initialization: Vec::new(),
        connections: vec![Connection { target: port(1, U), source: Drive::Copy(port(0, Y)), direct: false }],
        events: vec![Event::at(
            2,
            Some(2),
            vec![
                set(U, Drive::Real(dsl::scenario::RealExpression::Constant(3.0))),
                set(ENABLED, Drive::Boolean(BooleanExpression::Constant(true))),
            ],
        )],
        stop_when: None,
        seed: 0,
        conditions: Vec::new(),
        shared: Vec::new(),
        claims: Vec::new(),
        columns: [(0, U), (0, Y), (1, Y), (1, COUNT), (0, ENABLED)].map(column).to_vec(),
    }
}

struct Ran {
    rows: Vec<Vec<u64>>,
    end: Message,
}

fn step_run(scenario: Scenario, foreign: &Foreign) -> Ran {
    let (folder, fmu) = foreign.build();
    let unpacked = unpack(&fmu, &folder.path().join("unpacked")).unwrap();
    let unit = UnitSpec {
        name: "foreign.fmu".to_owned(),
        folder: unpacked.folder,
        description: unpacked.description,
        sha256: unpacked.sha256,
    };
    let layout = BoardLayout { notes: 1, columns: scenario.columns.len(), claims: 0 };
    let (folder, board) = (PathBuf::new(), PathBuf::new());
    let spec = RunSpec {
        scenario,
        units: vec![unit],
        folder,
        board,
        options: RunOptions { record: true, ..RunOptions::default() },
        worker_of: None,
        saves: Vec::new(),
        from: None,
    };
    let board = Arc::new(Board::private(&layout).unwrap());
    stepping::step_run(&spec, &board);
    let (mut rows, mut messages) = (Vec::new(), Vec::new());
    board.pop_rows(|_, row| rows.push(row.to_vec()));
    board.pop_messages(|bytes| messages.push(postcard::from_bytes::<Message>(bytes).unwrap()));
    // Units that are freed after a break may still say something.
    messages.retain(|message| !matches!(message, Message::Log(_) | Message::Window(_)));
    assert_eq!(messages.len(), 1, "a run ends once");
    Ran { rows, end: messages.pop().unwrap() }
}

fn misbehaving(call: &str, how: &str, from_s: f64) -> Ran {
    let defines = [("CALL", call.to_owned()), ("HOW", how.to_owned()), ("FROM_S", from_s.to_string())];
    let defines = defines.map(|(name, value)| format!("MISBEHAVE_{name}={value}"));
    step_run(scenario(), &Foreign { defines: &defines.each_ref().map(String::as_str), ..Foreign::default() })
}

#[test]
fn two_foreign_units_follow_their_equations_bit_for_bit() {
    let ran = step_run(scenario(), &Foreign::default());
    assert_eq!(ran.end, Message::Finished(Finish { last_tick: 10, reason: Reason::StopTime }));
    let (mut a, mut b) = (0.0, 0.0);
    for (tick, row) in ran.rows.iter().enumerate() {
        let open = (2..4).contains(&tick);
        let u: f64 = if open { 3.0 } else { 1.0 };
        let expected = [u.to_bits(), f64::to_bits(a), f64::to_bits(b), tick as u64, u64::from(open)];
        assert_eq!(row, &expected, "row {tick}");
        (a, b) = (a + STEP_S * (2.0 * u - a), b + STEP_S * (a - b));
    }
    assert_eq!(ran.rows.len(), 11);
}

#[test]
fn a_unit_that_is_done_within_a_step_leaves_the_row_before() {
    let ran = misbehaving("STEP", "TERMINATED", 2.0);
    assert_eq!(ran.end, Message::Finished(Finish { last_tick: 4, reason: Reason::Terminated(0) }));
    assert_eq!(ran.rows.len(), 5);
}

#[test]
fn what_breaks_a_run_is_named_and_the_rows_before_are_kept() {
    let step = Doing::Call(Call::DoStep);
    let not_a_number = || Cause::NonFinite { variable: "y".to_owned(), value: "NaN".to_owned() };
    for (call, how, from_s, doing, time_s, cause, rows) in [
        ("STEP", "ERROR_STATUS", 2.0, step, 2.0, Cause::Status(3), 5),
        ("STEP", "FATAL", 2.0, step, 2.0, Cause::Status(4), 5),
        ("STEP", "STATUS_42", 0.0, step, 0.0, Cause::Status(42), 1),
        ("SET", "ERROR_STATUS", 1.5, Doing::Call(Call::SetReal), 1.5, Cause::Status(3), 4),
        ("STEP", "NOT_A_NUMBER", 2.0, Doing::Call(Call::GetReal), 2.5, not_a_number(), 5),
        ("TERMINATE", "ERROR_STATUS", 0.0, Doing::Call(Call::Terminate), 5.0, Cause::Status(3), 11),
        ("ENTER", "ERROR_STATUS", 0.0, Doing::Call(Call::EnterInitializationMode), 0.0, Cause::Status(3), 0),
        ("INSTANTIATE", "NO_INSTANCE", 0.0, Doing::Call(Call::Instantiate), 0.0, Cause::NoInstance, 0),
    ] {
        let ran = misbehaving(call, how, from_s);
        let Message::Broken(failure) = ran.end else { panic!("{call} {how} ended with {:?}", ran.end) };
        assert_eq!(failure.instance.as_deref(), Some("a"), "{call} {how}");
        assert_eq!((failure.doing, failure.time_s, failure.cause), (doing, Some(time_s), cause), "{call} {how}");
        assert_eq!(ran.rows.len(), rows, "{call} {how}");
    }
}
