//! Rules for `dependencies` and `dependenciesKind`.

use std::collections::BTreeSet;

use super::{Report, structure};
use crate::description::{Causality, DependencyKind, Initial, Kind, Unknown, Variable};

const RULE: &str = "2.2.8";

pub(super) fn check(report: &mut Report) {
    let lists = &report.model.structure;
    for (list, unknowns) in
        [("Outputs", &lists.outputs), ("Derivatives", &lists.derivatives), ("InitialUnknowns", &lists.initial_unknowns)]
    {
        let states: BTreeSet<usize> = structure::states(report.model).map(|(_, state)| state).collect();
        for unknown in unknowns {
            dependencies(report, list, unknown, &states);
            kinds(report, list, unknown);
        }
    }
}

fn name_of(report: &Report, unknown: &Unknown) -> String {
    let variable = report.model.variables.get(unknown.index);
    variable.map_or_else(|| unknown.index.wrapping_add(1).to_string(), |variable| format!("`{}`", variable.name))
}

/// Checks that indices are in range, ascending, and of variables that may be knowns.
fn dependencies(report: &mut Report, list: &str, unknown: &Unknown, states: &BTreeSet<usize>) {
    let (model, at) = (report.model, unknown.position);
    let name = name_of(report, unknown);
    let indices = unknown.dependencies.as_deref().unwrap_or_default();
    if let Some(pair) = indices.windows(2).find(|pair| pair[0] >= pair[1]) {
        let (left, right) = (pair[0].wrapping_add(1), pair[1].wrapping_add(1));
        let message = format!("{name} in {list} has dependencies {left} and then {right}; expected ascending indices");
        report.error(RULE, at, message);
    }
    for &index in indices {
        let Some(known) = model.variables.get(index) else {
            let (index, count) = (index.wrapping_add(1), model.variables.len());
            let message = format!("{name} in {list} depends on index {index}; indices go from 1 to {count}");
            report.error(RULE, at, message);
            continue;
        };
        let (is_known, expected) = if list == "InitialUnknowns" {
            (is_known_at_start(known), "inputs, variables with initial exact, and the independent variable")
        } else {
            (is_known_in_a_step(known) || states.contains(&index), "inputs, states, and the independent variable")
        };
        if !is_known {
            let causality = known.causality.name();
            let message = format!("{name} in {list} depends on `{}`, which has causality {causality}", known.name);
            report.warning(RULE, at, format!("{message}; expected {expected}"));
        }
    }
}

fn is_known_in_a_step(variable: &Variable) -> bool {
    matches!(variable.causality, Causality::Input | Causality::Independent)
}

fn is_known_at_start(variable: &Variable) -> bool {
    is_known_in_a_step(variable) || variable.initial_or_default() == Some(Initial::Exact)
}

/// Checks that there are as many kinds as dependencies, linear kinds for Reals only, and in `InitialUnknowns` only the
/// kinds that are defined there.
fn kinds(report: &mut Report, list: &str, unknown: &Unknown) {
    let (model, at) = (report.model, unknown.position);
    let Some(kinds) = &unknown.dependencies_kind else { return };
    let name = name_of(report, unknown);
    let Some(indices) = &unknown.dependencies else {
        report.error(RULE, at, format!("{name} in {list} has dependenciesKind without dependencies"));
        return;
    };
    if kinds.len() != indices.len() {
        let (kinds, indices) = (kinds.len(), indices.len());
        let message =
            format!("{name} in {list} has {indices} dependencies, but {kinds} dependenciesKind; expected as many");
        report.error(RULE, at, message);
        return;
    }
    let is_real = |index: usize| model.variables.get(index).is_none_or(|known| matches!(known.kind, Kind::Real(_)));
    for (&kind, &index) in kinds.iter().zip(indices) {
        let word = kind.name();
        let changes = matches!(kind, DependencyKind::Fixed | DependencyKind::Tunable | DependencyKind::Discrete);
        if changes && list == "InitialUnknowns" {
            let message =
                format!("{name} in InitialUnknowns has dependenciesKind {word}; expected dependent or constant");
            report.error(RULE, at, message);
        } else if kind != DependencyKind::Dependent && !(is_real(unknown.index) && is_real(index)) {
            let index = index.wrapping_add(1);
            let message = format!(
                "{name} in {list} depends on index {index} with dependenciesKind {word}, which only Reals have among \
                 themselves; expected dependent"
            );
            report.error(RULE, at, message);
        }
    }
}
