//! The tokens of a script with its comments, and how many blanks are between two of them.

use std::borrow::Cow;

use fmi2::units;

use crate::parse::{Atom, Item, Shape, quoted_length};

/// What a token is, as far as the blanks around it depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A name, number, text, unit of measure, word of the language or operator.
    Plain,
    /// The name of a function.
    Function,
    /// A sign in front of a value.
    Sign,
    /// `.` and `..`, which join their neighbours.
    Joint,
    /// `,` and `:` and `;`
    Separator,
    /// `(`, the `[` of a list, or the brace of a group's members.
    Open,
    /// The `[` of an index.
    OpenIndex,
    /// `)`, `]`, or the brace after a group's members.
    Close,
    /// `{` of a block.
    OpenBlock,
    /// `}` of a block.
    CloseBlock,
    /// From `#` to the end of the line.
    Comment,
}

/// A token.
#[derive(Clone, Debug)]
pub(super) struct Token<'a> {
    /// As it is written in the style of the language.
    pub text: Cow<'a, str>,
    /// What it is.
    pub kind: Kind,
    /// The line breaks before it.
    pub breaks: usize,
    /// What begins here.
    pub item: Option<Item>,
}

/// The tokens of a text with this shape.
pub(super) fn tokens<'a>(text: &'a str, shape: &Shape) -> Vec<Token<'a>> {
    let mut tokens: Vec<Token<'_>> = Vec::new();
    // The kinds of the brackets that are open: what closes a group's members differs from what closes a block.
    let mut open: Vec<Kind> = Vec::new();
    let (mut at, mut breaks) = (0, 0);
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        if let Some(after) = ["\r\n", "\n", "\r"].iter().find_map(|ends| rest.strip_prefix(ends)) {
            (at, breaks) = (text.len() - after.len(), breaks + 1);
            continue;
        }
        if matches!(first, ' ' | '\t') {
            at += 1;
            continue;
        }
        let (end, kind) = match shape.atoms.get(&at) {
            Some(&(end, atom)) => (end, of_atom(atom)),
            None => {
                let (length, kind) = of_sign(rest, first);
                (at + length, kind)
            }
        };
        let kind = match kind {
            Kind::Open | Kind::OpenIndex | Kind::OpenBlock => {
                open.push(kind);
                kind
            }
            Kind::Close if open.pop() == Some(Kind::OpenBlock) => Kind::CloseBlock,
            kind => kind,
        };
        let is_unit = shape.atoms.get(&at).is_some_and(|&(_, atom)| atom == Atom::Unit);
        let written = &text[at..end];
        let written = if is_unit { spelt(written) } else { Cow::Borrowed(written.trim_end_matches([' ', '\t'])) };
        tokens.push(Token { text: written, kind, breaks, item: shape.items.get(&at).copied() });
        (at, breaks) = (end, 0);
    }
    tokens
}

fn of_atom(atom: Atom) -> Kind {
    match atom {
        Atom::Plain | Atom::Unit => Kind::Plain,
        Atom::Function => Kind::Function,
        Atom::Sign => Kind::Sign,
        Atom::Members => Kind::Open,
        Atom::Index => Kind::OpenIndex,
    }
}

/// The length and kind of a token that begins with a sign, or is a word of the language.
fn of_sign(rest: &str, first: char) -> (usize, Kind) {
    const PAIRS: [&str; 8] = ["->", "=>", "<=", ">=", "==", "!=", "+-", ".."];
    if let Some(pair) = PAIRS.iter().find(|pair| rest.starts_with(**pair)) {
        return (pair.len(), if *pair == ".." { Kind::Joint } else { Kind::Plain });
    }
    let is_word = |c: char| c == '_' || c.is_alphanumeric();
    match first {
        '#' => (rest.find(['\n', '\r']).unwrap_or(rest.len()), Kind::Comment),
        '"' | '\'' => (quoted_length(rest), Kind::Plain),
        '(' | '[' => (1, Kind::Open),
        '{' => (1, Kind::OpenBlock),
        ')' | ']' | '}' => (1, Kind::Close),
        ',' | ':' | ';' => (1, Kind::Separator),
        '.' => (1, Kind::Joint),
        _ if is_word(first) => (rest.find(|c| !is_word(c)).unwrap_or(rest.len()), Kind::Plain),
        _ => (first.len_utf8(), Kind::Plain),
    }
}

/// A unit of measure with `^` before each power, where that is the same unit.
fn spelt(unit: &str) -> Cow<'_, str> {
    let mut spelt = String::with_capacity(unit.len() + 2);
    for letter in unit.chars() {
        if letter.is_ascii_digit() && spelt.ends_with(char::is_alphabetic) {
            spelt.push('^');
        }
        spelt.push(letter);
    }
    let is_quoted = unit.starts_with('\'');
    let means = |text: &str| units::parse(text).ok();
    if is_quoted || spelt == unit || means(unit).is_none() || means(unit) != means(&spelt) {
        return Cow::Borrowed(unit);
    }
    Cow::Owned(spelt)
}

/// The blanks between two tokens of one line.
pub(super) fn gap(before: Kind, after: Kind) -> usize {
    use Kind::{Close, CloseBlock, Comment, Function, Joint, Open, OpenBlock, OpenIndex, Separator, Sign};
    match (before, after) {
        (_, Comment) => 2,
        (OpenBlock, CloseBlock) | (Function, Open) | (_, OpenIndex | Joint | Close | Separator) => 0,
        (Open | OpenIndex | Joint | Sign, _) => 0,
        _ => 1,
    }
}

#[test]
fn powers_get_their_sign_where_the_unit_stays_the_same() {
    for (unit, written) in [("m/s2", "m/s^2"), ("kg*m2/s2", "kg*m^2/s^2"), ("m/s^2", "m/s^2"), ("'m/s2'", "'m/s2'")] {
        assert_eq!(spelt(unit), written);
    }
    assert_eq!(spelt("quux2"), "quux2", "a unit of an FMU's own");
    assert_eq!(spelt("m²"), "m²");
}
