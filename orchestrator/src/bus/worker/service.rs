//! What a worker answers: greeted, told what to hold, initialized, started, stepped, finished.

use super::Spoken;
use crate::bus::link::LONGEST_MESSAGE;
use crate::bus::wire::open_request::{self, Aside, Company, Initial, Opening, Picked, Speaker};
use crate::bus::wire::{Blocks, Header, Incoming, Kind, Malformed, Outgoing};
use crate::flatten::values::Values;
use crate::flatten::wiring::{Group, Member, Ports};
use crate::run::instantiate::{Gate, Passenger, enter_initialization};
use crate::run::message::Message;
use crate::run::run_spec::PlannedUnit;
use crate::run::worker::{InProcess, Leaving, Lost, Order, Seating, Ticket, Worker};
use fmi2::description::ModelDescription;
use std::sync::Arc;
use unit::archive::read_unpacked;
use unit::board::Board;
use unit::failure::{Cause, Doing, Failure};

/// One run as a worker sees it.
pub struct Service {
    board: Arc<Board>,
    spoken: Arc<Spoken>,
    stage: Stage,
    schema: u64,
}

/// How far the run is.
enum Stage {
    /// Nobody called yet.
    Silent,
    /// It is known who calls.
    Greeted,
    /// Instances are made, and freed with this.
    Boarded(Box<Hold>, Vec<Seating>),
    /// Instances are in initialization mode, or step.
    Seated(Box<Hold>, Box<InProcess>),
    /// All is freed.
    Over,
}

/// What was ordered to be held, with places for its values.
struct Hold {
    opening: Opening,
    /// By index in the scenario; those of others are empty.
    members: Vec<Member>,
    inputs: Values,
    outputs: Values,
}

impl Service {
    pub fn new(board: Arc<Board>, spoken: Arc<Spoken>) -> Self {
        Self { board, spoken, stage: Stage::Silent, schema: 0 }
    }

    /// Whether the last answer was the last.
    pub fn is_over(&self) -> bool {
        matches!(self.stage, Stage::Over)
    }

    /// Does what a message says, and answers it.
    ///
    /// # Errors
    /// The message makes no sense: whoever sent it is not to be served.
    pub fn answer(&mut self, message: &[u8]) -> Result<Vec<u8>, String> {
        let Incoming { header, mut blocks, aside } = Incoming::read(message).map_err(|said| said.to_string())?;
        let stage = std::mem::replace(&mut self.stage, Stage::Over);
        let done = match (stage, header.kind) {
            (Stage::Silent, Kind::Hello) => return self.greet(header, aside),
            (Stage::Greeted, Kind::Open) => {
                let opening = open_request::read(aside).ok_or_else(|| Malformed::Aside.to_string())?;
                self.open(opening)
            }
            (Stage::Boarded(hold, mut aboard), Kind::Initialise)
                if open_request::read(aside) == Some(Initial::Enter) =>
            {
                let entered = enter_initialization(&mut aboard, &self.board.note(0));
                let entered = entered.map_err(|failure| lost(&hold.opening, failure));
                let inner = hold.seat(aboard, &self.board);
                self.stage = Stage::Seated(hold, Box::new(inner));
                entered.map(|()| Done::default())
            }
            (Stage::Seated(mut hold, mut inner), kind) => {
                let done = hold.obey(&mut inner, kind, header, &mut blocks, aside);
                if kind != Kind::Finish {
                    self.stage = Stage::Seated(hold, inner);
                }
                done?
            }
            // Whoever could not be brought further is freed.
            (Stage::Boarded(..) | Stage::Greeted, Kind::Finish) => Ok(Done::default()),
            (_, kind) => return Err(format!("a message {kind:?} at the wrong time")),
        };
        blocks.end().map_err(|said| said.to_string())?;
        Ok(self.tell(header, done))
    }

