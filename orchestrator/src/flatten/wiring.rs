//! Who feeds whom: a scenario flattened to indices, sorted once, before the first step.
//!
//! Instances that step and deliver together form a group. Inputs and outputs of all instances lie in one array for each
//! base type, ordered by group, instance and variable, so that a group's values are one range and an instance's values
//! one call. Next on the walk: `step_loop.rs`.

mod events;
mod feed;
mod groups;
mod row_layout;
mod slot_table;

pub use events::{Change, Effect, Override};
pub use feed::{Computed, CopyRange, Feed};
pub use groups::Group;
pub use row_layout::RowLayout;
pub use slot_table::{InstancePorts, Ports, VariableRange, VariableSlot};

use crate::flatten::expression::Program;
use crate::flatten::values::{Slot, Values, start_value};
use dsl::scenario::{InitialStep, Port, Scenario};
use fmi2::description::ModelDescription;
use slot_table::SlotTable;
use std::ops::Range;
use unit::time::seconds;

/// A scenario, ready to step.
#[derive(Debug)]
pub struct Wiring {
    /// The communication step in nanoseconds.
    pub step_ns: u64,
    /// The tick at which the run ends.
    pub stop_tick: u64,
    /// The instances in the script's order.
    pub ports: Vec<InstancePorts>,
    /// What messages call the instances and their Real outputs.
    pub names: Vec<Names>,
    /// Instances that step and deliver together, by wave.
    pub groups: Vec<Group>,
    /// The waves of a tick.
    pub waves: Vec<Wave>,
    /// What `->` brings, for each group, from what is visible.
    pub delayed: Vec<Feed>,
    /// What `=>` brings, for each group, from the latest results.
    pub direct: Vec<Feed>,
    /// What `set` can override, for each group.
    pub overrides: Vec<Vec<Override>>,
    /// Openings and closings of windows by tick.
    pub changes: Vec<Change>,
    /// How initialization carries values.
    pub initialization: Vec<InitialCall>,
    /// The conditions of `rises`.
    pub rises: Vec<Program>,
    /// What a row is made of.
    pub row: RowLayout,
    /// The inputs before the first step: presets and declared start values.
    pub inputs: Values,
    /// Outputs that nobody has read yet.
    pub outputs: Values,
    places: SlotTable,
}

/// Groups that step beside each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wave {
    /// The groups.
    pub groups: Range<usize>,
    /// Whether a `=>` or a `set` ever brings anything to one of them.
    pub is_fed: bool,
    /// Whether a `=>` ever reads one of them in the tick of the order.
    pub is_read: bool,
}

/// What messages call an instance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    /// Its name in the script.
    pub instance: String,
    /// The names of its Real outputs, in the order of [`InstancePorts::outputs`].
    pub reals: Vec<String>,
}

/// One turn of initialization.
#[derive(Debug)]
pub enum InitialCall {
    /// Computes these inputs of one instance and sets them.
    Set {
        /// The worker that holds the instance.
        worker: usize,
        /// The instance.
        instance: usize,
        /// What brings them.
        feed: Feed,
        /// The inputs.
        picks: Vec<VariableSlot>,
    },
    /// Reads these variables of one instance.
    Get {
        /// The worker that holds the instance.
        worker: usize,
        /// The instance.
        instance: usize,
        /// The variables.
        picks: Vec<VariableSlot>,
    },
}

impl Wiring {
    /// Flattens a scenario. `descriptions` and `worker_of` tell for each instance its unit's description and the index
    /// of the worker that holds it.
    #[must_use]
    pub fn new(scenario: &Scenario, descriptions: &[&ModelDescription], worker_of: &[usize]) -> Self {
        let (mut groups, waves) = groups::form(scenario, worker_of);
        let mut places = SlotTable::assign(scenario, descriptions, &mut groups);
        let mut inputs = places.inputs();
        for (port, slot) in places.input_slots() {
            let variable = &descriptions[port.instance].variables[port.variable];
            let presets = &scenario.instances[port.instance].presets;
            let preset = presets.iter().rev().find(|preset| preset.variable == port.variable);
            inputs.store(slot, preset.map_or(&start_value(variable), |preset| &preset.value));
        }
        let [delayed, direct]: [Vec<Feed>; 2] = [false, true].map(|direct| {
            let mut arrows = vec![Vec::new(); groups.len()];
            for arrow in scenario.connections.iter().filter(|arrow| arrow.direct == direct) {
                arrows[places.group_of(arrow.target.instance)].push(arrow);
            }
            arrows.iter().map(|arrows| Feed::new(arrows, &places)).collect()
        });
        let (overrides, changes) = events::plan(scenario, &groups, &places, &inputs);
        let wave = |range: Range<usize>| Wave {
            is_fed: range.clone().any(|group| !direct[group].is_empty() || !overrides[group].is_empty()),
            is_read: groups[range.clone()].iter().any(|group| !group.read_every.is_empty()),
            groups: range,
        };
        let waves = waves.into_iter().map(wave).collect();
        let initialization =
            scenario.initialization.iter().map(|step| turn(step, scenario, &places, worker_of)).collect();
        let ports = places.take_members();
        let rises = scenario.conditions.iter();
        let rises =
            rises.map(|condition| Program::compile_condition(&condition.is, &mut |port| places.read(port))).collect();
        Self {
            step_ns: scenario.step_ns,
            stop_tick: scenario.stop_tick,
            row: RowLayout::new(&scenario.columns, &places),
            outputs: places.outputs(),
            names: names(scenario, descriptions, &ports),
            ports,
            groups,
            waves,
            delayed,
            direct,
            overrides,
            changes,
            initialization,
            rises,
            inputs,
            places,
        }
    }

    /// Seconds at a tick: one product and one quotient, never a sum.
    #[must_use]
    pub fn seconds(&self, tick: u64) -> f64 {
        seconds(tick, self.step_ns)
    }

    /// Where the value of a readable port stands among the outputs.
    #[must_use]
    pub fn place(&self, port: Port) -> Slot {
        self.places.read(port)
    }
}

fn turn(step: &InitialStep, scenario: &Scenario, places: &SlotTable, worker_of: &[usize]) -> InitialCall {
    match step {
        InitialStep::Set { instance, connections } => {
            let connections: Vec<_> = connections.iter().map(|&index| &scenario.connections[index]).collect();
            let picks = connections.iter().map(|arrow| places.pick_input(arrow.target)).collect();
            let feed = Feed::new(&connections, places);
            InitialCall::Set { worker: worker_of[*instance], instance: *instance, feed, picks }
        }
        InitialStep::Get { instance, variables } => {
            let port = |&variable| Port { instance: *instance, variable };
            let picks = variables.iter().map(|variable| places.pick_output(port(variable))).collect();
            InitialCall::Get { worker: worker_of[*instance], instance: *instance, picks }
        }
    }
}

fn names(scenario: &Scenario, descriptions: &[&ModelDescription], ports: &[InstancePorts]) -> Vec<Names> {
    let of = |((instance, description), ports): ((&dsl::scenario::Instance, &&ModelDescription), &InstancePorts)| {
        let name = |&variable: &usize| description.variables[variable].name.clone();
        Names { instance: instance.name.clone(), reals: ports.outputs.reals.variables.iter().map(name).collect() }
    };
    scenario.instances.iter().zip(descriptions).zip(ports).map(of).collect()
}
