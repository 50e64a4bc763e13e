//! A small scenario, claim, run record and model description for tests.

use dsl::scenario::{BooleanExpression, Claim, Formula, Instance, Parameter, Scenario, Unit};
use fmi2::description::{
    Causality, Item, Kind, ModelDescription, Position, RealAttributes, RealVariable, SimpleType, TypeKind, Variability,
    Variable,
};
use results::run_record::{HashedFile, Host, RunRecord, RunState};

/// A scenario of one quadcopter.
pub fn scenario() -> Scenario {
    let parameter = |name: &str, value: &str, set| Parameter { name: name.to_owned(), value: value.to_owned(), set };
    Scenario {
        title: "Quadcopter flies".to_owned(),
        step_ns: 10_000_000,
        start_tick: 0,
        stop_tick: 9000,
        parameters: vec![parameter("gust", "4 m/s", true), parameter("seed", "1", false)],
        sweep: None,
        units: vec![Unit { name: "quadcopter".to_owned() }],
        instances: vec![Instance { name: "quad".to_owned(), unit: 0, every: 1, wave: 0, presets: vec![] }],
        initialization: vec![],
        connections: vec![],
        events: vec![],
        stop_when: None,
        seed: 0,
        conditions: vec![],
        shared: vec![],
        claims: vec![],
        columns: vec![],
    }
}

/// A claim that holds.
pub fn claim(name: &str, text: &str) -> Claim {
    let formula = Formula::Condition(BooleanExpression::Constant(true));
    Claim { name: name.to_owned(), text: text.to_owned(), line: 34, ..Claim::of(formula) }
}

/// The record of a run that is in progress.
pub fn record() -> RunRecord {
    let file = |name: &str| HashedFile { name: name.to_owned(), sha256: "0".repeat(64) };
    RunRecord {
        lockstep: "0.1.0",
        state: RunState::Running,
        scenario: "A unit goes up".to_owned(),
        script: file("up.scn"),
        units: vec![file("quadcopter")],
        files: vec![],
        from: None,
        parameters: vec![],
        case: None,
        host: Host { name: "here".to_owned(), system: "linux", processor: "x86_64" },
        started: "2030-01-02T03:04:05Z".to_owned(),
        wall_s: 0.0,
        simulated_s: None,
        broken: None,
    }
}

fn variable(name: &str, kind: Kind) -> Variable {
    Variable {
        position: Position::default(),
        name: name.to_owned(),
        value_reference: 0,
        description: None,
        causality: Causality::Output,
        variability: Variability::Continuous,
        initial: None,
        can_handle_multiple_set_per_time_instant: None,
        annotations: Vec::new(),
        declared_type: None,
        kind,
    }
}

/// The description of a unit with a `height` and a `method`.
pub fn description() -> ModelDescription {
    let attributes = RealAttributes { unit: Some("m".to_owned()), ..RealAttributes::default() };
    let mut height = variable("height", Kind::Real(RealVariable { attributes, ..RealVariable::default() }));
    height.description = Some("Height over ground".to_owned());
    let mut method = variable("method", Kind::Enumeration { start: None, min: None, max: None });
    method.declared_type = Some("Method".to_owned());
    let item =
        |name: &str, value| Item { name: name.to_owned(), value, description: None, position: Position::default() };
    let items = vec![item("grid", 1), item("ant_colony", 2)];
    let types = vec![SimpleType {
        position: Position::default(),
        name: "Method".to_owned(),
        description: None,
        kind: TypeKind::Enumeration { quantity: None, items },
    }];
    ModelDescription { variables: vec![height, method], types, ..ModelDescription::default() }
}
