//! Mistakes that only the types of the fields reveal.

use fmu::{Fmu, Group};
use nalgebra::Vector3;

/// A struct or enum
#[derive(Fmu)]
struct Unit {
    /// A port
    #[input]
    without_unit: Vector3<f64>,
    /// A port
    #[input(unit = "1")]
    integer_with_unit: i32,
    /// A port
    #[parameter(unit = "m")]
    without_start: f64,
    /// A port
    #[input(start = [0.0; 3], unit = "m")]
    wrong_length: [f64; 4],
    /// A port
    #[input(start = 1, unit = "m")]
    wrong_start: f64,
    /// A port
    #[input(min = 0)]
    switch_with_bound: bool,
    /// A port
    #[input]
    no_port: Vec<f64>,
    /// A port
    #[input]
    roles_inside: Inside,
    #[group]
    roles_outside: Outside,
}

#[derive(Group)]
struct Inside {
    /// A port
    #[input(unit = "m")]
    length: f64,
}

#[derive(Group)]
struct Outside {
    #[port(unit = "m")]
    length: f64,
}

fn main() {}
