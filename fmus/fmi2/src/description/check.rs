//! Checks a description against the rules of FMI 2.0.5 for co-simulation; each finding names the section, the position,
//! what was expected and what was found.

mod attributes;
mod dependencies;
mod header;
mod names;
mod references;
mod structure;
mod types;
mod units;
mod values;
mod variables;

use std::collections::BTreeMap;

use super::{Finding, Kind, ModelDescription, Named, Position, SimpleType, TypeKind, UnitDefinition, Variable};

/// All violations of the rules, in the file's order. Findings of [`read`](super::read::read) are not repeated.
#[must_use]
pub fn check(model: &ModelDescription) -> Vec<Finding> {
    let mut report = Report::new(model);
    header::check(&mut report);
    units::check(&mut report);
    types::check(&mut report);
    names::check(&mut report);
    variables::check(&mut report);
    values::check(&mut report);
    references::check(&mut report);
    structure::check(&mut report);
    let mut findings = report.findings;
    findings.sort_by_key(|finding| finding.position);
    findings
}

/// The description under check, its names for look-up, and the findings.
struct Report<'a> {
    model: &'a ModelDescription,
    units: BTreeMap<&'a str, &'a UnitDefinition>,
    types: BTreeMap<&'a str, &'a SimpleType>,
    findings: Vec<Finding>,
}

impl<'a> Report<'a> {
    fn new(model: &'a ModelDescription) -> Self {
        // Of equal names the first one is used, as in the description's own look-up.
        let units = model.units.iter().rev().map(|unit| (unit.name.as_str(), unit)).collect();
        let types = model.types.iter().rev().map(|declared| (declared.name.as_str(), declared)).collect();
        Self { model, units, types, findings: Vec::new() }
    }

    /// As [`ModelDescription::unit_of`], without a search through all types.
    fn unit_of(&self, variable: &'a Variable) -> Option<&'a str> {
        let Kind::Real(own) = &variable.kind else { return None };
        own.unit.as_deref().or_else(|| match &self.types.get(variable.declared_type.as_deref()?)?.kind {
            TypeKind::Real(real) => real.unit.as_deref(),
            _ => None,
        })
    }

    fn error(&mut self, rule: &'static str, position: Position, message: impl Into<String>) {
        self.findings.push(Finding::error(rule, position, message));
    }

    fn warning(&mut self, rule: &'static str, position: Position, message: impl Into<String>) {
        self.findings.push(Finding::warning(rule, position, message));
    }

    /// As [`Report::unique`], for elements of which only the name is kept.
    fn unique_named(&mut self, rule: &'static str, what: &str, elements: &[Named]) {
        self.unique(rule, what, elements.iter().map(|element| (element.name.as_str(), element.position)));
    }

    /// Reports names that are empty or occur twice in a list; `what` is the article and noun, as in "a unit".
    fn unique<'n>(&mut self, rule: &'static str, what: &str, names: impl IntoIterator<Item = (&'n str, Position)>) {
        let mut seen: BTreeMap<&str, Position> = BTreeMap::new();
        for (name, position) in names {
            if name.is_empty() {
                self.error(rule, position, format!("{what} has no name"));
            } else if let Some(first) = seen.get(name) {
                let elsewhere = first.line > 0 && *first != position;
                let at = if elsewhere { format!(", first in line {}", first.line) } else { String::new() };
                self.error(rule, position, format!("{what} named `{name}` stands here a second time{at}"));
            } else {
                seen.insert(name, position);
            }
        }
    }
}

#[cfg(test)]
mod tests;
