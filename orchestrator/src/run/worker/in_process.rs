//! The worker that holds its instances in this process: an order is a few calls through function pointers.

use super::scattered::{get_slots, handles, set_slots};
use super::{Lost, Order, Reply, Shutdown, Terminated, Ticket, Worker};
use crate::run::instantiate::at_start;
use crate::run::start_values::StartValues;
use flatten::values::Values;
use flatten::wiring::{Group, InstancePorts, Ports, VariableRange, VariableSlot};
use std::collections::BTreeMap;
use std::ops::Range;
use unit::board::{Note, Now};
use unit::failure::Failure;
use unit::handles::Handles;
use unit::instance::{Instance, StepResult};
use unit::process_state::{Changes, compare_each_step, restored_floating_point};
use unit::time::seconds;

/// An instance in initialization mode, with its index in the scenario.
#[derive(Debug)]
pub struct Instantiated {
    /// The index.
    pub index: usize,
    /// The instance.
    pub instance: Instance,
    /// What it is given at the start.
    pub start_values: StartValues,
}

/// Holds instances and steps them when ordered, one after the other.
#[derive(Debug)]
pub struct InProcess {
    note: Note,
    start_tick: u64,
    step_ns: u64,
    /// The instances, by group and then in the script's order.
    held: Vec<HeldInstance>,
    /// For each instance of the run its place in `held`, if it is with this worker.
    places: Vec<Option<usize>>,
    /// For each group of the run; the range of a group of another worker is empty.
    groups: Vec<GroupSteps>,
    /// The start values by the index of their instance, until initialization ends.
    start_values: BTreeMap<usize, StartValues>,
    /// Whether a step was ordered.
    steps: bool,
}

#[derive(Debug)]
struct HeldInstance {
    instance: Instance,
    inputs: Calls,
    outputs: Calls,
    index: usize,
    failed: bool,
}

/// The variables that are set or read with one call for each type. Kept small, since the loop visits all of them at
/// each tick.
#[derive(Debug)]
struct Calls {
    reals: Call,
    /// `None` for the many instances that have Reals only.
    others: Option<Box<Others>>,
}

#[derive(Debug)]
struct Others {
    integers: Call,
    booleans: Call,
    texts: Call,
}

/// Variables whose values are contiguous; without any, no call is made.
#[derive(Debug)]
struct Call {
    handles: Handles,
    start: usize,
}

/// The instances of a group, as a range of [`InProcess::held`], and the result of its last step besides values.
#[derive(Debug, Default)]
struct GroupSteps {
    held: Range<usize>,
    every: u64,
    step_s: f64,
    lost: Option<Lost>,
    terminated: Vec<Terminated>,
}

impl InProcess {
    /// Makes a worker of these instances, for a run that begins at a tick; their calls are noted in `note`.
    #[must_use]
    pub fn new(
        (start_tick, step_ns): (u64, u64),
        groups: &[Group],
        ports: &[InstancePorts],
        instances: Vec<Instantiated>,
        note: Note,
    ) -> Self {
        let mut waiting: Vec<Option<Instance>> = std::iter::repeat_with(|| None).take(ports.len()).collect();
        let mut start_values = BTreeMap::new();
        for made in instances {
            waiting[made.index] = Some(made.instance);
            start_values.insert(made.index, made.start_values);
        }
        let (mut held, mut places) = (Vec::new(), vec![None; ports.len()]);
        let mut group = |group: &Group| {
            let first = held.len();
            for &index in &group.instances {
                if let Some(instance) = waiting[index].take() {
                    let InstancePorts { inputs, outputs, .. } = &ports[index];
                    let (inputs, outputs) = (Calls::new(&instance, inputs), Calls::new(&instance, outputs));
                    places[index] = Some(held.len());
                    held.push(HeldInstance { instance, inputs, outputs, index, failed: false });
                }
            }
            let step_s = seconds(group.every, step_ns);
            GroupSteps { held: first..held.len(), every: group.every, step_s, lost: None, terminated: Vec::new() }
        };
        let groups = groups.iter().map(&mut group).collect();
        Self { note, start_tick, step_ns, held, places, groups, start_values, steps: false }
    }
}

/// The instances in the script's order.
fn in_order(held: &mut [HeldInstance]) -> Vec<&mut HeldInstance> {
    let mut held: Vec<_> = held.iter_mut().collect();
    held.sort_by_key(|held| held.index);
    held
}

