//! Units of measure that nobody knows, or that do not fit.

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
