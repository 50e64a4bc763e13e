//! Where each value lies: by group, instance and variable, inputs and outputs apart.

use super::groups::Group;
use crate::flatten::values::{Ranges, Slot, Values};
use dsl::scenario::{InitialStep, Port, Scenario};
use fmi2::description::{BaseType, Causality, ModelDescription};
use std::collections::{BTreeMap, BTreeSet};

/// An instance as its worker sees it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct InstancePorts {
    /// Inputs and tunable parameters that the script ever drives.
    pub inputs: Ports,
    /// Outputs that anything reads, judges or records.
    pub outputs: Ports,
    /// How many of the Real outputs, counted from the first, must be finite: they are connected or asserted.
    pub finite: usize,
}

/// Variables of one instance, each type one call.
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

/// Variables of one type whose values lie side by side.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VariableRange {
    /// Index of the first value.
    pub start: usize,
    /// The value references.
    pub references: Vec<u32>,
    /// The variables, as indices into the unit's description.
    pub variables: Vec<usize>,
}

/// One variable with the place of its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VariableSlot {
    /// Where the value lies.
    pub slot: Slot,
    /// The value reference.
    pub reference: u32,
}

impl VariableRange {
    /// Where the values lie.
    #[inline]
    #[must_use]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.references.len()
    }
}

/// The places of all ports that a scenario touches.
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
    /// Gives every port its place and tells the groups where theirs lie.
    pub fn assign(scenario: &Scenario, descriptions: &[&ModelDescription], groups: &mut [Group]) -> Self {
        let driven = driven(scenario);
        let must_be_finite = counting(scenario);
        let is_input = |port: &Port| {
            driven.contains(port) || descriptions[port.instance].variables[port.variable].causality == Causality::Input
        };
        let recorded = scenario.columns.iter().map(|column| column.port);
        let (recorded_inputs, recorded_outputs): (Vec<_>, Vec<_>) = recorded.partition(is_input);
        let mut read = must_be_finite.clone();
        read.extend(recorded_outputs);
        read.extend(scenario.initialization.iter().flat_map(initially_read));
        let mut places = Self {
            inputs: BTreeMap::new(),
            outputs: BTreeMap::new(),
            input_values: Values::default(),
            output_values: Values::default(),
            ports: vec![InstancePorts::default(); scenario.instances.len()],
            group_of: vec![0; scenario.instances.len()],
        };
        for (index, group) in groups.iter_mut().enumerate() {
            let begin = places.output_values.end();
            for &instance in &group.instances {
                let outputs = ports_of(instance, &read);
                let (finite, others): (Vec<_>, Vec<_>) = outputs.partition(|port| must_be_finite.contains(port));
                places.group_of[instance] = index;
                places.ports[instance] = places.ports(ports_of(instance, &driven), &finite, &others, descriptions);
            }
            group.outputs = begin.to(&places.output_values.end());
        }
        for port in recorded_inputs {
            // Nobody drives it: its value stands still, outside of what travels.
            if !places.inputs.contains_key(&port) {
                let pick = pick(port, &mut places.input_values, descriptions);
                places.inputs.insert(port, pick);
            }
        }
        places
    }

    fn ports(
        &mut self,
        inputs: impl Iterator<Item = Port>,
        finite: &[Port],
        others: &[Port],
        descriptions: &[&ModelDescription],
    ) -> InstancePorts {
        let mut ports = InstancePorts {
            inputs: Ports::beginning_at(&self.input_values.end()),
            outputs: Ports::beginning_at(&self.output_values.end()),
            finite: 0,
        };
        for port in inputs {
            let pick = pick(port, &mut self.input_values, descriptions);
            ports.inputs.add(pick, port.variable);
            self.inputs.insert(port, pick);
        }
        for port in finite.iter().chain(others) {
            let pick = pick(*port, &mut self.output_values, descriptions);
            ports.outputs.add(pick, port.variable);
            self.outputs.insert(*port, pick);
        }
        ports.finite = finite.iter().filter(|&port| self.outputs[port].slot.base == BaseType::Real).count();
        ports
    }

    /// Where the value of a readable port stands among the outputs.
    pub fn read(&self, port: Port) -> Slot {
        self.pick_output(port).slot
    }

    /// The same with the value reference.
    pub fn pick_output(&self, port: Port) -> VariableSlot {
        *self.outputs.get(&port).unwrap_or_else(|| unreachable!("{port:?} is read but was not placed"))
    }

    /// Where the value of an input stands, with its value reference.
    pub fn pick_input(&self, port: Port) -> VariableSlot {
        *self.inputs.get(&port).unwrap_or_else(|| unreachable!("{port:?} is driven but was not placed"))
    }

    /// Where a recorded port stands among the inputs, if it is one.
    pub fn input(&self, port: Port) -> Option<Slot> {
        self.inputs.get(&port).map(|pick| pick.slot)
    }

    /// All inputs with their places.
    pub fn input_slots(&self) -> impl Iterator<Item = (Port, Slot)> + '_ {
        self.inputs.iter().map(|(&port, pick)| (port, pick.slot))
    }

    /// The group of an instance.
    pub fn group_of(&self, instance: usize) -> usize {
        self.group_of[instance]
    }

    /// Room for all inputs.
    pub fn inputs(&self) -> Values {
        self.input_values.clone()
    }

    /// Room for all outputs.
    pub fn outputs(&self) -> Values {
        self.output_values.clone()
    }

    /// Hands the ports over, once.
    pub fn take_members(&mut self) -> Vec<InstancePorts> {
        std::mem::take(&mut self.ports)
    }
}

