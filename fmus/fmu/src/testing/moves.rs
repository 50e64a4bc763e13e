//! Other values for a variable, and whether an output moved.

use crate::visitor::Value;
use fmi2::description::{Kind, ModelDescription};

/// How far a Real is moved, in parts of its size: a little, and across many a threshold.
const MOVES: [f64; 4] = [1e-3, 0.37, -1e-3, -0.37];
/// How many values of a Real are tried.
const REALS: usize = 2;
/// What counts as rounding, in parts of the output's size.
const ROUNDING: f64 = 1e-12;
/// A state moves in proportion to the time that passes, so in a step 1000 times as short by a thousandth.
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

/// Whether an output moved with the input itself, not with the time that passed since.
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
    fn a_state_moves_with_time_only() {
        let acceleration = 1e4;
        assert!(!moved_at_once(&pair(0.0, acceleration * 1e-9), &pair(0.0, acceleration * 1e-6)));
        assert!(!moved_at_once(&pair(1e3, 1e3 + 1e-13), &pair(1e3, 1e3)), "rounding");
    }

    #[test]
    fn a_feedthrough_moves_at_once() {
        assert!(moved_at_once(&pair(0.0, 1e-6), &pair(0.0, 1e-6)));
        assert!(moved_at_once(&pair(2.0, 3.0), &pair(2.0, 3.001)));
    }
}
