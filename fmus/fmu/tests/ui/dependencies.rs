//! Outputs that depend on ports that do not exist or are computed themselves.

use fmu::Fmu;

/// A struct or enum
#[derive(Fmu)]
struct Unit {
    /// A port
    #[input(unit = "m")]
    length: f64,
    /// A port
    #[output(unit = "m", depends(lenght))]
    unknown: f64,
    /// A port
    #[output(unit = "m", depends(unknown))]
    computed: f64,
    /// A port
    #[output(unit = "m", depends(), init(depends(hidden)))]
    on_hidden: f64,
    hidden: f64,
}

fn main() {}
