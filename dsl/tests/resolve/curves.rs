//! `curve`: values over time out of a file.

use super::fixtures::{flight, run_with, shown};
use dsl::scenario::Drive;

#[test]
fn a_column_drives_an_input_in_its_unit_and_a_prefix_is_a_vector() {
    let lines = "curve(\"in.csv\", \"place\") -> ctrl.state.position
curve(\"in.csv\", \"u\") -> quad.wind.x
2 * curve(\"in.csv\", \"u\") -> quad.wind.y
curve(\"in.csv\", \"on\") -> ctrl.armed, ctrl.count
assert near: always dist(quad.state.position, curve(\"in.csv\", \"place\")) < 1 m";
    let scenario = run_with(&flight(lines), &[]).resolved.scenario.expect("no error");
    let kind = |drive: &Drive| match drive {
        Drive::Real(value) => format!("{value:?}").replace("(0.0, 0.0), ", ""),
        Drive::Curve(curve) => format!("held {}", curve.held),
        other => format!("{other:?}"),
    };
    let drives: Vec<_> = scenario.connections.iter().map(|it| kind(&it.source)).collect();
    insta::assert_snapshot!(drives.join("\n"));
}

#[test]
fn what_is_wrong_with_a_curve_is_reported_at_its_place() {
    let lines = "let a = curve(\"gone.csv\", \"u\")
let b = curve(\"in.csv\", \"plaec\")
let c = curve(\"in.csv\")
let d = curve(\"in.csv\", 3)
let e = curve(\"in.csv\", \"bad\")
curve(\"in.csv\", \"u\") -> quad.moment
curve(\"in.csv\", \"place\") -> ctrl.armed
let f = curve(\"in.csv\", quad.roll)";
    insta::assert_snapshot!(shown(&flight(lines)));
}

#[test]
fn a_tolerance_of_time_is_the_least_distance_from_a_curve_in_si() {
    let lines = "let x = curve(\"in.csv\", \"u\")
assert near: always quad.state.position.x / 1 s == x ± 1 m/s within 25 ms
assert turned: always x == quad.state.position.x / 1 s ± 1 m/s within (1 s)";
    let scenario = run_with(&flight(lines), &[]).resolved.scenario.expect("no error");
    let claims: Vec<_> = scenario.claims.iter().map(|claim| format!("{:?}", claim.formula)).collect();
    insta::assert_snapshot!(claims.join("\n"));
}

#[test]
fn a_tolerance_of_time_wants_a_curve_and_a_span_of_time() {
    let lines = "let x = curve(\"in.csv\", \"u\")
assert a: always quad.roll == quad.roll ± 1 deg within 20 ms
assert b: always quad.state.position.x / 1 s == x + 1 m/s ± 1 m/s within 20 ms
assert c: always quad.state.position.x / 1 s == x ± 1 m/s within 20
assert d: always quad.state.position.x / 1 s == x ± 1 m/s within quad.roll
assert e: always quad.state.position.x / 1 s < x ± 1 m/s within 20 ms
assert f: always x == curve(\"in.csv\", \"u\") ± 1 m/s within 20 ms
assert g: always quad.state.position.x / 1 s == x ± -1 m/s";
    insta::assert_snapshot!(super::fixtures::headings(&flight(lines)));
}
