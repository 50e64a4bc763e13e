//! Checks the declared dependencies of outputs, in both directions: changes every input and parameter and observes which
//! outputs change.

use super::Findings;
use super::bases::{Base, bases};
use super::moves::differs;
use super::subject::Subject;
use crate::declaration::Role;
use crate::library::Library;
use crate::visitor::{Scalar, Value};
use fmi2::description::{Causality, Unknown};
use std::collections::BTreeSet;

/// Steps before the inputs are changed.
const WARM_UP: u32 = 3;

/// When an output changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum When {
    /// In initialization mode, after `init`.
    AtTheStart,
    /// Between two steps, after `outputs`.
    AtOnce,
}

/// An output that changed with a variable, both by their index in the description.
type Move = (When, usize, usize);

/// Checks that each output changes with the inputs and parameters that it declares and with no other, in initialization
/// mode and when an input is set between two steps; and that `outputs` changes no state.
///
/// No time passes in either case, so that an output that changes is dependent. This is done from the start values, from
/// changed inputs, with each value of parameters that are not Real, and from random values.
///
/// # Errors
///
/// Each output that changed with an undeclared variable, each declared name with which no output ever changed, or the
/// reason why the unit does not run with its start values.
pub fn outputs_depend_on_what_they_declare(library: &'static Library) -> Result<(), Findings> {
    let mut subject = Subject::new(library);
    let start = subject.save();
    if let Err(fault) = subject.init(0.0) {
        return Err(Findings(vec![format!("the unit does not start with its start values: {fault}")]));
    }
    let (mut found, mut moves) = (BTreeSet::new(), BTreeSet::new());
    for base in bases(&mut subject, &*start) {
        moved_at_start(&mut subject, &base, &mut moves);
        moved_at_once(&mut subject, &base, &mut moves, &mut found);
    }
    found.extend(undeclared(&subject, &moves));
    found.extend(superfluous(&library.scalars(), &moves));
    Findings::none_or(found.into_iter().collect())
}

/// Changes each variable that has a start value and initializes.
fn moved_at_start(subject: &mut Subject, base: &Base, moves: &mut BTreeSet<Move>) {
    let outputs = subject.outputs();
    let knowns = subject.variables(|variable| variable.has_start());
    subject.restore(&*base.unit);
    if subject.init(base.start_s).is_err() {
        return;
    }
    let without: Vec<Value> = outputs.iter().map(|&output| subject.get(output)).collect();
    for known in knowns {
        subject.restore(&*base.unit);
        for other in subject.others(known) {
            subject.restore(&*base.unit);
            subject.set(known, &other);
            // A unit may reject a combination of values.
            if subject.init(base.start_s).is_ok() {
                note(subject, When::AtTheStart, &outputs, &without, known, moves);
            }
        }
    }
}

/// Changes the inputs after some steps and computes the outputs anew.
fn moved_at_once(subject: &mut Subject, base: &Base, moves: &mut BTreeSet<Move>, found: &mut BTreeSet<String>) {
    let inputs = subject.variables(|variable| variable.causality == Causality::Input);
    let Some(now_s) = warm_up(subject, base) else { return };
    let outputs = subject.outputs();
    let warm = subject.save();
    let state = subject.bytes();
    if subject.compute_outputs(now_s).is_err() {
        return;
    }
    if subject.bytes() != state {
        found.insert("a second `outputs` changes what the first one left: it must not change a state".to_owned());
    }
    let without: Vec<Value> = outputs.iter().map(|&output| subject.get(output)).collect();
    for input in inputs {
        subject.restore(&*warm);
        for other in subject.others(input) {
            subject.restore(&*warm);
            let own = subject.get(input);
            subject.set(input, &other);
            if subject.compute_outputs(now_s).is_ok() {
                note(subject, When::AtOnce, &outputs, &without, input, moves);
                subject.set(input, &own);
                if subject.compute_outputs(now_s).is_ok() && subject.bytes() != state {
                    let name = subject.name(input);
                    found.insert(format!(
                        "`outputs` changes a state: the unit remembers that `{name}` had another value"
                    ));
                }
            }
        }
    }
}

/// Notes the outputs that have other values than before.
fn note(subject: &Subject, when: When, outputs: &[usize], without: &[Value], known: usize, moves: &mut BTreeSet<Move>) {
    for (&output, without) in outputs.iter().zip(without) {
        if output != known && differs(without, &subject.get(output)) {
            moves.insert((when, output, known));
        }
    }
}

/// Runs some steps from the base; returns the time.
fn warm_up(subject: &mut Subject, base: &Base) -> Option<f64> {
    subject.restore(&*base.unit);
    subject.init(base.start_s).ok()?;
    let step_s = subject.step_s;
    for n in 0..WARM_UP {
        subject.step(base.start_s + f64::from(n) * step_s, step_s).ok()?;
    }
    Some(base.start_s + f64::from(WARM_UP) * step_s)
}

/// Outputs that changed with what they do not declare.
fn undeclared(subject: &Subject, moves: &BTreeSet<Move>) -> Vec<String> {
    let structure = &subject.description().structure;
    let declares = |unknowns: &[Unknown], output: usize, known: usize| {
        let unknown = unknowns.iter().find(|unknown| unknown.index == output);
        unknown.is_some_and(|unknown| unknown.dependencies.as_ref().is_none_or(|indices| indices.contains(&known)))
    };
    let line = |&(when, output, known): &Move| {
        let (unknowns, words) = match when {
            When::AtTheStart => (&structure.initial_unknowns, "at the start"),
            When::AtOnce => (&structure.outputs, "at once"),
        };
        let (output_name, known_name) = (subject.name(output), subject.name(known));
        (!declares(unknowns, output, known))
            .then(|| format!("`{output_name}` moves with `{known_name}` {words}, which it does not declare"))
    };
    moves.iter().filter_map(line).collect()
}

/// Declared names with which no output of the field that declares them ever changed.
fn superfluous(scalars: &[Scalar], moves: &BTreeSet<Move>) -> BTreeSet<String> {
    let mut lines = BTreeSet::new();
    for scalar in scalars {
        let Role::CalculatedOutput { field, depends, depends_at_start } = &scalar.declaration.role else { continue };
        let of_field = |output: usize| match &scalars[output].declaration.role {
            Role::CalculatedOutput { field: other, .. } => other == field,
            _ => false,
        };
        let moved = |wanted: When, name: &str| {
            moves
                .iter()
                .any(|&(when, output, known)| when == wanted && of_field(output) && scalars[known].is_named(name))
        };
        // Without `init`, the names are those for the start too, parameters among them.
        let is_input =
            |name: &str| scalars.iter().any(|known| known.declaration.role == Role::Input && known.is_named(name));
        for name in depends.iter().filter(|name| is_input(name) && !moved(When::AtOnce, name)) {
            lines.insert(format!(
                "`{field}` declares `{name}`, but does not move with it at once: compute it in `outputs`, or leave the name out"
            ));
        }
        for name in depends_at_start.iter().filter(|name| !moved(When::AtTheStart, name)) {
            lines.insert(format!(
                "`{field}` declares `{name}` for the start, but never moves with it there: leave it out"
            ));
        }
    }
    lines
}
