//! What is recorded, in which order.

use std::collections::BTreeSet;

use fmi2::description::BaseType;

use super::scope::Scope;
use super::signal::Signal;
use super::wire::Wired;
use crate::diagnostic::Diagnostic;
use crate::scenario::{Claim, Column, Port};
use crate::syntax::Path;

impl Scope<'_, '_> {
    /// The columns of `record`, each port once, in the script's order. Without `record`: every port at either end of a
    /// connection or in a claim, in order of instances and their variables.
    pub fn columns(&self, connections: &[Wired], claims: &[Claim]) -> Vec<Column> {
        let mut seen = BTreeSet::new();
        let ports: Vec<Port> = if self.script.has_record {
            let recorded = self.script.records.iter().flat_map(|path| self.at(path.frame).recorded(path.part));
            recorded.filter(|port| seen.insert(*port)).collect()
        } else {
            let mut all = self.sources(connections);
            all.extend(connections.iter().map(|wired| wired.connection.target));
            claims.iter().for_each(|claim| self.of_formula(&claim.formula, &mut all));
            all.into_iter().filter(|port| self.variable(*port).base_type() != BaseType::String).collect()
        };
        let name = |port: Port| {
            let instance = &self.script.instances[port.instance].name;
            format!("{instance}.{}", self.variable(port).name)
        };
        ports.into_iter().map(|port| Column { name: name(port), port }).collect()
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
        match self.look_up(&path.root.text).map(|found| found.part) {
            Some(Declaration::Let(_) | Declaration::Parameter(_)) => {
                let message = format!("`{}` is a name of the script, and `record` takes ports", path.root.text);
                self.refuse(
                    Diagnostic::error("E21", path.span, message).help("record the ports that it is computed from"),
                )
            }
            _ => self.signal(path),
        }
    }
}
