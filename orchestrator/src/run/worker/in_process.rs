//! Instances in this very process: an order is a few calls through function pointers.

use super::{Leaving, Lost, Order, Reply, Terminated, Ticket, Worker};
use crate::flatten::values::Values;
use crate::flatten::wiring::{Group, Member, Pick, Ports, Span};
use fmi2::description::BaseType;
use std::ops::Range;
use unit::board::{Note, Now};
use unit::failure::Failure;
use unit::instance::{Instance, StepResult};
use unit::time::seconds;

/// An instance in initialization mode, with its index in the scenario.
#[derive(Debug)]
pub struct Seating {
    /// The index.
    pub index: usize,
    /// The instance.
    pub instance: Instance,
}

/// Holds instances and steps them when ordered, one after the other.
#[derive(Debug)]
pub struct InProcess {
    note: Note,
    step_ns: u64,
    /// By group and then in the script's order.
    seats: Vec<Seat>,
    /// For each group of the run; those of other workers have no seats.
    teams: Vec<Team>,
}

#[derive(Debug)]
struct Seat {
    instance: Instance,
    inputs: Calls,
    outputs: Calls,
    index: usize,
    failed: bool,
}

/// What goes in or comes out by one call for each type. Kept small: the loop walks over all of them at each tick.
#[derive(Debug)]
struct Calls {
    reals: Call,
    /// Most instances have Reals only.
    others: Option<Box<Others>>,
}

#[derive(Debug)]
struct Others {
    integers: Call,
    booleans: Call,
    texts: Call,
}

/// Values that lie side by side; of none nothing is called.
#[derive(Debug)]
struct Call {
    references: Box<[u32]>,
    start: usize,
}

/// The seats of a group, and what its last step brought besides values.
#[derive(Debug, Default)]
struct Team {
    seats: Range<usize>,
    every: u64,
    step_s: f64,
    lost: Option<Lost>,
    terminated: Vec<Terminated>,
}

impl InProcess {
    /// Seats the instances of one worker, which notes its calls here.
    #[must_use]
    pub fn new(step_ns: u64, groups: &[Group], members: &[Member], seatings: Vec<Seating>, note: Note) -> Self {
        let mut waiting: Vec<Option<Instance>> = std::iter::repeat_with(|| None).take(members.len()).collect();
        for seating in seatings {
            waiting[seating.index] = Some(seating.instance);
        }
        let mut seats = Vec::new();
        let mut team = |group: &Group| {
            let first = seats.len();
            for &index in &group.instances {
                if let Some(instance) = waiting[index].take() {
                    let Member { inputs, outputs, .. } = &members[index];
                    let (inputs, outputs) = (Calls::new(inputs), Calls::new(outputs));
                    seats.push(Seat { instance, inputs, outputs, index, failed: false });
                }
            }
            let step_s = seconds(group.every, step_ns);
            Team { seats: first..seats.len(), every: group.every, step_s, lost: None, terminated: Vec::new() }
        };
        let teams = groups.iter().map(&mut team).collect();
        Self { note, step_ns, seats, teams }
    }
}

/// The seats in the script's order.
fn in_order(seats: &mut [Seat]) -> Vec<&mut Seat> {
    let mut seats: Vec<_> = seats.iter_mut().collect();
    seats.sort_by_key(|seat| seat.index);
    seats
}

fn find(seats: &mut [Seat], index: usize) -> &mut Seat {
    let seat = seats.iter_mut().find(|seat| seat.index == index);
    seat.unwrap_or_else(|| unreachable!("instance {index} is not with this worker"))
}

impl Worker for InProcess {
    fn set_initial(&mut self, instance: usize, picks: &[Pick], inputs: &Values) -> Result<(), Lost> {
        let Self { note, seats, .. } = self;
        let seat = find(seats, instance);
        seat.set_picked(&note.at(0, 0.0), picks, inputs).map_err(|failure| seat.lose(failure))
    }

    fn get_initial(&mut self, instance: usize, picks: &[Pick], outputs: &mut Values) -> Result<(), Lost> {
        let Self { note, seats, .. } = self;
        let seat = find(seats, instance);
        seat.get_picked(&note.at(0, 0.0), picks, outputs).map_err(|failure| seat.lose(failure))
    }

    fn start(&mut self, outputs: &mut Values) -> Result<(), Lost> {
        let now = self.note.at(0, 0.0);
        for seat in in_order(&mut self.seats) {
            let started = seat.instance.exit_initialization_mode(&now).and_then(|()| seat.get(&now, outputs));
            started.map_err(|failure| seat.lose(failure))?;
        }
        Ok(())
    }

