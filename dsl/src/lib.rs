//! The scenario language: text in, a [`Scenario`](scenario::Scenario) or diagnostics out.
//!
//! ```text
//! text --parse--> syntax tree --resolve (with what the loader returns)--> scenario
//! ```
//!
//! Nothing here opens a file, reads a clock or uses a network: the caller passes the text, what the command line sets and a
//! [`Loader`](loader::Loader) for files and units. Next on the walk of a number: `scenario.pest`, the grammar.
#![forbid(unsafe_code)]

pub mod diagnostic;
pub mod format;
pub mod groups;
pub mod loader;
pub mod nearest;
pub mod parse;
pub mod parts;
pub mod resolve;
pub mod scenario;
pub mod skeleton;
pub mod source;
pub mod spelling;
pub mod syntax;
