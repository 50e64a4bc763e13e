//! The tests that every unit gets from [`export!`](crate::export).

mod bases;
mod dependencies;
mod extremes;
mod moves;
mod states;
mod subject;

use crate::library::Library;
use fmi2::description::{check, read};
use std::fmt;

pub use dependencies::outputs_depend_on_what_they_declare;
pub use extremes::finite_values_give_finite_outputs_or_a_fault;
pub use states::{a_saved_state_goes_on_bit_for_bit, init_can_be_repeated, read_foreign_state, written_state};

/// Violations that a test of the export layer found in a unit, one line each.
#[derive(Clone, PartialEq, Eq)]
pub struct Findings(pub Vec<String>);

impl Findings {
    fn none_or(lines: Vec<String>) -> Result<(), Self> {
        if lines.is_empty() { Ok(()) } else { Err(Self(lines)) }
    }
}

/// One line for each finding, because a failing test shows the `Debug` form.
impl fmt::Debug for Findings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|line| write!(f, "\n  {line}"))
    }
}

/// Checks that the written description breaks no rule of the standard.
///
/// # Errors
///
/// The broken rules.
pub fn the_description_keeps_every_rule_of_the_standard(library: &'static Library) -> Result<(), Findings> {
    let findings = match read::read(library.xml().as_bytes()) {
        Ok((description, mut findings)) => {
            findings.extend(check::check(&description));
            findings
        }
        Err(finding) => vec![finding],
    };
    Findings::none_or(findings.iter().map(ToString::to_string).collect())
}

/// The tests of a unit.
#[doc(hidden)]
#[macro_export]
macro_rules! export_tests {
    ($library:ident: $($test:ident)*) => {
        #[cfg(test)]
        mod exported_tests {
            $(
                #[test]
                fn $test() -> ::core::result::Result<(), $crate::testing::Findings> {
                    $crate::testing::$test(&super::$library)
                }
            )*
        }
    };
}
