//! What happens to a text before the grammar sees it: comments, and line breaks inside brackets, become blanks.
//!
//! Every byte keeps its place. The scan also checks two rules that the grammar cannot express: the limit of
//! nesting, and that no blank separates a sign from its number.

use super::lines;
use super::wording::{Use, usage};
use crate::diagnostic::Diagnostic;
use crate::source::Span;

/// How many brackets and operators may nest.
pub(super) const NESTING_LIMIT: usize = 256;

/// A text as the grammar sees it.
#[derive(Debug)]
pub(super) struct Scanned {
    /// As long as the text that was read, without comments.
    pub text: String,
    /// Where the text nests too deeply and is cut off.
    pub diagnostics: Vec<Diagnostic>,
}

/// Blanks comments, and line breaks inside round and square brackets.
pub(super) fn scan(source: &str, text: u32) -> Scanned {
    let mut scanner = Scanner {
        source,
        text,
        at: 0,
        out: String::with_capacity(source.len()),
        levels: vec![Level::new(None)],
        after_operand: false,
        line_ended: false,
        diagnostics: Vec::new(),
    };
    while scanner.at < source.len() {
        scanner.token();
        if scanner.nesting() > NESTING_LIMIT {
            scanner.cut_off();
        }
    }
    Scanned { text: scanner.out, diagnostics: scanner.diagnostics }
}

/// That a text nests too deeply.
pub(super) fn nested_too_deeply(span: Span) -> Diagnostic {
    Diagnostic::error("E00", span, format!("more than {NESTING_LIMIT} brackets and operators inside each other"))
        .help("name parts with `let`, or write long sums as `sum(a, b, …)`")
}

/// An open bracket, or the outermost level.
struct Level {
    bracket: Option<char>,
    /// Operators of the current element that make its tree deeper.
    operators: usize,
    /// The deepest bracket of the current element.
    child: usize,
    /// The deepest element so far.
    deepest: usize,
}

impl Level {
    fn new(bracket: Option<char>) -> Self {
        Self { bracket, operators: 0, child: 0, deepest: 0 }
    }

    fn ends_element(&mut self) {
        self.deepest = self.deepest.max(self.operators + self.child);
        (self.operators, self.child) = (0, 0);
    }
}

struct Scanner<'a> {
    source: &'a str,
    text: u32,
    at: usize,
    out: String,
    /// Never empty: the first is the outermost level.
    levels: Vec<Level>,
    /// Whether the last token can be the left side of an operator.
    after_operand: bool,
    /// Whether a line break after an operand came since the last token: the next token decides whether it ends an element.
    line_ended: bool,
    diagnostics: Vec<Diagnostic>,
}

