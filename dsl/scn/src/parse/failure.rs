//! A failed match: where, in which statement, what was found there and what was expected.

use std::collections::BTreeSet;

use pest::error::{Error, ErrorVariant, InputLocation};

use super::grammar::Rule;
use super::lines;
use super::wording::{Model, is_reserved, model_of};
use crate::source::Span;

/// A text in which the grammar was matched from a byte on.
pub(super) struct Place<'a> {
    /// The text as the grammar saw it.
    pub blanked: &'a str,
    /// Its index in the sources.
    pub text: u32,
    /// Where the match began.
    pub from: usize,
}

/// A failed match.
pub(super) struct Failure<'a> {
    /// Where the match began.
    from: usize,
    /// The text as the grammar saw it.
    pub blanked: &'a str,
    /// Its index in the sources.
    pub text: u32,
    /// The first byte that does not fit.
    pub at: usize,
    /// Where the statement that contains `at` begins.
    pub statement: usize,
    /// The tokens that were expected at `at`, in the grammar's spelling.
    pub expected: BTreeSet<String>,
}

impl<'a> Place<'a> {
    /// Reads pest's error of a failed match.
    pub fn failure(&self, error: &Error<Rule>) -> Failure<'a> {
        let rule_at = rule_position(error);
        let attempts = error.parse_attempts();
        let mut expected: BTreeSet<_> = attempts
            .iter()
            .flat_map(|attempts| attempts.expected_tokens())
            .map(|token| token.to_string())
            .filter(|token| !token.trim_matches([' ', '\t']).is_empty())
            .collect();
        let furthest = attempts.filter(|_| !expected.is_empty()).map_or(rule_at, |attempts| attempts.max_position);
        let at = token_start(self.blanked, self.from + rule_at, self.from + furthest, &expected);
        if at < self.from + furthest && self.blanked[at..].starts_with(is_word) {
            // These tokens could have continued a word that is wrong as a whole.
            expected.clear();
        }
        if let (ErrorVariant::ParsingError { positives, .. }, true) = (&error.variant, at == self.from + rule_at) {
            expected.extend(positives.iter().flat_map(|rule| first_tokens(*rule)));
        }
        let at = match self.open_quote(at) {
            Some(quote) => {
                expected.clear();
                quote
            }
            None if expected.contains("scenario") => at,
            None => self.end_of_broken_line(at),
        };
        let statement = self.statement(at, &expected);
        Failure { from: self.from, blanked: self.blanked, text: self.text, at, statement, expected }
    }

    /// The quote of the line, up to a byte, that nothing closes.
    fn open_quote(&self, at: usize) -> Option<usize> {
        let line = lines::line_start(self.blanked, at).max(self.from);
        let symbols = lines::symbols(&self.blanked[line..]).map(|(byte, symbol)| (line + byte, symbol));
        let quotes = symbols.take_while(|(here, _)| *here < at).filter(|(_, symbol)| matches!(symbol, '"' | '\''));
        quotes.map(|(here, _)| here).find(|&here| !lines::is_closed(token(&self.blanked[here..])))
    }

    /// Where a line should have continued, if the next statement begins at a byte.
    fn end_of_broken_line(&self, at: usize) -> usize {
        let line = lines::line_start(self.blanked, at).max(self.from);
        let first_in_line = self.blanked[line..at].trim().is_empty();
        let begins = lines::first_word_begins_statement(&self.blanked[line..lines::line_end(self.blanked, at)]);
        if line > self.from && first_in_line && begins {
            return self.from + self.blanked[self.from..line].trim_end().len();
        }
        at
    }

    /// Where the statement that contains a failure at a byte begins.
    fn statement(&self, at: usize, expected: &BTreeSet<String>) -> usize {
        if expected.contains("scenario") {
            return at;
        }
        if !expected.contains("->") {
            return lines::statement_start(self.blanked, self.from, at);
        }
        let line = lines::line_start(self.blanked, at).max(self.from);
        let before = &self.blanked[line..at];
        let inside = &before[before.rfind('{').map_or(0, |brace| brace + 1)..];
        at - inside.trim_start().len()
    }
}

/// The byte at which the last rule was tried.
fn rule_position(error: &Error<Rule>) -> usize {
    match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    }
}

