//! Rules for aliases: variables that share a value reference.

use std::collections::{BTreeMap, BTreeSet};

use super::Report;
use crate::description::{BaseType, Kind, ModelDescription, Variability, Variable};

const RULE: &str = "2.2.7";

pub(super) fn check(report: &mut Report) {
    let model = report.model;
    let mut aliases: BTreeMap<(BaseType, u32), Vec<&Variable>> = BTreeMap::new();
    for variable in &model.variables {
        aliases.entry((variable.base_type(), variable.value_reference)).or_default().push(variable);
    }
    for set in aliases.values().filter(|set| set.len() > 1) {
        let first = set[0];
        for &other in &set[1..] {
            pair(report, first, other);
        }
        // Only one of the names may be set, so only one may have a start value.
        let mut starts = set.iter().filter(|alias| alias.has_start() && alias.variability != Variability::Constant);
        let (Some(one), Some(two)) = (starts.next(), starts.next()) else { continue };
        let message = format!(
            "`{}` and `{}` share value reference {} and both have a start value; of aliases one at most has",
            one.name, two.name, one.value_reference
        );
        report.error(RULE, two.position, message);
    }
}

/// What two aliases must have in common.
fn pair<'a>(report: &mut Report<'a>, first: &'a Variable, other: &'a Variable) {
    let share = format!("`{}` and `{}` share value reference {}", first.name, other.name, first.value_reference);
    let constants = [first, other].map(|alias| alias.variability == Variability::Constant);
    if constants[0] != constants[1] {
        report.error(RULE, other.position, format!("{share}, but only one of them is constant"));
    } else if constants[0] && !same_start(first, other) {
        report.error(RULE, other.position, format!("{share} and are constant, but start with different values"));
    }
    let enumerations = [first, other].map(|alias| matches!(alias.kind, Kind::Enumeration { .. }));
    if enumerations[0] != enumerations[1] {
        report.error(RULE, other.position, format!("{share}, but only one of them is an Enumeration"));
    } else if enumerations[0] && !same_items(report.model, first, other) {
        report.error(RULE, other.position, format!("{share}, but their types have different items"));
    }
    let [left, right] = [first, other].map(|alias| report.unit_of(alias));
    if left != right {
        let [left, right] =
            [left, right].map(|unit| unit.map_or("no unit".to_owned(), |unit| format!("the unit `{unit}`")));
        report.error(RULE, other.position, format!("{share}, but have {left} and {right}; aliases have one unit"));
    }
}

/// Whether the items have equal names and values, in any order.
fn same_items(model: &ModelDescription, first: &Variable, other: &Variable) -> bool {
    let items =
        |variable| model.items_of(variable).iter().map(|item| (item.value, &item.name)).collect::<BTreeSet<_>>();
    first.declared_type == other.declared_type || items(first) == items(other)
}

fn same_start(first: &Variable, other: &Variable) -> bool {
    match (&first.kind, &other.kind) {
        (Kind::Real(first), Kind::Real(other)) => first.start == other.start,
        (
            Kind::Integer { start: first, .. } | Kind::Enumeration { start: first, .. },
            Kind::Integer { start: other, .. } | Kind::Enumeration { start: other, .. },
        ) => first == other,
        (Kind::Boolean { start: first }, Kind::Boolean { start: other }) => first == other,
        (Kind::String { start: first }, Kind::String { start: other }) => first == other,
        _ => false,
    }
}