impl Ports {
    /// Gives variables of a unit places behind the values that are there; `None` if the unit has no such variable.
    #[must_use]
    pub fn place(variables: &[usize], description: &ModelDescription, values: &mut Values) -> Option<Self> {
        let mut ports = Self::beginning_at(&values.end());
        for &index in variables {
            let variable = description.variables.get(index)?;
            let slot = values.add(variable.base_type());
            ports.add(VariableSlot { slot, reference: variable.value_reference }, index);
        }
        Some(ports)
    }

    /// The values of these ports alone, in their order, whatever lies around them.
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
        let counts = [&self.reals, &self.integers, &self.booleans, &self.texts].map(|span| span.references.len());
        counts == [values.reals.len(), values.integers.len(), values.booleans.len(), values.texts.len()]
    }

    /// Puts what [`Ports::values`] took where these ports lie.
    ///
    /// # Panics
    /// If the values do not fit.
    pub fn store(&self, values: &Values, among: &mut Values) {
        among.reals[self.reals.range()].copy_from_slice(&values.reals);
        among.integers[self.integers.range()].copy_from_slice(&values.integers);
        among.booleans[self.booleans.range()].copy_from_slice(&values.booleans);
        among.texts[self.texts.range()].clone_from_slice(&values.texts);
    }

    fn beginning_at(end: &Ranges) -> Self {
        let span = |start| VariableRange { start, ..VariableRange::default() };
        Self {
            reals: span(end.reals.start),
            integers: span(end.integers.start),
            booleans: span(end.booleans.start),
            texts: span(end.texts.start),
        }
    }

    fn add(&mut self, pick: VariableSlot, variable: usize) {
        let span = match pick.slot.base {
            BaseType::Real => &mut self.reals,
            BaseType::Integer => &mut self.integers,
            BaseType::Boolean => &mut self.booleans,
            BaseType::String => &mut self.texts,
        };
        span.references.push(pick.reference);
        span.variables.push(variable);
    }
}

/// Inputs and tunable parameters that the script ever drives.
fn driven(scenario: &Scenario) -> BTreeSet<Port> {
    let connected = scenario.connections.iter().map(|connection| connection.target);
    let set = scenario.events.iter().flat_map(|event| event.sets().map(|set| set.target));
    connected.chain(set).collect()
}

/// Ports that connections, `set`, conditions or claims read: those whose values must be finite.
fn counting(scenario: &Scenario) -> BTreeSet<Port> {
    let mut ports = BTreeSet::new();
    let (conditions, told) = (&scenario.conditions, &mut |port| {
        ports.insert(port);
    });
    let sets = scenario.events.iter().flat_map(dsl::scenario::Event::sets).map(|set| &set.value);
    let drives = scenario.connections.iter().map(|connection| &connection.source).chain(sets);
    drives.for_each(|drive| drive.reads(conditions, told));
    conditions.iter().for_each(|condition| condition.is.reads(conditions, told));
    scenario.claims.iter().for_each(|claim| claim.formula.reads(conditions, told));
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

fn pick(port: Port, values: &mut Values, descriptions: &[&ModelDescription]) -> VariableSlot {
    let variable = &descriptions[port.instance].variables[port.variable];
    VariableSlot { slot: values.add(variable.base_type()), reference: variable.value_reference }
}
