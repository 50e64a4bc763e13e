//! Units of measure that are unknown or not compatible.

use fmu::Fmu;

/// A struct or enum
#[derive(Fmu)]
struct Unit {
    /// A port
    #[input(unit = "metre")]
    unknown: f64,
    /// A port
    #[input(unit = "m/s", display = "rpm")]
    other_dimension: f64,
    /// A port
    #[input(display = "km")]
    display_only: f64,
}

fn main() {}
