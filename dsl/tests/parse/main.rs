//! Scripts as text: what they parse to, and what users read where they do not parse.

mod foreign;
mod format;
mod mistakes;
mod partial;
mod scripts;
mod statements;

use dsl::parse::{Parsed, parse};
use dsl::source::Sources;
use dsl::syntax::{File, StatementKind};

/// A script's tree; a script that does not parse fails the test with its errors.
fn tree(script: &str) -> File {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", script);
    let Parsed { file, diagnostics } = parse(&sources, text);
    assert!(diagnostics.is_empty(), "{}", dsl::diagnostic::render(&sources, &diagnostics, false));
    file
}

/// The only statement of a script.
fn only(script: &str) -> StatementKind {
    let mut statements = tree(script).statements;
    assert_eq!(statements.len(), 1, "{script}");
    statements.remove(0).kind
}

/// What a user reads of a script's errors.
fn errors(script: &str) -> String {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", script);
    let Parsed { diagnostics, .. } = parse(&sources, text);
    assert!(!diagnostics.is_empty(), "this parses: {script}");
    dsl::diagnostic::render(&sources, &diagnostics, false)
}

/// The first line of each of a script's errors.
fn messages(script: &str) -> Vec<String> {
    errors(script).lines().filter(|line| line.starts_with("error")).map(str::to_owned).collect()
}
