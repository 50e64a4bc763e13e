//! What a formatter needs to know of a text without errors: which of its tokens are names, numbers and units of measure,
//! and where each item begins.

use std::collections::BTreeMap;

use pest::iterators::Pair;

use super::grammar::Rule;
use super::{match_rule, parse, scan, with_stack};
use crate::diagnostic::Diagnostic;
use crate::source::{Sources, Span};

/// What a token is whose signs do not say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Atom {
    /// A name, a number or a text.
    Plain,
    /// The name of a function, which a parenthesis follows.
    Function,
    /// A unit of measure.
    Unit,
    /// The sign of what is not a literal.
    Sign,
    /// The brace that opens the members of a group: `.{x, y}`.
    Members,
    /// The bracket that opens an index.
    Index,
}

/// What may begin a line of its own: a statement, or an entry of braces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Item {
    /// `param`
    Param,
    /// `let`
    Let,
    /// `fmu` and `use`
    Instance,
    /// A connection.
    Wire,
    /// `assert`
    Assert,
    /// `at`
    At,
    /// `when`
    When,
    /// `while`
    While,
    /// A value in the braces of an instance.
    Value,
    /// `set`
    Set,
    /// A parameter of a sweep.
    Axis,
    /// Any other.
    Other,
}

/// The shape of a text, by first byte.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shape {
    /// The tokens whose signs do not say what they are, each with the byte after its last.
    pub atoms: BTreeMap<usize, (usize, Atom)>,
    /// The items.
    pub items: BTreeMap<usize, Item>,
}

/// The shape of one text of `sources`, a whole file.
///
/// # Errors
/// Every syntax error.
pub(crate) fn shape(sources: &Sources, text: u32) -> Result<Shape, Vec<Diagnostic>> {
    let errors = parse(sources, text).diagnostics;
    if !errors.is_empty() {
        return Err(errors);
    }
    with_stack(text, || {
        let blanked = scan::scan(sources.text(text), text).text;
        let mut shape = Shape::default();
        match match_rule(Rule::file, &blanked) {
            Ok(file) => file.into_inner().flatten().for_each(|pair| shape.note(&pair)),
            Err(_) => return Err(Diagnostic::error("E00", Span { text, start: 0, end: 0 }, "this is no script")),
        }
        Ok(shape)
    })
    .and_then(|shape| shape)
    .map_err(|error| vec![error])
}

impl Shape {
    fn note(&mut self, pair: &Pair<'_, Rule>) {
        let start = pair.as_span().start();
        if let Some(item) = item(pair.as_rule()) {
            self.items.entry(start).or_insert(item);
        }
        let length = pair.as_str().trim_end().len();
        let (length, atom) = match pair.as_rule() {
            Rule::ident | Rule::field | Rule::number | Rule::string | Rule::bool => (length, Atom::Plain),
            Rule::unit => (length, Atom::Unit),
            Rule::neg => (1, Atom::Sign),
            Rule::group => (1, Atom::Members),
            Rule::index => (1, Atom::Index),
            Rule::call => {
                let name = pair.clone().into_inner().next();
                (name.map_or(0, |name| name.as_str().len()), Atom::Function)
            }
            _ => return,
        };
        // A call comes before its name.
        self.atoms.entry(start).or_insert((start + length, atom));
    }
}

fn item(rule: Rule) -> Option<Item> {
    Some(match rule {
        Rule::param => Item::Param,
        Rule::let_ => Item::Let,
        Rule::fmu | Rule::use_ => Item::Instance,
        Rule::wire => Item::Wire,
        Rule::assert => Item::Assert,
        Rule::at => Item::At,
        Rule::when => Item::When,
        Rule::while_ => Item::While,
        Rule::value => Item::Value,
        Rule::set => Item::Set,
        Rule::axis => Item::Axis,
        Rule::scenario | Rule::step | Rule::stop | Rule::for_ | Rule::record | Rule::sweep | Rule::fault => Item::Other,
        _ => return None,
    })
}
