//! The events of a script: when their windows open and close, and which inputs a `set` overrides meanwhile.

use super::feed::Computed;
use super::groups::Group;
use super::slot_table::SlotTable;
use crate::expression::{Moment, Stack};
use crate::values::{Slot, Values};
use dsl::scenario::{Port, Scenario, Trigger};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// An input or tunable parameter that the script sets at some time.
#[derive(Debug)]
pub struct Override {
    to: Slot,
    /// Whether it returns to its value after initialization; otherwise a connection drives it.
    returns: bool,
    sets: Vec<Computed>,
}

/// Which `set` of an override applies, by its index among those of its target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OverrideState {
    /// The `set` without end that began last.
    lasting: Option<usize>,
    /// The `set` whose window is open.
    window: Option<usize>,
}

/// All overrides of a script, in the order in which it names their targets.
#[derive(Debug, Default)]
pub struct Overrides {
    /// The overrides.
    pub all: Vec<Override>,
    /// Those of each group, as indices.
    pub of_group: Vec<Vec<usize>>,
    /// What happens to them, by tick.
    pub changes: Vec<Change>,
}

/// A window opens or closes, or a `set` without end begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// The tick at which it happens.
    pub tick: u64,
    /// The index of the override.
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

impl OverrideState {
    /// Applies a change.
    pub fn take(&mut self, effect: Effect) {
        match effect {
            Effect::Close(set) if self.window == Some(set) => self.window = None,
            Effect::Close(_) => {}
            Effect::Open(set) => self.window = Some(set),
            Effect::Stay(set) => self.lasting = Some(set),
        }
    }
}

impl Override {
    /// Stores the value that applies at this moment; leaves the input alone where a connection drives it. `initial` are the
    /// inputs after initialization.
    pub fn bring(
        &self,
        state: OverrideState,
        moment: &Moment<'_>,
        stack: &mut Stack,
        initial: &Values,
        inputs: &mut Values,
    ) {
        match state.window.or(state.lasting) {
            Some(set) => self.sets[set].bring(moment, stack, inputs),
            None if self.returns => inputs.copy_slot(self.to, initial, self.to),
            None => {}
        }
    }

    /// Whether this can be its state.
    #[must_use]
    pub fn fits(&self, state: &OverrideState) -> bool {
        [state.lasting, state.window].into_iter().flatten().all(|set| set < self.sets.len())
    }
}

impl Overrides {
    /// Lists the overrides and their changes, ordered by tick; within a tick, windows close before others open.
    pub(super) fn new(scenario: &Scenario, groups: &[Group], table: &SlotTable) -> Self {
        let connected: BTreeSet<Port> = scenario.connections.iter().map(|connection| connection.target).collect();
        let mut overrides = Self { of_group: vec![Vec::new(); groups.len()], ..Self::default() };
        let mut known = BTreeMap::new();
        for event in &scenario.events {
            let Trigger::At(from) = event.trigger else { unreachable!("the resolver refuses `when` and `while`") };
            for set in event.sets() {
                let to = table.input_slot(set.target).slot;
                let target = *known.entry(set.target).or_insert_with(|| {
                    let returns = !connected.contains(&set.target);
                    overrides.of_group[table.group_of(set.target.instance)].push(overrides.all.len());
                    overrides.all.push(Override { to, returns, sets: Vec::new() });
                    overrides.all.len() - 1
                });
                let sets = &mut overrides.all[target].sets;
                let index = sets.len();
                sets.push(Computed::new(&set.value, to, table));
                let mut change = |tick, effect| overrides.changes.push(Change { tick, target, effect });
                match event.lasting {
                    Some(lasting) => {
                        change(from, Effect::Open(index));
                        change(from.saturating_add(lasting), Effect::Close(index));
                    }
                    None => change(from, Effect::Stay(index)),
                }
            }
        }
        // A stable sort: changes of one kind at one tick keep the order of the script.
        overrides.changes.sort_by_key(|change: &Change| (change.tick, !matches!(change.effect, Effect::Close(_))));
        overrides
    }

    /// The state of all overrides before the first tick.
    #[must_use]
    pub fn states(&self) -> Vec<OverrideState> {
        vec![OverrideState::default(); self.all.len()]
    }
}