    fn greet(&mut self, header: Header, aside: &[u8]) -> Result<Vec<u8>, String> {
        // Who calls decides whether we get along; it reads from the answer who we are.
        serde_json::from_slice::<Speaker>(aside).map_err(|_| Malformed::Aside.to_string())?;
        self.stage = Stage::Greeted;
        let this = serde_json::to_vec(&Speaker::this()).map_err(|error| error.to_string())?;
        Ok(self.reply(header).finish(&this))
    }

    fn open(&mut self, opening: Opening) -> Result<Done, Lost> {
        let mut units = Vec::new();
        for unit in &opening.units {
            let description = read_unpacked(&unit.folder).map_err(|error| {
                let (doing, cause) = (Doing::Load, Cause::Other(error.to_string()));
                lost(&opening, Failure { instance: None, doing, time_s: None, cause })
            })?;
            let (name, folder, sha256) = (unit.name.clone(), unit.folder.clone(), unit.sha256.clone());
            units.push(PlannedUnit { name, folder, description, sha256 });
        }
        let descriptions: Vec<_> = units.iter().map(|unit| &unit.description).collect();
        // A layout that cannot be has no number, and then the coordinator knows.
        self.schema = opening.schema(|unit| descriptions.get(unit).copied()).unwrap_or(0);
        let Some(hold) = Hold::new(opening, &descriptions) else { return Ok(Done::default()) };
        let mut aboard = Vec::new();
        let spoken = Arc::clone(&self.spoken);
        let gate = Gate {
            units: &units,
            folder: &hold.opening.folder,
            note: self.board.note(0),
            step_ns: hold.opening.step_ns,
            sink: Arc::new(move |told| spoken.say(&told)),
        };
        let passengers = hold.opening.instances.iter().map(|held| Passenger {
            index: held.index,
            name: &held.name,
            unit: held.unit,
            presets: &held.presets,
            log_calls: held.log_calls,
        });
        let admitted = gate.admit(passengers, &mut aboard).map_err(|failure| lost(&hold.opening, failure));
        self.stage = Stage::Boarded(Box::new(hold), aboard);
        admitted.map(|()| Done::default())
    }

    fn reply(&self, order: Header) -> Outgoing {
        let kind = order.kind.reply().unwrap_or_else(|| unreachable!("{:?} was answered as an order", order.kind));
        Outgoing::new(&Header { kind, schema: self.schema, ..order })
    }

    /// The answer to an order, or why there is none, with what units said meanwhile.
    fn tell(&self, order: Header, done: Result<Done, Lost>) -> Vec<u8> {
        let said = self.spoken.take();
        let answer = self.compose(order, done, said.clone());
        if answer.len() <= LONGEST_MESSAGE {
            return answer;
        }
        let text = format!("an answer of {} bytes is longer than the {LONGEST_MESSAGE} that can be sent", answer.len());
        let (doing, cause) = (Doing::BetweenCalls, Cause::Other(text));
        let failure = Failure { instance: None, doing, time_s: None, cause };
        let lost = match &self.stage {
            Stage::Boarded(hold, _) | Stage::Seated(hold, _) => lost(&hold.opening, failure),
            Stage::Silent | Stage::Greeted | Stage::Over => Lost { instance: 0, failure },
        };
        self.compose(order, Err(lost), said)
    }

    fn compose(&self, order: Header, done: Result<Done, Lost>, said: Vec<Message>) -> Vec<u8> {
        let mut outgoing = self.reply(order);
        let aside = match done {
            Ok(Done { aside, delivered }) => {
                if let Stage::Seated(hold, _) = &self.stage {
                    for &index in &delivered {
                        outgoing.block(index, &hold.members[index].outputs, &hold.outputs);
                    }
                }
                aside
            }
            Err(lost) => Aside { lost: Some(lost), ..Aside::default() },
        };
        outgoing.finish(&Aside { said, ..aside }.bytes())
    }
}

/// What came of an order.
#[derive(Default)]
struct Done {
    aside: Aside,
    /// The instances whose outputs go back.
    delivered: Vec<usize>,
}

