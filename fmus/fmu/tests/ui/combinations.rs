//! Roles with attributes that the standard's table does not allow together.

use fmu::Fmu;

/// A struct or enum
#[derive(Fmu, Clone, serde::Serialize, serde::Deserialize)]
struct Unit {
    /// A port
    #[output(unit = "m")]
    depends_on_what: f64,
    /// A port
    #[output(exact = 0.0, depends(), unit = "m")]
    exact_and_computed: f64,
    /// A port
    #[output(start = 0.0, depends(), unit = "m")]
    computed_with_start: f64,
    /// A port
    #[input(tunable, unit = "m")]
    tunable_input: f64,
    /// A port
    #[parameter(exact = 1.0, unit = "m")]
    exact_parameter: f64,
    /// A port
    #[local(depends(), unit = "m")]
    local_that_depends: f64,
    /// A port
    #[input(unit = "m")]
    #[output(unit = "m", depends())]
    two_roles: f64,
    /// A port
    #[input(units = "m")]
    misspelt: f64,
    /// A port
    #[parameter(start = 3.0, unit = "m", max = 2.0)]
    above: f64,
    /// A port
    #[input(start = [0, -1], min = 0)]
    below: [i32; 2],
    /// A port
    #[input(unit = "m", min = 1.0, max = 0.0)]
    upside_down: f64,
    #[input(unit = "m")]
    undescribed: f64,
}

// The mistakes above are all that the compiler reports, though this needs what they prevent.
impl fmu::Model for Unit {
    fn init(&mut self, _: &mut fmu::Context) -> Result<(), fmu::Fault> {
        Ok(())
    }

    fn step(&mut self, _: fmu::Step, _: &mut fmu::Context) -> Result<fmu::Outcome, fmu::Fault> {
        Ok(fmu::Outcome::Done)
    }
}

fn main() {}
