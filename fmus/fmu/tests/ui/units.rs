//! Units of measure that are unknown or not compatible.

use fmu::Fmu;

#[derive(Fmu)]
struct Unit {
    #[input(unit = "metre")]
    unknown: f64,
    #[input(unit = "m/s", display = "rpm")]
    other_dimension: f64,
    #[input(display = "km")]
    display_only: f64,
}

fn main() {}
