//! Rules for `ModelStructure`: which variables are in which list, and in which order.

use std::collections::BTreeSet;

use super::{Report, dependencies};
use crate::description::{Causality, Initial, Kind, ModelDescription, Unknown, Variable};

const RULE: &str = "2.2.8";

pub(super) fn check(report: &mut Report) {
    let model = report.model;
    let structure = &model.structure;
    let outputs = |variable: &Variable| variable.causality == Causality::Output;
    let listed = members(report, "Outputs", &structure.outputs);
    for (index, variable) in model.variables.iter().enumerate() {
        if outputs(variable) && !listed.contains(&index) {
            let message = format!("the output `{}` is missing in Outputs; its index is {}", variable.name, index + 1);
            report.error(RULE, structure.position, message);
        }
    }
    for unknown in &structure.outputs {
        if let Some(variable) = model.variables.get(unknown.index).filter(|variable| !outputs(variable)) {
            let (name, causality) = (&variable.name, variable.causality.name());
            let message = format!(
                "Outputs lists index {}, `{name}`, which has causality {causality}{}",
                unknown.index + 1,
                counted_from_zero(model, unknown.index, outputs)
            );
            report.error(RULE, unknown.position, message);
        }
    }
    members(report, "Derivatives", &structure.derivatives);
    for unknown in &structure.derivatives {
        let variable = model.variables.get(unknown.index);
        let no_derivative =
            |variable: &&Variable| !matches!(&variable.kind, Kind::Real(real) if real.derivative.is_some());
        if let Some(variable) = variable.filter(no_derivative) {
            let message = format!("Derivatives lists `{}`, which has no attribute `derivative`", variable.name);
            report.error(RULE, unknown.position, message);
        }
    }
    initial_unknowns(report);
    dependencies::check(report);
}

/// A hint for lists that seem to hold value references or to count from 0.
fn counted_from_zero(model: &ModelDescription, index: usize, expected: impl Fn(&Variable) -> bool) -> &'static str {
    match model.variables.get(index.wrapping_add(1)) {
        Some(next) if expected(next) => "; indices count from 1, in the order of ModelVariables",
        _ => "",
    }
}

/// The variables of a list; reports indices without a variable and variables that occur twice.
fn members(report: &mut Report, list: &str, unknowns: &[Unknown]) -> BTreeSet<usize> {
    let model = report.model;
    let mut listed = BTreeSet::new();
    for unknown in unknowns {
        match model.variables.get(unknown.index) {
            None => {
                let (index, count) = (unknown.index.wrapping_add(1), model.variables.len());
                let message = format!("{list} lists index {index}; indices go from 1 to {count}");
                report.error(RULE, unknown.position, message);
            }
            Some(variable) if !listed.insert(unknown.index) => {
                let message = format!("{list} lists `{}`, index {}, a second time", variable.name, unknown.index + 1);
                report.error(RULE, unknown.position, message);
            }
            Some(_) => {}
        }
    }
    listed
}

/// Checks that the list is exactly the outputs, states and derivatives whose first value is calculated, and the
/// calculated parameters, in order.
fn initial_unknowns(report: &mut Report) {
    let model = report.model;
    let structure = &model.structure;
    let listed = members(report, "InitialUnknowns", &structure.initial_unknowns);
    let continuous: BTreeSet<usize> = states(model).flat_map(|(derivative, state)| [derivative, state]).collect();
    let why = |index: usize, variable: &Variable| {
        let computed = matches!(variable.initial_or_default(), Some(Initial::Approx | Initial::Calculated));
        match variable.causality {
            Causality::CalculatedParameter => Some("a calculated parameter"),
            Causality::Output if computed => Some("an output whose first value is computed"),
            _ if computed && continuous.contains(&index) => Some("a state or derivative whose first value is computed"),
            _ => None,
        }
    };
    for (index, variable) in model.variables.iter().enumerate() {
        if let Some(reason) = why(index, variable).filter(|_| !listed.contains(&index)) {
            let message =
                format!("`{}`, {reason}, is missing in InitialUnknowns; its index is {}", variable.name, index + 1);
            report.error(RULE, structure.position, message);
        }
    }
    let mut highest = 0;
    for unknown in &structure.initial_unknowns {
        let Some(variable) = model.variables.get(unknown.index) else { continue };
        if why(unknown.index, variable).is_none() {
            let initial = variable.initial_or_default().map_or("none", Initial::name);
            let message = format!(
                "InitialUnknowns lists index {}, `{}`, which has causality {} and initial {initial}; expected outputs, states \
                 and derivatives that are calculated or approx, and calculated parameters",
                unknown.index + 1,
                variable.name,
                variable.causality.name(),
            );
            report.error(RULE, unknown.position, message);
        }
        if unknown.index < highest {
            let message = format!(
                "InitialUnknowns lists index {} after {}; expected ascending indices",
                unknown.index + 1,
                highest + 1
            );
            report.error(RULE, unknown.position, message);
        }
        highest = highest.max(unknown.index);
    }
}

/// The listed derivatives with their states.
pub(super) fn states(model: &ModelDescription) -> impl Iterator<Item = (usize, usize)> {
    model.structure.derivatives.iter().filter_map(|unknown| match &model.variables.get(unknown.index)?.kind {
        Kind::Real(real) => Some((unknown.index, real.derivative?)),
        _ => None,
    })
}
