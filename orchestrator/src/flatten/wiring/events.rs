//! What `at` does: which windows open and close when, and what a `set` overrides meanwhile.

use super::feed::Computed;
use super::groups::Group;
use super::slot_table::SlotTable;
use crate::flatten::expression::Moment;
use crate::flatten::values::{Slot, Values};
use dsl::scenario::{Port, Scenario, Trigger, Value};
use fmi2::description::BaseType;
use std::collections::{BTreeMap, BTreeSet};

/// An input or tunable parameter that the script sets at some time.
#[derive(Debug)]
pub struct Override {
    to: Slot,
    /// What it returns to where no connection drives it.
    rest: Option<Value>,
    sets: Vec<Computed>,
    lasting: Option<usize>,
    window: Option<usize>,
}

/// A window opens or closes, or a `set` without end begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// When.
    pub tick: u64,
    /// The group of the target.
    pub group: usize,
    /// Which of the group's overrides.
    pub target: usize,
    /// What happens.
    pub effect: Effect,
}

/// What a change does, with the index of the `set` among those of its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// The window's value is undone.
    Close(usize),
    /// The window's value acts.
    Open(usize),
    /// The value acts from now on, wherever no window is open; it replaces the one before.
    Stay(usize),
}

impl Override {
    /// Takes a change.
    pub fn take(&mut self, effect: Effect) {
        match effect {
            Effect::Close(set) if self.window == Some(set) => self.window = None,
            Effect::Close(_) => {}
            Effect::Open(set) => self.window = Some(set),
            Effect::Stay(set) => self.lasting = Some(set),
        }
    }

    /// Brings the value that acts at this moment, where it is not a connection's.
    pub fn bring(&mut self, moment: &Moment<'_>, inputs: &mut Values) {
        match (self.window.or(self.lasting), &self.rest) {
            (Some(set), _) => self.sets[set].bring(moment, inputs),
            (None, Some(rest)) => inputs.store(self.to, rest),
            (None, None) => {}
        }
    }
}

/// Lists the overrides of each group and what happens to them, ordered by tick, closings first.
pub(super) fn plan(
    scenario: &Scenario,
    groups: &[Group],
    places: &SlotTable,
    inputs: &Values,
) -> (Vec<Vec<Override>>, Vec<Change>) {
    let connected: BTreeSet<Port> = scenario.connections.iter().map(|connection| connection.target).collect();
    let mut overrides: Vec<Vec<Override>> = groups.iter().map(|_| Vec::new()).collect();
    let mut known = BTreeMap::new();
    let mut changes = Vec::new();
    for event in &scenario.events {
        let Trigger::At(from) = event.trigger else { unreachable!("the resolver refuses `when` and `while`") };
        for set in event.sets() {
            let to = places.pick_input(set.target).slot;
            let group = places.group_of(set.target.instance);
            let of_group = &mut overrides[group];
            let target = *known.entry(set.target).or_insert_with(|| {
                let rest = (!connected.contains(&set.target)).then(|| value_at(inputs, to));
                of_group.push(Override { to, rest, sets: Vec::new(), lasting: None, window: None });
                of_group.len() - 1
            });
            let sets = &mut of_group[target].sets;
            let index = sets.len();
            sets.push(Computed::new(&set.value, to, places));
            let change = |tick, effect| Change { tick, group, target, effect };
            match event.lasting {
                Some(lasting) => {
                    changes.push(change(from, Effect::Open(index)));
                    changes.push(change(from.saturating_add(lasting), Effect::Close(index)));
                }
                None => changes.push(change(from, Effect::Stay(index))),
            }
        }
    }
    // Stable: what happens at one tick keeps the order of the file.
    changes.sort_by_key(|change: &Change| (change.tick, !matches!(change.effect, Effect::Close(_))));
    (overrides, changes)
}

fn value_at(values: &Values, slot: Slot) -> Value {
    match slot.base {
        BaseType::Real => Value::Real(values.reals[slot.index]),
        BaseType::Integer => Value::Integer(values.integers[slot.index]),
        BaseType::Boolean => Value::Boolean(values.booleans[slot.index] != 0),
        BaseType::String => Value::String(values.texts[slot.index].clone()),
    }
}
