//! The loop: gather, judge, events, drive, step, record, tick for tick.
//!
//! It works on flat arrays and allocates, hashes, formats and waits for nothing but its workers. Next on the walk: the
//! workers' units, `fmus/<unit>/src/lib.rs`, and back through `claims/` and `trace/`.

mod checkpoint;
mod gather;
mod initialise;
mod observer;
#[cfg(test)]
mod tests;

pub use checkpoint::Checkpoint;
pub use observer::Observer;

use crate::flatten::claims::{Claims, ClaimsMemory, Completeness};
use crate::flatten::expression::{Moment, Stack, evaluate_shared};
use crate::flatten::values::Values;
use crate::flatten::wiring::{OverrideState, Wave, Wiring};
use crate::run::message::{Finish, Reason};
use crate::run::run_options::RunOptions;
use crate::run::worker::{Order, Shutdown, Terminated, Worker};
use gather::UnderWay;
use std::ops::Range;
use unit::failure::Failure;

/// A run of a scenario.
pub struct StepLoop<'a, W> {
    wiring: Wiring,
    workers: Vec<Box<dyn Worker + 'a>>,
    claims: Claims,
    claims_memory: ClaimsMemory,
    options: RunOptions,
    observer: W,
    /// The outputs that `->`, claims and rows read: those of steps that have ended by this tick.
    visible: Values,
    /// The outputs that `=>` reads: those of all steps that were awaited.
    latest: Values,
    /// The inputs that were last passed to a step.
    inputs: Values,
    /// By group, the order whose result is not yet due, if any.
    under_way: Vec<Option<UnderWay>>,
    /// Results that a checkpoint awaited before they are due.
    early: Values,
    /// Instances that have terminated, with the tick at which their step ends.
    terminated: Vec<(u64, Terminated)>,
    /// Whether each condition of `rises` held at the last sample, and whether it rises now.
    held: Vec<bool>,
    rises: Vec<bool>,
    /// The stack of all programs.
    stack: Stack,
    /// The shared expressions, of the visible and of the latest outputs.
    visible_shared: Vec<f64>,
    latest_shared: Vec<f64>,
    next_change: usize,
    /// Which `set` of each override applies.
    overrides: Vec<OverrideState>,
    /// The number of samples that the claims took.
    samples: u64,
}

impl<'a, W: Observer> StepLoop<'a, W> {
    /// A run before initialization.
    pub fn new(
        wiring: Wiring,
        claims: Claims,
        workers: Vec<Box<dyn Worker + 'a>>,
        options: RunOptions,
        observer: W,
    ) -> Self {
        Self {
            visible: wiring.outputs.clone(),
            latest: wiring.outputs.clone(),
            inputs: wiring.inputs.clone(),
            under_way: wiring.groups.iter().map(|_| None).collect(),
            early: wiring.outputs.clone(),
            terminated: Vec::new(),
            held: vec![false; wiring.rises.len()],
            rises: vec![false; wiring.rises.len()],
            stack: Stack::default(),
            visible_shared: vec![0.0; wiring.shared.len()],
            latest_shared: vec![0.0; wiring.shared.len()],
            next_change: 0,
            overrides: wiring.overrides.states(),
            samples: 0,
            claims_memory: claims.memory(),
            wiring,
            workers,
            claims,
            options,
            observer,
        }
    }

    /// Runs to the end, whatever ends it, and reports the final standing of each claim to the observer. With a checkpoint
    /// it begins after the row of the checkpoint.
    ///
    /// # Errors
    /// The run broke.
    pub fn run(&mut self, from: Option<&Checkpoint>) -> Result<Finish, Failure> {
        let restored = self.initialise().and_then(|()| from.map_or(Ok(()), |checkpoint| self.restore(checkpoint)));
        let ended = restored.and_then(|()| self.ticks());
        let completeness = match &ended {
            Ok(Finish { reason: Reason::StopTime | Reason::Terminated(_), .. }) => Completeness::Complete,
            _ => Completeness::CutOff,
        };
        let (observer, last_sample) = (&mut self.observer, self.samples.checked_sub(1));
        let memory = &mut self.claims_memory;
        self.claims.end(memory, last_sample, completeness, |claim, standing| observer.claim(claim, standing));
        ended
    }

    fn ticks(&mut self) -> Result<Finish, Failure> {
        // One sample is taken at each tick.
        let mut tick = self.samples;
        loop {
            let time_s = self.wiring.seconds(tick);
            self.observer.reached(tick);
            if let Some(finish) = self.gather(tick)? {
                return Ok(finish);
            }
            self.judge(tick, time_s);
            if let Some(reason) = self.reason_to_end(tick) {
                self.record(tick);
                return Ok(Finish { last_tick: tick, reason });
            }
            self.take_events(tick);
            self.drive(tick, time_s);
            for wave in 0..self.wiring.waves.len() {
                if let Some(finish) = self.step(wave, tick, time_s)? {
                    self.record(tick);
                    return Ok(finish);
                }
            }
            self.record(tick);
            if self.observer.wants_checkpoint(tick) {
                self.save(tick)?;
            }
            tick += 1;
        }
    }