impl Done {
    fn saying(aside: Aside) -> Self {
        Self { aside, ..Self::default() }
    }
}

impl Hold {
    /// `None` if it names variables or instances that are not there.
    fn new(opening: Opening, descriptions: &[&ModelDescription]) -> Option<Self> {
        /// More instances than any scenario has.
        const TOO_MANY: usize = 1 << 20;
        let last = opening.instances.iter().map(|held| held.index).max();
        let count = last.map_or(Some(0), |last| last.checked_add(1).filter(|&count| count <= TOO_MANY))?;
        let mut hold = Self {
            members: vec![Member::default(); count],
            inputs: Values::default(),
            outputs: Values::default(),
            opening,
        };
        for held in &hold.opening.instances {
            let description = descriptions.get(held.unit)?;
            if held.presets.iter().any(|preset| preset.variable >= description.variables.len()) {
                return None;
            }
            let member = &mut hold.members[held.index];
            member.inputs = Ports::place(&held.inputs, description, &mut hold.inputs)?;
            member.outputs = Ports::place(&held.outputs, description, &mut hold.outputs)?;
        }
        let held = |index: &usize| hold.opening.instances.iter().any(|held| held.index == *index);
        hold.opening.groups.iter().all(|company| company.instances.iter().all(held)).then_some(hold)
    }

    fn seat(&self, aboard: Vec<Seating>, board: &Board) -> InProcess {
        let group = |Company { every, instances }: &Company| Group {
            every: *every,
            instances: instances.clone(),
            ..Group::default()
        };
        let groups: Vec<_> = self.opening.groups.iter().map(group).collect();
        InProcess::new(self.opening.step_ns, &groups, &self.members, aboard, board.note(0))
    }

    /// Does what seated instances can do.
    fn obey(
        &mut self,
        inner: &mut InProcess,
        kind: Kind,
        header: Header,
        blocks: &mut Blocks<'_>,
        aside: &[u8],
    ) -> Result<Result<Done, Lost>, String> {
        Ok(match kind {
            Kind::Initialise => {
                let initial = open_request::read(aside).ok_or_else(|| Malformed::Aside.to_string())?;
                self.initialise(inner, initial).ok_or_else(|| Malformed::Aside.to_string())?
            }
            Kind::Start => {
                let delivered = self.opening.instances.iter().map(|held| held.index).collect();
                inner.start(&mut self.outputs).map(|()| Done { delivered, ..Done::default() })
            }
            Kind::Step => self.step(inner, header, blocks).map_err(|said| said.to_string())?,
            Kind::Save => inner.save(header.tick).map(|states| Done::saying(Aside { states, ..Aside::default() })),
            Kind::Restore => {
                let states: Vec<(usize, &[u8])> =
                    open_request::read(aside).ok_or_else(|| Malformed::Aside.to_string())?;
                let held = self.opening.instances.iter().map(|held| held.index);
                if !states.iter().map(|(index, _)| *index).eq(held) {
                    return Err(Malformed::Aside.to_string());
                }
                inner.restore(header.tick, &states).map(|()| Done::default())
            }
            Kind::Finish => inner.finish(header.tick, Leaving::InPeace).map(|()| Done::default()),
            kind => return Err(format!("a message {kind:?} at the wrong time")),
        })
    }

    fn initialise(&mut self, inner: &mut InProcess, initial: Initial) -> Option<Result<Done, Lost>> {
        match initial {
            Initial::Enter => None,
            Initial::Set(Picked { instance, .. }) | Initial::Get(Picked { instance, .. })
                if !self.opening.instances.iter().any(|held| held.index == instance) =>
            {
                None
            }
            Initial::Set(picked) => {
                let set = inner.set_initial(picked.instance, &picked.picks()?, &picked.values);
                Some(set.map(|()| Done::default()))
            }
            Initial::Get(picked) => {
                let picks = picked.picks()?;
                let Picked { instance, mut values, .. } = picked;
                let got = inner.get_initial(instance, &picks, &mut values);
                Some(got.map(|()| Done::saying(Aside { values, ..Aside::default() })))
            }
        }
    }