impl<'a> Scanner<'a> {
    fn rest(&self) -> &'a str {
        &self.source[self.at..]
    }

    fn copy(&mut self, length: usize) {
        self.out.push_str(&self.source[self.at..self.at + length]);
        self.at += length;
    }

    fn blank(&mut self, length: usize) {
        self.out.extend(std::iter::repeat_n(' ', length));
        self.at += length;
    }

    /// Copies what is a single token for the purposes of this pass.
    fn token(&mut self) {
        let rest = self.rest();
        let Some(first) = rest.chars().next() else { return };
        if self.line_ended && !matches!(first, ' ' | '\t' | '\n' | '\r' | '#') {
            if !lines::continues(rest) {
                self.innermost().ends_element();
            }
            self.line_ended = false;
        }
        match first {
            ' ' | '\t' => self.copy(1),
            '\n' | '\r' => self.line_break(),
            '#' => self.blank(rest.find(['\n', '\r']).unwrap_or(rest.len())),
            '"' | '\'' => self.quoted(first),
            '(' | '[' | '{' => {
                self.levels.push(Level::new(Some(first)));
                self.symbol(1, false);
            }
            ')' | ']' | '}' => self.close(first),
            ',' => {
                self.innermost().ends_element();
                self.symbol(1, false);
            }
            '-' => self.minus(),
            '=' if rest.starts_with("=>") => self.symbol(2, false),
            '+' if rest.starts_with("+-") => self.symbol(2, false),
            '+' | '*' | '/' => {
                self.innermost().operators += 1;
                self.symbol(1, false);
            }
            '.' if !rest.starts_with("..") => self.field(),
            '%' | '°' | '²' | '³' => self.symbol(first.len_utf8(), true),
            _ if is_name_part(first) => self.word(),
            _ => self.symbol(first.len_utf8(), false),
        }
    }

    fn symbol(&mut self, length: usize, operand: bool) {
        self.copy(length);
        self.after_operand = operand;
    }

    fn innermost(&mut self) -> &mut Level {
        match self.levels.last_mut() {
            Some(level) => level,
            None => unreachable!("the outermost level is never closed"),
        }
    }

    fn nesting(&self) -> usize {
        self.levels.iter().map(|level| 1 + level.operators + level.child).sum::<usize>() - 1
    }

    fn inside_brackets(&self) -> bool {
        self.levels.iter().any(|level| matches!(level.bracket, Some('(' | '[')))
    }

    fn line_break(&mut self) {
        let next = &self.rest()[1..];
        if self.inside_brackets() && lines::first_word_begins_statement(next) {
            self.levels.retain(|level| !matches!(level.bracket, Some('(' | '[')));
        }
        if self.inside_brackets() {
            return self.blank(1);
        }
        self.line_ended |= self.after_operand;
        self.copy(1);
    }

    fn quoted(&mut self, quote: char) {
        let length = lines::quoted_length(self.rest());
        if quote == '"' {
            self.escapes(&self.rest()[..length]);
        }
        self.symbol(length, true);
    }

    /// Reports backslashes that begin no escape.
    fn escapes(&mut self, text: &str) {
        let mut letters = text.char_indices();
        while let Some((at, letter)) = letters.next() {
            if letter != '\\' {
                continue;
            }
            let Some((_, escaped)) = letters.next().filter(|(_, escaped)| !"\"\\nt".contains(*escaped)) else {
                continue;
            };
            let span = self.span(self.at + at, self.at + at + 1 + escaped.len_utf8());
            let message = format!("`\\{escaped}` is no escape");
            let help = "a backslash is written `\\\\`; escapes are `\\\"`, `\\\\`, `\\n` and `\\t`";
            self.diagnostics.push(Diagnostic::error("E00", span, message).help(help));
        }
    }

    fn close(&mut self, bracket: char) {
        let opening = match bracket {
            ')' => '(',
            ']' => '[',
            _ => '{',
        };
        let opened = match opening {
            '{' => self.levels.iter().rposition(|level| level.bracket == Some('{')),
            _ => (self.innermost().bracket == Some(opening)).then(|| self.levels.len() - 1),
        };
        if let Some(opened) = opened {
            self.innermost().ends_element();
            let depth = self.levels.drain(opened..).map(|level| 1 + level.deepest).sum();
            let outer = self.innermost();
            outer.child = outer.child.max(depth);
        }
        self.symbol(1, true);
    }

    fn minus(&mut self) {
        let rest = self.rest();
        if rest.starts_with("->") {
            return self.symbol(2, false);
        }
        let after = &rest[1..];
        let blanks = after.len() - after.trim_start_matches([' ', '\t']).len();
        let number_follows = after[blanks..].starts_with(|c: char| c.is_ascii_digit());
        let blank_before = self.out.ends_with([' ', '\t', '\n']);
        if self.after_operand && blank_before && blanks == 0 && self.innermost().bracket == Some('[') {
            self.ambiguous_minus(after);
        } else if !self.after_operand && blanks > 0 && number_follows {
            self.lonely_sign(blanks, &after[blanks..]);
        }
        if self.after_operand || !number_follows {
            self.innermost().operators += 1;
        }
        self.symbol(1, false);
    }

    fn span(&self, start: usize, end: usize) -> Span {
        lines::span(self.text, start, end)
    }

    fn ambiguous_minus(&mut self, after: &str) {
        let operand = &after[..after.find(|c| !is_name_part(c) && c != '.').unwrap_or(after.len())];
        let span = self.span(self.at, self.at + 1 + operand.len());
        let message = format!("`-{operand}` after a blank could be one more element or a difference");
        let help = format!("write `, -{operand}` for one more element, `- {operand}` for the difference");
        self.diagnostics.push(Diagnostic::error("E00", span, message).help(help));
    }

    fn lonely_sign(&mut self, blanks: usize, after: &str) {
        let number = &after[..after.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(after.len())];
        let span = self.span(self.at, self.at + 1 + blanks + number.len());
        let message = format!("the sign of `{number}` stands apart from it");
        let help = format!("write `-{number}`: a sign belongs to its number, `-5 degC` is 268.15 K");
        self.diagnostics.push(Diagnostic::error("E00", span, message).help(help));
    }

    /// Copies a dot and, if one follows, the word after it, which may be reserved.
    fn field(&mut self) {
        let after = &self.rest()[1..];
        let length = after.find(|c| !is_name_part(c)).unwrap_or(after.len());
        self.symbol(1 + length, length > 0);
    }

    fn word(&mut self) {
        let rest = self.rest();
        let length = rest.find(|c| !is_name_part(c)).unwrap_or(rest.len());
        let word = &rest[..length];
        let usage = usage(word);
        // `and` and `or` make one list of their operands, however many they are.
        let deepens = matches!(usage, Some(Use::Prefix | Use::Joint)) && !matches!(word, "and" | "or");
        let operand = matches!(usage, None | Some(Use::Value));
        self.innermost().operators += usize::from(deepens);
        self.symbol(length, operand);
    }

    /// Reports the nesting and blanks what is left of the text: errors in it would not be reliable.
    fn cut_off(&mut self) {
        self.diagnostics.push(nested_too_deeply(self.span(self.at - 1, self.at)));
        let start = lines::statement_start(&self.out, 0, self.out.len());
        let length = self.source.len() - start;
        self.out.truncate(start);
        self.at = start;
        self.blank(length);
    }
}

