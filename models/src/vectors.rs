//! The test vectors of `tests/vectors.json`, read by the unit tests.

use nalgebra::Vector3;
use serde_json::Value;

/// Returns the vector stored under `key`.
pub fn get(key: &str) -> Value {
    let all: Value = serde_json::from_str(include_str!("../tests/vectors.json")).unwrap();
    all.get(key).unwrap_or_else(|| panic!("vectors.json has no key '{key}'")).clone()
}

/// Reads one number.
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

/// Reads a list of numbers.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

/// Reads three numbers as a vector.
pub fn vector3(value: &Value) -> Vector3<f64> {
    Vector3::from_column_slice(&numbers(value))
}

/// Asserts that `actual` is `expected` within `tolerance`, relative unless zero is expected.
#[track_caller]
pub fn assert_close(actual: f64, expected: f64, tolerance: f64) {
    let allowed = if expected == 0.0 { tolerance } else { tolerance * expected.abs() };
    assert!((actual - expected).abs() <= allowed, "{actual} is not {expected} within {allowed:e}");
}

/// Asserts [`assert_close`] for each element.
#[track_caller]
pub fn assert_all_close(actual: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(actual.len(), expected.len());
    for (actual, expected) in actual.iter().zip(expected) {
        assert_close(*actual, *expected, tolerance);
    }
}
