//! Loops and parts: what a script with them is unrolled to.

use super::fixtures::{all_shown, flight, headings, run_with, scenario, shown};
use dsl::scenario::{Drive, RealExpression, Scenario, Value};

/// Instances with their unit, period and Real start values; connections and claims by name.
fn unrolled(scenario: &Scenario) -> String {
    let mut lines = Vec::new();
    for instance in scenario.instances.iter().skip(3) {
        let values = instance.presets.iter().filter_map(|preset| match preset.value {
            Value::Real(value) if value != 0.0 => Some(value.to_string()),
            Value::Integer(value) => Some(value.to_string()),
            _ => None,
        });
        let values: Vec<_> = values.collect();
        lines.push(format!("{} unit {} every {} [{}]", instance.name, instance.unit, instance.every, values.join(" ")));
    }
    for connection in &scenario.connections {
        let name = |port: dsl::scenario::Port| format!("{}.{}", scenario.instances[port.instance].name, port.variable);
        let source = match &connection.source {
            Drive::Copy(port) => name(*port),
            Drive::Real(RealExpression::Constant(value)) => value.to_string(),
            other => format!("{other:?}"),
        };
        lines.push(format!("{source} -> {}", name(connection.target)));
    }
    lines.extend(scenario.claims.iter().map(|claim| format!("{}: {}", claim.name, claim.text)));
    lines.join("\n")
}

#[test]
fn a_loop_yields_its_statements_once_for_each_round() {
    let lines = "let n = 2
for i in 1..n {
  fmu air[i] = \"wind\" { mean = [i * 1 m/s, 0 m/s, 0 m/s], stream = i }
  fmu own = \"quadcopter\" every i * 10 ms
  let gap = i * 1 m
  air[i].velocity -> own.wind
  assert near[i]: always own.state.position.x < gap
  assert low: always own.state.position.z < 3 m
}
air[2].velocity -> quad.wind";
    insta::assert_snapshot!(unrolled(&scenario(&flight(lines))));
}

#[test]
fn a_range_counts_in_its_unit_and_may_be_empty_and_a_list_is_gone_through() {
    let values = |range: &str| {
        let lines = format!("for v in {range} {{ fmu air = \"wind\" {{ mean = [v, 0 m/s, 0 m/s], stream = 9 }} }}");
        let scenario = run_with(&flight(&lines), &[]).resolved.scenario.expect("no error");
        let of = |instance: &dsl::scenario::Instance| {
            let Some(Value::Real(value)) = instance.presets.first().map(|preset| preset.value.clone()) else {
                return None;
            };
            Some(format!("{} {value}", instance.name))
        };
        scenario.instances.iter().skip(3).filter_map(of).collect::<Vec<_>>().join(", ")
    };
    assert_eq!(values("1..3 m/s"), "air[1] 1, air[2] 2, air[3] 3");
    assert_eq!(values("35..36 km/h"), "air[1] 9.722222222222223, air[2] 10");
    assert_eq!(values("2..1 m/s"), "");
    assert_eq!(values("[2, 5] m/s"), "air[1] 2, air[2] 5");
    assert_eq!(values("-1 m/s..1 m/s"), "air[1] -1, air[2] 0, air[3] 1");
}

#[test]
fn a_part_is_a_component_with_values_of_its_own() {
    let lines = "use lead = \"uav.scn\"
use wing[1] = \"uav.scn\" on edge[1] { speed = 5 m/s }
use both = \"pair.scn\"
lead.air.velocity -> quad.wind
assert quick: always (wing[1].double > 1 m/s and both.more[2].double > lead.double)
assert low: always both.left.body.roll < 3 deg";
    let outcome = run_with(&flight(lines), &["seed = 6"]);
    // Several units draw the same numbers, which is warned of.
    insta::assert_snapshot!(unrolled(&outcome.resolved.scenario.expect("no error")));
}

#[test]
fn rounds_are_named_by_whole_values_only_if_all_are_different() {
    let lines = "for v in [0.5, 1] { assert a: always quad.roll < v * 1 deg }
for w in [2, 2] { assert b: always quad.roll < w * 1 deg }
for x in [7, 3] { assert c: always quad.roll < x * 1 deg }
for y in 20..21 degC { assert d: always ctrl.temperature < y }";
    let scenario = scenario(&flight(lines));
    let names: Vec<_> = scenario.claims.iter().map(|claim| claim.name.as_str()).collect();
    assert_eq!(names, ["a[1]", "a[2]", "b[1]", "b[2]", "c[7]", "c[3]", "d[1]", "d[2]"]);
}

#[test]
fn values_may_be_declared_after_the_loops_and_indices_that_use_them() {
    let lines = "for i in 1..n { fmu air[i] = \"wind\" { stream = i } }\nfmu far[n] = \"quadcopter\"\nlet n = 2
air[2].velocity -> far[2].wind";
    let shown = all_shown(&flight(lines));
    assert!(!shown.contains("error") && !shown.contains("`n` is not used"), "{shown}");
}

#[test]
fn names_that_several_rounds_give_are_one_error_each() {
    let lines = "for i in 1..2 { fmu a[1] = \"wind\" { stream = i }
  wind.velocity -> quad.wind
  let gap = i * quad.roll
  assert b[1]: always gap < 1 deg
  record gap }
for i in 1..2 { fmu q = \"wind\" { stream = 3 + i }
  let gap = 3 * i * quad.roll
  record gap }
for i in 1..2 { fmu q = \"wind\" { stream = 7 + i } }";
    insta::assert_snapshot!(headings(&flight(lines)));
}

#[test]
fn what_is_wrong_with_loops_and_parts_is_reported_at_its_place() {
    let lines = "for i in 1..quad.roll { let a = 1 }
for j in 1 m..3 s { fmu lost[j] = \"wind\" }
for k in 1..2.5 { let b = 2 }
for m in 3 { let c = 2 }
for o in 1..1000000 { let d = 1 }
for p in 1..2 { fmu same = \"wind\" { stream = p }
  fmu fixed[1] = \"wind\"
  step 3 ms
  param q = 3 }
use gone = \"gone.scn\"
use round = \"circle.scn\"
use run = \"run.scn\"
use part = \"uav.scn\" { sped = 3 m/s, speed = 4 m }
use twice = \"uav.scn\" on a { speed = 1 m/s, speed = 2 m/s }
lost[1].velocity -> quad.wind
for r in 1..3 { fmu few[r] = \"wind\" { stream = r } }
few[4].velocity -> quad.wind
gone.body.state -> ctrl.state
assert w: always part.bodi.roll < 3 deg
assert x: always part < 3 deg
assert y: always part.body.rol < 3 deg
assert z: always i < 2 and part.double[1] < 3 m/s";
    insta::assert_snapshot!(shown(&flight(lines)));
}