/// The furthest byte that a failed match reached.
pub(super) fn position(error: &Error<Rule>) -> usize {
    error.parse_attempts().map_or(0, |attempts| attempts.max_position).max(rule_position(error))
}

/// The tokens that distinguish a rule from others, as far as messages name them.
fn first_tokens(rule: Rule) -> Vec<String> {
    let word = format!("{rule:?}");
    let tokens: &[&str] = match rule {
        Rule::unary | Rule::not_ | Rule::quantity => &["(", "\"", "_", "A..Z"],
        Rule::ident => &["_", "A..Z"],
        Rule::file | Rule::rest => &["scenario"],
        Rule::actions | Rule::values | Rule::block => &["{"],
        Rule::arrow => &["->", "=>"],
        Rule::string => &["\""],
        Rule::cmp => &["=="],
        Rule::mul => &["*"],
        _ if word.chars().all(char::is_uppercase) && rule != Rule::EOI => return vec![word.to_lowercase()],
        _ => &[],
    };
    tokens.iter().map(|&token| token.to_owned()).collect()
}

/// The first byte of the token at which a match failed, which reached `at` when it tried the rule at `rule_at`.
fn token_start(text: &str, rule_at: usize, at: usize, expected: &BTreeSet<String>) -> usize {
    let (before, after) = text.split_at(at);
    let word = before.trim_end_matches(is_word).len();
    let in_word = word < at && after.starts_with(is_word);
    let in_name = expected.iter().all(|token| matches!(token.as_str(), "_" | "0..9" | "A..Z" | "a..z"));
    if in_word || (in_name && rule_at <= word && is_reserved(&before[word..])) {
        return word;
    }
    (0..=at).rev().find(|&at| !in_sign(text, at)).unwrap_or(at)
}

/// Whether a sign of two or more characters was taken for a sign of one and something wrong.
fn in_sign(text: &str, at: usize) -> bool {
    let (before, after) = text.split_at(at);
    match before.chars().next_back() {
        Some('-') => after.starts_with('>') || after.starts_with("->"),
        Some('=') => after.starts_with(['>', '=']),
        Some(sign @ ('/' | '*')) => after.starts_with(sign),
        _ => false,
    }
}

/// Whether a character may occur in a word, though not always in a name.
pub(super) fn is_word(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

impl<'a> Failure<'a> {
    /// Whether a token was expected.
    pub fn expects(&self, token: &str) -> bool {
        self.expected.contains(token)
    }

    /// Whether a value was expected.
    pub fn expects_value(&self) -> bool {
        self.expects("(") && self.expects("\"")
    }

    /// Whether a name was expected, and no value.
    pub fn expects_name(&self) -> bool {
        self.expects("_") && self.expects("A..Z") && !self.expects("(")
    }

    /// The text from the place of the failure on.
    pub fn rest(&self) -> &'a str {
        &self.blanked[self.at..]
    }

    /// The statement up to the place of the failure.
    pub fn before(&self) -> &'a str {
        &self.blanked[self.statement..self.at]
    }

    /// The line's text from the statement's start on.
    pub fn line(&self) -> &'a str {
        self.blanked[self.statement..lines::line_end(self.blanked, self.at)].trim_end()
    }

    /// The token at the place of the failure: a word, number, symbol or text; empty at the end of a line.
    pub fn found(&self) -> &'a str {
        token(self.rest())
    }

    /// The token before the place of the failure, within the statement.
    pub fn previous(&self) -> &'a str {
        last_token(self.before())
    }

    /// The word that the statement begins with, or the action inside it.
    pub fn begun(&self) -> &'static Model {
        let inside = self.before().rsplit(['{', ',', '\n']).next().unwrap_or_default();
        let action = lines::first_word(inside);
        if matches!(action, "set" | "fault") || lines::first_word_begins_statement(inside) {
            return model_of(action);
        }
        model_of(lines::first_word(&self.blanked[self.statement..]))
    }

    /// The brackets before the place of the failure that nothing closes, with their bytes.
    pub fn open_brackets(&self) -> Vec<(usize, char)> {
        let mut open: Vec<(usize, char)> = Vec::new();
        for (byte, symbol) in lines::symbols(&self.blanked[self.from..self.at]) {
            match symbol {
                '(' | '[' | '{' => open.push((self.from + byte, symbol)),
                ')' | ']' | '}' => {
                    open.pop_if(|(_, bracket)| closing(*bracket) == symbol);
                }
                _ => {}
            }
        }
        open
    }

    /// Whether a brace opens the statements of a `for`.
    pub fn is_block(&self, brace: usize) -> bool {
        lines::first_word(&self.blanked[lines::line_start(self.blanked, brace)..]) == "for"
    }

    /// Whether a brace is closed further on, as far as a few screens of text show.
    pub fn is_closed_later(&self, brace: usize) -> bool {
        const SEARCHED_BYTES: usize = 4096;
        let text = &self.blanked[brace..self.blanked.floor_char_boundary(brace + SEARCHED_BYTES)];
        let mut depth = 0_usize;
        for (_, symbol) in lines::symbols(text) {
            match symbol {
                '{' => depth += 1,
                '}' if depth == 1 => return true,
                '}' => depth -= 1,
                _ => {}
            }
        }
        false
    }

    /// Where the statement begins that holds the failure, with all blocks around it.
    pub fn outermost_statement(&self) -> usize {
        let block =
            self.open_brackets().first().map(|(open, _)| lines::statement_start(self.blanked, self.from, *open));
        block.map_or(self.statement, |block| block.min(self.statement))
    }

    /// The place of what was found.
    pub fn span(&self) -> Span {
        self.span_of(self.at, self.found().len())
    }

    /// A place from a byte on.
    pub fn span_of(&self, start: usize, length: usize) -> Span {
        lines::span(self.text, start, start + length)
    }
}

