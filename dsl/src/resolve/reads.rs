//! Which ports drivers and claims read, before all conditions of `rises` are known and values are shared.

use std::collections::BTreeSet;

use super::scope::Scope;
use super::wire::Wired;
use crate::scenario::{Drive, Formula, Port, Slots};

impl Scope<'_, '_> {
    /// All ports that connections read.
    pub fn sources(&self, connections: &[Wired]) -> BTreeSet<Port> {
        connections.iter().flat_map(|wired| self.read_by(&wired.connection.source)).collect()
    }

    /// The ports that a driver reads.
    pub fn read_by(&self, drive: &Drive) -> BTreeSet<Port> {
        let mut ports = BTreeSet::new();
        drive.reads(Slots { conditions: &self.conditions.borrow().by_slot, shared: &[] }, &mut |port| {
            ports.insert(port);
        });
        ports
    }

    /// Adds the ports that a claim reads.
    pub fn of_formula(&self, formula: &Formula, ports: &mut BTreeSet<Port>) {
        formula.reads(Slots { conditions: &self.conditions.borrow().by_slot, shared: &[] }, &mut |port| {
            ports.insert(port);
        });
    }
}
