//! The loop: gather, judge, events, drive, step, record, tick for tick.
//!
//! It reads a plan and changes a state. A tick without events and checkpoints allocates nothing, and the loop waits for
//! nothing but its workers. Next on the walk:
//! the workers' units, `fmus/<unit>/src/lib.rs`, and back through `orchestrator/flatten/src/claims/` and `orchestrator/results`.

mod checkpoint;
mod gather;
mod initialise;
mod next_rows;
mod observer;
mod state;

pub use checkpoint::Checkpoint;
pub use observer::Observer;

use crate::run::message::{Finish, Reason};
use crate::run::run_options::RunOptions;
use crate::run::worker::{Order, Shutdown, Worker};
use flatten::claims::Completeness;
use flatten::expression::{Moment, Stack, evaluate_shared};
use flatten::wiring::{Plan, Wave};
use gather::UnderWay;
use state::{CarriedState, State};
use std::ops::Range;
use unit::failure::Failure;

/// A run of a scenario.
pub struct StepLoop<'a, W> {
    plan: Plan,
    state: State,
    workers: Vec<Box<dyn Worker + 'a>>,
    options: RunOptions,
    observer: W,
    /// The stack of all programs.
    stack: Stack,
}

impl<'a, W: Observer> StepLoop<'a, W> {
    /// A run before initialization.
    pub fn new(plan: Plan, workers: Vec<Box<dyn Worker + 'a>>, options: RunOptions, observer: W) -> Self {
        Self { state: State::new(&plan), plan, workers, options, observer, stack: Stack::default() }
    }

    /// Runs to the end, whatever ends it, and reports the final standing of each claim to the observer. With a checkpoint
    /// it begins after the row of the checkpoint.
    ///
    /// # Errors
    /// The run broke.
    pub fn run(&mut self, from: Option<&Checkpoint>) -> Result<Finish, Failure> {
        let restored = self.initialise().and_then(|()| from.map_or(Ok(()), |checkpoint| self.restore(checkpoint)));
        let ended = restored.and_then(|()| self.ticks());
        let stored = self.store_next_rows(|_| true);
        let ended = ended.and_then(|finish| stored.map(|()| finish));
        let completeness = match &ended {
            Ok(Finish { reason: Reason::StopTime | Reason::StopWhen | Reason::Terminated(_), .. }) => {
                Completeness::Complete
            }
            _ => Completeness::CutOff,
        };
        let (observer, last_sample) = (&mut self.observer, self.state.samples.checked_sub(1));
        let memory = &mut self.state.carried.claims;
        self.plan.claims.end(memory, last_sample, completeness, |claim, standing| observer.claim(claim, standing));
        ended
    }

