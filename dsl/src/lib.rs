//! The scenario language: text in, a [`Scenario`](scenario::Scenario) or diagnostics out.
//!
//! ```text
//! text --parse--> syntax tree --resolve (with the units' descriptions)--> scenario
//! ```
//!
//! Nothing here opens a file, reads a clock or talks to a network: whoever calls hands in the text, the units' model
//! descriptions and what the command line sets. Next on the walk of a number: `scenario.pest`, the grammar.
#![forbid(unsafe_code)]

pub mod diagnostic;
pub mod nearest;
pub mod parse;
pub mod resolve;
pub mod scenario;
pub mod source;
pub mod syntax;
