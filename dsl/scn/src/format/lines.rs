//! Tokens in lines: where each line begins, and how far to the right.

use super::tokens::{Kind, Token, gap};
use crate::parse::Item;

/// How far each brace or bracket that stays open, and each continued statement, moves lines to the right.
const INDENTATION: usize = 2;

/// A token in its line.
#[derive(Clone, Debug)]
pub(super) struct Placed<'a> {
    /// The blanks before it.
    pub gap: usize,
    /// The token.
    pub token: &'a Token<'a>,
}

/// A line.
#[derive(Clone, Debug)]
pub(super) struct Line<'a> {
    /// Whether an empty line comes before it.
    pub after_empty: bool,
    /// The blanks that it begins with.
    pub indent: usize,
    /// At least one.
    pub tokens: Vec<Placed<'a>>,
}

impl Line<'_> {
    /// The item that the line begins with.
    pub fn item(&self) -> Option<Item> {
        self.tokens[0].token.item
    }

    /// Whether it has nothing but a comment.
    pub fn is_comment(&self) -> bool {
        self.tokens[0].token.kind == Kind::Comment
    }

    /// The column, from 0, at which a token begins if there are `blanks` before it.
    pub fn column(&self, token: usize, blanks: usize) -> usize {
        let before = self.tokens[..token].iter().map(|placed| placed.gap + placed.token.text.chars().count());
        self.indent + before.sum::<usize>() + blanks
    }

    /// The line as text, with its line break and the empty line before it.
    pub fn text(&self) -> String {
        let mut text = if self.after_empty { "\n".to_owned() } else { String::new() };
        text.extend(std::iter::repeat_n(' ', self.indent));
        for Placed { gap, token } in &self.tokens {
            text.extend(std::iter::repeat_n(' ', *gap));
            text.push_str(&token.text);
        }
        text + "\n"
    }
}

/// A bracket or brace that is open, or the outermost level.
struct Level {
    /// Where lines inside of it begin.
    inside: usize,
    /// Where a line begins that closes it.
    closes: usize,
    /// Whether it holds items.
    has_items: bool,
}

/// The lines of a text, without columns that are aligned.
pub(super) fn lines<'a>(tokens: &'a [Token<'a>]) -> Vec<Line<'a>> {
    let mut lines: Vec<Line<'_>> = Vec::new();
    let mut levels = vec![Level { inside: 0, closes: 0, has_items: true }];
    for (index, token) in tokens.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| tokens[before].kind);
        match lines.last_mut().filter(|_| token.breaks == 0).zip(before) {
            Some((line, before)) => line.tokens.push(Placed { gap: gap(before, token.kind), token }),
            None => {
                let closes = matches!(token.kind, Kind::Close | Kind::CloseBlock);
                let after_opening = matches!(before, None | Some(Kind::Open | Kind::OpenIndex | Kind::OpenBlock));
                let after_empty = token.breaks > 1 && !closes && !after_opening;
                let indent = levels.last().map_or(0, |level| level.indent(&tokens[index..]));
                lines.push(Line { after_empty, indent, tokens: vec![Placed { gap: 0, token }] });
            }
        }
        let indent = lines.last().map_or(0, |line| line.indent);
        match token.kind {
            Kind::OpenBlock => {
                let closes = levels.last().map_or(0, |level| level.inside);
                levels.push(Level { inside: closes + INDENTATION, closes, has_items: true });
            }
            Kind::Open | Kind::OpenIndex => {
                levels.push(Level { inside: indent + INDENTATION, closes: indent, has_items: false });
            }
            Kind::Close | Kind::CloseBlock if levels.len() > 1 => {
                levels.pop();
            }
            _ => {}
        }
    }
    lines
}

impl Level {
    /// Where a line begins whose tokens come first; a comment begins where the code below it does, but inside of a brace
    /// that the code closes.
    fn indent(&self, rest: &[Token<'_>]) -> usize {
        let is_comment = rest.first().is_some_and(|first| first.kind == Kind::Comment);
        let code = rest.iter().find(|token| token.kind != Kind::Comment);
        let closes = code.is_some_and(|code| matches!(code.kind, Kind::Close | Kind::CloseBlock));
        match code {
            Some(_) if closes && !is_comment => self.closes,
            Some(code) if !closes && self.has_items && code.item.is_none() => self.inside + INDENTATION,
            _ => self.inside,
        }
    }
}
