//! Other values for a variable, and whether a value changed.

use crate::visitor::Value;
use fmi2::description::{Kind, ModelDescription};

/// Changes of a Real relative to its size: a small one, and one that crosses most thresholds.
const MOVES: [f64; 4] = [1e-3, 0.37, -1e-3, -0.37];
/// Number of values of a Real that are tried.
const REALS: usize = 2;

/// Values other than the present one that the variable may have.
pub(super) fn others(description: &ModelDescription, variable: usize, present: &Value) -> Vec<Value> {
    let variable = &description.variables[variable];
    match (present, &variable.kind) {
        (Value::Real(present), Kind::Real(real)) => {
            let size = present.abs().max(real.nominal.unwrap_or(1.0));
            let (min, max) = (real.min.unwrap_or(f64::MIN), real.max.unwrap_or(f64::MAX));
            let moved = MOVES.iter().map(|part| present + part * size).filter(|value| (min..=max).contains(value));
            moved.take(REALS).map(Value::Real).collect()
        }
        (Value::Integer(present), Kind::Enumeration { .. }) => {
            let items = description.items_of(variable).iter().map(|item| item.value);
            items.filter(|value| value != present).map(Value::Integer).collect()
        }
        (Value::Integer(present), Kind::Integer { min, max, .. }) => {
            let range = min.unwrap_or(i32::MIN)..=max.unwrap_or(i32::MAX);
            let near = [present.saturating_add(1), present.saturating_sub(1)];
            near.into_iter().filter(|value| value != present && range.contains(value)).map(Value::Integer).collect()
        }
        (Value::Boolean(present), _) => vec![Value::Boolean(!present)],
        (Value::String(present), _) => vec![Value::String(format!("{present}x"))],
        _ => vec![],
    }
}

/// Whether two values differ in any bit.
pub(super) fn differs(one: &Value, other: &Value) -> bool {
    match (one, other) {
        (Value::Real(one), Value::Real(other)) => one.to_bits() != other.to_bits(),
        _ => one != other,
    }
}
