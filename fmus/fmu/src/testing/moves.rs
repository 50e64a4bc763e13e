//! Other values for a variable, and whether an output changed.

use crate::visitor::Value;
use fmi2::description::{Kind, ModelDescription};

/// Changes of a Real relative to its size: a small one, and one that crosses most thresholds.
const MOVES: [f64; 4] = [1e-3, 0.37, -1e-3, -0.37];
/// Number of values of a Real that are tried.
const REALS: usize = 2;
/// Changes up to this fraction of the output's size are treated as rounding errors.
const ROUNDING: f64 = 1e-12;
/// A state changes in proportion to the elapsed time, so in a step 1000 times as short by a thousandth. A larger ratio
/// means that the output depends on the input directly.
const AT_ONCE: f64 = 0.03;

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

/// An output without and with a change of an input, after a step.
pub(super) struct Pair {
    pub(super) without: Value,
    pub(super) with: Value,
}

impl Pair {
    fn distance(&self) -> f64 {
        match (&self.without, &self.with) {
            (Value::Real(without), Value::Real(with)) => (with - without).abs(),
            (without, with) => f64::from(u8::from(without != with)),
        }
    }
}

/// Whether an output changed with the input itself, not with the time that passed since.
pub(super) fn moved_at_once(short: &Pair, long: &Pair) -> bool {
    let size = if let Value::Real(value) = short.without { value.abs().max(1.0) } else { 1.0 };
    short.distance() > ROUNDING * size && short.distance() > AT_ONCE * long.distance()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pair(without: f64, with: f64) -> Pair {
        Pair { without: Value::Real(without), with: Value::Real(with) }
    }

    #[test]
    fn a_state_changes_with_time_only() {
        let acceleration = 1e4;
        assert!(!moved_at_once(&pair(0.0, acceleration * 1e-9), &pair(0.0, acceleration * 1e-6)));
        assert!(!moved_at_once(&pair(1e3, 1e3 + 1e-13), &pair(1e3, 1e3)), "rounding");
    }

    #[test]
    fn a_feedthrough_changes_at_once() {
        assert!(moved_at_once(&pair(0.0, 1e-6), &pair(0.0, 1e-6)));
        assert!(moved_at_once(&pair(2.0, 3.0), &pair(2.0, 3.001)));
    }
}