fn find<'h>(held: &'h mut [HeldInstance], places: &[Option<usize>], index: usize) -> &'h mut HeldInstance {
    let place = places[index].unwrap_or_else(|| unreachable!("instance {index} is not with this worker"));
    &mut held[place]
}

impl Worker for InProcess {
    fn set_initial(&mut self, instance: usize, slots: &[VariableSlot], inputs: &Values) -> Result<(), Lost> {
        if let Some(start_values) = self.start_values.get_mut(&instance) {
            start_values.are_replaced(slots);
        }
        let now = at_start(&self.note, self.start_tick, self.step_ns);
        let held = find(&mut self.held, &self.places, instance);
        set_slots(&mut held.instance, &now, slots, inputs).map_err(|failure| held.lose(failure))
    }

    fn get_initial(&mut self, instance: usize, slots: &[VariableSlot], outputs: &mut Values) -> Result<(), Lost> {
        let now = at_start(&self.note, self.start_tick, self.step_ns);
        let held = find(&mut self.held, &self.places, instance);
        get_slots(&mut held.instance, &now, slots, outputs).map_err(|failure| held.lose(failure))
    }

    fn start(&mut self, outputs: &mut Values) -> Result<(), Lost> {
        // A batch for each step of this, since start values and outputs are read by the same function.
        let now = || at_start(&self.note, self.start_tick, self.step_ns);
        for held in in_order(&mut self.held) {
            let start_values = self.start_values.remove(&held.index);
            let started = held.instance.exit_initialization_mode(&now());
            let started = started.and_then(|()| match start_values {
                Some(start_values) => start_values.compare_held(&mut held.instance, &now()),
                None => Ok(()),
            });
            started.and_then(|()| held.get(&now(), outputs)).map_err(|failure| held.lose(failure))?;
        }
        Ok(())
    }

    fn order(&mut self, order: &Order<'_>) -> Result<Ticket, Lost> {
        if !std::mem::replace(&mut self.steps, true) {
            compare_each_step();
        }
        let group = &mut self.groups[order.group];
        let due_tick = order.tick.saturating_add(group.every);
        let now = self.note.counting_at(order.tick, seconds(order.tick, self.step_ns), due_tick);
        for held in &mut self.held[group.held.clone()] {
            match held.set(&now, order.inputs).and_then(|()| held.instance.do_step(&now, group.step_s)) {
                Ok(StepResult::Done) => {}
                Ok(StepResult::Terminated { last_successful_time_s }) => {
                    group.terminated.push(Terminated { instance: held.index, last_successful_time_s });
                }
                // No other instance of its library may be called until the reply is due.
                Err(failure) if held.instance.is_dead() => return Err(held.lose(failure)),
                Err(failure) => {
                    // The reply of the group is an error now, so the results of later instances would be dropped.
                    group.lost = Some(held.lose(failure));
                    break;
                }
            }
        }
        Ok(Ticket { group: order.group })
    }

    fn reply(&mut self, ticket: Ticket, due_tick: u64, outputs: &mut Values) -> Result<Reply, Lost> {
        let now = self.note.at(due_tick, seconds(due_tick, self.step_ns));
        let group = &mut self.groups[ticket.group];
        if let Some(lost) = group.lost.take() {
            return Err(lost);
        }
        for held in &mut self.held[group.held.clone()] {
            held.get(&now, outputs).map_err(|failure| held.lose(failure))?;
        }
        let changes = restored_floating_point();
        if changes != Changes::NONE {
            read_again(&mut self.held[group.held.clone()], &now, outputs, changes)?;
        }
        Ok(Reply { terminated: std::mem::take(&mut group.terminated) })
    }

    fn save(&mut self, tick: u64) -> Result<Vec<(usize, Vec<u8>)>, Lost> {
        let now = self.note.at(tick, seconds(tick, self.step_ns));
        let save = |held: &mut HeldInstance| {
            let state = held.instance.save(&now).map_err(|failure| held.lose(failure))?;
            Ok((held.index, state))
        };
        in_order(&mut self.held).into_iter().map(save).collect()
    }

    fn restore(&mut self, tick: u64, states: &[(usize, &[u8])]) -> Result<(), Lost> {
        let now = self.note.at(tick, seconds(tick, self.step_ns));
        for &(index, state) in states {
            let held = find(&mut self.held, &self.places, index);
            held.instance.restore(&now, state).map_err(|failure| held.lose(failure))?;
        }
        Ok(())
    }

