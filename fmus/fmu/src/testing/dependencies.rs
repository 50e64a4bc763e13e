//! Checks the declared dependencies of outputs: changes every input and parameter and observes which outputs change.

use super::Findings;
use super::moves::{Pair, differs, moved_at_once, others};
use super::subject::Subject;
use crate::library::{Library, Unit};
use crate::visitor::Value;
use fmi2::description::{Causality, Kind, Unknown};
use std::collections::BTreeSet;

/// Steps before the inputs are changed.
const WARM_UP: u32 = 3;
/// A step so short that states hardly change.
const SHORT_S: f64 = 1e-9;
/// A step in which states change a thousand times as much.
const LONG_S: f64 = 1e-6;

/// Checks that no output changes with an input or parameter that it does not declare, in initialization mode or after a
/// step.
///
/// In initialization mode no time passes, so every output that changes is dependent. A step is as short as time can be
/// counted: in it states hardly change, and outputs change with their dependencies at the same instant. All this is
/// done with the start values, with every input changed from its start value, and with each value of parameters that
/// are not Real.
///
/// # Errors
///
/// Each output that changed with an undeclared variable, or the reason why the unit does not run with its start values.
pub fn outputs_move_only_with_what_they_declare(library: &'static Library) -> Result<(), Findings> {
    let mut subject = Subject::new(library);
    let start = subject.save();
    if let Err(fault) = subject.init() {
        return Err(Findings(vec![format!("the unit does not start with its start values: {fault}")]));
    }
    let mut found = BTreeSet::new();
    for base in bases(&mut subject, &*start) {
        moved_at_start(&mut subject, &*base, &mut found);
        moved_in_a_step(&mut subject, &*base, &mut found);
    }
    Findings::none_or(found.into_iter().collect())
}

/// The unit before initialization: with start values, with changed inputs, and with these and one changed parameter.
fn bases(subject: &mut Subject, start: &dyn Unit) -> Vec<Box<dyn Unit>> {
    let inputs = subject.variables(|variable| variable.causality == Causality::Input);
    let choices = subject
        .variables(|variable| variable.causality == Causality::Parameter && !matches!(variable.kind, Kind::Real(_)));
    subject.restore(start);
    let mut bases = vec![subject.save()];
    for input in inputs {
        if let Some(moved) = others(subject.description, input, &subject.get(input)).last() {
            subject.set(input, moved);
        }
    }
    let moved = subject.save();
    for choice in choices {
        for other in others(subject.description, choice, &subject.get(choice)) {
            subject.restore(&*moved);
            subject.set(choice, &other);
            bases.push(subject.save());
        }
        subject.restore(&*moved);
    }
    bases.push(moved);
    bases
}

/// Changes each variable that has a start value and initializes.
fn moved_at_start(subject: &mut Subject, base: &dyn Unit, found: &mut BTreeSet<String>) {
    let outputs = subject.outputs();
    let knowns = subject.variables(|variable| variable.has_start());
    subject.restore(base);
    if subject.init().is_err() {
        return;
    }
    let without: Vec<Value> = outputs.iter().map(|&output| subject.get(output)).collect();
    for known in knowns {
        subject.restore(base);
        for other in others(subject.description, known, &subject.get(known)) {
            subject.restore(base);
            subject.set(known, &other);
            // A unit may reject a combination of values.
            if subject.init().is_err() {
                continue;
            }
            for (&output, without) in outputs.iter().zip(&without) {
                let declared = declares(&subject.description.structure.initial_unknowns, output, known);
                if output != known && !declared && differs(without, &subject.get(output)) {
                    found.insert(format!(
                        "`{}` moves with `{}` at the start, which it does not declare",
                        subject.name(output),
                        subject.name(known)
                    ));
                }
            }
        }
    }
}

/// Changes the inputs after some steps and makes a short step, which ends where a sample may be due.
fn moved_in_a_step(subject: &mut Subject, base: &dyn Unit, found: &mut BTreeSet<String>) {
    let inputs = subject.variables(|variable| variable.causality == Causality::Input);
    let Some(now_s) = warm_up(subject, base) else { return };
    let outputs = subject.outputs();
    let warm = subject.save();
    let after = |subject: &mut Subject, change: Option<(usize, &Value)>, length_s| {
        subject.restore(&*warm);
        if let Some((input, value)) = change {
            subject.set(input, value);
        }
        subject.step(now_s, length_s).ok()?;
        Some(outputs.iter().map(|&output| subject.get(output)).collect::<Vec<_>>())
    };
    let (Some(short), Some(long)) = (after(subject, None, SHORT_S), after(subject, None, LONG_S)) else { return };
    for input in inputs {
        subject.restore(&*warm);
        for other in others(subject.description, input, &subject.get(input)) {
            let change = Some((input, &other));
            let moved = (after(subject, change, SHORT_S), after(subject, change, LONG_S));
            let (Some(short_moved), Some(long_moved)) = moved else { continue };
            for (place, &output) in outputs.iter().enumerate() {
                let pair = |without: &[Value], with: &[Value]| Pair {
                    without: without[place].clone(),
                    with: with[place].clone(),
                };
                let declared = declares(&subject.description.structure.outputs, output, input);
                if !declared && moved_at_once(&pair(&short, &short_moved), &pair(&long, &long_moved)) {
                    found.insert(format!(
                        "`{}` moves with `{}` at once, which it does not declare",
                        subject.name(output),
                        subject.name(input)
                    ));
                }
            }
        }
    }
}

/// Runs from the base to shortly before the end of a full step; returns the time.
fn warm_up(subject: &mut Subject, base: &dyn Unit) -> Option<f64> {
    subject.restore(base);
    subject.init().ok()?;
    let step_s = subject.step_s;
    for n in 0..WARM_UP {
        subject.step(f64::from(n) * step_s, step_s).ok()?;
    }
    subject.step(f64::from(WARM_UP) * step_s, step_s - SHORT_S).ok()?;
    Some(f64::from(WARM_UP + 1) * step_s - SHORT_S)
}

fn declares(unknowns: &[Unknown], output: usize, known: usize) -> bool {
    let unknown = unknowns.iter().find(|unknown| unknown.index == output);
    unknown.is_some_and(|unknown| unknown.dependencies.as_ref().is_none_or(|indices| indices.contains(&known)))
}
