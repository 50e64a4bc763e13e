//! Differences (`relativeQuantity`): the offset of a unit of measure does not apply to them.

use super::fixtures::{flight, headings, scenario, shown};
use dsl::scenario::{Drive, RealExpression, Scenario, Value};

fn heaters(lines: &str) -> String {
    flight(&format!("fmu s = \"heater\"\nfmu d = \"heater\"\n{lines}"))
}

fn number(drive: &Drive) -> f64 {
    match drive {
        Drive::Real(RealExpression::Constant(value)) => *value,
        other => panic!("{other:?}"),
    }
}

/// The factors and offsets that the connections apply.
fn conversions(scenario: &Scenario) -> Vec<String> {
    let shown = |drive: &Drive| match drive {
        Drive::Copy(_) => "copy".to_owned(),
        Drive::Real(expression) => format!("{expression:?}"),
        other => panic!("{other:?}"),
    };
    scenario.connections.iter().map(|connection| shown(&connection.source)).collect()
}

#[test]
fn a_connection_of_differences_has_no_offset() {
    let made = conversions(&scenario(&heaters("s.rise -> d.riseK, d.riseF\ns.temp -> d.tempK, d.tempC")));
    insta::assert_snapshot!(made.join("\n"), @r"
    copy
    InverseAffine { of: Signal(Port { instance: 3, variable: 7 }), factor: 0.5555555555555556, offset: 0.0 }
    Affine { of: Signal(Port { instance: 3, variable: 8 }), factor: 1.0, offset: 273.15 }
    copy
    ");
}

#[test]
fn a_literal_for_a_difference_is_one() {
    let made = scenario(&heaters(
        "param by = 9 degF\nfmu a = \"heater\" { dT = 5 K }\nfmu b = \"heater\" { dT = 5 degC }\n\
         fmu c = \"heater\" { dT = by, tempC = 5 degC }\n\
         at 1 s { set d.riseK = 5 degC, set d.riseF = 5 K, set d.tempK = 5 degC }\n2 bar -> d.over",
    ));
    let presets = made.instances[5..].iter().flat_map(|instance| &instance.presets);
    let presets = presets.map(|preset| match preset.value {
        Value::Real(value) => value,
        ref other => panic!("{other:?}"),
    });
    assert_eq!(presets.collect::<Vec<_>>(), [5.0, 5.0, 5.0, 5.0]);
    let sets = made.events[0].sets().map(|set| number(&set.value));
    assert_eq!(sets.collect::<Vec<_>>(), [5.0, 9.0, 278.15]);
    assert_eq!(number(&made.connections[0].source), 2.0);
}

#[test]
fn a_difference_is_no_point_on_a_scale() {
    insta::assert_snapshot!(shown(&heaters("s.rise -> d.tempK\ns.temp -> d.riseF")), @r"
    error[E32]: `d.tempK` takes a point on a scale, and `s.rise` is a difference
     --> test.scn:9:1
      |
    9 | s.rise -> d.tempK
      | ^^^^^^    ------- takes a point on a scale
      | |
      | gives a difference
      |
      = help: add the point that it counts from: `s.rise + 273.15 K`

    error[E32]: `d.riseF` takes a difference, and `s.temp` is a point on a scale
      --> test.scn:10:1
       |
    10 | s.temp -> d.riseF
       | ^^^^^^    ------- takes a difference
       | |
       | gives a point on a scale
       |
       = help: subtract the point to count from: `s.temp - 273.15 K`
    ");
    let lines = "s.gap -> d.plain\n2 * s.rise -> d.tempC\nassert a: always s.rise < s.temp\n\
                 assert b: always max(s.rise, s.temp) < 3 K\nat 1 s { set d.dT = s.temp }\ns.temp - s.other -> s.tempC\n\
                 s.pressure -> d.over";
    insta::assert_snapshot!(headings(&heaters(lines)), @r"
    error[E32]: `d.plain` takes a point on a scale, and `s.gap` is a difference
    = help: add the point that it counts from
    error[E32]: `d.tempC` takes a point on a scale, and `2 * s.rise` is a difference
    = help: add the point that it counts from: `2 * s.rise + 273.15 K`
    error[E32]: a difference cannot be compared with a point on a scale
    = help: compare two points or two differences: the difference of two points is `a - b`
    error[E32]: a difference cannot be compared with a point on a scale
    = help: compare two points or two differences: the difference of two points is `a - b`
    error[E32]: `d.dT` takes a difference, and `s.temp` is a point on a scale
    = help: subtract the point to count from: `s.temp - 273.15 K`
    error[E32]: `s.tempC` takes a point on a scale, and `s.temp - s.other` is a difference
    = help: add the point that it counts from: `s.temp - s.other + 273.15 K`
    error[E32]: `d.over` takes a difference, and `s.pressure` is a point on a scale
    = help: subtract the point to count from
    ");
}

#[test]
fn points_and_differences_compute() {
    let lines = "s.temp - s.other -> d.riseK\ns.temp + s.rise -> d.tempK\ns.rise + 293.15 K -> d.tempC\n\
                 s.temp - 273.15 K -> d.riseF\ns.error -> s.riseK\ns.error -> s.tempK";
    scenario(&heaters(lines));
}

#[test]
fn a_claim_on_a_difference_compares_differences() {
    let lines = "assert a: always s.rise < 12 K\nassert b: always s.rise < 12 degC\n\
                 assert c: always s.temp - s.other < 12 degC\nassert d: always (s.rise in degF) < 18\n\
                 assert e: always s.rise == 10 K ± 1 K\nassert f: always s.temp < 12 degC";
    let made = scenario(&heaters(lines));
    let shown = made
        .claims
        .iter()
        .map(|claim| format!("{}: {:?} {:?}\n{:?}", claim.name, claim.limit, claim.unit, claim.formula));
    insta::assert_snapshot!(shown.collect::<Vec<_>>().join("\n"), @r#"
    a: Some(Limit { value: 12.0, upper: true }) Some(MarginUnit { name: "K", factor: 1.0 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Constant(12.0), Signal(Port { instance: 3, variable: 7 })), strict: true }))
    b: Some(Limit { value: 12.0, upper: true }) Some(MarginUnit { name: "degC", factor: 1.0 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Constant(12.0), Signal(Port { instance: 3, variable: 7 })), strict: true }))
    c: Some(Limit { value: 12.0, upper: true }) Some(MarginUnit { name: "degC", factor: 1.0 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Constant(12.0), Subtract(Affine { of: Signal(Port { instance: 3, variable: 8 }), factor: 1.0, offset: 273.15 }, Affine { of: Signal(Port { instance: 3, variable: 9 }), factor: 1.0, offset: 273.15 })), strict: true }))
    d: Some(Limit { value: 18.0, upper: true }) Some(MarginUnit { name: "", factor: 1.0 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Constant(18.0), InverseAffine { of: Signal(Port { instance: 3, variable: 7 }), factor: 0.5555555555555556, offset: 0.0 }), strict: true }))
    e: None Some(MarginUnit { name: "K", factor: 1.0 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Constant(1.0), Call(Abs, [Subtract(Signal(Port { instance: 3, variable: 7 }), Constant(10.0))])), strict: false }))
    f: Some(Limit { value: 285.15, upper: true }) Some(MarginUnit { name: "K", factor: 1.0 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Constant(285.15), Affine { of: Signal(Port { instance: 3, variable: 8 }), factor: 1.0, offset: 273.15 }), strict: true }))
    "#);
}