fn is_name_part(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

#[test]
fn comments_and_line_breaks_in_brackets_become_blanks_of_equal_length() {
    let blanked = |source: &str| scan(source, 0).text;
    assert_eq!(blanked("a # é\nb"), "a     \nb");
    assert_eq!(blanked("f(1, # (\r\n 2)\nb"), "f(1,       2)\nb");
    assert_eq!(blanked("{\n}"), "{\n}");
    assert_eq!(blanked("\"# (\"\n'# ['\n"), "\"# (\"\n'# ['\n");
}

#[test]
fn a_closing_bracket_without_an_opening_one_and_a_statement_word_end_nothing_too_much() {
    let blanked = |source: &str| scan(source, 0).text;
    assert_eq!(blanked("a)\n(b\nc)\n"), "a)\n(b c)\n");
    assert_eq!(blanked("(a\n[b\nstep 5 ms\nc"), "(a [b\nstep 5 ms\nc");
}

#[test]
fn nesting_counts_what_is_inside_and_not_what_follows() {
    let refused = |source: String| !scan(&source, 0).diagnostics.is_empty();
    let nested = |depth| format!("{}1{}", "(".repeat(depth), ")".repeat(depth));
    assert!(!refused(nested(NESTING_LIMIT)));
    assert!(refused(nested(NESTING_LIMIT + 1)));
    assert!(!refused(format!("[{}]", "-a + b, ".repeat(1_000))));
    assert!(!refused("a + (b - c)\n".repeat(1_000)));
    assert!(!refused("a and b or c and ".repeat(1_000)));
    assert!(refused("a + ".repeat(NESTING_LIMIT + 1)));
    assert!(refused("not ".repeat(NESTING_LIMIT + 1)));
    assert!(refused("a\nimplies ".repeat(NESTING_LIMIT + 1)));
}
