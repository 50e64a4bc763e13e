//! Tests of compiled expressions.

use super::{Moment, Program, Stack};
use crate::values::{Slot, ValueType, Values};
use dsl::scenario::{BooleanExpression as B, Curve, Function, Margin, Near, Operand, Port, RealExpression as E, Value};
use proptest::prelude::*;
use std::sync::Arc;

/// Variables of instance 0 are Reals 0, 1, …; of instance 1 Integers, of 2 Booleans, of 3 texts.
fn slot_of(port: Port) -> Slot {
    let base = [ValueType::Real, ValueType::Integer, ValueType::Boolean, ValueType::Text][port.instance];
    Slot { base, index: port.variable }
}

fn outputs() -> Values {
    Values {
        reals: vec![3.0, -4.0, f64::NAN],
        integers: vec![7],
        booleans: vec![1, 0],
        texts: vec!["land".into(), "hover".into()],
    }
}

fn real(expression: &E) -> f64 {
    let moment = Moment { outputs: &outputs(), time_s: 1.5, rises: &[false, true], shared: &[] };
    Program::compile_real(expression, &mut slot_of).real(&moment, &mut Stack::default())
}

fn holds(condition: &B) -> bool {
    let moment = Moment { outputs: &outputs(), time_s: 1.5, rises: &[false, true], shared: &[] };
    Program::compile_condition(condition, &mut slot_of).holds(&moment, &mut Stack::default())
}

fn signal(variable: usize) -> E {
    E::Signal(Port { instance: 0, variable })
}

#[test]
fn the_least_distance_from_a_curve_is_that_around_the_moment() {
    // At 1.5 s the curve is 5; it comes down to the 3 of the signal at 1.25 s.
    let curve = Arc::new(Curve { rows: vec![(1.0, 1.0), (2.0, 9.0)], held: false });
    let near = |within_s| E::Near(Near { of: Box::new(signal(0)), curve: Arc::clone(&curve), within_s });
    assert_eq!([0.0, 0.125, 0.25, 9.0].map(|within_s| real(&near(within_s))), [2.0, 1.0, 0.0, 0.0]);
}

#[test]
fn operands_keep_their_order() {
    let difference = E::Subtract(Box::new(signal(0)), Box::new(signal(1)));
    assert_eq!(real(&E::Divide(Box::new(difference), Box::new(E::Constant(2.0)))), 3.5);
    assert_eq!(real(&E::Call(Function::Atan2, vec![E::Constant(0.0), E::Constant(-1.0)])), std::f64::consts::PI);
}

#[test]
fn a_conversion_and_its_inverse_cancel() {
    let kelvin = E::Affine { of: Box::new(E::Constant(20.0)), factor: 1.0, offset: 273.15 };
    assert_eq!(real(&kelvin), 293.15);
    assert_eq!(real(&E::InverseAffine { of: Box::new(kelvin), factor: 1.0, offset: 273.15 }), 20.0);
}

#[test]
fn functions_of_many_arguments_evaluate_from_left_to_right() {
    let all = || vec![signal(0), signal(1), E::Time];
    assert_eq!(real(&E::Call(Function::Sum, all())), 0.5);
    assert_eq!(real(&E::Call(Function::Mean, all())), 0.5 / 3.0);
    assert_eq!(real(&E::Call(Function::Min, all())), -4.0);
    assert_eq!(real(&E::Call(Function::Max, all())), 3.0);
    assert_eq!(real(&E::Call(Function::Norm, vec![signal(0), signal(1)])), 5.0);
}

#[test]
fn the_minimum_and_maximum_with_a_nan_are_a_nan() {
    for function in [Function::Min, Function::Max] {
        assert!(real(&E::Call(function, vec![signal(2), signal(0)])).is_nan());
        assert!(real(&E::Call(function, vec![signal(0), signal(2)])).is_nan());
    }
}

#[test]
fn a_comparison_with_a_nan_is_false_and_strictness_decides_at_zero() {
    let margin = |value, strict| B::Margin(Margin { value, strict });
    assert!(!holds(&margin(signal(2), false)));
    assert!(!holds(&margin(E::Constant(0.0), true)));
    assert!(holds(&margin(E::Constant(0.0), false)));
    assert!(holds(&margin(E::Constant(1e-300), true)));
}

#[test]
fn discrete_values_compare_with_values_of_the_script() {
    let port = |instance, variable| Operand::Signal(Port { instance, variable });
    let text = |text: &str| Operand::Constant(Value::String(text.into()));
    assert!(holds(&B::Same(port(1, 0), Operand::Constant(Value::Integer(7)))));
    assert!(!holds(&B::Same(port(1, 0), Operand::Constant(Value::Integer(8)))));
    assert!(holds(&B::Same(port(2, 1), Operand::Constant(Value::Boolean(false)))));
    assert!(holds(&B::Same(port(3, 0), text("land"))));
    assert!(!holds(&B::Same(text("land"), port(3, 1))));
    assert!(!holds(&B::Same(port(3, 0), port(3, 1))));
}

#[test]
fn conditions_are_joined_negated_and_rise() {
    let [yes, no] = [B::Signal(Port { instance: 2, variable: 0 }), B::Signal(Port { instance: 2, variable: 1 })];
    assert!(!holds(&B::And(vec![yes.clone(), no.clone(), yes.clone()])));
    assert!(holds(&B::Or(vec![no.clone(), no.clone(), yes.clone()])));
    assert!(holds(&B::Not(Box::new(no))));
    assert!(!holds(&B::Rises(0)) && holds(&B::Rises(1)));
    assert!(holds(&B::And(vec![])) && !holds(&B::Or(vec![])) && holds(&B::Constant(true)));
}

/// Includes the numbers at which implementations differ: zeros of both signs, NaN, infinities, the ends of the range.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 5e-324]),
        any::<f64>(),
        -10.0..10.0,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_constant_folded_before_a_run_has_the_bits_that_the_run_computes(
        many in prop::collection::vec(any_number(), 1..5), y in any_number(),
    ) {
        use Function::{Abs, Atan2, Cos, Exp, Floor, Log, Max, Mean, Min, Norm, Sin, Sqrt, Sum, Tan};
        let one = [Abs, Sqrt, Exp, Log, Floor, Sin, Cos, Tan].map(|function| (function, vec![many[0]]));
        let all = [Min, Max, Sum, Mean, Norm].map(|function| (function, many.clone()));
        for (function, arguments) in one.into_iter().chain(all).chain([(Atan2, vec![y, many[0]])]) {
            let folded = function.apply(&arguments);
            let computed = real(&E::Call(function, arguments.iter().map(|&argument| E::Constant(argument)).collect()));
            let is_same = folded.to_bits() == computed.to_bits() || folded.is_nan() && computed.is_nan();
            prop_assert!(is_same, "{function:?} of {arguments:?}: {folded} and {computed}");
        }
    }
}