    fn ticks(&mut self) -> Result<Finish, Failure> {
        // One sample is taken at each tick.
        let mut tick = self.state.samples;
        loop {
            let time_s = self.plan.seconds(tick);
            self.observer.reached(tick);
            if let Some(finish) = self.gather(tick)? {
                return Ok(finish);
            }
            if self.state.next_rows.are_due() {
                self.take_next_row(tick)?;
            }
            self.judge(tick, time_s);
            if let Some(reason) = self.reason_to_end(tick) {
                self.record(tick);
                return Ok(Finish { last_tick: tick, reason });
            }
            self.take_events(tick, time_s)?;
            self.drive(tick, time_s);
            for wave in 0..self.plan.waves.len() {
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
        let Self { plan, state, stack, observer, .. } = self;
        let State { visible, visible_shared, carried: CarriedState { conditions, claims, running, .. }, .. } = state;
        plan.running.evaluate(&plan.shared, (visible, time_s, tick), stack, visible_shared, running);
        plan.conditions.take(conditions, (visible, time_s, visible_shared), stack);
        let moment = Moment { outputs: visible, time_s, rises: conditions.rises(), shared: visible_shared };
        plan.claims.take(claims, tick, &moment, stack, |claim, standing| observer.claim(claim, standing));
        state.samples = tick + 1;
    }

    fn reason_to_end(&self, tick: u64) -> Option<Reason> {
        if tick >= self.plan.stop_tick {
            return Some(Reason::StopTime);
        }
        if self.plan.stop_when.is_some_and(|slot| self.state.carried.conditions.holds(slot)) {
            return Some(Reason::StopWhen);
        }
        let due = self.state.carried.terminated.iter().filter(|(due_tick, _)| *due_tick <= tick);
        if let Some(first) = due.map(|(_, unit)| unit.instance).min() {
            return Some(Reason::Terminated(first));
        }
        let lost = self.state.carried.claims.lost().filter(|_| self.options.fail_fast).map(Reason::ClaimLost);
        lost.or_else(|| self.observer.stop_requested().then_some(Reason::Interrupted))
    }

    /// Windows close, then open.
    #[inline]
    fn take_events(&mut self, tick: u64, time_s: f64) -> Result<(), Failure> {
        let Self { plan, state, observer, .. } = self;
        let CarriedState { events, conditions, .. } = &mut state.carried;
        let taken = plan.events.take(events, tick, conditions, |change| observer.window(change));
        taken.map_err(|clash| Failure::between_calls(time_s, clash))
    }

    /// `->` brings the visible outputs to the groups that step now.
    fn drive(&mut self, tick: u64, time_s: f64) {
        let Self { plan, state, stack, .. } = self;
        let State { visible, visible_shared, inputs, carried, .. } = state;
        let moment = Moment { outputs: visible, time_s, rises: carried.conditions.rises(), shared: visible_shared };
        for (group, feed) in plan.groups.iter().zip(&plan.delayed) {
            if group.is_due(tick) {
                feed.bring(&moment, stack, inputs);
            }
        }
    }

    /// A wave: all orders go out before the first reply is awaited. A finish means that this tick is the last.
    fn step(&mut self, wave: usize, tick: u64, time_s: f64) -> Result<Option<Finish>, Failure> {
        let Wave { groups, is_fed, is_read, is_limited } = self.plan.waves[wave].clone();
        if is_fed {
            self.feed(wave, groups.clone(), tick, time_s);
        }
        if is_limited {
            self.check_limits(groups.clone(), tick);
        }
        for index in groups.clone() {
            let group = &self.plan.groups[index];
            if group.is_due(tick) {
                let order = Order { group: index, tick, inputs: &self.state.inputs };
                let ticket = match self.workers[group.worker].order(&order) {
                    Ok(ticket) => ticket,
                    Err(lost) => {
                        // As for a result that is not there when it is due, this row is still complete, unless inputs of
                        // later waves are missing.
                        if wave + 1 == self.plan.waves.len() {
                            self.record(tick);
                        }
                        return Err(lost.failure);
                    }
                };
                self.state.under_way[index] = Some(UnderWay::Ordered(ticket));
            }
        }
        if is_read { self.await_direct(groups, tick) } else { Ok(None) }
    }

    /// `=>` and `set` drive the inputs of the groups that step in this wave, and faults act on them.
    fn feed(&mut self, wave: usize, groups: Range<usize>, tick: u64, time_s: f64) {
        let Self { plan, state, stack, .. } = self;
        let State { visible, visible_shared, latest, latest_shared, initial_inputs, inputs, carried, .. } = state;
        let (CarriedState { conditions, events, .. }, slots) = (carried, plan.shared_of_wave[wave].iter().copied());
        let rises = conditions.rises();
        evaluate_shared(&plan.shared, slots, (latest, time_s), stack, latest_shared);
        let latest = Moment { outputs: latest, time_s, rises, shared: latest_shared };
        let visible = Moment { outputs: visible, time_s, rises, shared: visible_shared };
        for group in groups.filter(|&group| plan.groups[group].is_due(tick)) {
            plan.direct[group].bring(&latest, stack, inputs);
            plan.events.bring((group, tick), events, &visible, stack, (initial_inputs, inputs));
        }
    }

    /// Reports inputs whose values are not allowed, each once in a run.
    fn check_limits(&mut self, groups: Range<usize>, tick: u64) {
        let Self { plan, state, observer, .. } = self;
        let State { unreported, inputs, .. } = state;
        for group in groups.filter(|&group| plan.groups[group].is_due(tick)) {
            unreported[group].retain(|&index| {
                let input = &plan.limits.all[index];
                let missed = input.missed(inputs);
                missed.inspect(|&value| observer.missed_limits(input, value, tick)).is_none()
            });
        }
    }

    /// Hands over the row of this tick.
    fn record(&mut self, tick: u64) {
        if self.options.hands_over_rows() {
            let Self { plan, state, observer, stack, .. } = self;
            let State { visible, visible_shared, inputs, carried, .. } = state;
            observer.row(tick, |row| {
                let (time_s, rises) = (plan.seconds(tick), carried.conditions.rises());
                let moment = Moment { outputs: visible, time_s, rises, shared: visible_shared };
                plan.row.fill(&moment, inputs, stack, &row);
            });
        }
    }

    /// Terminates and frees all instances, at the tick that the run has reached.
    ///
    /// # Errors
    /// The first in the script's order that refused.
    pub fn close(&mut self, shutdown: Shutdown) -> Result<(), Failure> {
        let tick = self.state.samples.saturating_sub(1);
        let lost = self.workers.iter_mut().filter_map(|worker| worker.finish(tick, shutdown).err());
        let lost: Vec<_> = lost.collect();
        lost.into_iter().min_by_key(|lost| lost.instance).map_or(Ok(()), |lost| Err(lost.failure))
    }
}
