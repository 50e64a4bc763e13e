//! Checkpoints: all that a run is between two ticks, taken out of one run and put into another.
//!
//! Everything is kept by instance in the script's order and by port in the ports's order, never by place or group, so that
//! a run can continue in other workers than it was saved in.

use super::next_rows::Row;
use super::{CarriedState, Observer, StepLoop, UnderWay};
use crate::run::worker::{Reply, Terminated};
use dsl::scenario::Scenario;
use flatten::values::Values;
use flatten::wiring::{Group, InstancePorts, Plan};
use fmi2::description::ModelDescription;
use results::checkpoint::CheckpointError;
use serde::{Deserialize, Serialize};
use unit::failure::Failure;

/// A run after the row of a tick.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The tick of the last row.
    pub tick: u64,
    /// The instances in the script's order.
    instances: Vec<SavedInstance>,
    carried: CarriedState,
    /// The rows that followed, as far as they were known when this was stored.
    pub(super) next: Vec<Row>,
}

/// One instance.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct SavedInstance {
    /// Its state, as the unit serialized it.
    state: Vec<u8>,
    inputs: Values,
    visible: Values,
    latest: Values,
    /// What its step brings when it is due, if one is under way.
    early: Option<EarlyResult>,
}

/// A result that was awaited before it is due.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct EarlyResult {
    outputs: Values,
    terminated: Option<Terminated>,
}

impl Checkpoint {
    /// Reads a checkpoint of a run of this scenario.
    ///
    /// # Errors
    /// The bytes are damaged, were saved where this run is over, or do not fit the scenario.
    pub fn read(
        bytes: &[u8],
        scenario: &Scenario,
        descriptions: &[&ModelDescription],
    ) -> Result<Self, CheckpointError> {
        let read = postcard::take_from_bytes::<Self>(bytes);
        let (checkpoint, rest) = read.map_err(|_| CheckpointError::Damaged)?;
        if checkpoint.tick >= scenario.stop_tick {
            return Err(CheckpointError::AtTheEnd { tick: checkpoint.tick, step_ns: scenario.step_ns });
        }
        if rest.is_empty() && checkpoint.fits(scenario, descriptions) {
            Ok(checkpoint)
        } else {
            Err(CheckpointError::Unfit)
        }
    }

    /// Whether it could be one of a run of this scenario: as many of everything, each where it may be. What units saved is
    /// theirs to judge.
    fn fits(&self, scenario: &Scenario, descriptions: &[&ModelDescription]) -> bool {
        if self.tick >= scenario.stop_tick || self.instances.len() != scenario.instances.len() {
            return false;
        }
        let plan = Plan::new(scenario, descriptions, &vec![0; scenario.instances.len()]);
        let instance_fits = |instance: usize| {
            let early = &self.instances[instance].early;
            let itself = |result: &EarlyResult| result.terminated.is_none_or(|unit| unit.instance == instance);
            self.instances[instance].fits(&plan.ports[instance]) && early.as_ref().is_none_or(itself)
        };
        let row_fits = |row: &Row| {
            row.len() == plan.ports.len() && plan.ports.iter().zip(row).all(|(ports, values)| ports.outputs.fit(values))
        };
        let is_under_way = |instance: &usize| self.instances[*instance].early.is_some();
        let group_fits = |group: &Group| {
            let under_way = group.is_under_way_after(self.tick);
            group.instances.iter().all(|instance| is_under_way(instance) == under_way)
        };
        (0..plan.ports.len()).all(instance_fits)
            && self.next.iter().all(row_fits)
            && plan.groups.iter().all(group_fits)
            && self.carried.fits(&plan, self.tick + 1)
    }
}

impl SavedInstance {
    fn fits(&self, ports: &InstancePorts) -> bool {
        let early = self.early.iter().map(|early| &early.outputs);
        let mut outputs = [&self.visible, &self.latest].into_iter().chain(early);
        ports.inputs.fit(&self.inputs) && outputs.all(|values| ports.outputs.fit(values))
    }
}

