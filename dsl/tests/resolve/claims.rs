//! What claims mean: formulas, units and limits.

use super::fixtures::{flight, run_with, scenario};
use dsl::scenario::{BooleanExpression, Claim, Formula, Limit, RealExpression, TickWindow};

fn claim(text: &str) -> Claim {
    scenario(&flight(&format!("assert a: {text}"))).claims.remove(0)
}

#[test]
fn always_is_a_window_without_end() {
    let claim = claim("always quad.roll < 35 deg");
    assert!(matches!(claim.formula, Formula::Always(TickWindow { from: 0, to: None }, _)));
}

#[test]
fn nested_windows_are_in_ticks() {
    let claim = claim("eventually within 20 s hold for 2 s quad.landed");
    let Formula::Eventually(TickWindow { from: 0, to: Some(2_000) }, body) = &claim.formula else {
        panic!("{claim:?}")
    };
    assert!(matches!(**body, Formula::Always(TickWindow { from: 0, to: Some(200) }, _)));
    assert_eq!(claim.unit, None);
}

#[test]
fn after_begins_later_and_a_range_takes_the_last_unit_for_both_ends() {
    assert!(matches!(
        claim("always after 2 s quad.landed").formula,
        Formula::Always(TickWindow { from: 200, to: None }, _)
    ));
    assert!(matches!(
        claim("eventually within 2..5 s quad.landed").formula,
        Formula::Eventually(TickWindow { from: 200, to: Some(500) }, _)
    ));
}

#[test]
fn a_limit_has_the_unit_of_its_literal() {
    let claim = claim("always quad.roll < 35 deg");
    let unit = claim.unit.expect("a margin of reals");
    assert_eq!((unit.name.as_str(), unit.factor), ("deg", std::f64::consts::PI / 180.0));
    assert_eq!(claim.limit, Some(Limit { value: 35.0, upper: true }));
}

#[test]
fn a_limit_on_the_left_and_a_negation_swap_the_side() {
    assert_eq!(claim("always 3 m < quad.height").limit, Some(Limit { value: 3.0, upper: false }));
    assert_eq!(claim("always not (quad.height > 3 m)").limit, Some(Limit { value: 3.0, upper: true }));
    assert_eq!(claim("always 1 m < quad.height < 3 m").limit, None);
}

#[test]
fn without_a_literal_the_unit_is_that_of_the_signal_and_kelvin_for_celsius() {
    let of = |text: &str| claim(text).unit.map(|unit| (unit.name, unit.factor));
    assert_eq!(of("always quad.height > quad.state.position.z"), Some(("ft".to_owned(), 0.3048)));
    assert_eq!(of("always ctrl.temperature < 30 degC"), Some(("K".to_owned(), 1.0)));
    assert_eq!(of("always norm(quad.state.position) / 1 m < 3"), Some((String::new(), 1.0)));
}

#[test]
fn negations_move_inward_and_swap_always_and_eventually() {
    let claim = claim("not eventually (quad.landed and quad.roll > 3 deg)");
    let Formula::Always(_, body) = claim.formula else { panic!("{claim:?}") };
    let Formula::Or(parts) = *body else { panic!("{body:?}") };
    assert!(matches!(&parts[0], Formula::Condition(BooleanExpression::Not(_))));
    let Formula::Margin(margin) = &parts[1] else { panic!("{parts:?}") };
    assert!(!margin.strict);
    assert!(matches!(margin.value, RealExpression::Negate(_)));
}

#[test]
fn equality_of_reals_is_a_tolerance_minus_a_distance() {
    let claim = claim("always quad.state.position.x == 3 m ± 10 cm");
    let Formula::Always(_, body) = claim.formula else { panic!() };
    let Formula::Margin(margin) = *body else { panic!() };
    let RealExpression::Subtract(tolerance, distance) = margin.value else { panic!() };
    assert_eq!(*tolerance, RealExpression::Constant(0.1));
    assert!(matches!(*distance, RealExpression::Call(dsl::scenario::Function::Abs, _)));
    assert!(!margin.strict);
}

#[test]
fn a_let_may_hold_a_claim_that_an_assert_uses() {
    let scenario = scenario(&flight("let late = eventually quad.landed\nassert a: late"));
    assert!(matches!(scenario.claims[0].formula, Formula::Eventually(..)));
}

#[test]
fn rises_has_one_slot_for_one_condition() {
    let lines =
        "let up = rises(quad.height > 3 m)\nassert a: eventually up\nassert b: always not rises(quad.height > 3 m)";
    assert_eq!(scenario(&flight(lines)).conditions.len(), 1);
}

#[test]
fn signals_of_claims_are_columns_unless_record_says_otherwise() {
    let names = |lines: &str| {
        let columns = scenario(&flight(lines)).columns;
        columns.into_iter().map(|column| column.name).collect::<Vec<_>>()
    };
    let claim = "assert a: eventually (rises(quad.height > 3 m) and not ctrl.now == \"idle\")";
    assert_eq!(names(claim), ["quad.height", "ctrl.now"]);
    assert_eq!(names(&format!("wind.velocity.y -> quad.wind.x\n{claim}"))[..2], ["wind.velocity.y", "quad.wind.x"]);
    assert_eq!(
        names(&format!("{claim}\nrecord quad.wind.y, quad.roll, quad.wind")),
        ["quad.wind.y", "quad.roll", "quad.wind.x", "quad.wind.z"]
    );
}

#[test]
fn a_claim_within_the_run_to_the_last_tick_is_fine() {
    let outcome = run_with(&flight("assert a: eventually within 58 s hold for 2 s quad.landed"), &[]);
    assert!(outcome.resolved.scenario.is_some());
}