    fn finish(&mut self, tick: u64, _: Shutdown) -> Result<(), Lost> {
        let now = self.note.at(tick, seconds(tick, self.step_ns));
        let mut first = Ok(());
        self.held.sort_by_key(|held| held.index);
        for mut held in self.held.drain(..) {
            if !held.failed
                && let Err(failure) = held.instance.terminate(&now)
            {
                first = first.and(Err(held.lose(failure)));
            }
            held.instance.free();
        }
        unit::process::await_copies();
        first
    }
}

/// Reads outputs a second time: a call that read one of them changed floating-point control, so that those after it may be
/// wrong. Now every call is compared and named.
#[cold]
fn read_again(held: &mut [HeldInstance], now: &Now<'_>, outputs: &mut Values, changes: Changes) -> Result<(), Lost> {
    for held in &mut *held {
        held.get(now, outputs).map_err(|failure| held.lose(failure))?;
    }
    let reported = held.iter().any(|held| held.instance.reported_floating_point());
    if let Some(first) = held.first_mut().filter(|_| !reported) {
        first.instance.changed_by_reading(now, changes);
    }
    Ok(())
}

impl Calls {
    fn new(instance: &Instance, ports: &Ports) -> Self {
        let call = |range: &VariableRange| Call { handles: handles(instance, &range.variables), start: range.start };
        let others = [&ports.integers, &ports.booleans, &ports.texts];
        let others = others.iter().any(|range| !range.variables.is_empty()).then(|| {
            let [integers, booleans, texts] = others.map(call);
            Box::new(Others { integers, booleans, texts })
        });
        Self { reals: call(&ports.reals), others }
    }
}

impl InProcess {
    /// Whether an instance has all of these variables: a request from another process may name others.
    #[must_use]
    pub fn has_variables(&self, instance: usize, slots: &[VariableSlot]) -> bool {
        let place = self.places.get(instance).copied().flatten();
        place.is_some_and(|at| self.held[at].instance.handles(slots.iter().map(|slot| slot.variable)).is_some())
    }
}

impl Call {
    #[inline]
    fn range(&self) -> Range<usize> {
        self.start..self.start + self.handles.len()
    }
}

impl HeldInstance {
    #[cold]
    fn lose(&mut self, failure: Failure) -> Lost {
        self.failed = true;
        Lost { instance: self.index, failure }
    }

    #[inline]
    fn set(&mut self, now: &Now<'_>, inputs: &Values) -> Result<(), Failure> {
        let Calls { reals, others } = &self.inputs;
        if !reals.handles.is_empty() {
            self.instance.set_real(now, &reals.handles, &inputs.reals[reals.range()])?;
        }
        if others.is_some() { self.set_others(now, inputs) } else { Ok(()) }
    }

    #[inline(always)]
    fn get(&mut self, now: &Now<'_>, outputs: &mut Values) -> Result<(), Failure> {
        let Calls { reals, others } = &self.outputs;
        if !reals.handles.is_empty() {
            self.instance.get_real(now, &reals.handles, &mut outputs.reals[reals.range()])?;
        }
        if others.is_some() { self.get_others(now, outputs) } else { Ok(()) }
    }

    #[inline(never)]
    fn set_others(&mut self, now: &Now<'_>, inputs: &Values) -> Result<(), Failure> {
        let Some(Others { integers, booleans, texts }) = self.inputs.others.as_deref() else { return Ok(()) };
        self.instance.set_integer(now, &integers.handles, &inputs.integers[integers.range()])?;
        self.instance.set_boolean(now, &booleans.handles, &inputs.booleans[booleans.range()])?;
        self.instance.set_string(now, &texts.handles, &inputs.texts[texts.range()])
    }

    #[inline(never)]
    fn get_others(&mut self, now: &Now<'_>, outputs: &mut Values) -> Result<(), Failure> {
        let Some(Others { integers, booleans, texts }) = self.outputs.others.as_deref() else { return Ok(()) };
        self.instance.get_integer(now, &integers.handles, &mut outputs.integers[integers.range()])?;
        self.instance.get_boolean(now, &booleans.handles, &mut outputs.booleans[booleans.range()])?;
        self.instance.get_string(now, &texts.handles, &mut outputs.texts[texts.range()])
    }
}
