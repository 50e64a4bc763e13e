//! A unit is driven through its exported C functions, as an importer drives it.
#![allow(unsafe_code, reason = "an importer calls C functions")]
#![allow(clippy::expect_used, reason = "a test may fail anywhere")]

mod compile_errors;
mod importer;
mod instances;
mod panics;
mod planted;
mod probe;
mod states;
mod time;
mod values;
mod walk;
