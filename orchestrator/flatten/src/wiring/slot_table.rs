//! The slot of each value: ordered by group, instance and variable, inputs and outputs in separate arrays.

use super::groups::Group;
use crate::values::{Ranges, Slot, ValueType, Values};
use dsl::scenario::{Column, InitialStep, Port, Scenario};
use fmi2::description::{Causality, ModelDescription};
use std::collections::{BTreeMap, BTreeSet};

/// The ports of an instance that its worker sets and reads.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InstancePorts {
    /// Inputs and tunable parameters that a connection or a `set` drives.
    pub inputs: Ports,
    /// Outputs that connections or claims read, or that are recorded.
    pub outputs: Ports,
    /// The first so many Real outputs must be finite, since a connection, a condition or a claim reads them.
    pub finite: usize,
}

/// Variables of one instance, by type: one FMI call sets or reads all of a type.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ports {
    /// The Reals.
    pub reals: VariableRange,
    /// The Integers and Enumerations.
    pub integers: VariableRange,
    /// The Booleans.
    pub booleans: VariableRange,
    /// The Strings.
    pub texts: VariableRange,
}

/// Variables of one type whose values are contiguous.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VariableRange {
    /// Index of the first value.
    pub start: usize,
    /// The variables, as indices into the unit's description.
    pub variables: Vec<usize>,
}

/// One variable with the slot of its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VariableSlot {
    /// The slot.
    pub slot: Slot,
    /// The variable, as an index into the unit's description.
    pub variable: usize,
}

impl VariableRange {
    /// The range of the values.
    #[inline]
    #[must_use]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.variables.len()
    }
}

/// The slots of all ports that a scenario drives, reads or records.
#[derive(Debug)]
pub(super) struct SlotTable {
    inputs: BTreeMap<Port, VariableSlot>,
    outputs: BTreeMap<Port, VariableSlot>,
    input_values: Values,
    output_values: Values,
    ports: Vec<InstancePorts>,
    group_of: Vec<usize>,
}

impl SlotTable {
    /// Assigns a slot to every port and stores the ranges of the outputs in the groups.
    pub fn assign(scenario: &Scenario, descriptions: &[&ModelDescription], groups: &mut [Group]) -> Self {
        let driven = driven(scenario);
        let must_be_finite = finite_ports(scenario);
        let is_input = |port: &Port| {
            driven.contains(port) || descriptions[port.instance].variables[port.variable].causality == Causality::Input
        };
        let recorded = scenario.columns.iter().filter_map(Column::port);
        let (recorded_inputs, recorded_outputs): (Vec<_>, Vec<_>) = recorded.partition(is_input);
        let mut read = must_be_finite.clone();
        read.extend(recorded_outputs);
        scenario.columns.iter().for_each(|column| column.reads(scenario.slots(), &mut |port| _ = read.insert(port)));
        read.extend(scenario.initialization.iter().flat_map(initially_read));
        let mut table = Self {
            inputs: BTreeMap::new(),
            outputs: BTreeMap::new(),
            input_values: Values::default(),
            output_values: Values::default(),
            ports: vec![InstancePorts::default(); scenario.instances.len()],
            group_of: vec![0; scenario.instances.len()],
        };
        for (index, group) in groups.iter_mut().enumerate() {
            let begin = table.output_values.end();
            for &instance in &group.instances {
                let outputs = ports_of(instance, &read);
                let (finite, others): (Vec<_>, Vec<_>) = outputs.partition(|port| must_be_finite.contains(port));
                table.group_of[instance] = index;
                table.ports[instance] = table.ports(ports_of(instance, &driven), &finite, &others, descriptions);
            }
            group.outputs = begin.to(&table.output_values.end());
        }
        for port in recorded_inputs {
            // No connection or `set` drives it: its value stays constant and is not part of what is sent to workers.
            if !table.inputs.contains_key(&port) {
                let slot = add_slot(port, &mut table.input_values, descriptions);
                table.inputs.insert(port, slot);
            }
        }
        table
    }

    fn ports(
        &mut self,
        inputs: impl Iterator<Item = Port>,
        finite: &[Port],
        others: &[Port],
        descriptions: &[&ModelDescription],
    ) -> InstancePorts {
        let mut ports = InstancePorts {
            inputs: Ports::starting_at(&self.input_values.end()),
            outputs: Ports::starting_at(&self.output_values.end()),
            finite: 0,
        };
        for port in inputs {
            let slot = add_slot(port, &mut self.input_values, descriptions);
            ports.inputs.add(slot);
            self.inputs.insert(port, slot);
        }
        for port in finite.iter().chain(others) {
            let slot = add_slot(*port, &mut self.output_values, descriptions);
            ports.outputs.add(slot);
            self.outputs.insert(*port, slot);
        }
        ports.finite = finite.iter().filter(|&port| self.outputs[port].slot.base == ValueType::Real).count();
        ports
    }

    /// The slot of a readable port among the outputs.
    pub fn read(&self, port: Port) -> Slot {
        self.output_slot(port).slot
    }

    /// The same with the value reference.
    pub fn output_slot(&self, port: Port) -> VariableSlot {
        *self.outputs.get(&port).unwrap_or_else(|| unreachable!("{port:?} is read but was not placed"))
    }

