//! The events of a script: when their windows open and close, and what is in force meanwhile.

mod compile;

use super::conditions::ConditionsMemory;
use super::faults::{FaultMemory, FaultyInput};
use super::feed::Computed;
use super::groups::Group;
use super::slot_table::SlotTable;
use crate::expression::{Moment, Stack};
use crate::values::{Slot, Values};
use compile::Compiler;
use dsl::scenario::{Scenario, Trigger};
use fmi2::description::ModelDescription;
use serde::{Deserialize, Serialize};

/// All windows of a script, and the inputs that they act on.
#[derive(Debug, Default)]
pub struct Events {
    windows: Vec<Window>,
    /// The ticks at which a window of `at` opens or closes, in order.
    at_ticks: Vec<u64>,
    /// Whether a condition opens a window.
    has_conditions: bool,
    /// In the order in which the script names their targets.
    overrides: Vec<Override>,
    faulty: Vec<FaultyInput>,
    /// The overrides and faulty inputs of each group, as indices.
    of_group: Vec<[Vec<usize>; 2]>,
    /// The names of all ports that windows touch.
    ports: Vec<String>,
}

#[derive(Debug)]
struct Window {
    trigger: Trigger,
    lasting: Option<u64>,
    is_window: bool,
    effects: Vec<Effect>,
    /// Indices into [`Events::ports`].
    touches: Vec<usize>,
    /// Where it is written.
    statement: String,
}

/// What a window brings into force: a choice, as an index among those of its target.
#[derive(Clone, Copy, Debug)]
enum Effect {
    Set {
        target: usize,
        choice: usize,
    },
    /// The stage counts from that of `bias`.
    Fault {
        target: usize,
        stage: usize,
        choice: usize,
    },
}

/// An input or tunable parameter that the script sets at some time.
#[derive(Debug)]
struct Override {
    to: Slot,
    /// Whether it returns to its value after initialization; otherwise a connection drives it.
    returns: bool,
    sets: Vec<Computed>,
}

/// Which of several choices applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct InForce {
    /// The one without end that began last.
    lasting: Option<usize>,
    /// The one whose window is open.
    window: Option<usize>,
}

/// A window has opened or closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Change {
    /// The tick.
    pub tick: u64,
    /// Index into [`Scenario::events`].
    pub event: usize,
    /// Whether it opened.
    pub opened: bool,
}

/// What is remembered of events: which windows are open, what is in force, and all that happened.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct EventsMemory {
    /// For each window, if it is open, the tick at which it closes by itself.
    open: Vec<Option<u64>>,
    overrides: Vec<InForce>,
    faults: Vec<FaultMemory>,
    /// All changes so far.
    changes: Vec<Change>,
    /// The open window over each port.
    #[serde(skip)]
    holders: Vec<Option<usize>>,
    /// The next tick at which a window of `at` opens or closes.
    #[serde(skip)]
    next_at: u64,
}

impl InForce {
    /// What applies.
    pub fn choice(self) -> Option<usize> {
        self.window.or(self.lasting)
    }

    /// Whether there are enough choices for it.
    pub fn fits(&self, choices: usize) -> bool {
        [self.lasting, self.window].into_iter().flatten().all(|choice| choice < choices)
    }

    fn begin(&mut self, choice: usize, is_window: bool) {
        *(if is_window { &mut self.window } else { &mut self.lasting }) = Some(choice);
    }

    fn close(&mut self, choice: usize) {
        if self.window == Some(choice) {
            self.window = None;
        }
    }
}

impl Override {
    /// Stores the value that applies at this moment; leaves the input alone where a connection drives it.
    fn bring(&self, state: InForce, moment: &Moment<'_>, stack: &mut Stack, initial: &Values, inputs: &mut Values) {
        match state.choice() {
            Some(set) => self.sets[set].bring(moment, stack, inputs),
            None if self.returns => inputs.copy_slot(self.to, initial, self.to),
            None => {}
        }
    }
}

impl Events {
    /// Compiles the events of a scenario.
    pub(super) fn new(
        scenario: &Scenario,
        descriptions: &[&ModelDescription],
        groups: &[Group],
        table: &SlotTable,
    ) -> Self {
        let mut compiler = Compiler::new(scenario, descriptions, groups, table);
        scenario.events.iter().for_each(|event| compiler.event(event));
        let mut events = compiler.events;
        events.at_ticks.sort_unstable();
        events.at_ticks.dedup();
        events
    }

    /// Whether a window acts on an input of a group at some time.
    pub(super) fn act_on(&self, group: usize) -> bool {
        self.of_group[group].iter().any(|targets| !targets.is_empty())
    }

    /// Before the first tick.
    #[must_use]
    pub fn memory(&self) -> EventsMemory {
        EventsMemory {
            open: vec![None; self.windows.len()],
            overrides: vec![InForce::default(); self.overrides.len()],
            faults: self.faulty.iter().map(FaultyInput::memory).collect(),
            changes: Vec::new(),
            holders: vec![None; self.ports.len()],
            next_at: self.at_ticks.first().copied().unwrap_or(u64::MAX),
        }
    }

    /// The values of inputs before the first tick are those after initialization.
    pub fn begin(&self, memory: &mut EventsMemory, initial: &Values) {
        self.faulty.iter().zip(&mut memory.faults).for_each(|(input, memory)| input.begin(memory, initial));
    }