    fn order(&mut self, order: &Order<'_>) -> Result<Ticket, Lost> {
        let team = &mut self.teams[order.group];
        let due_tick = order.tick.saturating_add(team.every);
        let now = self.note.counting_at(order.tick, seconds(order.tick, self.step_ns), due_tick);
        for seat in &mut self.seats[team.seats.clone()] {
            match seat.set(&now, order.inputs).and_then(|()| seat.instance.do_step(&now, team.step_s)) {
                Ok(StepResult::Done) => {}
                Ok(StepResult::Terminated { last_successful_time_s }) => {
                    team.terminated.push(Terminated { instance: seat.index, last_successful_time_s });
                }
                Err(failure) => {
                    // The results of those behind it would be dropped together with its own.
                    team.lost = Some(seat.lose(failure));
                    break;
                }
            }
        }
        Ok(Ticket { group: order.group })
    }

    fn reply(&mut self, ticket: Ticket, due_tick: u64, outputs: &mut Values) -> Result<Reply, Lost> {
        let now = self.note.at(due_tick, seconds(due_tick, self.step_ns));
        let team = &mut self.teams[ticket.group];
        if let Some(lost) = team.lost.take() {
            return Err(lost);
        }
        for seat in &mut self.seats[team.seats.clone()] {
            seat.get(&now, outputs).map_err(|failure| seat.lose(failure))?;
        }
        Ok(Reply { terminated: std::mem::take(&mut team.terminated) })
    }

    fn save(&mut self, tick: u64) -> Result<Vec<(usize, Vec<u8>)>, Lost> {
        let now = self.note.at(tick, seconds(tick, self.step_ns));
        let save = |seat: &mut Seat| {
            let state = seat.instance.save(&now).map_err(|failure| seat.lose(failure))?;
            Ok((seat.index, state))
        };
        in_order(&mut self.seats).into_iter().map(save).collect()
    }

    fn restore(&mut self, tick: u64, states: &[(usize, &[u8])]) -> Result<(), Lost> {
        let now = self.note.at(tick, seconds(tick, self.step_ns));
        for &(index, state) in states {
            let seat = find(&mut self.seats, index);
            seat.instance.restore(&now, state).map_err(|failure| seat.lose(failure))?;
        }
        Ok(())
    }

    fn finish(&mut self, tick: u64, _: Leaving) -> Result<(), Lost> {
        let now = self.note.at(tick, seconds(tick, self.step_ns));
        let mut first = Ok(());
        self.seats.sort_by_key(|seat| seat.index);
        for mut seat in self.seats.drain(..) {
            if !seat.failed
                && let Err(failure) = seat.instance.terminate(&now)
            {
                first = first.and(Err(seat.lose(failure)));
            }
            seat.instance.free();
        }
        first
    }
}

impl Calls {
    fn new(ports: &Ports) -> Self {
        let call = |span: &Span| Call { references: span.references.clone().into(), start: span.start };
        let others = [&ports.integers, &ports.booleans, &ports.texts];
        let others = others.iter().any(|span| !span.references.is_empty()).then(|| {
            let [integers, booleans, texts] = others.map(call);
            Box::new(Others { integers, booleans, texts })
        });
        Self { reals: call(&ports.reals), others }
    }
}

impl Call {
    #[inline]
    fn range(&self) -> Range<usize> {
        self.start..self.start + self.references.len()
    }
}

impl Seat {
    #[cold]
    fn lose(&mut self, failure: Failure) -> Lost {
        self.failed = true;
        Lost { instance: self.index, failure }
    }

    #[inline]
    fn set(&mut self, now: &Now<'_>, inputs: &Values) -> Result<(), Failure> {
        let Calls { reals, others } = &self.inputs;
        if !reals.references.is_empty() {
            self.instance.set_real(now, &reals.references, &inputs.reals[reals.range()])?;
        }
        if others.is_some() { self.set_others(now, inputs) } else { Ok(()) }
    }

    #[inline]
    fn get(&mut self, now: &Now<'_>, outputs: &mut Values) -> Result<(), Failure> {
        let Calls { reals, others } = &self.outputs;
        if !reals.references.is_empty() {
            self.instance.get_real(now, &reals.references, &mut outputs.reals[reals.range()])?;
        }
        if others.is_some() { self.get_others(now, outputs) } else { Ok(()) }
    }

