//! `[*]`: the paths with each index that there is in its place.

use super::frame::{FrameId, Placed};
use super::path::Root;
use super::scope::Scope;
use super::script::Declaration;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::syntax::{Expression, ExpressionKind, Path, Segment};

impl Scope<'_, '_> {
    /// The paths that a path with `[*]` means, in order of the indices; a path without is itself. Where there is no index
    /// this is reported, and nothing is returned.
    pub fn expanded(self, path: &Path) -> Vec<Path> {
        let is_star = |segment: &Segment| matches!(segment, Segment::AllIndices(_));
        let Some(at) = path.tail.iter().position(is_star) else { return vec![path.clone()] };
        let Segment::AllIndices(span) = path.tail[at] else { return Vec::new() };
        if matches!(self.look_up(&path.root.text).map(|found| found.part), Some(Declaration::Refused(_))) {
            return Vec::new();
        }
        let mut indices = self.indices(path, at);
        indices.sort();
        indices.dedup();
        if indices.is_empty() {
            let before = Path { tail: path.tail[..at].to_vec(), ..path.clone() };
            let named = before.tail.iter().fold(before.root.text.clone(), |name, segment| match segment {
                Segment::Field(word) => format!("{name}.{}", word.text),
                _ => name,
            });
            let error = Diagnostic::error("E01", span, format!("nothing is called `{named}[…]`"));
            self.report(error.help("`[*]` stands for each index of an array, or of instances such as `wing[1]`"));
        }
        let with = |index: Vec<i64>| {
            let mut tail = path.tail.clone();
            tail[at] = Segment::Index(index.into_iter().map(|number| literal(number, span)).collect(), span);
            Path { tail, ..path.clone() }
        };
        indices.into_iter().flat_map(|index| self.expanded(&with(index))).collect()
    }

    /// The indices that the segment at a place may have.
    fn indices(self, path: &Path, at: usize) -> Vec<Vec<i64>> {
        let (before, name) = match path.tail[..at].split_last() {
            None => return self.declared_indices(self.known_names(), &path.root.text),
            Some((Segment::Field(word), before)) => (before, Some(word)),
            Some(_) => (&path.tail[..at], None),
        };
        // A name in a part, else an array of a unit.
        let outer = Path { tail: before.to_vec(), ..path.clone() };
        if let Some(word) = name
            && let Some(part) = self.part_of(&outer)
        {
            let names = self.script.frames.names(part).map(|(name, _)| name.to_owned()).collect();
            return self.declared_indices(names, &word.text);
        }
        self.array_indices(&Path { tail: path.tail[..at].to_vec(), ..path.clone() })
    }

    fn known_names(self) -> Vec<String> {
        self.script.frames.known(self.frame()).map(|(name, _)| name.to_owned()).collect()
    }

    /// The indices of names such as `wing[1]`.
    fn declared_indices(self, names: Vec<String>, of: &str) -> Vec<Vec<i64>> {
        names.iter().filter_map(|name| numbers(name.strip_prefix(of)?)).collect()
    }

    /// The frame of the part that a whole path names.
    fn part_of(self, path: &Path) -> Option<FrameId> {
        match self.root_or_part(path) {
            Root::Declared(Placed { part: Declaration::Part(frame, _), .. }, _) => Some(frame),
            _ => None,
        }
    }

    /// The indices of an array of a unit.
    fn array_indices(self, path: &Path) -> Vec<Vec<i64>> {
        let Root::Declared(found, tail) = self.root(path) else { return Vec::new() };
        let Declaration::Instance(instance, _) = found.part else { return Vec::new() };
        let Some(unit) = self.description(instance) else { return Vec::new() };
        let mut prefix = String::new();
        for segment in tail {
            match segment {
                Segment::Field(word) => {
                    prefix = if prefix.is_empty() { word.text.clone() } else { format!("{prefix}.{}", word.text) };
                }
                Segment::Index(index, _) => match self.index_text(index) {
                    Some(text) => prefix += &text,
                    None => return Vec::new(),
                },
                _ => return Vec::new(),
            }
        }
        let begins = format!("{prefix}[");
        let variables = unit.beginning(&begins).iter();
        variables
            .filter_map(|&variable| {
                let rest = &unit.variables[variable].name[prefix.len()..];
                numbers(&rest[..=rest.find(']')?])
            })
            .collect()
    }
}

/// The numbers of `[1,2]`.
fn numbers(index: &str) -> Option<Vec<i64>> {
    let inner = index.strip_prefix('[')?.strip_suffix(']')?;
    inner.split(',').map(|number| number.parse().ok()).collect()
}

fn literal(number: i64, span: Span) -> Expression {
    Expression { kind: ExpressionKind::Quantity { number: number as f64, unit: None }, span, parenthesised: false }
}
