//! Structs and enums that cannot be ports.

use fmu::{FmiEnum, Fmu, Group};

#[derive(Fmu)]
struct Tuple(f64);

#[derive(Fmu)]
struct Generic<T> {
    inner: T,
}

#[derive(Fmu)]
struct PortInAUnit {
    #[port(unit = "m")]
    length: f64,
}

#[derive(Group)]
struct Mixed {
    #[port(unit = "m")]
    outside: f64,
    #[input(unit = "m")]
    inside: f64,
}

#[derive(FmiEnum)]
enum Data {
    Empty,
    Full(f64),
}

fn main() {}
