//! A flight asks for memory before its first step and after its last, never between.

use super::*;
use crate::run::message::Reason;
use crate::run::run_options::RunOptions;
use crate::run::run_spec::UnitSpec;
use ::tests::foreign::Foreign;
use dsl::scenario::{
    Action, BooleanExpression, Claim, Column, Connection, Drive, Event, Fault, FaultKind, Formula, Gated, Instance,
    Margin, Port, RealExpression, Scenario, Set, TickWindow, Unit, Until,
};
use std::path::PathBuf;
use unit::archive::{Unpacked, unpack};
use unit::board::BoardLayout;

/// Variables of the foreign unit.
const U: usize = 0;
const Y: usize = 2;
const ENABLED: usize = 4;

fn port(instance: usize, variable: usize) -> Port {
    Port { instance, variable }
}

fn signal(instance: usize) -> RealExpression {
    RealExpression::Signal(port(instance, Y))
}

/// Not below zero, in each way that a claim can wait for it.
fn claims() -> Vec<Claim> {
    let body = || Box::new(Formula::Margin(Margin { value: signal(1), strict: false }));
    let window = |to| TickWindow { from: 0, to };
    let within = Formula::Eventually(window(Some(20)), body());
    let until = |to: Option<u64>| {
        let (gate, any) = (Box::new(Formula::Finally(body())), true);
        let gated = Box::new(Formula::Gated(Gated { any, gate: body(), body: body() }));
        let gate = if to.is_some() { body() } else { gate };
        Formula::Until(Until { any, window: window(to), body: gated, gate })
    };
    let formulas = [
        Formula::Always(window(None), body()),
        Formula::Eventually(window(None), body()),
        Formula::Always(window(None), Box::new(within)),
        Formula::Always(window(None), Box::new(Formula::Eventually(window(None), body()))),
        Formula::Always(window(None), Box::new(until(Some(20)))),
        Formula::Always(window(None), Box::new(until(None))),
        until(None),
    ];
    formulas.map(Claim::of).to_vec()
}

/// Both arrows, a computed value, a window that opens and closes, faults, claims and columns.
fn scenario(ticks: u64) -> Scenario {
    let instance = |name: &str, wave| Instance { name: name.to_owned(), unit: 0, every: 1, wave, presets: Vec::new() };
    let arrow = |target, source, direct| Connection { target: port(target, U), source, direct };
    let computed = RealExpression::Affine { of: Box::new(signal(1)), factor: 0.5, offset: 1.0 };
    let enabled = Set { target: port(0, ENABLED), value: Drive::Boolean(BooleanExpression::Constant(true)) };
    let column = |(instance, variable)| Column::of_port("", port(instance, variable));
    // Faults that compute and draw at each tick and change no value.
    let nothing = || RealExpression::Constant(0.0);
    let kinds = [FaultKind::Noise(vec![nothing()]), FaultKind::Loss(nothing())];
    let fault = |kind| Action::Fault(Fault { targets: vec![port(1, U)], kind });
    let faults = Event { actions: kinds.map(fault).to_vec(), ..Event::at(5, None, Vec::new()) };
    Scenario {
        title: String::new(),
        step_ns: 1_000_000,
        start_tick: 0,
        stop_tick: ticks,
        parameters: Vec::new(),
        sweep: None,
        units: vec![Unit { name: "foreign.fmu".to_owned() }],
        instances: vec![instance("a", 0), instance("b", 1)],
        initialization: Vec::new(),
        connections: vec![arrow(0, Drive::Real(computed), false), arrow(1, Drive::Copy(port(0, Y)), true)],
        events: vec![Event::at(20, Some(20), vec![enabled]), faults],
        stop_when: None,
        seed: 0,
        conditions: Vec::new(),
        shared: Vec::new(),
        claims: claims(),
        columns: [(0, U), (0, Y), (1, Y), (0, ENABLED)].map(column).to_vec(),
    }
}

/// Two instances of the foreign unit with all that a script can do, for so many ticks.
pub(crate) fn spec(ticks: u64, unit: &Unpacked) -> RunSpec {
    let (name, folder) = ("foreign.fmu".to_owned(), unit.folder.clone());
    let (description, sha256) = (unit.description.clone(), unit.sha256.clone());
    let units = vec![UnitSpec { name, folder, description, sha256 }];
    let (folder, board) = (PathBuf::new(), PathBuf::new());
    let scenario = scenario(ticks);
    let options = RunOptions { fail_fast: true, record: true, ..RunOptions::default() };
    RunSpec { scenario, units, folder, board, options, worker_of: None, saves: Vec::new(), from: None }
}

#[test]
fn a_long_flight_asks_for_memory_as_often_as_a_short_one() {
    let (folder, fmu) = Foreign::default().build();
    let unpacked = unpack(&fmu, &folder.path().join("unpacked")).unwrap();
    let allocations = |ticks| {
        let spec = spec(ticks, &unpacked);
        let layout = BoardLayout { notes: 1, columns: spec.scenario.columns.len(), claims: spec.scenario.claims.len() };
        let board = Arc::new(Board::private(&layout).unwrap());
        let plan = plan_of(&spec, &[0, 0]);
        let worker =
            InProcess::new((0, plan.step_ns), &plan.groups, &plan.ports, instantiated(&spec, &board), board.note(0));
        let mut run = step_loop(&spec, &board, plan, vec![Box::new(worker)]);
        let mut finish = None;
        let count = allocation_counter::measure(|| finish = run.run(None).ok()).count_total;
        assert_eq!(finish, Some(Finish { last_tick: ticks, reason: Reason::StopTime }));
        assert_eq!(board.pop_rows(|_, _| ()) as u64, ticks + 1);
        count
    };
    assert_eq!(allocations(10_000), allocations(100));
}

fn instantiated(spec: &RunSpec, board: &Arc<Board>) -> Vec<Instantiated> {
    let mut made = Vec::new();
    instantiate_all(spec, board, &mut made).unwrap();
    made
}
