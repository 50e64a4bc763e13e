//! All that changes during a run outside of the instances.

use super::UnderWay;
use super::next_rows::NextRows;
use crate::run::worker::Terminated;
use dsl::scenario::RunningMemory;
use flatten::claims::ClaimsMemory;
use flatten::values::Values;
use flatten::wiring::{ConditionsMemory, EventsMemory, Plan};
use serde::{Deserialize, Serialize};

/// The state of a run. With the saved states of the instances it is a checkpoint.
#[derive(Debug)]
pub(super) struct State {
    /// The outputs that `->`, claims and rows read: those of steps that have ended by this tick.
    pub visible: Values,
    /// The outputs that `=>` reads: those of all steps that were awaited.
    pub latest: Values,
    /// The inputs that were last passed to a step.
    pub inputs: Values,
    /// The inputs after initialization, to which a `set` returns.
    pub initial_inputs: Values,
    /// By group, the order whose result is not yet due, if any.
    pub under_way: Vec<Option<UnderWay>>,
    /// Results that a checkpoint awaited before they are due.
    pub early: Values,
    /// What belongs to no instance.
    pub carried: CarriedState,
    /// The shared expressions, computed from the visible and from the latest outputs.
    pub visible_shared: Vec<f64>,
    pub latest_shared: Vec<f64>,
    /// By group, the inputs with limits that they have not missed yet.
    pub unreported: Vec<Vec<usize>>,
    /// The rows that follow checkpoints.
    pub next_rows: NextRows,
    /// The tick of the next sample of the claims.
    pub samples: u64,
}

/// The part of the state that belongs to no instance: a checkpoint contains it as it is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CarriedState {
    /// Instances that have terminated, with the tick at which their step ends.
    pub terminated: Vec<(u64, Terminated)>,
    /// Since when each condition holds.
    pub conditions: ConditionsMemory,
    /// Which windows are open, and what they did.
    pub events: EventsMemory,
    /// What the claims remember of earlier samples.
    pub claims: ClaimsMemory,
    /// The same of running values.
    pub running: Vec<RunningMemory>,
}

impl State {
    /// Before initialization.
    pub fn new(plan: &Plan) -> Self {
        Self {
            visible: plan.outputs.clone(),
            latest: plan.outputs.clone(),
            inputs: plan.inputs.clone(),
            initial_inputs: plan.inputs.clone(),
            under_way: plan.groups.iter().map(|_| None).collect(),
            early: plan.outputs.clone(),
            carried: CarriedState {
                terminated: Vec::new(),
                conditions: plan.conditions.memory(),
                events: plan.events.memory(),
                claims: plan.claims.memory(),
                running: plan.running.memories(),
            },
            visible_shared: vec![0.0; plan.shared.len()],
            latest_shared: vec![0.0; plan.shared.len()],
            unreported: plan.limits.of_group.clone(),
            next_rows: NextRows::default(),
            samples: plan.start_tick,
        }
    }
}

impl CarriedState {
    /// Whether it can be that of a run of this plan after so many samples.
    pub fn fits(&self, plan: &Plan, samples: u64) -> bool {
        self.terminated.iter().all(|(_, unit)| unit.instance < plan.ports.len())
            && plan.conditions.fit(&self.conditions, samples)
            && plan.events.fit(&self.events, samples)
            && plan.claims.fits(&self.claims, samples)
            && plan.running.fit(&self.running)
    }
}