    fn step(
        &mut self,
        inner: &mut InProcess,
        header: Header,
        blocks: &mut Blocks<'_>,
    ) -> Result<Result<Done, Lost>, Malformed> {
        let group = usize::from(header.group);
        let Some(Company { every, instances }) = self.opening.groups.get(group) else {
            return Err(Malformed::Group(header.group));
        };
        for &index in instances {
            blocks.read(index, &self.members[index].inputs, &mut self.inputs)?;
        }
        let order = Order { group, tick: header.tick, inputs: &self.inputs };
        let replied = inner.order(&order).and_then(|Ticket { group }| {
            inner.reply(Ticket { group }, header.tick.saturating_add(*every), &mut self.outputs)
        });
        Ok(replied.map(|reply| Done {
            aside: Aside { terminated: reply.terminated, ..Aside::default() },
            delivered: instances.clone(),
        }))
    }
}

/// A failure as one of the instance that it names, or of the first.
fn lost(opening: &Opening, mut failure: Failure) -> Lost {
    let named = opening.instances.iter().find(|held| Some(&held.name) == failure.instance.as_ref());
    let held = named.or(opening.instances.first());
    failure.instance = failure.instance.or_else(|| held.map(|held| held.name.clone()));
    Lost { instance: held.map_or(0, |held| held.index), failure }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::wire::open_request::bytes;
    use proptest::prelude::*;
    use unit::board::BoardLayout;

    fn greeted() -> Service {
        let board = Arc::new(Board::private(&BoardLayout { notes: 1, columns: 0, claims: 0 }).unwrap());
        let mut service = Service::new(Arc::clone(&board), Spoken::new(board));
        let hello = Outgoing::new(&header(Kind::Hello)).finish(&serde_json::to_vec(&Speaker::this()).unwrap());
        service.answer(&hello).unwrap();
        service
    }

    fn header(kind: Kind) -> Header {
        Header { kind, group: 0, schema: 0, sequence: 0, tick: u64::MAX }
    }

    #[test]
    fn what_comes_at_the_wrong_time_is_not_served() {
        for kind in [Kind::Hello, Kind::Start, Kind::Step, Kind::Save, Kind::Initialise] {
            assert!(greeted().answer(&Outgoing::new(&header(kind)).finish(&[])).is_err(), "{kind:?}");
        }
    }

    #[test]
    fn instances_without_number_or_unit_are_not_held() {
        let held = |index, unit| open_request::Held {
            index,
            name: "a".to_owned(),
            unit,
            presets: Vec::new(),
            log_calls: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
        };
        for instance in [held(usize::MAX, 0), held(1 << 40, 0), held(0, 7)] {
            let (folder, units, groups) = (std::path::PathBuf::new(), Vec::new(), Vec::new());
            let opening = Opening { step_ns: 1, folder, units, instances: vec![instance], groups };
            let mut service = greeted();
            let answer = service.answer(&Outgoing::new(&header(Kind::Open)).finish(&bytes(&opening))).unwrap();
            assert_eq!(Incoming::read(&answer).unwrap().header.schema, 0, "a layout that cannot be has no number");
            assert!(service.is_over());
        }
    }

    proptest! {
        #[test]
        fn whatever_comes_is_answered_or_refused(
            aside in prop::collection::vec(any::<u8>(), 0..60), kind in 0..8_usize, raw: bool,
        ) {
            let kinds = [
                Kind::Hello, Kind::Open, Kind::Initialise, Kind::Start, Kind::Step, Kind::Finish, Kind::Save, Kind::Restore,
            ];
            let message = if raw { aside } else { Outgoing::new(&header(kinds[kind])).finish(&aside) };
            // Neither panics, and what is answered is a message.
            if let Ok(answer) = greeted().answer(&message) {
                prop_assert!(Incoming::read(&answer).is_ok());
            }
        }
    }
}
