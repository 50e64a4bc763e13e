//! Text to syntax tree, or to what is wrong with the text.
//!
//! ```text
//! text --scan--> blanked text --grammar--> pairs --tree--> syntax::File
//!                                   |error
//!                                   +--explain--> Diagnostic, on with the next line that begins a statement
//! ```

mod explain;
mod expressions;
mod failure;
mod grammar;
mod lines;
mod mistakes;
mod scan;
mod shape;
mod slips;
mod tree;
mod wording;

use std::thread;

use failure::Place;
use grammar::{Grammar, Rule};
pub(crate) use lines::quoted_length;
pub use lines::symbols;
use pest::Parser;
use pest::iterators::Pair;
pub(crate) use shape::{Atom, Item, Shape, shape};

use crate::diagnostic::Diagnostic;
use crate::source::{Sources, Span};
use crate::syntax::{Binding, File, Value};

/// A text, read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parsed {
    /// The tree as far as it goes: of a statement with a syntax error nothing is kept, and what follows the error in a
    /// block is outside of it. A tree with errors is for editors; its meaning would have errors that the whole script
    /// does not have.
    pub file: File,
    /// Every syntax error, in the text's order.
    pub diagnostics: Vec<Diagnostic>,
}

/// Parses one text of `sources`, a whole file.
#[must_use]
pub fn parse(sources: &Sources, text: u32) -> Parsed {
    let source = sources.text(text);
    let parsed = with_stack(text, || {
        let scan::Scanned { text: blanked, mut diagnostics } = scan::scan(source, text);
        let mut walk = tree::Walk::new(source, text);
        let mut statements = Vec::new();
        let (mut from, mut matched) = (0, match_rule(Rule::file, &blanked));
        while let Err(error) = matched {
            let explained = explain::statements(&Place { blanked: &blanked, text, from }, &error);
            diagnostics.push(explained.diagnostic);
            if let Ok(before) = match_rule(Rule::rest, &blanked[from..explained.statement]) {
                statements.extend(walk.statements_from(from, before));
            }
            // They would change what users read of the syntax errors.
            walk.diagnostics.clear();
            from = explained.resume;
            matched = match_rest(&blanked, from);
        }
        let is_whole = from == 0;
        if let Ok(rest) = matched {
            statements.extend(walk.statements_from(from, rest));
        }
        if is_whole {
            diagnostics.append(&mut walk.diagnostics);
        }
        diagnostics.sort_by_key(|diagnostic| diagnostic.labels.first().map(|label| label.span));
        Parsed { file: File { statements }, diagnostics }
    });
    parsed.unwrap_or_else(|error| Parsed { file: File { statements: Vec::new() }, diagnostics: vec![error] })
}

/// Matches what follows a byte, in a window that grows: pest's own search for an error's line runs from the end of the text
/// it is given, which for many errors in a long text would take quadratic time.
fn match_rest(blanked: &str, from: usize) -> Matched<'_> {
    const FIRST_WINDOW_BYTES: usize = 4096;
    let mut window_bytes = FIRST_WINDOW_BYTES;
    loop {
        let end = lines::line_end(blanked, blanked.floor_char_boundary(from + window_bytes));
        let matched = match_rule(Rule::rest, &blanked[from..end]);
        let last_line = lines::line_start(blanked, end).saturating_sub(from);
        match matched {
            Err(error) if end < blanked.len() && failure::position(&error) >= last_line => window_bytes *= 4,
            Ok(_) if end < blanked.len() => window_bytes *= 4,
            matched => return matched,
        }
    }
}

/// Parses one text of `sources`, an assignment of the command line such as `gust = 6 m/s`.
///
/// # Errors
///
/// What is wrong with the text.
pub fn parse_assignment(sources: &Sources, text: u32) -> Result<Binding, Vec<Diagnostic>> {
    parse_one(sources, text, Rule::assignment, "gust = 6 m/s", |walk, pair| walk.binding(pair))
}

/// Parses one text of `sources`, a start value of the command line such as `mass = 1.6 kg`.
///
/// # Errors
///
/// What is wrong with the text.
pub fn parse_start_value(sources: &Sources, text: u32) -> Result<Value, Vec<Diagnostic>> {
    parse_one(sources, text, Rule::start_value, "mass = 1.6 kg", |walk, pair| {
        walk.value(tree::next(&mut tree::parts(pair)))
    })
}

/// Parses a text that matches one rule; it looks like `example`.
fn parse_one<T: Send>(
    sources: &Sources,
    text: u32,
    rule: Rule,
    example: &str,
    build: fn(&mut tree::Walk<'_>, Pair<'_, Rule>) -> T,
) -> Result<T, Vec<Diagnostic>> {
    let source = sources.text(text);
    let parsed = with_stack(text, || {
        let scan::Scanned { text: blanked, mut diagnostics } = scan::scan(source, text);
        let mut walk = tree::Walk::new(source, text);
        let built = match match_rule(rule, &blanked) {
            Ok(pair) => Ok(build(&mut walk, pair)),
            Err(error) => Err(explain::assignment(&Place { blanked: &blanked, text, from: 0 }, &error, example)),
        };
        diagnostics.append(&mut walk.diagnostics);
        match built {
            Ok(built) if diagnostics.is_empty() => Ok(built),
            Ok(_) => Err(diagnostics),
            Err(error) if diagnostics.is_empty() => Err(vec![error]),
            Err(_) => Err(diagnostics),
        }
    });
    parsed.unwrap_or_else(|error| Err(vec![error]))
}

/// The one pair of a match, or where and why it failed.
type Matched<'i> = Result<Pair<'i, Rule>, Box<pest::error::Error<Rule>>>;

/// The one pair of a rule that spans a whole text.
fn match_rule(rule: Rule, text: &str) -> Matched<'_> {
    let matched = Grammar::parse(rule, text).or_else(|error| match error.parse_attempts() {
        Some(_) => Err(error),
        // Without it pest does not report how far the match came; valid texts parse faster without it.
        None => {
            pest::set_error_detail(true);
            Grammar::parse(rule, text)
        }
    });
    matched.map_err(Box::new).map(tree::only)
}

/// Whether a script can write a unit of measure behind a number without quotes.
#[must_use]
pub fn is_plain_unit(unit: &str) -> bool {
    !unit.starts_with('\'') && Grammar::parse(Rule::unit, unit).is_ok_and(|matched| matched.as_str() == unit)
}

/// Runs `work` with a stack for the deepest nesting allowed, independent of the caller's stack.
///
/// # Errors
/// The system starts no thread; the diagnostic is at the beginning of `text`.
pub fn with_stack<R: Send>(text: u32, work: impl FnOnce() -> R + Send) -> Result<R, Diagnostic> {
    const STACK_BYTES: usize = 64 << 20;
    thread::scope(|scope| {
        let parser = thread::Builder::new().name("parse".to_owned()).stack_size(STACK_BYTES);
        match parser.spawn_scoped(scope, work).map(thread::ScopedJoinHandle::join) {
            Ok(Ok(result)) => Ok(result),
            Ok(Err(panic)) => std::panic::resume_unwind(panic),
            Err(error) => {
                let message = format!("cannot start a thread to read the script: {error}");
                let help = "raise the limit of processes and threads (ulimit -u)";
                Err(Diagnostic::error("E00", Span { text, start: 0, end: 0 }, message).help(help))
            }
        }
    })
}