    /// The slot of an input, with its value reference.
    pub fn input_slot(&self, port: Port) -> VariableSlot {
        *self.inputs.get(&port).unwrap_or_else(|| unreachable!("{port:?} is driven but was not placed"))
    }

    /// The slot of a recorded port among the inputs, if it is an input.
    pub fn input(&self, port: Port) -> Option<Slot> {
        self.inputs.get(&port).map(|slot| slot.slot)
    }

    /// All inputs with their slots.
    pub fn input_slots(&self) -> impl Iterator<Item = (Port, Slot)> + '_ {
        self.inputs.iter().map(|(&port, slot)| (port, slot.slot))
    }

    /// The group of an instance.
    pub fn group_of(&self, instance: usize) -> usize {
        self.group_of[instance]
    }

    /// Zeroed values for all inputs.
    pub fn inputs(&self) -> Values {
        self.input_values.clone()
    }

    /// Zeroed values for all outputs.
    pub fn outputs(&self) -> Values {
        self.output_values.clone()
    }

    /// Moves the ports out; the table is left without them.
    pub fn take_ports(&mut self) -> Vec<InstancePorts> {
        std::mem::take(&mut self.ports)
    }
}

impl Ports {
    /// Appends slots for variables of a unit to these values; `None` if the unit has no such variable.
    #[must_use]
    pub fn place(variables: &[usize], description: &ModelDescription, values: &mut Values) -> Option<Self> {
        let mut ports = Self::starting_at(&values.end());
        for &index in variables {
            let variable = description.variables.get(index)?;
            let slot = values.add(ValueType::of(variable));
            ports.add(VariableSlot { slot, variable: index });
        }
        Some(ports)
    }

    /// Copies the values of these ports, in their order, out of the values of all ports.
    #[must_use]
    pub fn values(&self, among: &Values) -> Values {
        Values {
            reals: among.reals[self.reals.range()].to_vec(),
            integers: among.integers[self.integers.range()].to_vec(),
            booleans: among.booleans[self.booleans.range()].to_vec(),
            texts: among.texts[self.texts.range()].to_vec(),
        }
    }

    /// Whether there is one value for each of these ports.
    #[must_use]
    pub fn fit(&self, values: &Values) -> bool {
        let counts = [&self.reals, &self.integers, &self.booleans, &self.texts].map(|range| range.variables.len());
        counts == [values.reals.len(), values.integers.len(), values.booleans.len(), values.texts.len()]
    }

    /// Copies what [`Ports::values`] returned back to the slots of these ports.
    ///
    /// # Panics
    /// If the values do not fit.
    pub fn store(&self, values: &Values, among: &mut Values) {
        among.reals[self.reals.range()].copy_from_slice(&values.reals);
        among.integers[self.integers.range()].copy_from_slice(&values.integers);
        among.booleans[self.booleans.range()].copy_from_slice(&values.booleans);
        among.texts[self.texts.range()].clone_from_slice(&values.texts);
    }

    fn starting_at(end: &Ranges) -> Self {
        let range = |start| VariableRange { start, ..VariableRange::default() };
        Self {
            reals: range(end.reals.start),
            integers: range(end.integers.start),
            booleans: range(end.booleans.start),
            texts: range(end.texts.start),
        }
    }

    fn add(&mut self, slot: VariableSlot) {
        let range = match slot.slot.base {
            ValueType::Real => &mut self.reals,
            ValueType::Integer => &mut self.integers,
            ValueType::Boolean => &mut self.booleans,
            ValueType::Text => &mut self.texts,
        };
        range.variables.push(slot.variable);
    }
}

/// Inputs and tunable parameters that a connection or a `set` drives.
fn driven(scenario: &Scenario) -> BTreeSet<Port> {
    let connected = scenario.connections.iter().map(|connection| connection.target);
    let set = scenario.events.iter().flat_map(|event| event.sets().map(|set| set.target));
    connected.chain(set).collect()
}

/// Ports that connections, events, conditions or claims read: those whose values must be finite.
fn finite_ports(scenario: &Scenario) -> BTreeSet<Port> {
    let mut ports = BTreeSet::new();
    let (slots, visit) = (scenario.slots(), &mut |port| {
        ports.insert(port);
    });
    scenario.connections.iter().for_each(|connection| connection.source.reads(slots, visit));
    scenario.events.iter().for_each(|event| event.reads(slots, visit));
    slots.conditions.iter().for_each(|condition| condition.is.reads(slots, visit));
    scenario.claims.iter().for_each(|claim| claim.formula.reads(slots, visit));
    ports
}

fn initially_read(step: &InitialStep) -> Vec<Port> {
    match step {
        InitialStep::Set { .. } => Vec::new(),
        InitialStep::Get { instance, variables } => {
            variables.iter().map(|&variable| Port { instance: *instance, variable }).collect()
        }
    }
}

fn ports_of(instance: usize, ports: &BTreeSet<Port>) -> impl Iterator<Item = Port> + '_ {
    let first = Port { instance, variable: 0 };
    let last = Port { instance, variable: usize::MAX };
    ports.range(first..=last).copied()
}

fn add_slot(port: Port, values: &mut Values, descriptions: &[&ModelDescription]) -> VariableSlot {
    let variable = &descriptions[port.instance].variables[port.variable];
    VariableSlot { slot: values.add(ValueType::of(variable)), variable: port.variable }
}
