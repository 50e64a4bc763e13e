//! Roles with attributes that the standard's table does not allow together.

use fmu::Fmu;

#[derive(Fmu)]
struct Unit {
    #[output(unit = "m")]
    depends_on_what: f64,
    #[output(exact = 0.0, depends(), unit = "m")]
    exact_and_computed: f64,
    #[output(start = 0.0, depends(), unit = "m")]
    computed_with_start: f64,
    #[input(tunable, unit = "m")]
    tunable_input: f64,
    #[parameter(exact = 1.0, unit = "m")]
    exact_parameter: f64,
    #[local(depends(), unit = "m")]
    local_that_depends: f64,
    #[input(unit = "m")]
    #[output(unit = "m", depends())]
    two_roles: f64,
    #[input(units = "m")]
    misspelt: f64,
}

fn main() {}
