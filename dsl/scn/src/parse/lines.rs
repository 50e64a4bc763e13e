//! Where statements begin, for recovery after a syntax error and for the line that an error names.

use super::wording::{Use, is_statement_word, usage};
use crate::source::Span;

/// A span from byte positions.
pub(super) fn span(text: u32, start: usize, end: usize) -> Span {
    let narrow = |position: usize| u32::try_from(position).unwrap_or(u32::MAX);
    Span { text, start: narrow(start), end: narrow(end) }
}

/// The word that a text begins with, after blanks; empty if there is none.
pub(super) fn first_word(text: &str) -> &str {
    let text = text.trim_start_matches([' ', '\t']);
    let end = text.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(text.len());
    &text[..end]
}

/// Whether a line begins with a statement word that is not a key of braces (`step = 1`).
pub(super) fn first_word_begins_statement(line: &str) -> bool {
    let word = first_word(line);
    let after = line.trim_start_matches([' ', '\t'])[word.len()..].trim_start_matches([' ', '\t']);
    let is_key = after.starts_with(['.', '[']) || (after.starts_with('=') && !after.starts_with("=>"));
    is_statement_word(word) && !is_key
}

/// Whether a line continues the statement of the line before.
pub(super) fn continues(next: &str) -> bool {
    usage(first_word(next)) == Some(Use::Joint) || next.starts_with("->") || next.starts_with("=>")
}

/// The byte length of what is quoted at the beginning of a text, with both quotes; up to the end of the line where nothing
/// closes it. In double quotes a backslash takes away the meaning of what follows it.
pub(crate) fn quoted_length(text: &str) -> usize {
    let mut letters = text.char_indices();
    let quote = letters.next().map(|(_, quote)| quote);
    while let Some((at, letter)) = letters.next() {
        match letter {
            '\n' | '\r' => return at,
            '\\' if quote == Some('"') => {
                if let Some((at, '\n' | '\r')) = letters.next() {
                    return at;
                }
            }
            letter if Some(letter) == quote => return at + letter.len_utf8(),
            _ => {}
        }
    }
    text.len()
}

/// Whether something that begins with a quote and reaches as far as [`quoted_length`] says ends with its quote.
pub(super) fn is_closed(quoted: &str) -> bool {
    let Some(quote) = quoted.chars().next() else { return true };
    let Some(body) = quoted[quote.len_utf8()..].strip_suffix(quote) else { return false };
    let backslashes = body.len() - body.trim_end_matches('\\').len();
    quote != '"' || backslashes.is_multiple_of(2)
}

/// The characters of a text with their bytes; of what is quoted only the first quote.
pub fn symbols(text: &str) -> impl Iterator<Item = (usize, char)> {
    let mut next = 0;
    std::iter::from_fn(move || {
        let (at, rest) = (next, &text[next..]);
        let symbol = rest.chars().next()?;
        next += if matches!(symbol, '"' | '\'') { quoted_length(rest) } else { symbol.len_utf8() };
        Some((at, symbol))
    })
}

/// Whether a line holds an arrow, outside quotes, that does not begin it.
fn holds_arrow(line: &str) -> bool {
    let line = line.trim_start();
    symbols(line).any(|(at, _)| at > 0 && (line[at..].starts_with("->") || line[at..].starts_with("=>")))
}

/// Whether a statement begins on a line.
pub(super) fn begins_statement(line: &str) -> bool {
    first_word_begins_statement(line) || holds_arrow(line)
}

/// A text that ends in a line break, without it.
pub(super) fn without_line_break(text: &str) -> Option<&str> {
    text.strip_suffix("\r\n").or_else(|| text.strip_suffix(['\n', '\r']))
}

/// The first byte of the line that contains a position.
pub(super) fn line_start(text: &str, at: usize) -> usize {
    text[..at].rfind(['\n', '\r']).map_or(0, |line_break| line_break + 1)
}

/// One past the last byte of the line that contains a position, without its line break.
pub(super) fn line_end(text: &str, at: usize) -> usize {
    text[at..].find(['\n', '\r']).map_or(text.len(), |length| at + length)
}

/// The first byte of the statement that contains a position, not before `from`.
pub(super) fn statement_start(text: &str, from: usize, at: usize) -> usize {
    let mut start = line_start(text, at).max(from);
    while start > from && !begins_statement(&text[start..line_end(text, start)]) {
        start = line_start(text, start - 1).max(from);
    }
    start + blanks(&text[start..at])
}

/// The first line after a position on which a statement begins.
pub(super) fn next_statement(text: &str, at: usize) -> usize {
    let mut start = line_end(text, at);
    while start < text.len() {
        start += 1;
        let end = line_end(text, start);
        if begins_statement(&text[start..end]) {
            return start;
        }
        start = end;
    }
    text.len()
}

fn blanks(text: &str) -> usize {
    text.len() - text.trim_start().len()
}

#[test]
fn statements_begin_with_a_statement_word_or_hold_an_arrow_further_on() {
    for line in ["step 5 ms", "  stop when x", "a.b -> c.d", "a =>", "let", "at=>b"] {
        assert!(begins_statement(line), "{line}");
    }
    for line in [
        "step = 1",
        "at.x = 2",
        "set[1] = 2",
        "steps",
        "-> c.d",
        "  => c.d",
        "x = \"a -> b\"",
        "x = \"a \\\" -> b\"",
        "",
    ] {
        assert!(!begins_statement(line), "{line}");
    }
}

#[test]
fn the_next_statement_is_sought_on_later_lines() {
    let text = "let a 3\n  b c\n  d -> e\n";
    assert_eq!(next_statement(text, 2), 14);
    assert_eq!(next_statement(text, 14), text.len());
    assert_eq!(statement_start(text, 0, 18), 16);
    assert_eq!(statement_start(text, 0, 11), 0);
}
