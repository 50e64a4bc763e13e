//! Rules for `TypeDefinitions`.

use std::collections::BTreeMap;

use super::{Report, attributes};
use crate::description::{Item, SimpleType, TypeKind};

const RULE: &str = "2.2.3";

pub(super) fn check(report: &mut Report) {
    let model = report.model;
    report.unique(RULE, "a type", model.types.iter().map(|declared| (declared.name.as_str(), declared.position)));
    for variable in &model.variables {
        if let Some(declared) = report.types.get(variable.name.as_str()).filter(|declared| !declared.name.is_empty()) {
            let line = declared.position.line;
            let message = format!("`{}` is the name of a variable, but also of a type (line {line})", variable.name);
            report.error(RULE, variable.position, message);
        }
    }
    for declared in &model.types {
        let what = format!("the type `{}`", declared.name);
        match &declared.kind {
            TypeKind::Real(real) => {
                let place = attributes::Place { rule: RULE, position: declared.position, what: &what };
                attributes::check(report, &place, real);
                attributes::display_unit(report, &place, real, None);
                attributes::range(report, &place, real.min, real.max);
            }
            TypeKind::Integer { min, max } => {
                let place = attributes::Place { rule: RULE, position: declared.position, what: &what };
                attributes::range(report, &place, *min, *max);
            }
            TypeKind::Boolean | TypeKind::String => {}
            TypeKind::Enumeration { items, .. } => enumeration(report, declared, items),
        }
    }
}

fn enumeration(report: &mut Report, declared: &SimpleType, items: &[Item]) {
    let name = &declared.name;
    if items.is_empty() {
        report.error(RULE, declared.position, format!("the enumeration `{name}` has no Item; at least one is needed"));
    }
    let names = items.iter().map(|item| (item.name.as_str(), item.position));
    report.unique(RULE, &format!("an item of `{name}`"), names);
    let mut values: BTreeMap<i32, &str> = BTreeMap::new();
    for item in items {
        if let Some(first) = values.get(&item.value) {
            let (value, second) = (item.value, &item.name);
            let message = format!("the items `{first}` and `{second}` of `{name}` both have the value {value}");
            report.error(RULE, item.position, message);
        } else {
            values.insert(item.value, &item.name);
        }
    }
}