/// The bracket that closes what another opens.
pub(super) fn closing(opening: char) -> char {
    match opening {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// The token that a text begins with.
pub(super) fn token(text: &str) -> &str {
    let Some(first) = text.chars().next() else { return "" };
    let length = match first {
        '\n' | '\r' => 0,
        '"' | '\'' => lines::quoted_length(text),
        '0'..='9' => text.find(|c| !is_word(c) && c != '.').unwrap_or(text.len()),
        _ if is_word(first) => text.find(|c| !is_word(c)).unwrap_or(text.len()),
        _ => {
            let symbols =
                ["-->", "==>", "->", "=>", "<-", "<=", ">=", "==", "!=", ":=", "&&", "||", "//", "**", "..", "+-"];
            symbols.iter().find(|symbol| text.starts_with(**symbol)).map_or(first.len_utf8(), |symbol| symbol.len())
        }
    };
    &text[..length]
}

/// The token that a text ends with.
fn last_token(text: &str) -> &str {
    let text = text.trim_end();
    if let Some(quote) = text.chars().next_back().filter(|c| matches!(c, '"' | '\'')) {
        let is_opening = |at: &usize| !text[..*at].ends_with('\\');
        let opening = text[..text.len() - 1].rmatch_indices(quote).map(|(at, _)| at).find(is_opening);
        return &text[opening.unwrap_or(text.len() - 1)..];
    }
    let word = text.trim_end_matches(|c| is_word(c) || c == '.').len();
    if word < text.len() {
        return &text[word..];
    }
    let symbol = text.len() - text.chars().next_back().map_or(0, char::len_utf8);
    let pair = symbol.checked_sub(1).filter(|&pair| matches!(text.get(pair..), Some("->" | "=>" | "<=" | ">=" | "==")));
    &text[pair.unwrap_or(symbol)..]
}

#[test]
fn tokens_are_words_numbers_texts_and_signs() {
    for (text, first) in [
        ("a.b", "a"),
        ("1.5 m", "1.5"),
        ("\"a b\" c", "\"a b\""),
        ("\"a \\\" b\" c", "\"a \\\" b\""),
        ("\"a\n", "\"a"),
        ("=> x", "=>"),
        ("\n", ""),
    ] {
        assert_eq!(token(text), first, "{text:?}");
    }
    for (text, last) in [
        ("let a.b ", "a.b"),
        ("x =>", "=>"),
        ("f = \"a b\"", "\"a b\""),
        ("f = \"a \\\" b\"", "\"a \\\" b\""),
        ("(", "("),
        ("", ""),
    ] {
        assert_eq!(last_token(text), last, "{text:?}");
    }
}
