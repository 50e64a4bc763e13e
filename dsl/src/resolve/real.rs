//! Builds real expressions; what is known before the run is computed here, with the run's own arithmetic.

use fmi2::units::BaseUnit;

use crate::scenario::{Function, RealExpression as E};
use crate::syntax::Operator;

/// `left operator right`
pub(super) fn combine(operator: Operator, left: E, right: E) -> E {
    if let (&E::Constant(l), &E::Constant(r)) = (&left, &right) {
        return E::Constant(match operator {
            Operator::Add => l + r,
            Operator::Subtract => l - r,
            Operator::Multiply => l * r,
            Operator::Divide => l / r,
        });
    }
    let (left, right) = (Box::new(left), Box::new(right));
    match operator {
        Operator::Add => E::Add(left, right),
        Operator::Subtract => E::Subtract(left, right),
        Operator::Multiply => E::Multiply(left, right),
        Operator::Divide => E::Divide(left, right),
    }
}

/// `-of`
pub(super) fn negate(of: E) -> E {
    match of {
        E::Constant(value) => E::Constant(-value),
        of => E::Negate(Box::new(of)),
    }
}

/// A function of its arguments.
pub(super) fn call(function: Function, arguments: Vec<E>) -> E {
    let constants = arguments.iter().map(|argument| match argument {
        E::Constant(value) => Some(*value),
        _ => None,
    });
    match constants.collect::<Option<Vec<_>>>() {
        Some(values) => E::Constant(function.apply(&values)),
        None => E::Call(function, arguments),
    }
}

/// From a unit of measure to SI, with the operations of [`BaseUnit::to_si`]; the identity leaves no trace.
pub(super) fn to_si(of: E, unit: BaseUnit) -> E {
    let BaseUnit { factor, offset, .. } = unit;
    match (of, unit.parts()) {
        (E::Constant(value), _) => E::Constant(unit.to_si(value)),
        (of, Some(parts)) => E::InverseAffine { of: Box::new(of), factor: parts, offset },
        (of, None) if (factor, offset) == (1.0, 0.0) => of,
        (of, None) => E::Affine { of: Box::new(of), factor, offset },
    }
}

/// From SI to a unit of measure, with the operations of [`BaseUnit::from_si`]; the identity leaves no trace.
pub(super) fn from_si(of: E, unit: BaseUnit) -> E {
    let BaseUnit { factor, offset, .. } = unit;
    match (of, unit.parts()) {
        (E::Constant(value), _) => E::Constant(unit.from_si(value)),
        (of, Some(parts)) => E::Affine { of: Box::new(of), factor: parts, offset },
        (of, None) if (factor, offset) == (1.0, 0.0) => of,
        (of, None) => E::InverseAffine { of: Box::new(of), factor, offset },
    }
}

#[test]
fn what_is_known_before_the_run_is_one_number() {
    let half = combine(Operator::Divide, E::Constant(1.0), E::Constant(2.0));
    assert_eq!(call(Function::Max, vec![half, negate(E::Constant(3.0))]), E::Constant(0.5));
}

#[test]
fn what_depends_on_time_stays_an_expression() {
    assert_eq!(
        combine(Operator::Multiply, E::Constant(2.0), E::Time),
        E::Multiply(Box::new(E::Constant(2.0)), Box::new(E::Time))
    );
}
