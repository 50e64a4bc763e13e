//! Replies: when each is awaited, where its values go, and what it may say.

use super::{StepLoop, Witness};
use crate::failure::{Cause, Doing, Failure};
use crate::message::{Finish, Reason};
use crate::values::Values;
use crate::wiring::Group;
use crate::worker::{Lost, Reply, Terminated, Ticket, Worker};
use fmi2::calls::Call;
use std::ops::Range;

/// A unit that reached the end of its step may say so in its own rounding.
const HALF_A_NANOSECOND_S: f64 = 0.5e-9;

/// An order whose result is not yet due.
#[derive(Debug)]
pub(super) enum UnderWay {
    /// Nobody has asked for its reply.
    Ordered(Ticket),
    /// A checkpoint asked early; the values lie aside.
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

impl<W: Witness> StepLoop<'_, W> {
    /// Takes the results of all steps that end at this tick. A finish means that a unit ended before this tick, so that
    /// the row before was the last.
    ///
    /// # Errors
    /// The first instance in the script's order whose step failed, or whose values are none.
    pub(super) fn gather(&mut self, tick: u64) -> Result<Option<Finish>, Failure> {
        if tick == 0 {
            return Ok(None);
        }
        let mut lost = None;
        for index in 0..self.wiring.groups.len() {
            let group = &self.wiring.groups[index];
            if !group.is_due(tick) {
                continue;
            }
            let through_latest = !group.read_every.is_empty();
            if let Some(order) = self.under_way[index].take() {
                let outputs = if through_latest { &mut self.latest } else { &mut self.visible };
                match order.result((group, &mut *self.workers[group.worker]), tick, &self.early, outputs) {
                    Ok(reply) => self.terminated.extend(reply.terminated.into_iter().map(|unit| (tick, unit))),
                    Err(other) => keep_first(&mut lost, other),
                }
            }
            if through_latest {
                self.visible.copy_ranges(&self.latest, &self.wiring.groups[index].outputs);
            }
        }
        if let Some(lost) = lost {
            return Err(lost.failure);
        }
        if let Some(finish) = self.ended_within(tick - 1) {
            return Ok(Some(finish));
        }
        self.refuse_non_finite(0..self.wiring.groups.len(), |group| group.is_due(tick).then_some(tick))?;
        Ok(None)
    }

    /// Takes the results that a `=>` reads in the tick of the order. A finish means that a unit ended within its step,
    /// so that nothing is there to be read.
    ///
    /// # Errors
    /// As for [`Self::gather`].
    pub(super) fn await_direct(&mut self, groups: Range<usize>, tick: u64) -> Result<Option<Finish>, Failure> {
        let mut lost = None;
        for index in groups.clone() {
            let group = &self.wiring.groups[index];
            if !group.is_read_at(tick) {
                continue;
            }
            if let Some(order) = self.under_way[index].take() {
                let (due_tick, worker) = (tick + group.every, &mut *self.workers[group.worker]);
                match order.result((group, worker), due_tick, &self.early, &mut self.latest) {
                    Ok(reply) => self.terminated.extend(reply.terminated.into_iter().map(|unit| (due_tick, unit))),
                    Err(other) => keep_first(&mut lost, other),
                }
            }
        }
        if let Some(lost) = lost {
            return Err(lost.failure);
        }
        if let Some(finish) = self.ended_within(tick) {
            return Ok(Some(finish));
        }
        self.refuse_non_finite(groups, |group| group.is_read_at(tick).then(|| tick + group.every))?;
        Ok(None)
    }

    /// The finish of a unit that ended before the tick at which its step was to end.
    fn ended_within(&self, last_tick: u64) -> Option<Finish> {
        let early = |(due_tick, unit): &&(u64, Terminated)| {
            unit.last_successful_time_s < self.wiring.seconds(*due_tick) - HALF_A_NANOSECOND_S
        };
        let first = self.terminated.iter().filter(early).map(|(_, unit)| unit.instance).min()?;
        Some(Finish { last_tick, reason: Reason::Terminated(first) })
    }

    /// Refuses values that are no numbers where they are connected or asserted, in groups that just delivered;
    /// `delivered` tells for which tick.
    ///
    /// # Errors
    /// The first such variable in the script's order.
    pub(super) fn refuse_non_finite(
        &self,
        groups: Range<usize>,
        delivered: impl Fn(&Group) -> Option<u64>,
    ) -> Result<(), Failure> {
        let mut lost = None;
        for group in &self.wiring.groups[groups] {
            let Some(tick) = delivered(group) else { continue };
            let values = if group.read_every.is_empty() { &self.visible } else { &self.latest };
            let block = &values.reals[group.outputs.reals.clone()];
            // Without a branch for each value, so that it takes several at once.
            if block.iter().fold(true, |finite, value| finite & value.is_finite()) {
                continue;
            }
            for &instance in &group.instances {
                if let Some(failure) = self.non_finite(instance, &values.reals, tick) {
                    keep_first(&mut lost, Lost { instance, failure });
                }
            }
        }
        lost.map_or(Ok(()), |lost| Err(lost.failure))
    }

    #[cold]
    fn non_finite(&self, instance: usize, reals: &[f64], tick: u64) -> Option<Failure> {
        let member = &self.wiring.members[instance];
        let values = &reals[member.outputs.reals.range()][..member.finite];
        let position = values.iter().position(|value| !value.is_finite())?;
        let unit = &self.wiring.names[instance];
        Some(Failure {
            instance: Some(unit.instance.clone()),
            doing: Doing::Call(Call::GetReal),
            time_s: Some(self.wiring.seconds(tick)),
            cause: Cause::NonFinite { variable: unit.reals[position].clone(), value: values[position].to_string() },
        })
    }
}

fn keep_first(kept: &mut Option<Lost>, other: Lost) {
    if kept.as_ref().is_none_or(|kept| other.instance < kept.instance) {
        *kept = Some(other);
    }
}
