//! The events of a script: when their windows open and close, and which inputs a `set` overrides meanwhile.

use super::feed::Computed;
use super::groups::Group;
use super::slot_table::SlotTable;
use crate::flatten::expression::{Moment, Stack};
use crate::flatten::values::{Slot, Values};
use dsl::scenario::{Port, Scenario, Trigger, Value};
use fmi2::description::BaseType;
use std::collections::{BTreeMap, BTreeSet};

/// An input or tunable parameter that the script sets at some time.
#[derive(Debug)]
pub struct Override {
    to: Slot,
    /// The value that it returns to; `None` where a connection drives it.
    rest: Option<Value>,
    sets: Vec<Computed>,
    /// The `set` without end that began last.
    lasting: Option<usize>,
    /// The `set` whose window is open.
    window: Option<usize>,
}

/// A window opens or closes, or a `set` without end begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// The tick at which it happens.
    pub tick: u64,
    /// The group of the target.
    pub group: usize,
    /// The index of the target among the group's overrides.
    pub target: usize,
    /// What changes.
    pub effect: Effect,
}

/// What a change does, with the index of the `set` among those of its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// The window's value no longer applies.
    Close(usize),
    /// The window's value applies.
    Open(usize),
    /// The value applies from now on, except while a window is open; it replaces an earlier value of this kind.
    Stay(usize),
}

impl Override {
    /// Applies a change.
    pub fn take(&mut self, effect: Effect) {
        match effect {
            Effect::Close(set) if self.window == Some(set) => self.window = None,
            Effect::Close(_) => {}
            Effect::Open(set) => self.window = Some(set),
            Effect::Stay(set) => self.lasting = Some(set),
        }
    }

    /// Stores the value that applies at this moment; leaves the input alone where a connection drives it.
    pub fn bring(&self, moment: &Moment<'_>, stack: &mut Stack, inputs: &mut Values) {
        match (self.window.or(self.lasting), &self.rest) {
            (Some(set), _) => self.sets[set].bring(moment, stack, inputs),
            (None, Some(rest)) => inputs.store(self.to, rest),
            (None, None) => {}
        }
    }
}

/// Lists the overrides of each group and their changes, ordered by tick; within a tick, windows close before others open.
pub(super) fn plan(
    scenario: &Scenario,
    groups: &[Group],
    table: &SlotTable,
    inputs: &Values,
) -> (Vec<Vec<Override>>, Vec<Change>) {
    let connected: BTreeSet<Port> = scenario.connections.iter().map(|connection| connection.target).collect();
    let mut overrides: Vec<Vec<Override>> = groups.iter().map(|_| Vec::new()).collect();
    let mut known = BTreeMap::new();
    let mut changes = Vec::new();
    for event in &scenario.events {
        let Trigger::At(from) = event.trigger else { unreachable!("the resolver refuses `when` and `while`") };
        for set in event.sets() {
            let to = table.input_slot(set.target).slot;
            let group = table.group_of(set.target.instance);
            let of_group = &mut overrides[group];
            let target = *known.entry(set.target).or_insert_with(|| {
                let rest = (!connected.contains(&set.target)).then(|| value_at(inputs, to));
                of_group.push(Override { to, rest, sets: Vec::new(), lasting: None, window: None });
                of_group.len() - 1
            });
            let sets = &mut of_group[target].sets;
            let index = sets.len();
            sets.push(Computed::new(&set.value, to, table));
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
    // A stable sort: changes of one kind at one tick keep the order of the script.
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
