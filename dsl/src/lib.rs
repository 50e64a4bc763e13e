//! The scenario language: text in, a [`Scenario`](scenario::Scenario) or diagnostics out.
//!
//! ```text
//! text --parse--> syntax tree --resolve (with what the loader returns)--> scenario
//! ```
//!
//! Nothing here opens a file, reads a clock or uses a network: the caller passes the text, what the command line sets and a
//! [`Loader`](loader::Loader) for files and units. The text side is the crate `scn`. Next on the walk of a number:
//! `scn/src/scenario.pest`, the grammar.
#![forbid(unsafe_code)]

pub mod groups;
pub mod loader;
pub mod parts;
pub mod random;
pub mod resolve;
pub mod scenario;
pub mod skeleton;

pub use scn::{diagnostic, format, nearest, parse, source, spelling, syntax};
