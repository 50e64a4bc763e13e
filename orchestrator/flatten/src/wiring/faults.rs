//! Faults of connections: what happens to the value of an input behind its connection and its `set`.

use super::events::InForce;
use super::slot_table::SlotTable;
use crate::expression::{Moment, Program, Stack};
use crate::values::{Slot, Values};
use dsl::random::Draws;
use dsl::scenario::{Fault, FaultKind, Port, RealExpression, Scenario};
use serde::{Deserialize, Serialize};

/// An input that has faults at some time, with its faults by stage.
#[derive(Debug)]
pub struct FaultyInput {
    to: Slot,
    /// Its period in ticks.
    every: u64,
    bias: Vec<Program>,
    noise: Vec<Noise>,
    hold: Vec<Hold>,
    /// By how many of its own samples.
    delay: Vec<usize>,
    /// How many values are kept.
    kept: usize,
}

#[derive(Debug)]
struct Noise {
    deviation: Program,
    draws: Draws,
    element: u64,
}

#[derive(Debug)]
enum Hold {
    Freeze,
    Loss(Program, Draws),
}

/// Which faults of an input apply, and the values that it had.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FaultMemory {
    /// By stage: bias, noise, loss or freeze, delay.
    pub(super) in_force: [InForce; 4],
    /// The values before the delay, of the input's last samples, in a ring.
    values: Values,
    /// The place of the next one; the one before it is the last.
    next: usize,
}

/// What the fault of one path has in common for all of its elements.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    pub table: &'a SlotTable,
    pub draws: Draws,
}

impl FaultyInput {
    /// An input without faults.
    pub(super) fn new(port: Port, scenario: &Scenario, table: &SlotTable) -> Self {
        let (to, every) = (table.input_slot(port).slot, scenario.instances[port.instance].every);
        Self { to, every, bias: Vec::new(), noise: Vec::new(), hold: Vec::new(), delay: Vec::new(), kept: 1 }
    }

    /// Adds a fault, whose targets have this input at place `element`; returns its index among those of its stage. Values
    /// from before the start are all equal, so that none need be kept for longer than the run is.
    pub(super) fn add(&mut self, fault: &Fault, element: usize, stop_tick: u64, context: Context<'_>) -> usize {
        let Context { table, draws } = context;
        let compile = |value: &RealExpression| Program::compile_real(value, &mut |port| table.read(port));
        match &fault.kind {
            FaultKind::Bias(values) => add(&mut self.bias, compile(&values[element])),
            FaultKind::Noise(values) => {
                let deviation = compile(&values[element]);
                add(&mut self.noise, Noise { deviation, draws, element: element as u64 })
            }
            FaultKind::Loss(probability) => add(&mut self.hold, Hold::Loss(compile(probability), draws)),
            FaultKind::Freeze => add(&mut self.hold, Hold::Freeze),
            FaultKind::Delay(ticks) => {
                let samples = ticks.div_ceil(self.every).min(stop_tick / self.every + 1);
                let samples = usize::try_from(samples).unwrap_or(usize::MAX);
                self.kept = self.kept.max(samples.saturating_add(1));
                add(&mut self.delay, samples)
            }
        }
    }

    /// Before the first sample.
    pub(super) fn memory(&self) -> FaultMemory {
        let mut values = Values::default();
        for _ in 0..self.kept {
            values.add(self.to.base);
        }
        FaultMemory { in_force: [InForce::default(); 4], values, next: 0 }
    }

    /// All earlier values are those after initialization.
    pub(super) fn begin(&self, memory: &mut FaultMemory, initial: &Values) {
        (0..self.kept).for_each(|place| memory.values.copy_slot(self.place(place), initial, self.to));
    }

    /// Whether it can be the memory of this input.
    pub(super) fn fits(&self, memory: &FaultMemory) -> bool {
        let mut expected = Values::default();
        for _ in 0..self.kept {
            expected.add(self.to.base);
        }
        let counts = [self.bias.len(), self.noise.len(), self.hold.len(), self.delay.len()];
        memory.values.end() == expected.end()
            && memory.next < self.kept
            && memory.in_force.iter().zip(counts).all(|(in_force, count)| in_force.fits(count))
    }

    /// Passes the value of the input through its faults.
    pub(super) fn bring(
        &self,
        memory: &mut FaultMemory,
        tick: u64,
        moment: &Moment<'_>,
        stack: &mut Stack,
        inputs: &mut Values,
    ) {
        let [bias, noise, hold, delay] = memory.in_force.map(InForce::choice);
        if let Some(choice) = bias {
            inputs.reals[self.to.index] += self.bias[choice].real(moment, stack);
        }
        if let Some(choice) = noise {
            let Noise { deviation, draws, element } = &self.noise[choice];
            inputs.reals[self.to.index] += deviation.real(moment, stack) * draws.normal(*element, tick);
        }
        let is_held = hold.is_some_and(|choice| match &self.hold[choice] {
            Hold::Freeze => true,
            Hold::Loss(probability, draws) => draws.uniform(0, tick) < probability.real(moment, stack),
        });
        let before = |samples: usize| self.place((memory.next + self.kept - samples) % self.kept);
        let (now, last) = (before(0), before(1));
        if is_held {
            inputs.copy_slot(self.to, &memory.values, last);
        }
        memory.values.copy_slot(now, inputs, self.to);
        if let Some(choice) = delay {
            inputs.copy_slot(self.to, &memory.values, before(self.delay[choice]));
        }
        memory.next = (memory.next + 1) % self.kept;
    }

    fn place(&self, index: usize) -> Slot {
        Slot { base: self.to.base, index }
    }
}

fn add<T>(all: &mut Vec<T>, one: T) -> usize {
    all.push(one);
    all.len() - 1
}
