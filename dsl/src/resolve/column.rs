//! What is recorded, in which order, and which ports an expression reads.

use std::collections::BTreeSet;

use fmi2::description::BaseType;

use super::scope::Scope;
use super::signal::Signal;
use super::wave::sources;
use super::wire::Wired;
use crate::diagnostic::Diagnostic;
use crate::scenario::{BooleanExpression, Claim, Column, Formula, Operand, Port, RealExpression};
use crate::syntax::Path;

impl Scope<'_> {
    /// The columns of `record`, each port once, in the script's order. Without `record`: every port at either end of a
    /// connection or in a claim, in order of instances and their variables.
    pub fn columns(&self, connections: &[Wired], claims: &[Claim]) -> Vec<Column> {
        let mut seen = BTreeSet::new();
        let ports: Vec<Port> = if self.script.has_record {
            let recorded = self.script.records.iter().flat_map(|path| self.recorded(path));
            recorded.filter(|port| seen.insert(*port)).collect()
        } else {
            let mut all = sources(connections);
            all.extend(connections.iter().map(|wired| wired.connection.target));
            for claim in claims {
                all.extend(self.formula_ports(&claim.formula));
            }
            all.into_iter().filter(|port| self.variable(*port).base_type() != BaseType::String).collect()
        };
        ports.into_iter().map(|port| Column { name: self.port_name(port), port }).collect()
    }

    fn recorded(&self, path: &Path) -> Vec<Port> {
        let Some(signal) = self.signal_to_record(path) else { return Vec::new() };
        let ports = signal.ports();
        match ports.iter().find(|port| self.variable(**port).base_type() == BaseType::String) {
            Some(text) => {
                let message = format!("`{}` is a String, and a trace holds numbers", self.port_name(*text));
                self.report(Diagnostic::error("E21", path.span, message).help("record the other members by name"));
                Vec::new()
            }
            None => ports,
        }
    }

    fn signal_to_record(&self, path: &Path) -> Option<Signal> {
        use super::script::Declaration;
        match self.script.names.get(path.root.text.as_str()) {
            Some(Declaration::Let(_) | Declaration::Parameter(_)) => {
                let message = format!("`{}` is a name of the script, and `record` takes ports", path.root.text);
                self.refuse(
                    Diagnostic::error("E21", path.span, message).help("record the ports that it is computed from"),
                )
            }
            _ => self.signal(path),
        }
    }

    fn formula_ports(&self, formula: &Formula) -> Vec<Port> {
        let mut ports = Vec::new();
        match formula {
            Formula::Margin(margin) => margin.value.collect_ports(&mut ports),
            Formula::Condition(condition) => condition.collect_ports(&mut ports),
            Formula::And(parts) | Formula::Or(parts) => {
                ports.extend(parts.iter().flat_map(|part| self.formula_ports(part)));
            }
            Formula::Always(_, body) | Formula::Eventually(_, body) => ports = self.formula_ports(body),
        }
        ports
    }
}

impl RealExpression {
    /// Adds the ports that are read.
    pub(super) fn collect_ports(&self, ports: &mut Vec<Port>) {
        match self {
            Self::Constant(_) | Self::Time => {}
            Self::Signal(port) => ports.push(*port),
            Self::Affine { of, .. } | Self::InverseAffine { of, .. } | Self::Negate(of) => of.collect_ports(ports),
            Self::Add(left, right)
            | Self::Subtract(left, right)
            | Self::Multiply(left, right)
            | Self::Divide(left, right) => {
                left.collect_ports(ports);
                right.collect_ports(ports);
            }
            Self::Call(_, arguments) => arguments.iter().for_each(|argument| argument.collect_ports(ports)),
        }
    }
}

impl BooleanExpression {
    /// Adds the ports that are read; those of `rises` belong to its slot.
    pub(super) fn collect_ports(&self, ports: &mut Vec<Port>) {
        match self {
            Self::Constant(_) | Self::Rises(_) => {}
            Self::Signal(port) => ports.push(*port),
            Self::Margin(margin) => margin.value.collect_ports(ports),
            Self::Same(left, right) => {
                for operand in [left, right] {
                    if let Operand::Signal(port) = operand {
                        ports.push(*port);
                    }
                }
            }
            Self::Not(of) => of.collect_ports(ports),
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.collect_ports(ports)),
        }
    }
}
