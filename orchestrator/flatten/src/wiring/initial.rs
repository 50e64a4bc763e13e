//! The calls of initialization.

use super::feed::Feed;
use super::limits::LimitChecks;
use super::slot_table::{SlotTable, VariableSlot};
use super::used;
use crate::expression::Program;
use dsl::scenario::{InitialStep, Port, Scenario, Value};
use fmi2::description::{Causality, ModelDescription};
use std::collections::{BTreeMap, BTreeSet};

/// One call of initialization.
#[derive(Debug)]
pub enum InitialCall {
    /// Computes these inputs of one instance and sets them.
    Set {
        /// The worker that holds the instance.
        worker: usize,
        /// The instance.
        instance: usize,
        /// The connections that drive them.
        feed: Feed,
        /// The shared expressions that they use.
        shared: Vec<usize>,
        /// The inputs.
        slots: Vec<VariableSlot>,
        /// Those of them that have limits, as indices into [`LimitChecks::all`].
        limited: Vec<usize>,
    },
    /// Reads these variables of one instance.
    Get {
        /// The worker that holds the instance.
        worker: usize,
        /// The instance.
        instance: usize,
        /// The variables.
        slots: Vec<VariableSlot>,
    },
    /// Reads what nothing sets at the start into the inputs of one instance: that is recorded, and a `set` returns to it.
    GetInputs {
        /// The worker that holds the instance.
        worker: usize,
        /// The instance.
        instance: usize,
        /// The variables.
        slots: Vec<VariableSlot>,
    },
}

/// The calls of initialization in their order: those that carry values along connections, then those that read inputs.
pub(super) fn calls(
    scenario: &Scenario,
    descriptions: &[&ModelDescription],
    (table, limits): (&SlotTable, &LimitChecks),
    shared: &[Program],
    worker_of: &[usize],
) -> Vec<InitialCall> {
    let along_connections = scenario.initialization.iter();
    let along_connections =
        along_connections.map(|step| initial_call(step, scenario, (table, limits), shared, worker_of));
    let mut unknown: BTreeMap<usize, Vec<VariableSlot>> = BTreeMap::new();
    for port in unknown_inputs(scenario, descriptions, table) {
        unknown.entry(port.instance).or_default().push(table.input_slot(port));
    }
    let unknown = unknown.into_iter();
    let reads =
        unknown.map(|(instance, slots)| InitialCall::GetInputs { worker: worker_of[instance], instance, slots });
    along_connections.chain(reads).collect()
}

/// The ports among the inputs whose value after initialization only the unit knows: no connection drives them, and they are
/// parameters, whose declared start values are not set, inputs without a start value, or paths of files.
fn unknown_inputs(scenario: &Scenario, descriptions: &[&ModelDescription], table: &SlotTable) -> Vec<Port> {
    let connected: BTreeSet<Port> = scenario.connections.iter().map(|connection| connection.target).collect();
    let is_unknown = |port: &Port| {
        let variable = &descriptions[port.instance].variables[port.variable];
        let presets = &scenario.instances[port.instance].presets;
        let preset = presets.iter().rev().find(|preset| preset.variable == port.variable);
        let is_given = match preset {
            Some(preset) => !matches!(preset.value, Value::File(_)),
            None => variable.has_start(),
        };
        !(connected.contains(port) || is_given && variable.causality == Causality::Input)
    };
    table.input_slots().map(|(port, _)| port).filter(is_unknown).collect()
}

fn initial_call(
    step: &InitialStep,
    scenario: &Scenario,
    (table, limits): (&SlotTable, &LimitChecks),
    shared: &[Program],
    worker_of: &[usize],
) -> InitialCall {
    match step {
        InitialStep::Set { instance, connections } => {
            let connections: Vec<_> = connections.iter().map(|&index| &scenario.connections[index]).collect();
            let slots: Vec<_> = connections.iter().map(|connection| table.input_slot(connection.target)).collect();
            let limited = limits.among(connections.iter().map(|connection| connection.target));
            let feed = Feed::new(&connections, table);
            let shared = used(shared, std::slice::from_ref(&feed));
            InitialCall::Set { worker: worker_of[*instance], instance: *instance, feed, shared, slots, limited }
        }
        InitialStep::Get { instance, variables } => {
            let port = |&variable| Port { instance: *instance, variable };
            let slots = variables.iter().map(|variable| table.output_slot(port(variable))).collect();
            InitialCall::Get { worker: worker_of[*instance], instance: *instance, slots }
        }
    }
}
