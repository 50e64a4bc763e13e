//! Mistakes that only the types of the fields reveal.

use fmu::{Fmu, Group};
use nalgebra::Vector3;

#[derive(Fmu)]
struct Unit {
    #[input]
    without_unit: Vector3<f64>,
    #[input(unit = "1")]
    integer_with_unit: i32,
    #[parameter(unit = "m")]
    without_start: f64,
    #[input(start = [0.0; 3], unit = "m")]
    wrong_length: [f64; 4],
    #[input(start = 1, unit = "m")]
    wrong_start: f64,
    #[input(min = 0)]
    switch_with_bound: bool,
    #[input]
    no_port: Vec<f64>,
    #[input]
    roles_inside: Inside,
    #[group]
    roles_outside: Outside,
}

#[derive(Group)]
struct Inside {
    #[input(unit = "m")]
    length: f64,
}

#[derive(Group)]
struct Outside {
    #[port(unit = "m")]
    length: f64,
}

fn main() {}
