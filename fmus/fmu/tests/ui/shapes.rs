//! Structs and enums that cannot be ports.

use fmu::{FmiEnum, Fmu, Group};

/// A struct or enum
#[derive(Fmu)]
struct Tuple(f64);

/// A struct or enum
#[derive(Fmu)]
struct Generic<T> {
    inner: T,
}

/// A struct or enum
#[derive(Fmu)]
struct PortInAUnit {
    #[port(unit = "m")]
    length: f64,
}

#[derive(Group)]
struct Mixed {
    #[port(unit = "m")]
    outside: f64,
    /// A port
    #[input(unit = "m")]
    inside: f64,
}

/// A struct or enum
#[derive(FmiEnum, Clone, Copy)]
enum Data {
    /// Nothing
    Empty,
    /// Something
    Full(f64),
}

#[derive(FmiEnum, Clone, Copy)]
enum Undescribed {
    Item,
}

#[derive(Fmu)]
struct UnitWithoutWords {
    #[input(unit = "m")]
    length: f64,
}

fn main() {}
