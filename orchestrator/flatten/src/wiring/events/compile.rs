//! Compiles the events of a script.

use super::{Effect, Events, Override, Window};
use crate::wiring::faults::{Context, FaultyInput};
use crate::wiring::feed::Computed;
use crate::wiring::groups::Group;
use crate::wiring::slot_table::SlotTable;
use dsl::random::Draws;
use dsl::scenario::{Action, Event, Fault, Port, Scenario, Set, Stage, Trigger};
use fmi2::description::ModelDescription;
use std::collections::BTreeMap;

/// Compiles events one by one.
pub(super) struct Compiler<'a> {
    scenario: &'a Scenario,
    descriptions: &'a [&'a ModelDescription],
    table: &'a SlotTable,
    pub events: Events,
    overridden: BTreeMap<Port, usize>,
    faulty: BTreeMap<Port, usize>,
    touched: BTreeMap<Port, usize>,
    /// How many faults name each port first, which numbers them.
    ordinals: BTreeMap<Port, u64>,
}

impl<'a> Compiler<'a> {
    pub fn new(
        scenario: &'a Scenario,
        descriptions: &'a [&'a ModelDescription],
        groups: &[Group],
        table: &'a SlotTable,
    ) -> Self {
        let events = Events { of_group: vec![[Vec::new(), Vec::new()]; groups.len()], ..Events::default() };
        let (overridden, faulty) = (BTreeMap::new(), BTreeMap::new());
        let (touched, ordinals) = (BTreeMap::new(), BTreeMap::new());
        Self { scenario, descriptions, table, events, overridden, faulty, touched, ordinals }
    }

    pub fn event(&mut self, event: &Event) {
        let mut effects = Vec::new();
        let mut touches = Vec::new();
        for action in &event.actions {
            match action {
                Action::Set(set) => effects.push(self.set(set)),
                Action::Fault(fault) => effects.extend(self.fault(fault)),
            }
            touches.extend(action.targets().iter().map(|&port| self.touched(port)));
        }
        touches.sort_unstable();
        touches.dedup();
        match event.trigger {
            Trigger::At(from) => {
                let ends = event.lasting.map(|lasting| from.saturating_add(lasting));
                self.events.at_ticks.extend([from].into_iter().chain(ends));
            }
            Trigger::When(_) | Trigger::While(_) => self.events.has_conditions = true,
        }
        self.events.windows.push(Window {
            trigger: event.trigger,
            lasting: event.lasting,
            is_window: event.is_window(),
            effects,
            touches,
            statement: event.statement.clone(),
        });
    }

    fn set(&mut self, set: &Set) -> Effect {
        let Self { events, table, scenario, .. } = self;
        let to = table.input_slot(set.target).slot;
        let target = *self.overridden.entry(set.target).or_insert_with(|| {
            let returns =
                scenario.connections.binary_search_by_key(&set.target, |connection| connection.target).is_err();
            events.of_group[table.group_of(set.target.instance)][0].push(events.overrides.len());
            events.overrides.push(Override { to, returns, sets: Vec::new() });
            events.overrides.len() - 1
        });
        let sets = &mut events.overrides[target].sets;
        sets.push(Computed::new(&set.value, to, table));
        Effect::Set { target, choice: sets.len() - 1 }
    }

    fn fault(&mut self, fault: &Fault) -> Vec<Effect> {
        let Some(&first) = fault.targets.first() else { return Vec::new() };
        let ordinal = self.ordinals.entry(first).or_insert(0);
        let number = std::mem::replace(ordinal, *ordinal + 1);
        let draws = Draws::new(self.scenario.seed, &self.name(first), number);
        let stage = fault.kind.stage() as usize - Stage::Bias as usize;
        let Self { events, table, scenario, .. } = self;
        let mut effects = Vec::new();
        for (element, &port) in fault.targets.iter().enumerate() {
            let target = *self.faulty.entry(port).or_insert_with(|| {
                events.of_group[table.group_of(port.instance)][1].push(events.faulty.len());
                events.faulty.push(FaultyInput::new(port, scenario, table));
                events.faulty.len() - 1
            });
            let context = Context { table, draws };
            let choice = events.faulty[target].add(fault, element, scenario.stop_tick, context);
            effects.push(Effect::Fault { target, stage, choice });
        }
        effects
    }

    fn touched(&mut self, port: Port) -> usize {
        let (name, ports) = (self.name(port), &mut self.events.ports);
        *self.touched.entry(port).or_insert_with(|| {
            ports.push(name);
            ports.len() - 1
        })
    }

    /// `instance.variable`
    fn name(&self, port: Port) -> String {
        let variable = &self.descriptions[port.instance].variables[port.variable];
        format!("{}.{}", self.scenario.instances[port.instance].name, variable.name)
    }
}
