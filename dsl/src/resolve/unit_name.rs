//! Units of measure that a script writes: the built-in table, and the names that loaded units define.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use fmi2::units::{BaseUnit, parse};

use super::findings::Remedy;
use super::scope::Scope;
use super::script::Script;
use crate::diagnostic::{Diagnostic, Edit};
use crate::nearest::nearest;
use crate::source::Span;
use crate::spelling;
use crate::syntax::{Expression, ExpressionKind, Word};

impl Scope<'_, '_> {
    /// The unit of measure that a script wrote in `of`, which is the number with its unit.
    pub fn unit_of_measure(&self, unit: &Word, of: &Expression) -> Option<BaseUnit> {
        if let Some((name, at, declared)) = self.name_in_unit(unit) {
            if parse(&unit.text).is_err() && self.meanings_of_unit(&unit.text).is_empty() {
                return self.refuse(self.product_in_unit(unit, of, name, at));
            }
            let (text, line) = (self.text(of.span), self.line(of.span));
            let message = format!("`{name}` is a unit of measure too, so that `{text}` (line {line}) cannot be read");
            return self.refuse(Diagnostic::error("E11", declared, message).help("rename it"));
        }
        let loaded = self.meanings_of_unit(&unit.text);
        let other = |built_in| loaded.iter().find(|(loaded, _)| !same(built_in, *loaded));
        match (parse(&unit.text), loaded.first()) {
            (Ok(built_in), _) => {
                let Some((loaded, owner)) = other(built_in) else { return Some(built_in) };
                let message = format!("`{}` has two meanings here", unit.text);
                let error = Diagnostic::error("E33", unit.span, message).saying(format!(
                    "{} in the built-in table, {} in {}",
                    shown(built_in),
                    shown(*loaded),
                    self.script.instances[*owner].name
                ));
                self.refuse(error.help("write the quantity in another unit"))
            }
            (Err(_), Some((loaded, _))) => Some(*loaded),
            (Err(mut unknown), None) => {
                let suggestion = unknown.suggestion.take();
                let error = Diagnostic::error("E11", unit.span, unknown.to_string());
                if let Some(near) = suggestion {
                    let quote = u32::from(self.request.sources.slice(unit.span).starts_with('\''));
                    let place = |byte: usize| unit.span.start + quote + u32::try_from(byte).unwrap_or(0);
                    let part = Span { start: place(unknown.part.start), end: place(unknown.part.end), ..unit.span };
                    let error = error.help(format!("did you mean `{near}`?"));
                    return self.refuse(error.fix(format!("write `{near}`"), [Edit::new(part, near)]));
                }
                let (written, span) = (unit.text.clone(), unit.span);
                let error = error.help("a unit of a loaded FMU may be written in quotes, for example `5 'N.m'`");
                self.refuse_and_search(error, move |scope| Some(Remedy::meant(&scope.near_loaded(&written)?, span)))
            }
        }
    }

    /// The unit of measure that the head of a column names, which `curve` reads at a place.
    pub fn unit_of_table(&self, unit: &str, span: Span) -> Option<BaseUnit> {
        match (parse(unit), self.meanings_of_unit(unit)) {
            (_, [_, _, ..]) => {
                let error =
                    Diagnostic::error("E33", span, format!("`{unit}`, the unit of this column, has two meanings here"));
                self.refuse(error.help("write the column in another unit"))
            }
            (_, [(loaded, _)]) => Some(*loaded),
            (Ok(built_in), []) => Some(built_in),
            (Err(unknown), []) => {
                let error = Diagnostic::error("E11", span, format!("the unit of this column: {unknown}"));
                let known = "write a unit that is built in or that a loaded unit defines";
                self.refuse(match unknown.suggestion {
                    Some(near) => error.help(format!("in the file, did you mean `{near}`?")),
                    None => error.help(known),
                })
            }
        }
    }

    /// A literal whose unit has an offset, such as degC, as the operand of a computation.
    pub fn is_offset_literal(&self, expression: &Expression) -> bool {
        let unit = match &expression.kind {
            ExpressionKind::Quantity { unit, .. } | ExpressionKind::List { unit, .. } => unit,
            _ => return false,
        };
        let base = unit
            .as_ref()
            .and_then(|unit| parse(&unit.text).ok().or_else(|| Some(self.meanings_of_unit(&unit.text).first()?.0)));
        base.is_some_and(|base| base.offset != 0.0)
    }

