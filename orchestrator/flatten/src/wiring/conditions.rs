//! The conditions that a run follows from sample to sample: since when each holds.

use crate::expression::{Moment, Program, SlotOf, Stack};
use crate::values::Values;
use dsl::scenario::Condition;
use serde::{Deserialize, Serialize};

/// The conditions, by slot.
#[derive(Debug, Default)]
pub struct Conditions {
    all: Vec<Followed>,
}

#[derive(Debug)]
struct Followed {
    is: Program,
    held_ticks: u64,
}

/// What is remembered of earlier samples.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ConditionsMemory {
    /// The number of samples in a row at which each held, up to the last.
    samples: Vec<u64>,
    /// Whether each holds, for its time, at the last sample.
    holds: Vec<bool>,
    /// Whether each holds there and did not at the sample before.
    rises: Vec<bool>,
}

impl Conditions {
    /// Compiles conditions.
    pub(super) fn new(conditions: &[Condition], slot_of: &mut SlotOf<'_>) -> Self {
        let followed = |condition: &Condition| Followed {
            is: Program::compile_condition(&condition.is, slot_of),
            held_ticks: condition.held_ticks,
        };
        Self { all: conditions.iter().map(followed).collect() }
    }

    /// Before the first sample, where each counts as false.
    #[must_use]
    pub fn memory(&self) -> ConditionsMemory {
        let count = self.all.len();
        ConditionsMemory { samples: vec![0; count], holds: vec![false; count], rises: vec![false; count] }
    }

    /// Takes a sample: the outputs, the time in seconds and the shared values. A condition may use those before it.
    #[inline]
    pub fn take(
        &self,
        memory: &mut ConditionsMemory,
        (outputs, time_s, shared): (&Values, f64, &[f64]),
        stack: &mut Stack,
    ) {
        for (slot, condition) in self.all.iter().enumerate() {
            let moment = Moment { outputs, time_s, rises: &memory.rises, shared };
            let is = condition.is.holds(&moment, stack);
            let samples = if is { memory.samples[slot] + 1 } else { 0 };
            memory.samples[slot] = samples;
            let holds = samples > condition.held_ticks;
            let held = std::mem::replace(&mut memory.holds[slot], holds);
            memory.rises[slot] = holds && !held;
        }
    }

    /// Whether it can be the memory of these conditions.
    #[must_use]
    pub fn fit(&self, memory: &ConditionsMemory, samples: u64) -> bool {
        [memory.samples.len(), memory.holds.len(), memory.rises.len()] == [self.all.len(); 3]
            && memory.samples.iter().all(|&in_a_row| in_a_row <= samples)
    }
}

impl ConditionsMemory {
    /// Whether a condition holds, for its time.
    #[inline]
    #[must_use]
    pub fn holds(&self, slot: usize) -> bool {
        self.holds[slot]
    }

    /// For each condition whether it holds and did not at the sample before.
    #[inline]
    #[must_use]
    pub fn rises(&self) -> &[bool] {
        &self.rises
    }
}
