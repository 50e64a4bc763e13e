//! Which ports an expression reads, those behind `rises` included.

use std::collections::BTreeSet;

use super::scope::Scope;
use super::wire::Wired;
use crate::scenario::{BooleanExpression, Drive, Formula, Operand, Port, RealExpression};

impl Scope<'_> {
    /// All ports that connections read.
    pub fn sources(&self, connections: &[Wired]) -> BTreeSet<Port> {
        connections.iter().flat_map(|wired| self.read_by(&wired.connection.source)).collect()
    }

    /// The ports that a driver reads.
    pub fn read_by(&self, drive: &Drive) -> BTreeSet<Port> {
        let mut ports = BTreeSet::new();
        match drive {
            Drive::Copy(port) => {
                ports.insert(*port);
            }
            Drive::Real(value) => of_real(value, &mut ports),
            Drive::Boolean(condition) => self.of_condition(condition, &mut ports),
            Drive::Integer(_) | Drive::String(_) | Drive::Curve(_) => {}
        }
        ports
    }

    /// Adds the ports that a claim reads.
    pub fn of_formula(&self, formula: &Formula, ports: &mut BTreeSet<Port>) {
        match formula {
            Formula::Margin(margin) => of_real(&margin.value, ports),
            Formula::Condition(condition) => self.of_condition(condition, ports),
            Formula::And(parts) | Formula::Or(parts) => parts.iter().for_each(|part| self.of_formula(part, ports)),
            Formula::Always(_, body) | Formula::Eventually(_, body) => self.of_formula(body, ports),
        }
    }

    fn of_condition(&self, condition: &BooleanExpression, ports: &mut BTreeSet<Port>) {
        match condition {
            BooleanExpression::Constant(_) => {}
            BooleanExpression::Signal(port) => {
                ports.insert(*port);
            }
            BooleanExpression::Margin(margin) => of_real(&margin.value, ports),
            BooleanExpression::Same(left, right) => {
                for operand in [left, right] {
                    if let Operand::Signal(port) = operand {
                        ports.insert(*port);
                    }
                }
            }
            BooleanExpression::Rises(slot) => self.of_condition(&self.risen(*slot), ports),
            BooleanExpression::Not(of) => self.of_condition(of, ports),
            BooleanExpression::And(parts) | BooleanExpression::Or(parts) => {
                parts.iter().for_each(|part| self.of_condition(part, ports));
            }
        }
    }
}

fn of_real(value: &RealExpression, ports: &mut BTreeSet<Port>) {
    use RealExpression as E;
    match value {
        E::Constant(_) | E::Time => {}
        E::Signal(port) => {
            ports.insert(*port);
        }
        E::Affine { of, .. } | E::InverseAffine { of, .. } | E::Negate(of) => of_real(of, ports),
        E::Add(left, right) | E::Subtract(left, right) | E::Multiply(left, right) | E::Divide(left, right) => {
            of_real(left, ports);
            of_real(right, ports);
        }
        E::Call(_, arguments) => arguments.iter().for_each(|argument| of_real(argument, ports)),
    }
}
