//! Which inputs have limits that a value may miss during the run: those that their unit's description limits, and that are
//! driven by more than a constant, which was checked before.

use super::slot_table::SlotTable;
use crate::values::{Slot, ValueType, Values};
use dsl::scenario::{Drive, Port, RealExpression, Scenario};
use fmi2::description::{Limits, ModelDescription};
use std::collections::BTreeSet;

/// The limits of one input or tunable parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct InputLimits {
    /// The input.
    pub port: Port,
    /// `instance.variable`
    pub name: String,
    /// The name of its unit of measure, empty if there is none.
    pub unit: String,
    /// What the description allows.
    pub limits: Limits,
    slot: Slot,
}

/// All such inputs.
#[derive(Clone, Debug, Default)]
pub struct LimitChecks {
    /// The inputs, ordered by port.
    pub all: Vec<InputLimits>,
    /// Those of each group, as indices.
    pub of_group: Vec<Vec<usize>>,
}

impl InputLimits {
    /// The value, if the description does not allow it.
    #[must_use]
    pub fn missed(&self, inputs: &Values) -> Option<f64> {
        let value = match self.slot.base {
            ValueType::Real => inputs.reals[self.slot.index],
            ValueType::Integer => f64::from(inputs.integers[self.slot.index]),
            ValueType::Boolean | ValueType::Text => return None,
        };
        (!self.limits.allow(value)).then_some(value)
    }
}

impl LimitChecks {
    pub(super) fn new(
        scenario: &Scenario,
        descriptions: &[&ModelDescription],
        groups: usize,
        table: &SlotTable,
    ) -> Self {
        let mut checks = Self { all: Vec::new(), of_group: vec![Vec::new(); groups] };
        for port in changing(scenario) {
            let description = descriptions[port.instance];
            let variable = &description.variables[port.variable];
            let limits = description.limits_of(variable);
            if limits.is_empty() {
                continue;
            }
            checks.of_group[table.group_of(port.instance)].push(checks.all.len());
            checks.all.push(InputLimits {
                port,
                name: format!("{}.{}", scenario.instances[port.instance].name, variable.name),
                unit: description.unit_of(variable).unwrap_or_default().to_owned(),
                limits,
                slot: table.input_slot(port).slot,
            });
        }
        checks
    }

    /// Those of these ports that are checked, as indices in order.
    pub(super) fn among(&self, ports: impl Iterator<Item = Port>) -> Vec<usize> {
        let index_of = |port| self.all.binary_search_by_key(&port, |input| input.port).ok();
        let mut indices: Vec<_> = ports.filter_map(index_of).collect();
        indices.sort_unstable();
        indices
    }
}

/// The ports whose values are not known before the run.
fn changing(scenario: &Scenario) -> BTreeSet<Port> {
    let connected = scenario.connections.iter().map(|connection| (connection.target, &connection.source));
    let set = scenario.events.iter().flat_map(|event| event.sets().map(|set| (set.target, &set.value)));
    let is_constant = |drive: &Drive| {
        matches!(drive, Drive::Real(RealExpression::Constant(_)) | Drive::Integer(_) | Drive::String(_))
    };
    connected.chain(set).filter(|(_, drive)| !is_constant(drive)).map(|(port, _)| port).collect()
}
