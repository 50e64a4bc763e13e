//! The parser that pest makes of `scenario.pest`.

/// Matches the grammar's rules against a text.
#[derive(pest_derive::Parser)]
#[grammar = "scenario.pest"]
pub(super) struct Grammar;
