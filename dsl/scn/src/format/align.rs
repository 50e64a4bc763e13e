//! Columns: parts of neighbouring lines of one kind that begin below each other.

use super::lines::Line;
use super::tokens::{Kind, Token};
use crate::parse::Item;

/// Parts that begin further to the right stay where they are.
const WIDEST: usize = 72;
/// Comments that begin further to the right stay where they are.
const WIDEST_BEFORE_COMMENT: usize = 100;
/// The most parts that one line aligns.
const PARTS: usize = 3;

/// Aligns the parts of neighbouring lines, then the comments at their ends.
pub(super) fn align(lines: &mut [Line<'_>]) {
    let mut is_done = vec![false; lines.len()];
    for first in 0..lines.len() {
        if lines[first].item().is_none() || is_done[first] {
            continue;
        }
        let run = neighbours(lines, first);
        run.iter().for_each(|&line| is_done[line] = true);
        for part in 0..PARTS {
            let places: Vec<_> = run.iter().filter_map(|&line| Some((line, parts(&lines[line])[part]?))).collect();
            into_column(lines, &places, 1, WIDEST);
        }
    }
    align_comments(lines);
}

/// The lines from `first` on that begin items of the same kind at the same place, with no empty line, comment line or other
/// item of this place between them.
fn neighbours(lines: &[Line<'_>], first: usize) -> Vec<usize> {
    let (item, indent) = (lines[first].item(), lines[first].indent);
    let mut run = vec![first];
    for (index, line) in lines.iter().enumerate().skip(first + 1) {
        let is_inner = line.indent > indent || (line.indent == indent && !line.is_comment() && line.item().is_none());
        if line.after_empty || line.indent < indent || (!is_inner && line.item() != item) {
            break;
        }
        if !is_inner {
            run.push(index);
        }
    }
    run
}

/// The tokens of a line that are aligned with those of its neighbours.
fn parts(line: &Line<'_>) -> [Option<usize>; PARTS] {
    let find = |from: usize, is: &dyn Fn(&Token<'_>) -> bool| {
        (from..line.tokens.len()).find(|&index| is(line.tokens[index].token))
    };
    let sign = |texts: &[&str]| find(1, &|token| token.kind == Kind::Plain && texts.contains(&&*token.text));
    // What only a comment or nothing follows is no column.
    let inner = |token: usize| line.tokens.get(token + 1).is_some_and(|next| next.token.kind != Kind::Comment);
    let block = |from: usize| find(from, &|token| token.kind == Kind::OpenBlock).filter(|&block| inner(block));
    match line.item() {
        Some(Item::Param | Item::Let | Item::Value | Item::Set) => [sign(&["="]), None, None],
        Some(Item::Wire) => [sign(&["->", "=>"]), None, None],
        Some(Item::Axis) => [sign(&["in", "~"]), None, None],
        Some(Item::Assert) => [find(1, &|token| token.text == ":").map(|colon| colon + 1), None, None],
        Some(Item::At | Item::When | Item::While) => [block(1), None, None],
        Some(Item::Instance) => {
            let equals = sign(&["="]);
            let clause = equals
                .map(|equals| equals + 2)
                .filter(|&clause| line.tokens.get(clause).is_some_and(|placed| placed.token.kind != Kind::Comment));
            [equals, clause.filter(|&clause| inner(clause)), clause.and_then(|clause| block(clause + 1))]
        }
        Some(Item::Other) | None => [None; PARTS],
    }
    .map(|part| part.filter(|&part| part < line.tokens.len() && line.tokens[part].token.kind != Kind::Comment))
}

/// Comments at the ends of lines that follow each other.
fn align_comments(lines: &mut [Line<'_>]) {
    let mut first = 0;
    while first < lines.len() {
        let ends = |&index: &usize| {
            let line = &lines[index];
            line.after_empty || line.is_comment() || line.indent != lines[first].indent
        };
        let end = (first + 1..lines.len()).find(ends).unwrap_or(lines.len());
        let comment = |index: usize| {
            let tokens = &lines[index].tokens;
            (tokens.len() > 1 && tokens[tokens.len() - 1].token.kind == Kind::Comment).then_some(tokens.len() - 1)
        };
        let places: Vec<_> = (first..end).filter_map(|index| Some((index, comment(index)?))).collect();
        into_column(lines, &places, 2, WIDEST_BEFORE_COMMENT);
        first = end;
    }
}

/// Moves tokens, each given with its line, to the first column that has at least `blanks` before each of them.
fn into_column(lines: &mut [Line<'_>], places: &[(usize, usize)], blanks: usize, widest: usize) {
    let column = |&(line, token): &(usize, usize)| lines[line].column(token, blanks);
    let columns: Vec<_> = places.iter().map(|place| (*place, column(place))).filter(|(_, at)| *at <= widest).collect();
    let Some(common) = columns.iter().map(|(_, at)| *at).max() else { return };
    for ((line, token), at) in columns {
        lines[line].tokens[token].gap = blanks + common - at;
    }
}
