//! Units of measure that a script writes: the built-in table, and the names that loaded units define.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use fmi2::units::{BaseUnit, parse};

use super::scope::Scope;
use super::script::Script;
use crate::diagnostic::Diagnostic;
use crate::nearest::nearest;
use crate::syntax::{Expression, ExpressionKind, Word};

impl Scope<'_, '_> {
    /// The unit of measure that a script wrote in `of`, which is the number with its unit.
    pub fn unit_of_measure(&self, unit: &Word, of: &Expression) -> Option<BaseUnit> {
        if let Some(name) = self.name_in_unit(unit) {
            let message = format!("`{name}` in `{}` is a name of this script, not a unit", self.text(of.span));
            return self.refuse(self.spaced(unit, name, of, Diagnostic::error("E11", unit.span, message)));
        }
        let loaded = self.loaded_unit(&unit.text);
        let built_in = parse(&unit.text);
        match (built_in, loaded) {
            (Ok(built_in), None) => Some(built_in),
            (Err(_), Some((loaded, _))) => Some(loaded),
            (Ok(built_in), Some((loaded, _))) if same(built_in, loaded) => Some(built_in),
            (Ok(built_in), Some((loaded, owner))) => {
                let message = format!("`{}` has two meanings here", unit.text);
                let error = Diagnostic::error("E33", unit.span, message).saying(format!(
                    "{} in the built-in table, {} in {owner}",
                    shown(built_in),
                    shown(loaded)
                ));
                self.refuse(error.help("write the quantity in another unit"))
            }
            (Err(mut unknown), None) => {
                let suggestion = unknown.suggestion.take();
                let error = Diagnostic::error("E11", unit.span, unknown.to_string());
                if let Some(near) = suggestion {
                    return self.refuse(error.help(format!("did you mean `{near}`?")));
                }
                let written = unit.text.clone();
                let error = error.help("a unit of a loaded FMU may be written in quotes, for example `5 'N.m'`");
                self.refuse_and_search(error, move |scope| {
                    Some(format!("did you mean `{}`?", scope.near_loaded(&written)?))
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
            .and_then(|unit| parse(&unit.text).ok().or_else(|| self.loaded_unit(&unit.text).map(|(loaded, _)| loaded)));
        base.is_some_and(|base| base.offset != 0.0)
    }

    /// Refuses such an operand.
    pub fn refuse_offset(&self, expression: &Expression, place: &str) {
        let message = format!("`{}` is a point on a scale, which {place} cannot take", self.text(expression.span));
        let error = Diagnostic::error("E32", expression.span, message);
        self.report(error.help("write it in K: a difference of 1 degC is 1 K"));
    }

    /// What a loaded unit defines under this name, with the owner's name.
    fn loaded_unit(&self, name: &str) -> Option<(BaseUnit, &str)> {
        let (base, instance) = self.loaded.get(name)?;
        Some((*base, self.script.instances[*instance].name.text.as_str()))
    }

    fn near_loaded(&self, written: &str) -> Option<String> {
        let units = self.script.units();
        let names = units.flat_map(|unit| &unit.units).map(|unit| unit.name.as_str());
        nearest(written, names).map(|near| format!("'{near}'"))
    }

    /// The first part after `*` or `/` that is a name of the script.
    fn name_in_unit<'u>(&self, unit: &'u Word) -> Option<&'u str> {
        let is_quoted = self.request.sources.slice(unit.span).starts_with('\'');
        if is_quoted {
            return None;
        }
        let parts = unit.text.split(['*', '/']).skip(1);
        let mut names = parts.map(|part| &part[..part.find(|c: char| !c.is_alphabetic()).unwrap_or(part.len())]);
        names.find(|name| self.look_up(name).is_some())
    }

    fn spaced(&self, unit: &Word, name: &str, of: &Expression, error: Diagnostic) -> Diagnostic {
        let text = self.text(of.span);
        let cut = ["*", "/"].into_iter().find_map(|operator| {
            let joined = format!("{operator}{name}");
            let at = unit.text.find(&joined)? + text.len().checked_sub(unit.text.len())?;
            let (head, tail) = (text.get(..at)?, text.get(at + operator.len()..)?);
            Some(format!("{head} {operator} {tail}"))
        });
        match cut {
            Some(product) => error.help(format!("a unit has no spaces, a product has: `{product}`")),
            None => error.help("a unit has no spaces, a product has"),
        }
    }
}

/// What the units of a script define, each name with the first instance whose unit gives it base units.
pub(super) fn loaded(script: &Script<'_>) -> BTreeMap<String, (BaseUnit, usize)> {
    let mut loaded = BTreeMap::new();
    let mut seen = BTreeSet::new();
    for (index, instance) in script.instances.iter().enumerate() {
        let Some(unit) = &instance.description else { continue };
        if !seen.insert(Rc::as_ptr(unit)) {
            continue;
        }
        for definition in &unit.units {
            if let Some(base) = unit.unit(&definition.name).and_then(|first| first.base) {
                loaded.entry(definition.name.clone()).or_insert((base, index));
            }
        }
    }
    loaded
}

fn same(left: BaseUnit, right: BaseUnit) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(b.abs());
    left.dimension == right.dimension && close(left.factor, right.factor) && close(left.offset, right.offset)
}

fn shown(unit: BaseUnit) -> String {
    format!("{} {}", unit.factor, unit.dimension)
}