    /// Claims take the sample of this tick.
    fn judge(&mut self, tick: u64, time_s: f64) {
        let Self { wiring, visible, visible_shared, held, rises, stack, claims_memory, observer, .. } = self;
        evaluate_shared(&wiring.shared, 0..wiring.shared.len(), (visible, time_s), stack, visible_shared);
        for (slot, condition) in wiring.rises.iter().enumerate() {
            let holds = condition.holds(&Moment { outputs: visible, time_s, rises, shared: visible_shared }, stack);
            rises[slot] = holds && !std::mem::replace(&mut held[slot], holds);
        }
        let moment = Moment { outputs: visible, time_s, rises, shared: visible_shared };
        self.claims.take(claims_memory, tick, &moment, stack, |claim, standing| observer.claim(claim, standing));
        self.samples = tick + 1;
    }

    fn reason_to_end(&self, tick: u64) -> Option<Reason> {
        if tick >= self.wiring.stop_tick {
            return Some(Reason::StopTime);
        }
        let due = self.terminated.iter().filter(|(due_tick, _)| *due_tick <= tick);
        if let Some(first) = due.map(|(_, unit)| unit.instance).min() {
            return Some(Reason::Terminated(first));
        }
        let lost = self.claims_memory.lost().filter(|_| self.options.fail_fast).map(Reason::ClaimLost);
        lost.or_else(|| self.observer.stop_requested().then_some(Reason::Interrupted))
    }

    /// Windows close, then open.
    #[inline]
    fn take_events(&mut self, tick: u64) {
        while let Some(change) =
            self.wiring.overrides.changes.get(self.next_change).filter(|change| change.tick <= tick)
        {
            self.overrides[change.target].take(change.effect);
            self.next_change += 1;
        }
    }

    /// `->` brings the visible outputs to the groups that step now.
    fn drive(&mut self, tick: u64, time_s: f64) {
        let moment = Moment { outputs: &self.visible, time_s, rises: &self.rises, shared: &self.visible_shared };
        for (group, feed) in self.wiring.groups.iter().zip(&self.wiring.delayed) {
            if group.is_due(tick) {
                feed.bring(&moment, &mut self.stack, &mut self.inputs);
            }
        }
    }

    /// A wave: all orders go out before the first reply is awaited. A finish means that this tick is the last.
    fn step(&mut self, wave: usize, tick: u64, time_s: f64) -> Result<Option<Finish>, Failure> {
        let Wave { groups, is_fed, is_read } = self.wiring.waves[wave].clone();
        if is_fed {
            let slots = self.wiring.shared_of_wave[wave].iter().copied();
            let now = (&self.latest, time_s);
            evaluate_shared(&self.wiring.shared, slots, now, &mut self.stack, &mut self.latest_shared);
            self.feed(groups.clone(), tick, time_s);
        }
        for index in groups.clone() {
            let group = &self.wiring.groups[index];
            if group.is_due(tick) {
                let order = Order { group: index, tick, inputs: &self.inputs };
                let ticket = self.workers[group.worker].order(&order).map_err(|lost| lost.failure)?;
                self.under_way[index] = Some(UnderWay::Ordered(ticket));
            }
        }
        if is_read { self.await_direct(groups, tick) } else { Ok(None) }
    }

    /// `=>` and `set` drive the inputs of the groups that step in this wave.
    fn feed(&mut self, groups: Range<usize>, tick: u64, time_s: f64) {
        let latest = Moment { outputs: &self.latest, time_s, rises: &self.rises, shared: &self.latest_shared };
        let visible = Moment { outputs: &self.visible, time_s, rises: &self.rises, shared: &self.visible_shared };
        for group in groups.filter(|&group| self.wiring.groups[group].is_due(tick)) {
            self.wiring.direct[group].bring(&latest, &mut self.stack, &mut self.inputs);
            for &target in &self.wiring.overrides.of_group[group] {
                let (target, state) = (&self.wiring.overrides.all[target], self.overrides[target]);
                target.bring(state, &visible, &mut self.stack, &mut self.inputs);
            }
        }
    }

    /// Hands over the row of this tick.
    fn record(&mut self, tick: u64) {
        if self.options.hands_over_rows() {
            let Self { wiring, visible, inputs, observer, .. } = self;
            observer.row(tick, |row| wiring.row.fill(visible, inputs, &row));
        }
    }

    /// Terminates and frees all instances, at the tick that the run has reached.
    ///
    /// # Errors
    /// The first in the script's order that refused.
    pub fn close(&mut self, shutdown: Shutdown) -> Result<(), Failure> {
        let tick = self.samples.saturating_sub(1);
        let lost = self.workers.iter_mut().filter_map(|worker| worker.finish(tick, shutdown).err());
        let lost: Vec<_> = lost.collect();
        lost.into_iter().min_by_key(|lost| lost.instance).map_or(Ok(()), |lost| Err(lost.failure))
    }
}