    /// Whether it can be the memory of these events after so many ticks.
    #[must_use]
    pub fn fit(&self, memory: &EventsMemory, ticks: u64) -> bool {
        let happened = |change: &Change| change.tick < ticks && change.event < self.windows.len();
        memory.open.len() == self.windows.len()
            && memory.open.iter().zip(&self.windows).all(|(open, window)| open.is_none() || window.is_window)
            && memory.overrides.len() == self.overrides.len()
            && memory.overrides.iter().zip(&self.overrides).all(|(state, one)| state.fits(one.sets.len()))
            && memory.faults.len() == self.faulty.len()
            && memory.faults.iter().zip(&self.faulty).all(|(memory, input)| input.fits(memory))
            && memory.changes.iter().all(happened)
    }

    /// Completes a memory that was read from a checkpoint after the row of this tick.
    pub fn resume(&self, memory: &mut EventsMemory, tick: u64) {
        memory.holders = vec![None; self.ports.len()];
        for (index, window) in self.windows.iter().enumerate().filter(|(index, _)| memory.open[*index].is_some()) {
            window.touches.iter().for_each(|&port| memory.holders[port] = Some(index));
        }
        memory.next_at = self.next_at(tick);
    }

    /// Closes the windows that end at a tick, then opens others.
    ///
    /// # Errors
    /// Two windows are open over one port: the error names both statements and the port.
    #[inline]
    pub fn take(
        &self,
        memory: &mut EventsMemory,
        tick: u64,
        conditions: &ConditionsMemory,
        report: impl FnMut(Change),
    ) -> Result<(), String> {
        if self.has_conditions || tick >= memory.next_at {
            self.change(memory, tick, conditions, report)
        } else {
            Ok(())
        }
    }

    fn change(
        &self,
        memory: &mut EventsMemory,
        tick: u64,
        conditions: &ConditionsMemory,
        mut report: impl FnMut(Change),
    ) -> Result<(), String> {
        for (event, window) in self.windows.iter().enumerate() {
            let Some(until) = memory.open[event] else { continue };
            let closes = match window.trigger {
                Trigger::While(slot) => !conditions.holds(slot),
                Trigger::At(_) | Trigger::When(_) => until <= tick,
            };
            if closes {
                memory.close(event, window);
                report(memory.note(Change { tick, event, opened: false }));
            }
        }
        for (event, window) in self.windows.iter().enumerate() {
            let opens = match window.trigger {
                Trigger::At(from) => from == tick,
                Trigger::When(slot) => conditions.rises()[slot],
                Trigger::While(slot) => conditions.holds(slot),
            };
            if !opens || memory.open[event].is_some() {
                continue;
            }
            if let Some((port, other)) = memory.clash(window) {
                return Err(self.clash(port, &self.windows[other], window));
            }
            memory.open(event, window, tick);
            report(memory.note(Change { tick, event, opened: true }));
        }
        memory.next_at = self.next_at(tick);
        Ok(())
    }

    /// The first tick behind this one at which a window of `at` opens or closes.
    fn next_at(&self, tick: u64) -> u64 {
        let next = self.at_ticks.partition_point(|&at| at <= tick);
        self.at_ticks.get(next).copied().unwrap_or(u64::MAX)
    }

    #[cold]
    fn clash(&self, port: usize, earlier: &Window, later: &Window) -> String {
        let port = &self.ports[port];
        format!("the windows of {} and {} act on `{port}` at one time", earlier.statement, later.statement)
    }

    /// Stores what is set in the inputs of a group and passes them through their faults. `initial` are the inputs after
    /// initialization.
    #[inline]
    pub fn bring(
        &self,
        (group, tick): (usize, u64),
        memory: &mut EventsMemory,
        moment: &Moment<'_>,
        stack: &mut Stack,
        (initial, inputs): (&Values, &mut Values),
    ) {
        let [overrides, faulty] = &self.of_group[group];
        for &target in overrides {
            self.overrides[target].bring(memory.overrides[target], moment, stack, initial, inputs);
        }
        for &target in faulty {
            self.faulty[target].bring(&mut memory.faults[target], tick, moment, stack, inputs);
        }
    }
}

impl EventsMemory {
    /// All changes so far, in their order.
    #[must_use]
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    fn note(&mut self, change: Change) -> Change {
        self.changes.push(change);
        change
    }

    /// The first port of a window over which another one is open, with that one.
    fn clash(&self, window: &Window) -> Option<(usize, usize)> {
        window.touches.iter().find_map(|&port| Some((port, self.holders[port]?)))
    }

    fn open(&mut self, event: usize, window: &Window, tick: u64) {
        if window.is_window {
            self.open[event] = Some(window.lasting.map_or(u64::MAX, |ticks| tick.saturating_add(ticks)));
            window.touches.iter().for_each(|&port| self.holders[port] = Some(event));
        }
        for &effect in &window.effects {
            let (state, choice) = self.state(effect);
            state.begin(choice, window.is_window);
        }
    }

    fn close(&mut self, event: usize, window: &Window) {
        self.open[event] = None;
        window.touches.iter().for_each(|&port| self.holders[port] = None);
        for &effect in &window.effects {
            let (state, choice) = self.state(effect);
            state.close(choice);
        }
    }

    fn state(&mut self, effect: Effect) -> (&mut InForce, usize) {
        match effect {
            Effect::Set { target, choice } => (&mut self.overrides[target], choice),
            Effect::Fault { target, stage, choice } => (&mut self.faults[target].in_force[stage], choice),
        }
    }
}
