//! Running values in a run: the shared expressions that have a memory.

use crate::expression::{Program, Stack, evaluate_shared};
use crate::values::Values;
use dsl::scenario::{RealExpression, Running, RunningMemory};

/// The running values of a script.
#[derive(Debug)]
pub struct RunningValues {
    /// Each with its slot among the shared expressions, in their order.
    all: Vec<(usize, Running)>,
}

impl RunningValues {
    /// Those among the shared expressions.
    #[must_use]
    pub fn new(shared: &[RealExpression]) -> Self {
        let running = |(slot, value): (usize, &RealExpression)| match value {
            RealExpression::Running(running) => Some((slot, running.clone())),
            _ => None,
        };
        Self { all: shared.iter().enumerate().filter_map(running).collect() }
    }

    /// Whether memories can be those of these values.
    #[must_use]
    pub fn fit(&self, memories: &[RunningMemory]) -> bool {
        memories.len() == self.all.len()
    }

    /// The memories before the first sample.
    #[must_use]
    pub fn memories(&self) -> Vec<RunningMemory> {
        vec![RunningMemory::default(); self.all.len()]
    }

    /// Computes all shared expressions for the sample of a tick, of which none is left out.
    pub fn evaluate(
        &self,
        programs: &[Program],
        (outputs, time_s, tick): (&Values, f64, u64),
        stack: &mut Stack,
        values: &mut [f64],
        memories: &mut [RunningMemory],
    ) {
        let mut next = 0;
        for ((slot, running), memory) in self.all.iter().zip(memories) {
            evaluate_shared(programs, next..=*slot, (outputs, time_s), stack, values);
            values[*slot] = running.take(memory, tick, values[*slot]);
            next = slot + 1;
        }
        evaluate_shared(programs, next..programs.len(), (outputs, time_s), stack, values);
    }
}