    #[inline(never)]
    fn set_others(&mut self, now: &Now<'_>, inputs: &Values) -> Result<(), Failure> {
        let Some(Others { integers, booleans, texts }) = self.inputs.others.as_deref() else { return Ok(()) };
        self.instance.set_integer(now, &integers.references, &inputs.integers[integers.range()])?;
        self.instance.set_boolean(now, &booleans.references, &inputs.booleans[booleans.range()])?;
        self.instance.set_string(now, &texts.references, &inputs.texts[texts.range()])
    }

    #[inline(never)]
    fn get_others(&mut self, now: &Now<'_>, outputs: &mut Values) -> Result<(), Failure> {
        let Some(Others { integers, booleans, texts }) = self.outputs.others.as_deref() else { return Ok(()) };
        self.instance.get_integer(now, &integers.references, &mut outputs.integers[integers.range()])?;
        self.instance.get_boolean(now, &booleans.references, &mut outputs.booleans[booleans.range()])?;
        self.instance.get_string(now, &texts.references, &mut outputs.texts[texts.range()])
    }

    fn set_picked(&mut self, now: &Now<'_>, picks: &[Pick], inputs: &Values) -> Result<(), Failure> {
        let [reals, integers, booleans, texts] = by_type(picks);
        self.instance.set_real(now, &reals.references, &reals.out_of(&inputs.reals))?;
        self.instance.set_integer(now, &integers.references, &integers.out_of(&inputs.integers))?;
        self.instance.set_boolean(now, &booleans.references, &booleans.out_of(&inputs.booleans))?;
        self.instance.set_string(now, &texts.references, &texts.out_of(&inputs.texts))
    }

    fn get_picked(&mut self, now: &Now<'_>, picks: &[Pick], outputs: &mut Values) -> Result<(), Failure> {
        let [reals, integers, booleans, texts] = by_type(picks);
        reals.fetch(&mut outputs.reals, |to| self.instance.get_real(now, &reals.references, to))?;
        integers.fetch(&mut outputs.integers, |to| self.instance.get_integer(now, &integers.references, to))?;
        booleans.fetch(&mut outputs.booleans, |to| self.instance.get_boolean(now, &booleans.references, to))?;
        texts.fetch(&mut outputs.texts, |to| self.instance.get_string(now, &texts.references, to))
    }
}

/// Variables of one type whose values lie anywhere.
struct Scattered {
    references: Vec<u32>,
    at: Vec<usize>,
}

fn by_type(picks: &[Pick]) -> [Scattered; 4] {
    [BaseType::Real, BaseType::Integer, BaseType::Boolean, BaseType::String].map(|base| {
        let of_type = picks.iter().filter(|pick| pick.slot.base == base);
        let (references, at) = of_type.map(|pick| (pick.reference, pick.slot.index)).unzip();
        Scattered { references, at }
    })
}

impl Scattered {
    fn out_of<T: Clone>(&self, values: &[T]) -> Vec<T> {
        self.at.iter().map(|&at| values[at].clone()).collect()
    }

    fn fetch<T: Clone>(
        &self,
        values: &mut [T],
        get: impl FnOnce(&mut [T]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let mut got = self.out_of(values);
        get(&mut got)?;
        for (&at, value) in self.at.iter().zip(got) {
            values[at] = value;
        }
        Ok(())
    }
}

#[test]
fn variables_are_asked_for_by_type_and_their_values_go_to_their_places() {
    use crate::flatten::values::Slot;
    let pick = |base, index, reference| Pick { slot: Slot { base, index }, reference };
    let (real, integer) = (BaseType::Real, BaseType::Integer);
    let [reals, integers, booleans, texts] = by_type(&[pick(real, 3, 30), pick(integer, 0, 31), pick(real, 1, 10)]);
    assert_eq!((reals.references.as_slice(), integers.references.as_slice()), ([30, 10].as_slice(), [31].as_slice()));
    assert!(booleans.references.is_empty() && texts.references.is_empty());
    let mut values = [0.0, 1.0, 2.0, 3.0];
    assert_eq!(reals.out_of(&values), [3.0, 1.0]);
    let answered = reals.fetch(&mut values, |to| {
        to.copy_from_slice(&[30.0, 10.0]);
        Ok(())
    });
    assert_eq!((answered, values), (Ok(()), [0.0, 10.0, 2.0, 30.0]));
}
