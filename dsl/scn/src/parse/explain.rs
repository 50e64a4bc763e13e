//! From a failed match to a message: first the mistakes that have a name, then what was expected and what was found.

use pest::error::{Error, ErrorVariant};

use super::failure::{Failure, Place};
use super::grammar::Rule;
use super::wording::{Use, is_reserved, usage, words};
use super::{lines, mistakes, scan};
use crate::diagnostic::{Diagnostic, Edit};
use crate::nearest::nearest;
use crate::source::Span;

/// An error, and where parsing continues.
pub(super) struct Explained {
    /// The error.
    pub diagnostic: Diagnostic,
    /// Where the outermost statement begins that could not be read.
    pub statement: usize,
    /// A byte after which a statement may begin.
    pub resume: usize,
}

/// Says what is wrong where a match of statements failed.
pub(super) fn statements(place: &Place<'_>, error: &Error<Rule>) -> Explained {
    let failure = place.failure(error);
    let statement = failure.outermost_statement();
    if let ErrorVariant::CustomError { .. } = error.variant {
        // The only error with a message of pest's own: its stack limit is reached.
        let diagnostic = scan::nested_too_deeply(failure.span());
        return Explained { diagnostic, statement, resume: place.blanked.len() };
    }
    if let Some((diagnostic, resume)) = mistakes::unclosed(&failure) {
        return Explained { diagnostic, statement, resume };
    }
    let diagnostic = mistakes::known(&failure).unwrap_or_else(|| unexpected(&failure));
    Explained { diagnostic, statement, resume: lines::next_statement(place.blanked, failure.at) }
}

/// Says what is wrong with an assignment of the command line, which looks like `example`.
pub(super) fn assignment(place: &Place<'_>, error: &Error<Rule>, example: &str) -> Diagnostic {
    let failure = place.failure(error);
    if let ErrorVariant::CustomError { .. } = error.variant {
        return scan::nested_too_deeply(failure.span());
    }
    let help = format!("an assignment looks like `{example}`");
    Diagnostic::error("E00", failure.span(), expected_and_found(&failure)).help(help)
}

fn unexpected(failure: &Failure<'_>) -> Diagnostic {
    let model = failure.begun();
    let looks = format!("{} looks like {}", model.called, model.example);
    let error = Diagnostic::error("E00", failure.span(), expected_and_found(failure));
    match meant(failure) {
        Some((meant, span)) => error
            .help(format!("did you mean `{meant}`? {looks}"))
            .fix(format!("write `{meant}`"), [Edit::new(span, meant)]),
        None => error.help(looks),
    }
}

/// The keyword that the word found, or the one before it, is probably a misspelling of, and which it is.
fn meant(failure: &Failure<'_>) -> Option<(&'static str, Span)> {
    let expected = words_behind_values().filter(|word| failure.expects(word));
    let (found, previous) = (failure.found(), failure.previous());
    let this = nearest(found, expected).filter(|meant| *meant != found);
    this.map(|meant| (meant, failure.span())).or_else(|| {
        let misspelt = failure.expects("*") && !is_reserved(previous) && !found.is_empty();
        let before = failure.at - (failure.before().len() - failure.before().trim_end().len()) - previous.len();
        let meant = nearest(previous, words(&[Use::Prefix, Use::Joint])).filter(|_| misspelt)?;
        Some((meant, failure.span_of(before, previous.len())))
    })
}

fn expected_and_found(failure: &Failure<'_>) -> String {
    let previous = failure.previous();
    let after = if previous.is_empty() { String::new() } else { format!(" after `{previous}`") };
    format!("expected {}{after}, found {}", expected(failure), found(failure))
}

/// What was found, as text for a message.
pub(super) fn found(failure: &Failure<'_>) -> String {
    if let Some(c) = failure.found().chars().next().filter(|c| c.is_whitespace() || c.is_control()) {
        if matches!(c, ' ' | '\t') {
            return "a blank".to_owned();
        }
        return format!("the invisible character U+{:04X}", u32::from(c));
    }
    match failure.found() {
        "" if failure.rest().trim().is_empty() && !failure.rest().contains('\n') => "the end".to_owned(),
        "" => "the end of the line".to_owned(),
        token => format!("`{token}`"),
    }
}

fn expected(failure: &Failure<'_>) -> String {
    if failure.expects("scenario") {
        return "a statement".to_owned();
    }
    if failure.expects_value() {
        return value(failure).to_owned();
    }
    if failure.before().ends_with('.') {
        return "a name".to_owned();
    }
    let structure = structure(failure);
    if structure == [","] && failure.expects("\n") {
        return "`,` or the end of the line".to_owned();
    }
    if !structure.is_empty() {
        return any_of(&structure);
    }
    if failure.expects_name() {
        let port = matches!(failure.previous(), "->" | "=>" | "set" | "fault" | "record" | ",");
        return if port { "a port" } else { "a name" }.to_owned();
    }
    if failure.expects("*") { "an operator or the end of the line" } else { "the end of the line" }.to_owned()
}

/// What kind of value was expected.
fn value(failure: &Failure<'_>) -> &'static str {
    let statement = lines::first_word(failure.before());
    match failure.previous() {
        "step" | "stop" | "at" | "every" | "lasting" | "held" | "within" | "after" => "a time",
        "for" if failure.before().contains("hold") => "a time",
        ":" => "a claim",
        "when" | "while" | "and" | "or" | "not" | "implies" | "until" | "always" | "eventually" | "finally" => {
            "a condition"
        }
        _ if failure.expects("..") && statement == "assert" => "a condition",
        _ => "a value",
    }
}

/// The words that may follow a value or begin an action; `for` follows `hold`.
fn words_behind_values() -> impl Iterator<Item = &'static str> {
    words(&[Use::Action, Use::Clause, Use::Conversion, Use::Joint]).chain(["for"])
}

/// The brackets, signs and words of the statement that were expected; operators are not listed.
fn structure(failure: &Failure<'_>) -> Vec<&'static str> {
    const SIGNS: [&str; 11] = ["->", "=>", "=", ":", "~", "{", "}", ")", "]", ",", "\""];
    // `in` without `as` is that of a range.
    let is_operator = |word: &str| match usage(word) {
        Some(Use::Joint) => true,
        Some(Use::Conversion) => failure.expects("as"),
        _ => false,
    };
    // After an error the grammar takes a `}` anywhere; in a `for` block the end of a line is what is missed.
    let in_braces =
        failure.open_brackets().last().is_some_and(|&(open, bracket)| bracket == '{' && !failure.is_block(open));
    let words = words_behind_values().filter(|word| !is_operator(word));
    let tokens = SIGNS.into_iter().filter(|sign| *sign != "}" || in_braces).chain(words);
    tokens.filter(|token| failure.expects(token)).collect()
}

fn any_of(tokens: &[&'static str]) -> String {
    let worded: Vec<_> = tokens
        .iter()
        .map(|token| match *token {
            "\"" => "a text in double quotes".to_owned(),
            token => format!("`{token}`"),
        })
        .collect();
    match worded.as_slice() {
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
        [] => String::new(),
    }
}