impl<W: Observer> StepLoop<'_, W> {
    /// Has the observer keep the run as it is after the row of this tick. Where a step that is under way is lost there is
    /// nothing to keep: the run breaks when its result is due.
    ///
    /// # Errors
    /// A unit refuses to be saved, or the observer cannot keep what was saved.
    #[cold]
    pub(super) fn save(&mut self, tick: u64) -> Result<(), Failure> {
        if !self.await_early(tick) {
            return Ok(());
        }
        let mut states = Vec::new();
        for worker in &mut self.workers {
            states.extend(worker.save(tick).map_err(|lost| lost.failure)?);
        }
        states.sort_by_key(|(instance, _)| *instance);
        assert!(
            states.iter().map(|(instance, _)| *instance).eq(0..self.plan.ports.len()),
            "each instance is saved once"
        );
        let states = states.into_iter();
        let checkpoint = Checkpoint {
            tick,
            instances: states.map(|(instance, state)| self.saved_instance(instance, state)).collect(),
            carried: self.state.carried.clone(),
            next: Vec::new(),
        };
        // Now, as a unit may crash before the next rows are known.
        self.store(&checkpoint)?;
        self.state.next_rows.keep(checkpoint);
        Ok(())
    }

    /// Has the observer store a checkpoint, in place of an earlier one of its tick.
    ///
    /// # Errors
    /// It cannot be stored.
    pub(super) fn store(&mut self, checkpoint: &Checkpoint) -> Result<(), Failure> {
        let time_s = self.plan.seconds(checkpoint.tick);
        self.observer.checkpoint(checkpoint).map_err(|cause| Failure::between_calls(time_s, cause))
    }

    /// Awaits all orders that are under way, aside from where results are seen; false if one is lost.
    fn await_early(&mut self, tick: u64) -> bool {
        for (group, order) in self.plan.groups.iter().zip(&mut self.state.under_way) {
            if let Some(UnderWay::Ordered(ticket)) = *order {
                let result = self.workers[group.worker].reply(ticket, group.due_after(tick), &mut self.state.early);
                *order = Some(UnderWay::Early(Box::new(result)));
            }
        }
        self.state.under_way.iter().flatten().all(|order| matches!(order, UnderWay::Early(result) if result.is_ok()))
    }

    fn saved_instance(&self, instance: usize, state: Vec<u8>) -> SavedInstance {
        let InstancePorts { inputs, outputs, .. } = &self.plan.ports[instance];
        let of_group = |(group, _): &(&Group, _)| group.instances.contains(&instance);
        let order =
            self.plan.groups.iter().zip(&self.state.under_way).find(of_group).and_then(|(_, order)| order.as_ref());
        let early = order.map(|order| EarlyResult {
            outputs: outputs.values(&self.state.early),
            terminated: order.terminated().iter().copied().find(|unit| unit.instance == instance),
        });
        SavedInstance {
            state,
            inputs: inputs.values(&self.state.inputs),
            visible: outputs.values(&self.state.visible),
            latest: outputs.values(&self.state.latest),
            early,
        }
    }

    /// Takes a run that was initialized to where another stood when it was saved.
    ///
    /// # Errors
    /// A unit refuses its state.
    ///
    /// # Panics
    /// If the checkpoint does not fit, see [`Checkpoint::fits`].
    pub(super) fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), Failure> {
        let Checkpoint { tick, instances, .. } = checkpoint;
        for (index, worker) in self.workers.iter_mut().enumerate() {
            let groups = self.plan.groups.iter().filter(|group| group.worker == index);
            let mut held: Vec<_> = groups.flat_map(|group| &group.instances).copied().collect();
            held.sort_unstable();
            let states: Vec<_> = held.into_iter().map(|instance| (instance, &*instances[instance].state)).collect();
            worker.restore(*tick, &states).map_err(|lost| lost.failure)?;
        }
        let Self { plan, state, observer, .. } = self;
        for (saved, ports) in instances.iter().zip(&plan.ports) {
            ports.inputs.store(&saved.inputs, &mut state.inputs);
            ports.outputs.store(&saved.visible, &mut state.visible);
            ports.outputs.store(&saved.latest, &mut state.latest);
            if let Some(early) = &saved.early {
                ports.outputs.store(&early.outputs, &mut state.early);
            }
        }
        for (group, order) in plan.groups.iter().zip(&mut state.under_way) {
            let results = group.instances.iter().filter_map(|&instance| instances[instance].early.as_ref());
            let terminated = results.filter_map(|result| result.terminated).collect();
            *order = group.is_under_way_after(*tick).then(|| UnderWay::Early(Box::new(Ok(Reply { terminated }))));
        }
        state.samples = tick + 1;
        state.next_rows.expect(&checkpoint.next);
        assert!(checkpoint.carried.fits(plan, state.samples), "a checkpoint fits its run");
        state.carried.clone_from(&checkpoint.carried);
        plan.claims.reserve(&mut state.carried.claims);
        plan.events.resume(&mut state.carried.events, *tick);
        state.carried.events.changes().iter().for_each(|&change| observer.window(change));
        let standings = plan.claims.standings(&state.carried.claims);
        standings.for_each(|(claim, standing)| observer.claim(claim, standing));
        Ok(())
    }
}
