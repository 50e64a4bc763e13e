//! Gives the value of a `let` that is used several times a slot of its own, so that a run computes it once a snapshot.
//!
//! Works on the finished scenario: expressions are numbered so that equal ones have one number, and a value of a `let` that
//! occurs in more than one place is replaced by its slot.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::meaning::Meaning;
use crate::scenario::{
    Action, BooleanExpression, ColumnSource, Drive, Formula, Gated, Near, RealExpression as E, Running, Scenario, Until,
};

/// An expression apart from its parts: its kind and what else distinguishes it from others.
type Head = (u8, u64, u64);

/// The numbers of expressions.
#[derive(Default)]
struct Numbers {
    by_node: BTreeMap<(Head, Vec<usize>), usize>,
    /// For each number the parts of the expression.
    parts: Vec<Vec<usize>>,
    /// The slots of the expressions that are shared.
    slots: BTreeMap<usize, usize>,
    shared: Vec<E>,
    /// The expressions that get a slot.
    is_shared: BTreeSet<usize>,
    /// The running values, which have one memory each and so get a slot in any case.
    running: BTreeSet<usize>,
    /// The conditions by their text, which is equal where they are.
    conditions: BTreeMap<String, u64>,
}

/// Moves the values of these meanings that are used more than once to [`Scenario::shared`].
pub(super) fn share<'m>(scenario: &mut Scenario, meanings: impl Iterator<Item = &'m Meaning>) {
    let mut numbers = Numbers::default();
    let mut named = BTreeSet::new();
    meanings.for_each(|meaning| numbers.name(meaning, &mut named));
    let mut uses = BTreeMap::new();
    expressions(scenario, &mut |expression| {
        let number = numbers.number(expression);
        numbers.count(number, &named, &mut uses);
    });
    numbers.is_shared = uses.into_iter().filter(|&(_, count)| count > 1).map(|(number, _)| number).collect();
    numbers.is_shared.extend(&numbers.running);
    expressions(scenario, &mut |expression| {
        numbers.number(expression);
    });
    scenario.shared = numbers.shared;
}

impl Numbers {
    /// Adds the numbers of what a `let` computes: of each element of a list.
    fn name(&mut self, meaning: &Meaning, named: &mut BTreeSet<usize>) {
        match meaning {
            Meaning::Real(value) if is_computed(&value.expression) => {
                named.insert(self.number(&mut value.expression.clone()));
            }
            Meaning::List(elements) => elements.iter().for_each(|element| self.name(element, named)),
            _ => {}
        }
    }

    /// The number of an expression; parts that get a slot, and the expression itself, are replaced.
    fn number(&mut self, expression: &mut E) -> usize {
        let head = self.head(expression);
        let mut parts = Vec::new();
        for_parts(expression, &mut |part| parts.push(self.number(part)));
        let new = self.parts.len();
        let number = *self.by_node.entry((head, parts.clone())).or_insert(new);
        if number == new {
            self.parts.push(parts);
        }
        if matches!(expression, E::Running(_)) {
            self.running.insert(number);
        }
        if self.is_shared.contains(&number) {
            let slot = *self.slots.entry(number).or_insert(self.shared.len());
            let whole = std::mem::replace(expression, E::Shared(slot));
            if slot == self.shared.len() {
                self.shared.push(whole);
            }
        }
        number
    }

    fn head(&mut self, expression: &E) -> Head {
        match *expression {
            E::Constant(value) => (0, value.to_bits(), 0),
            E::Signal(port) => (1, port.instance as u64, port.variable as u64),
            E::Time => (2, 0, 0),
            E::Affine { factor, offset, .. } => (3, factor.to_bits(), offset.to_bits()),
            E::InverseAffine { factor, offset, .. } => (4, factor.to_bits(), offset.to_bits()),
            E::Negate(_) => (5, 0, 0),
            E::Add(..) => (6, 0, 0),
            E::Subtract(..) => (7, 0, 0),
            E::Multiply(..) => (8, 0, 0),
            E::Divide(..) => (9, 0, 0),
            E::Call(function, _) => (10, function as u64, 0),
            E::Running(Running { kind, from_tick, .. }) => (11, kind as u64, from_tick),
            E::Truth(ref condition) => {
                let new = self.conditions.len() as u64;
                (12, *self.conditions.entry(format!("{condition:?}")).or_insert(new), 0)
            }
            // The resolver makes one for each column, and one for each that it converts.
            E::Curve(ref curve) => (13, Arc::as_ptr(curve) as usize as u64, 0),
            E::Near(Near { ref curve, within_s, .. }) => (14, Arc::as_ptr(curve) as usize as u64, within_s.to_bits()),
            E::Shared(_) => unreachable!("each expression is visited once"),
        }
    }

