//! Which ports an expression, a claim or a whole scenario reads.

use crate::expression::Program;
use crate::values::Slot;
use dsl::scenario::{BooleanExpression, Drive, Formula, Port, Scenario};
use fmi2::description::ModelDescription;

/// Tells each port that a value is computed from; a port may be told more than once.
pub fn reads_of(drive: &Drive, descriptions: &[&ModelDescription], told: &mut dyn FnMut(Port)) {
    match drive {
        Drive::Copy(port) => told(*port),
        Drive::Real(expression) => drop(Program::compile_real(expression, &mut teller(descriptions, told))),
        Drive::Boolean(condition) => reads_of_condition(condition, descriptions, told),
        Drive::Integer(_) | Drive::String(_) | Drive::Curve(_) => {}
    }
}

/// Tells each port that connections, `set`, conditions or claims read: those whose values must be finite.
pub fn reads_that_count(scenario: &Scenario, descriptions: &[&ModelDescription], told: &mut dyn FnMut(Port)) {
    for connection in &scenario.connections {
        reads_of(&connection.source, descriptions, told);
    }
    for set in scenario.events.iter().flat_map(|event| &event.sets) {
        reads_of(&set.value, descriptions, told);
    }
    for condition in &scenario.rises {
        reads_of_condition(condition, descriptions, told);
    }
    for claim in &scenario.claims {
        reads_of_formula(&claim.formula, descriptions, told);
    }
}

fn reads_of_condition(condition: &BooleanExpression, descriptions: &[&ModelDescription], told: &mut dyn FnMut(Port)) {
    drop(Program::compile_condition(condition, &mut teller(descriptions, told)));
}

fn reads_of_formula(formula: &Formula, descriptions: &[&ModelDescription], told: &mut dyn FnMut(Port)) {
    match formula {
        Formula::Margin(margin) => drop(Program::compile_real(&margin.value, &mut teller(descriptions, told))),
        Formula::Condition(condition) => reads_of_condition(condition, descriptions, told),
        Formula::And(parts) | Formula::Or(parts) => {
            parts.iter().for_each(|part| reads_of_formula(part, descriptions, told));
        }
        Formula::Always(_, body) | Formula::Eventually(_, body) => reads_of_formula(body, descriptions, told),
    }
}

/// Compiling asks for the place of every signal: this answers with the right type and tells the port.
fn teller<'a>(descriptions: &'a [&ModelDescription], told: &'a mut dyn FnMut(Port)) -> impl FnMut(Port) -> Slot + 'a {
    |port| {
        told(port);
        Slot { base: descriptions[port.instance].variables[port.variable].base_type(), index: 0 }
    }
}
