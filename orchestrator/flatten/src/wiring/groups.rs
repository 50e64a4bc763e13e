//! Which instances step and deliver together: one order and one reply for each group.

use crate::values::Ranges;
use dsl::scenario::Scenario;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Instances of one worker and wave with equal periods whose results are awaited at the same ticks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Group {
    /// The wave in which it steps.
    pub wave: usize,
    /// The worker that holds it.
    pub worker: usize,
    /// The period in ticks.
    pub every: u64,
    /// A `=>` reads its result in the tick of the order if one of these periods divides the tick; empty if no `=>` reads
    /// it.
    pub read_every: Vec<u64>,
    /// The instances, in the script's order.
    pub instances: Vec<usize>,
    /// The ranges of its outputs.
    pub outputs: Ranges,
}

impl Group {
    /// Whether it is ordered to step at this tick.
    #[inline]
    #[must_use]
    pub fn is_due(&self, tick: u64) -> bool {
        self.every == 1 || tick.is_multiple_of(self.every)
    }

    /// Whether a `=>` reads its result in the tick of the order, so that it is awaited at once.
    #[inline]
    #[must_use]
    pub fn is_read_at(&self, tick: u64) -> bool {
        self.read_every.iter().any(|&every| tick.is_multiple_of(every))
    }

    /// Whether the result of its last order has not yet been awaited at the end of this tick.
    #[must_use]
    pub fn is_under_way_after(&self, tick: u64) -> bool {
        let ordered_tick = tick - tick % self.every;
        self.read_every.iter().all(|every| tick - tick % every < ordered_tick)
    }

    /// The tick at which the order that is under way after this tick is due.
    #[must_use]
    pub fn due_after(&self, tick: u64) -> u64 {
        tick - tick % self.every + self.every
    }
}

/// Forms the groups, ordered by wave, and the range of groups of each wave.
pub fn form(scenario: &Scenario, worker_of: &[usize]) -> (Vec<Group>, Vec<Range<usize>>) {
    let mut readers = vec![BTreeSet::new(); scenario.instances.len()];
    for connection in scenario.connections.iter().filter(|connection| connection.direct) {
        let target_every = scenario.instances[connection.target.instance].every;
        connection.source.reads(scenario.slots(), &mut |port| {
            let source_every = scenario.instances[port.instance].every;
            readers[port.instance].insert(source_every.max(target_every));
        });
    }
    let mut members = BTreeMap::<_, Vec<usize>>::new();
    for (index, instance) in scenario.instances.iter().enumerate() {
        let key = (instance.wave, worker_of[index], instance.every, std::mem::take(&mut readers[index]));
        members.entry(key).or_default().push(index);
    }
    let form = |((wave, worker, every, readers), instances): ((usize, usize, u64, BTreeSet<u64>), Vec<usize>)| {
        // A group that is read at each of its own steps is awaited then: the longer periods of other readers add nothing.
        let read_every = if readers.contains(&every) { vec![every] } else { readers.into_iter().collect() };
        Group { wave, worker, every, read_every, instances, outputs: Ranges::default() }
    };
    let groups: Vec<_> = members.into_iter().map(form).collect();
    let mut waves: Vec<Range<usize>> = Vec::new();
    for (index, group) in groups.iter().enumerate() {
        match waves.last_mut().filter(|wave| groups[wave.start].wave == group.wave) {
            Some(wave) => wave.end = index + 1,
            None => waves.push(index..index + 1),
        }
    }
    (groups, waves)
}
