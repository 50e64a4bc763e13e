//! Which value goes where: a scenario flattened to indices, sorted once, before the first step.
//!
//! Instances that step and deliver together form a group. Inputs and outputs of all instances are in one array for each
//! base type, ordered by group, instance and variable, so that a group's values are one range and one call per type sets
//! or reads an instance's values. Next on the walk: `step_loop.rs`.

mod conditions;
mod events;
mod faults;
mod feed;
mod groups;
mod initial;
mod limits;
mod row_layout;
mod slot_table;

pub use conditions::{Conditions, ConditionsMemory};
pub use events::{Change, Events, EventsMemory};
pub use feed::{Computed, CopyRange, Feed};
pub use groups::Group;
pub use initial::InitialCall;
pub use limits::{InputLimits, LimitChecks};
pub use row_layout::RowLayout;
pub use slot_table::{InstancePorts, Ports, VariableRange, VariableSlot};

use crate::claims::Claims;
use crate::expression::Program;
use crate::running::RunningValues;
use crate::values::{Slot, Values, start_value};
use dsl::scenario::{Port, Scenario};
use fmi2::description::ModelDescription;
use slot_table::SlotTable;
use std::collections::BTreeSet;
use std::ops::Range;
use unit::time::seconds;

/// A scenario, ready to step.
#[derive(Debug)]
pub struct Plan {
    /// The communication step in nanoseconds.
    pub step_ns: u64,
    /// The tick at which the run begins.
    pub start_tick: u64,
    /// The tick at which the run ends.
    pub stop_tick: u64,
    /// The instances in the script's order.
    pub ports: Vec<InstancePorts>,
    /// The names of the instances and their outputs in messages.
    pub names: Vec<Names>,
    /// Instances that step and deliver together, by wave.
    pub groups: Vec<Group>,
    /// The waves of a tick.
    pub waves: Vec<Wave>,
    /// For each group, what its `->` connections bring, computed from the visible outputs.
    pub delayed: Vec<Feed>,
    /// For each group, what its `=>` connections bring, computed from the latest results.
    pub direct: Vec<Feed>,
    /// The windows of `at`, `when` and `while`.
    pub events: Events,
    /// The slot of the condition that ends the run.
    pub stop_when: Option<usize>,
    /// The inputs whose values can miss the limits that their units declare.
    pub limits: LimitChecks,
    /// The calls of initialization, in their order.
    pub initialization: Vec<InitialCall>,
    /// What is followed from sample to sample.
    pub conditions: Conditions,
    /// What several connections, conditions and claims use.
    pub shared: Vec<Program>,
    /// Those of them that sum up samples.
    pub running: RunningValues,
    /// For each wave, those of them that its `=>` connections use.
    pub shared_of_wave: Vec<Vec<usize>>,
    /// The claims.
    pub claims: Claims,
    /// Where the values of a row come from.
    pub row: RowLayout,
    /// The inputs before initialization: presets and declared start values.
    pub inputs: Values,
    /// The outputs before the first read: zero, false or empty.
    pub outputs: Values,
    table: SlotTable,
}

/// Groups that step in parallel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wave {
    /// The groups.
    pub groups: Range<usize>,
    /// Whether a `=>`, a `set` or a fault ever acts on an input of one of them.
    pub is_fed: bool,
    /// Whether a `=>` ever reads an output of one of them in the tick in which its step is ordered.
    pub is_read: bool,
    /// Whether an input of one of them has limits.
    pub is_limited: bool,
}

/// The names of an instance and its outputs in messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// Its name in the script.
    pub instance: String,
    /// The names of its Real outputs, in the order of [`InstancePorts::outputs`].
    pub reals: Vec<String>,
    /// Those of its Integer, Boolean and String outputs.
    pub others: [Vec<String>; 3],
}