    /// Refuses such an operand.
    pub fn refuse_offset(&self, expression: &Expression, place: &str) {
        let message = format!("`{}` is a point on a scale, which {place} cannot take", self.text(expression.span));
        let error = Diagnostic::error("E32", expression.span, message);
        self.report(error.help("write it in K: a difference of 1 degC is 1 K"));
    }

    /// What loaded units define under this name, each meaning once, with the first instance whose unit does.
    pub fn meanings_of_unit(&self, name: &str) -> &[(BaseUnit, usize)] {
        let loaded = self.shared.loaded.get_or_init(|| loaded(&self.shared.script));
        loaded.get(name).map_or(&[], Vec::as_slice)
    }

    fn near_loaded(&self, written: &str) -> Option<String> {
        let units = self.script.units();
        let names = units.flat_map(|unit| &unit.units).map(|unit| unit.name.as_str());
        nearest(written, names).map(spelling::unit)
    }

    /// That a factor is written into a unit: `2 m/s*k`.
    fn product_in_unit(&self, unit: &Word, of: &Expression, name: &str, at: usize) -> Diagnostic {
        let place = |byte: usize| unit.span.start + u32::try_from(byte).unwrap_or(0);
        let operator = Span { start: place(at - 1), end: place(at), ..unit.span };
        let (text, sign) = (self.text(of.span), self.text(operator));
        let name_span = Span { start: place(at), end: place(at + name.len()), ..unit.span };
        let error = Diagnostic::error("E11", name_span, format!("`{name}` in `{text}` is not a unit"));
        let before = self.text(Span { end: operator.start, ..of.span });
        let after = self.text(Span { start: operator.end, ..of.span });
        let written = format!("{before} {sign} {after}");
        let error = error.help(format!("a unit has no spaces, a product has: `{written}`"));
        error.fix(format!("write `{written}`"), [Edit::new(operator, format!(" {sign} "))])
    }

    /// The first part after `*` or `/` that is a name of the script, with its byte in the unit and the place of its
    /// declaration.
    fn name_in_unit<'u>(&self, unit: &'u Word) -> Option<(&'u str, usize, Span)> {
        let is_quoted = self.request.sources.slice(unit.span).starts_with('\'');
        if is_quoted {
            return None;
        }
        unit.text.match_indices(['*', '/']).find_map(|(sign, _)| {
            let part = &unit.text[sign + 1..];
            let name = &part[..part.find(|c: char| !c.is_alphabetic()).unwrap_or(part.len())];
            Some((name, sign + 1, self.look_up(name)?.part.span()))
        })
    }
}

/// What the units of a script define: each name with its meanings, and for each the first instance whose unit gives it
/// these base units.
pub(super) fn loaded(script: &Script<'_>) -> BTreeMap<String, Vec<(BaseUnit, usize)>> {
    let mut loaded: BTreeMap<String, Vec<(BaseUnit, usize)>> = BTreeMap::new();
    let mut seen = BTreeSet::new();
    for (index, instance) in script.instances.iter().enumerate() {
        let Some(unit) = &instance.description else { continue };
        if !seen.insert(Rc::as_ptr(unit)) {
            continue;
        }
        for definition in &unit.units {
            if let Some(base) = unit.unit(&definition.name).and_then(|first| first.base) {
                let meanings = loaded.entry(definition.name.clone()).or_default();
                if !meanings.iter().any(|(known, _)| same(*known, base)) {
                    meanings.push((base, index));
                }
            }
        }
    }
    loaded
}

/// Whether two definitions mean one unit of measure: descriptions give factors with as few as six digits.
fn same(left: BaseUnit, right: BaseUnit) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(b.abs());
    left.dimension == right.dimension && close(left.factor, right.factor) && close(left.offset, right.offset)
}

/// A unit of measure by its base units.
pub(super) fn shown(unit: BaseUnit) -> String {
    let offset = if unit.offset == 0.0 { String::new() } else { format!(" + {}", unit.offset) };
    format!("{} {}{offset}", unit.factor, unit.dimension)
}
