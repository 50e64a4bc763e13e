//! Takes replies: when each is awaited, where its values are stored, and how a run ends by one.

use super::{CarriedState, Observer, State, StepLoop};
use crate::run::message::{Finish, Reason};
use crate::run::worker::{Lost, Reply, Terminated, Ticket, Worker};
use flatten::values::Values;
use flatten::wiring::Group;
use std::ops::Range;
use unit::failure::Failure;

/// A unit that reached the end of its step may report that time with its own rounding.
const HALF_A_NANOSECOND_S: f64 = 0.5e-9;

/// An order whose result is not yet due.
#[derive(Debug)]
pub(super) enum UnderWay {
    /// Its reply has not been awaited.
    Ordered(Ticket),
    /// A checkpoint awaited its reply early; the values are in [`StepLoop::early`].
    Early(Box<Result<Reply, Lost>>),
}

impl UnderWay {
    /// The units of which an early reply says that they are done for good.
    pub fn terminated(&self) -> &[Terminated] {
        match self {
            Self::Early(result) => result.as_ref().as_ref().map_or(&[], |reply| &reply.terminated),
            Self::Ordered(_) => &[],
        }
    }

    /// The result, now that it is due.
    #[inline]
    fn result(
        self,
        (group, worker): (&Group, &mut (dyn Worker + '_)),
        due_tick: u64,
        early: &Values,
        outputs: &mut Values,
    ) -> Result<Reply, Lost> {
        match self {
            Self::Ordered(ticket) => worker.reply(ticket, due_tick, outputs),
            Self::Early(result) => {
                outputs.copy_ranges(early, &group.outputs);
                *result
            }
        }
    }
}

/// What the results taken at one tick say besides values.
#[derive(Default)]
struct Taken {
    lost: Option<Lost>,
    /// Some Real is no finite number.
    non_finite: bool,
}

impl Taken {
    /// Takes in what a result says, and how its Reals look.
    #[inline]
    fn add(
        &mut self,
        due_tick: u64,
        result: Result<Reply, Lost>,
        reals: &[f64],
        terminated: &mut Vec<(u64, Terminated)>,
    ) {
        match result {
            Ok(reply) if reply.terminated.is_empty() => {}
            Ok(reply) => terminated.extend(reply.terminated.into_iter().map(|unit| (due_tick, unit))),
            Err(lost) => keep_first(&mut self.lost, lost),
        }
        self.non_finite |= !all_finite(reals);
    }
}

impl<W: Observer> StepLoop<'_, W> {
    /// Takes the results of all steps that end at this tick. A finish means that a unit ended before this tick, so that
    /// the row before was the last.
    ///
    /// # Errors
    /// The first instance in the script's order whose step failed, or whose values are not finite.
    pub(super) fn gather(&mut self, tick: u64) -> Result<Option<Finish>, Failure> {
        if tick == self.plan.start_tick {
            return Ok(None);
        }
        let Self { plan, workers, state, .. } = self;
        let State { under_way, visible, latest, early, carried: CarriedState { terminated, .. }, .. } = state;
        let mut taken = Taken::default();
        for (group, order) in plan.groups.iter().zip(under_way).filter(|(group, _)| group.is_due(tick)) {
            let through_latest = !group.read_every.is_empty();
            if let Some(order) = order.take() {
                let outputs = if through_latest { &mut *latest } else { &mut *visible };
                let result = order.result((group, &mut *workers[group.worker]), tick, early, outputs);
                taken.add(tick, result, &outputs.reals[group.outputs.reals.clone()], terminated);
            }
            if through_latest {
                visible.copy_ranges(latest, &group.outputs);
            }
        }
        self.conclude(taken, tick - 1, |group| group.is_due(tick).then_some(tick))
    }

    /// Takes the results that a `=>` reads in the tick of the order. A finish means that a unit ended within its step,
    /// so that nothing is there to be read.
    ///
    /// # Errors
    /// As for [`Self::gather`].
    pub(super) fn await_direct(&mut self, groups: Range<usize>, tick: u64) -> Result<Option<Finish>, Failure> {
        let Self { plan, workers, state, .. } = self;
        let State { under_way, latest, early, carried: CarriedState { terminated, .. }, .. } = state;
        let mut taken = Taken::default();
        let orders = plan.groups[groups.clone()].iter().zip(&mut under_way[groups]);
        for (group, order) in orders.filter(|(group, _)| group.is_read_at(tick)) {
            if let Some(order) = order.take() {
                let due_tick = tick + group.every;
                let result = order.result((group, &mut *workers[group.worker]), due_tick, early, latest);
                taken.add(due_tick, result, &latest.reals[group.outputs.reals.clone()], terminated);
            }
        }
        self.conclude(taken, tick, |group| group.is_read_at(tick).then(|| tick + group.every))
    }

    /// Judges what was taken; `delivered` returns the tick for which a group delivered, if it did.
    #[inline]
    fn conclude(
        &self,
        taken: Taken,
        last_tick: u64,
        delivered: impl Fn(&Group) -> Option<u64>,
    ) -> Result<Option<Finish>, Failure> {
        if taken.lost.is_none() && !taken.non_finite && self.state.carried.terminated.is_empty() {
            return Ok(None);
        }
        if let Some(lost) = taken.lost {
            return Err(lost.failure);
        }
        if let Some(finish) = self.ended_within(last_tick) {
            return Ok(Some(finish));
        }
        self.refuse_non_finite(delivered)?;
        Ok(None)
    }

    /// The finish of a unit that ended before the tick at which its step was to end.
    #[cold]
    fn ended_within(&self, last_tick: u64) -> Option<Finish> {
        let early = |(due_tick, unit): &&(u64, Terminated)| {
            unit.last_successful_time_s < self.plan.seconds(*due_tick) - HALF_A_NANOSECOND_S
        };
        let first = self.state.carried.terminated.iter().filter(early).map(|(_, unit)| unit.instance).min()?;
        Some(Finish { last_tick, reason: Reason::Terminated(first) })
    }

    /// Refuses values that are not finite where they are connected or asserted, in groups that just delivered; `delivered`
    /// returns the tick for which.
    ///
    /// # Errors
    /// The first such variable in the script's order.
    #[cold]
    pub(super) fn refuse_non_finite(&self, delivered: impl Fn(&Group) -> Option<u64>) -> Result<(), Failure> {
        let mut lost = None;
        for group in &self.plan.groups {
            let Some(tick) = delivered(group) else { continue };
            let values = if group.read_every.is_empty() { &self.state.visible } else { &self.state.latest };
            for &instance in &group.instances {
                if let Some(failure) = self.non_finite(instance, &values.reals, tick) {
                    keep_first(&mut lost, Lost { instance, failure });
                }
            }
        }
        lost.map_or(Ok(()), |lost| Err(lost.failure))
    }

    fn non_finite(&self, instance: usize, reals: &[f64], tick: u64) -> Option<Failure> {
        let ports = &self.plan.ports[instance];
        let values = &reals[ports.outputs.reals.range()][..ports.finite];
        let position = values.iter().position(|value| !value.is_finite())?;
        let unit = &self.plan.names[instance];
        let (name, variable) = (unit.instance.clone(), unit.reals[position].clone());
        Some(Failure::non_finite(name, self.plan.seconds(tick), variable, values[position]))
    }
}

/// Whether all are finite: a finite number minus itself is zero, any other gives NaN. There is no branch for each value,
/// so that the compiler can vectorize the loop.
#[inline]
#[expect(clippy::eq_op, reason = "the difference is NaN for values that are not finite")]
fn all_finite(values: &[f64]) -> bool {
    values.iter().fold(0, |bits, value| bits | (value - value).to_bits()) == 0
}

fn keep_first(kept: &mut Option<Lost>, other: Lost) {
    if kept.as_ref().is_none_or(|kept| other.instance < kept.instance) {
        *kept = Some(other);
    }
}

#[test]
fn every_number_but_the_infinite_and_the_undefined_is_finite() {
    for value in [0.0, -0.0, f64::MIN_POSITIVE / 3.0, -f64::MAX, 1.5] {
        assert!(all_finite(&[1.0, value, 2.0, value, 3.0]), "{value}");
    }
    for value in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..5 {
            let mut values = [1.0; 5];
            values[place] = value;
            assert!(!all_finite(&values), "{value} at {place}");
        }
    }
}
