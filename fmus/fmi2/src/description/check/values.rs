//! Rules for start values: finite, between min and max of the variable or its type, and an item of an enumeration.

use std::fmt::Display;

use super::Report;
use super::attributes::{Place, range};
use crate::description::{Item, Kind, TypeKind, Variable};

const RULE: &str = "2.2.7";

pub(super) fn check(report: &mut Report) {
    for variable in &report.model.variables {
        let declared =
            variable.declared_type.as_deref().and_then(|name| report.types.get(name)).map(|found| &found.kind);
        match (&variable.kind, declared) {
            (Kind::Real(real), declared) => {
                let inherited = match declared {
                    Some(TypeKind::Real(inherited)) => (inherited.min, inherited.max),
                    _ => (None, None),
                };
                if let Some(start) = real.start.filter(|start| !start.is_finite()) {
                    let message = format!("`{}` has the start value {start}; expected a finite number", variable.name);
                    report.error(RULE, variable.position, message);
                }
                let start = real.start.filter(|start| start.is_finite());
                within(report, variable, start, (real.min, real.max), inherited);
            }
            (Kind::Integer { start, min, max }, Some(TypeKind::Integer { min: low, max: high })) => {
                within(report, variable, *start, (*min, *max), (*low, *high));
            }
            (Kind::Integer { start, min, max }, _) => within(report, variable, *start, (*min, *max), (None, None)),
            (Kind::Enumeration { start, min, max }, declared) => {
                within(report, variable, *start, (*min, *max), (None, None));
                if let (Some(start), Some(TypeKind::Enumeration { items, .. })) = (*start, declared) {
                    among(report, variable, start, items);
                }
            }
            (Kind::Boolean { .. } | Kind::String { .. }, _) => {}
        }
    }
}

fn among(report: &mut Report, variable: &Variable, start: i32, items: &[Item]) {
    if items.is_empty() || items.iter().any(|item| item.value == start) {
        return;
    }
    let known: Vec<_> = items.iter().map(|item| format!("{} ({})", item.value, item.name)).collect();
    let message = format!("`{}` starts with {start}, which is no item; items are {}", variable.name, known.join(", "));
    report.error(RULE, variable.position, message);
}

/// Checks `min <= start <= max` with the variable's own range or, where it has none, that of its type.
fn within<T: PartialOrd + Display + Copy>(
    report: &mut Report,
    variable: &Variable,
    start: Option<T>,
    own: (Option<T>, Option<T>),
    inherited: (Option<T>, Option<T>),
) {
    let (name, at) = (&variable.name, variable.position);
    let (min, max) = (own.0.or(inherited.0), own.1.or(inherited.1));
    if own.0.is_some() || own.1.is_some() {
        range(report, &Place { rule: RULE, position: at, what: &format!("`{name}`") }, min, max);
    }
    let Some(start) = start else { return };
    if let Some(min) = min.filter(|min| start < *min) {
        report.error(RULE, at, format!("`{name}` starts with {start}, below its min {min}"));
    } else if let Some(max) = max.filter(|max| start > *max) {
        report.error(RULE, at, format!("`{name}` starts with {start}, above its max {max}"));
    }
}