    /// Counts the places in which named expressions are used; what is used inside of one counts once.
    fn count(&self, number: usize, named: &BTreeSet<usize>, uses: &mut BTreeMap<usize, usize>) {
        if named.contains(&number) {
            let uses = uses.entry(number).or_insert(0);
            *uses += 1;
            if *uses > 1 {
                return;
            }
        }
        self.parts[number].iter().for_each(|&part| self.count(part, named, uses));
    }
}

/// Whether it takes more than reading a value and converting it.
fn is_computed(expression: &E) -> bool {
    match expression {
        E::Constant(_) | E::Signal(_) | E::Time | E::Curve(_) | E::Shared(_) => false,
        E::Affine { of, .. } | E::InverseAffine { of, .. } => is_computed(of),
        _ => true,
    }
}

fn for_parts(expression: &mut E, visit: &mut dyn FnMut(&mut E)) {
    match expression {
        E::Constant(_) | E::Signal(_) | E::Time | E::Curve(_) | E::Shared(_) => {}
        E::Affine { of, .. } | E::InverseAffine { of, .. } | E::Negate(of) | E::Near(Near { of, .. }) => visit(of),
        E::Add(left, right) | E::Subtract(left, right) | E::Multiply(left, right) | E::Divide(left, right) => {
            visit(left);
            visit(right);
        }
        E::Call(_, arguments) => arguments.iter_mut().for_each(visit),
        E::Running(running) => visit(&mut running.of),
        E::Truth(condition) => of_condition(condition, visit),
    }
}

/// Visits the real expressions of a scenario that are no part of others.
fn expressions(scenario: &mut Scenario, visit: &mut dyn FnMut(&mut E)) {
    let drive = |drive: &mut Drive, visit: &mut dyn FnMut(&mut E)| match drive {
        Drive::Real(value) => visit(value),
        Drive::Boolean(condition) => of_condition(condition, visit),
        _ => {}
    };
    scenario.connections.iter_mut().for_each(|connection| drive(&mut connection.source, visit));
    for action in scenario.events.iter_mut().flat_map(|event| &mut event.actions) {
        match action {
            Action::Set(set) => drive(&mut set.value, visit),
            Action::Fault(fault) => fault.kind.values_mut().iter_mut().for_each(&mut *visit),
        }
    }
    scenario.conditions.iter_mut().for_each(|condition| of_condition(&mut condition.is, visit));
    scenario.claims.iter_mut().for_each(|claim| of_formula(&mut claim.formula, visit));
    for column in &mut scenario.columns {
        match &mut column.source {
            ColumnSource::Port(_) => {}
            ColumnSource::Real { value, .. } => visit(value),
            ColumnSource::Condition(condition) => of_condition(condition, visit),
        }
    }
}

fn of_condition(condition: &mut BooleanExpression, visit: &mut dyn FnMut(&mut E)) {
    use BooleanExpression as B;
    match condition {
        B::Margin(margin) => visit(&mut margin.value),
        B::Not(of) => of_condition(of, visit),
        B::And(parts) | B::Or(parts) => parts.iter_mut().for_each(|part| of_condition(part, visit)),
        B::Constant(_) | B::Signal(_) | B::Same(..) | B::Rises(_) => {}
    }
}

fn of_formula(formula: &mut Formula, visit: &mut dyn FnMut(&mut E)) {
    match formula {
        Formula::Margin(margin) => visit(&mut margin.value),
        Formula::Condition(condition) => of_condition(condition, visit),
        Formula::And(parts) | Formula::Or(parts) => parts.iter_mut().for_each(|part| of_formula(part, visit)),
        Formula::Always(_, body) | Formula::Eventually(_, body) | Formula::Finally(body) => of_formula(body, visit),
        Formula::Gated(Gated { gate, body, .. }) | Formula::Until(Until { gate, body, .. }) => {
            of_formula(gate, visit);
            of_formula(body, visit);
        }
    }
}