impl Plan {
    /// Flattens a scenario. For each instance, `descriptions` holds its unit's description and `worker_of` the index of
    /// the worker that holds it.
    #[must_use]
    pub fn new(scenario: &Scenario, descriptions: &[&ModelDescription], worker_of: &[usize]) -> Self {
        let (mut groups, waves) = groups::form(scenario, worker_of);
        let mut table = SlotTable::assign(scenario, descriptions, &mut groups);
        let inputs = first_inputs(scenario, descriptions, &table);
        let [delayed, direct]: [Vec<Feed>; 2] = [false, true].map(|direct| {
            let mut by_group = vec![Vec::new(); groups.len()];
            for connection in scenario.connections.iter().filter(|connection| connection.direct == direct) {
                by_group[table.group_of(connection.target.instance)].push(connection);
            }
            by_group.iter().map(|connections| Feed::new(connections, &table)).collect()
        });
        let events = Events::new(scenario, descriptions, &groups, &table);
        let limits = LimitChecks::new(scenario, descriptions, groups.len(), &table);
        let wave = |range: Range<usize>| Wave {
            is_fed: range.clone().any(|group| !direct[group].is_empty() || events.act_on(group)),
            is_read: groups[range.clone()].iter().any(|group| !group.read_every.is_empty()),
            is_limited: limits.of_group[range.clone()].iter().any(|checks| !checks.is_empty()),
            groups: range,
        };
        let waves: Vec<_> = waves.into_iter().map(wave).collect();
        let shared = scenario.shared.iter();
        let shared: Vec<_> = shared.map(|value| Program::compile_real(value, &mut |port| table.read(port))).collect();
        let shared_of_wave = waves.iter().map(|wave| used(&shared, &direct[wave.groups.clone()])).collect();
        let initialization = initial::calls(scenario, descriptions, (&table, &limits), &shared, worker_of);
        let ports = table.take_ports();
        let conditions = Conditions::new(&scenario.conditions, &mut |port| table.read(port));
        Self {
            step_ns: scenario.step_ns,
            start_tick: scenario.start_tick,
            stop_tick: scenario.stop_tick,
            claims: Claims::new(&scenario.claims, scenario.stop_tick, &mut |port| table.read(port)),
            row: RowLayout::new(&scenario.columns, &table),
            outputs: table.outputs(),
            names: names(scenario, descriptions, &ports),
            ports,
            groups,
            waves,
            delayed,
            direct,
            events,
            stop_when: scenario.stop_when.as_ref().map(|stop| stop.condition),
            limits,
            initialization,
            running: RunningValues::new(&scenario.shared),
            conditions,
            shared,
            shared_of_wave,
            inputs,
            table,
        }
    }

    /// Seconds at a tick: one product and one quotient, never a sum.
    #[must_use]
    #[inline]
    pub fn seconds(&self, tick: u64) -> f64 {
        seconds(tick, self.step_ns)
    }

    /// The slot of a readable port among the outputs.
    #[must_use]
    pub fn place(&self, port: Port) -> Slot {
        self.table.read(port)
    }
}

/// The inputs before anything drives them: what the script gives them, else the start value of their description.
fn first_inputs(scenario: &Scenario, descriptions: &[&ModelDescription], table: &SlotTable) -> Values {
    let mut inputs = table.inputs();
    for (port, slot) in table.input_slots() {
        inputs.store(slot, &start_value(&descriptions[port.instance].variables[port.variable]));
    }
    for (instance, of) in scenario.instances.iter().enumerate() {
        for preset in &of.presets {
            if let Some(slot) = table.input(Port { instance, variable: preset.variable }) {
                inputs.store(slot, &preset.value);
            }
        }
    }
    inputs
}

/// The shared expressions that these feeds use, by way of others too, in their order.
fn used(shared: &[Program], feeds: &[Feed]) -> Vec<usize> {
    let mut open: Vec<_> = feeds.iter().flat_map(Feed::programs).flat_map(Program::shared).collect();
    let mut used = BTreeSet::new();
    while let Some(slot) = open.pop() {
        if used.insert(slot) {
            open.extend(shared[slot].shared());
        }
    }
    used.into_iter().collect()
}

fn names(scenario: &Scenario, descriptions: &[&ModelDescription], ports: &[InstancePorts]) -> Vec<Names> {
    let names_of =
        |((instance, description), ports): ((&dsl::scenario::Instance, &&ModelDescription), &InstancePorts)| {
            let names = |range: &VariableRange| -> Vec<_> {
                range.variables.iter().map(|&variable| description.variables[variable].name.clone()).collect()
            };
            let Ports { reals, integers, booleans, texts } = &ports.outputs;
            let (reals, others) = (names(reals), [integers, booleans, texts].map(names));
            Names { instance: instance.name.clone(), reals, others }
        };
    scenario.instances.iter().zip(descriptions).zip(ports).map(names_of).collect()
}
