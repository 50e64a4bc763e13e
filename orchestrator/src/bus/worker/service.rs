//! What a worker answers: greeted, told what to held, initialized, started, stepped, finished.

use super::LogBuffer;
use crate::bus::link::LONGEST_MESSAGE;
use crate::bus::wire::open_request::{self, GroupSpec, Handshake, Initial, OpenRequest, Picked, ReplyExtras};
use crate::bus::wire::{Blocks, Header, Incoming, Kind, Malformed, Outgoing};
use crate::flatten::values::Values;
use crate::flatten::wiring::{Group, InstancePorts, Ports};
use crate::run::instantiate::{Instantiator, NewInstance, enter_initialization};
use crate::run::message::Message;
use crate::run::run_spec::UnitSpec;
use crate::run::worker::{InProcess, Instantiated, Lost, Order, Shutdown, Ticket, Worker};
use fmi2::description::ModelDescription;
use std::sync::Arc;
use unit::archive::read_unpacked;
use unit::board::Board;
use unit::failure::{Cause, Doing, Failure};

/// One run as a worker sees it.
pub struct Service {
    board: Arc<Board>,
    log_buffer: Arc<LogBuffer>,
    stage: Stage,
    schema: u64,
}

/// How far the run is.
enum Stage {
    /// No message came yet.
    New,
    /// Coordinator and worker have exchanged their versions.
    HandshakeDone,
    /// Instances are made, and freed with this.
    Instantiated(Box<HeldInstances>, Vec<Instantiated>),
    /// Instances are in initialization mode, or step.
    Initialized(Box<HeldInstances>, Box<InProcess>),
    /// All is freed.
    Finished,
}

/// What was ordered to be held, with places for its values.
struct HeldInstances {
    request: OpenRequest,
    /// By index in the scenario; those of others are empty.
    ports: Vec<InstancePorts>,
    inputs: Values,
    outputs: Values,
}

impl Service {
    pub fn new(board: Arc<Board>, log_buffer: Arc<LogBuffer>) -> Self {
        Self { board, log_buffer, stage: Stage::New, schema: 0 }
    }

    /// Whether the last answer was the last.
    pub fn is_over(&self) -> bool {
        matches!(self.stage, Stage::Finished)
    }

    /// Does what a message says, and answers it.
    ///
    /// # Errors
    /// The message makes no sense: whoever sent it is not to be served.
    pub fn answer(&mut self, message: &[u8]) -> Result<Vec<u8>, String> {
        let Incoming { header, mut blocks, extras } = Incoming::read(message).map_err(|said| said.to_string())?;
        let stage = std::mem::replace(&mut self.stage, Stage::Finished);
        let done = match (stage, header.kind) {
            (Stage::New, Kind::Hello) => return self.shake_hands(header, extras),
            (Stage::HandshakeDone, Kind::Open) => {
                let request = open_request::read(extras).ok_or_else(|| Malformed::ReplyExtras.to_string())?;
                self.open(request)
            }
            (Stage::Instantiated(held, mut instances), Kind::Initialise)
                if open_request::read(extras) == Some(Initial::Enter) =>
            {
                let entered = enter_initialization(&mut instances, &self.board.note(0));
                let entered = entered.map_err(|failure| lost(&held.request, failure));
                let inner = held.stepper(instances, &self.board);
                self.stage = Stage::Initialized(held, Box::new(inner));
                entered.map(|()| Answer::default())
            }
            (Stage::Initialized(mut held, mut inner), kind) => {
                let done = held.execute(&mut inner, kind, header, &mut blocks, extras);
                if kind != Kind::Finish {
                    self.stage = Stage::Initialized(held, inner);
                }
                done?
            }
            // Whoever could not be brought further is freed.
            (Stage::Instantiated(..) | Stage::HandshakeDone, Kind::Finish) => Ok(Answer::default()),
            (_, kind) => return Err(format!("a message {kind:?} at the wrong time")),
        };
        blocks.end().map_err(|said| said.to_string())?;
        Ok(self.tell(header, done))
    }

    fn shake_hands(&mut self, header: Header, extras: &[u8]) -> Result<Vec<u8>, String> {
        // Who calls decides whether we get along; it reads from the answer who we are.
        serde_json::from_slice::<Handshake>(extras).map_err(|_| Malformed::ReplyExtras.to_string())?;
        self.stage = Stage::HandshakeDone;
        let this = serde_json::to_vec(&Handshake::this()).map_err(|error| error.to_string())?;
        Ok(self.reply(header).finish(&this))
    }

    fn open(&mut self, request: OpenRequest) -> Result<Answer, Lost> {
        let mut units = Vec::new();
        for unit in &request.units {
            let description = read_unpacked(&unit.folder).map_err(|error| {
                let (doing, cause) = (Doing::Load, Cause::Other(error.to_string()));
                lost(&request, Failure { instance: None, doing, time_s: None, cause })
            })?;
            let (name, folder, sha256) = (unit.name.clone(), unit.folder.clone(), unit.sha256.clone());
            units.push(UnitSpec { name, folder, description, sha256 });
        }
        let descriptions: Vec<_> = units.iter().map(|unit| &unit.description).collect();
        // A layout that cannot be has no number, and then the coordinator knows.
        self.schema = request.schema(|unit| descriptions.get(unit).copied()).unwrap_or(0);
        let Some(held) = HeldInstances::new(request, &descriptions) else { return Ok(Answer::default()) };
        let mut instances = Vec::new();
        let log_buffer = Arc::clone(&self.log_buffer);
        let instantiator = Instantiator {
            units: &units,
            folder: &held.request.folder,
            note: self.board.note(0),
            step_ns: held.request.step_ns,
            sink: Arc::new(move |told| log_buffer.say(&told)),
        };
        let new_instances = held.request.instances.iter().map(|spec| NewInstance {
            index: spec.index,
            name: &spec.name,
            unit: spec.unit,
            presets: &spec.presets,
            log_calls: spec.log_calls,
        });
        let made = instantiator.make(new_instances, &mut instances).map_err(|failure| lost(&held.request, failure));
        self.stage = Stage::Instantiated(Box::new(held), instances);
        made.map(|()| Answer::default())
    }

    fn reply(&self, order: Header) -> Outgoing {
        let kind = order.kind.reply().unwrap_or_else(|| unreachable!("{:?} was answered as an order", order.kind));
        Outgoing::new(&Header { kind, schema: self.schema, ..order })
    }

    /// The answer to an order, or why there is none, with what units said meanwhile.
    fn tell(&self, order: Header, done: Result<Answer, Lost>) -> Vec<u8> {
        let said = self.log_buffer.take();
        let answer = self.compose(order, done, said.clone());
        if answer.len() <= LONGEST_MESSAGE {
            return answer;
        }
        let text = format!("an answer of {} bytes is longer than the {LONGEST_MESSAGE} that can be sent", answer.len());
        let (doing, cause) = (Doing::BetweenCalls, Cause::Other(text));
        let failure = Failure { instance: None, doing, time_s: None, cause };
        let lost = match &self.stage {
            Stage::Instantiated(held, _) | Stage::Initialized(held, _) => lost(&held.request, failure),
            Stage::New | Stage::HandshakeDone | Stage::Finished => Lost { instance: 0, failure },
        };
        self.compose(order, Err(lost), said)
    }

    fn compose(&self, order: Header, done: Result<Answer, Lost>, said: Vec<Message>) -> Vec<u8> {
        let mut outgoing = self.reply(order);
        let extras = match done {
            Ok(Answer { extras, delivered }) => {
                if let Stage::Initialized(held, _) = &self.stage {
                    for &index in &delivered {
                        outgoing.block(index, &held.ports[index].outputs, &held.outputs);
                    }
                }
                extras
            }
            Err(lost) => ReplyExtras { lost: Some(lost), ..ReplyExtras::default() },
        };
        outgoing.finish(&ReplyExtras { said, ..extras }.bytes())
    }
}

/// What came of an order.
#[derive(Default)]
struct Answer {
    extras: ReplyExtras,
    /// The instances whose outputs go back.
    delivered: Vec<usize>,
}

impl Answer {
    fn saying(extras: ReplyExtras) -> Self {
        Self { extras, ..Self::default() }
    }
}

impl HeldInstances {
    /// `None` if the request names variables or instances that do not exist.
    fn new(request: OpenRequest, descriptions: &[&ModelDescription]) -> Option<Self> {
        /// More instances than any scenario has.
        const TOO_MANY: usize = 1 << 20;
        let last = request.instances.iter().map(|instance| instance.index).max();
        let count = last.map_or(Some(0), |last| last.checked_add(1).filter(|&count| count <= TOO_MANY))?;
        let mut held = Self {
            ports: vec![InstancePorts::default(); count],
            inputs: Values::default(),
            outputs: Values::default(),
            request,
        };
        for instance in &held.request.instances {
            let description = descriptions.get(instance.unit)?;
            if instance.presets.iter().any(|preset| preset.variable >= description.variables.len()) {
                return None;
            }
            let ports = &mut held.ports[instance.index];
            ports.inputs = Ports::place(&instance.inputs, description, &mut held.inputs)?;
            ports.outputs = Ports::place(&instance.outputs, description, &mut held.outputs)?;
        }
        let holds = |index: &usize| held.request.instances.iter().any(|instance| instance.index == *index);
        held.request.groups.iter().all(|group| group.instances.iter().all(holds)).then_some(held)
    }

    fn stepper(&self, instances: Vec<Instantiated>, board: &Board) -> InProcess {
        let group = |GroupSpec { every, instances }: &GroupSpec| Group {
            every: *every,
            instances: instances.clone(),
            ..Group::default()
        };
        let groups: Vec<_> = self.request.groups.iter().map(group).collect();
        InProcess::new(self.request.step_ns, &groups, &self.ports, instances, board.note(0))
    }

    /// Does what seated instances can do.
    fn execute(
        &mut self,
        inner: &mut InProcess,
        kind: Kind,
        header: Header,
        blocks: &mut Blocks<'_>,
        extras: &[u8],
    ) -> Result<Result<Answer, Lost>, String> {
        Ok(match kind {
            Kind::Initialise => {
                let initial = open_request::read(extras).ok_or_else(|| Malformed::ReplyExtras.to_string())?;
                self.initialise(inner, initial).ok_or_else(|| Malformed::ReplyExtras.to_string())?
            }
            Kind::Start => {
                let delivered = self.request.instances.iter().map(|held| held.index).collect();
                inner.start(&mut self.outputs).map(|()| Answer { delivered, ..Answer::default() })
            }
            Kind::Step => self.step(inner, header, blocks).map_err(|said| said.to_string())?,
            Kind::Save => {
                inner.save(header.tick).map(|states| Answer::saying(ReplyExtras { states, ..ReplyExtras::default() }))
            }
            Kind::Restore => {
                let states: Vec<(usize, &[u8])> =
                    open_request::read(extras).ok_or_else(|| Malformed::ReplyExtras.to_string())?;
                let held = self.request.instances.iter().map(|held| held.index);
                if !states.iter().map(|(index, _)| *index).eq(held) {
                    return Err(Malformed::ReplyExtras.to_string());
                }
                inner.restore(header.tick, &states).map(|()| Answer::default())
            }
            Kind::Finish => inner.finish(header.tick, Shutdown::Orderly).map(|()| Answer::default()),
            kind => return Err(format!("a message {kind:?} at the wrong time")),
        })
    }

    fn initialise(&mut self, inner: &mut InProcess, initial: Initial) -> Option<Result<Answer, Lost>> {
        match initial {
            Initial::Enter => None,
            Initial::Set(Picked { instance, .. }) | Initial::Get(Picked { instance, .. })
                if !self.request.instances.iter().any(|held| held.index == instance) =>
            {
                None
            }
            Initial::Set(picked) => {
                let set = inner.set_initial(picked.instance, &picked.picks()?, &picked.values);
                Some(set.map(|()| Answer::default()))
            }
            Initial::Get(picked) => {
                let picks = picked.picks()?;
                let Picked { instance, mut values, .. } = picked;
                let got = inner.get_initial(instance, &picks, &mut values);
                Some(got.map(|()| Answer::saying(ReplyExtras { values, ..ReplyExtras::default() })))
            }
        }
    }

    fn step(
        &mut self,
        inner: &mut InProcess,
        header: Header,
        blocks: &mut Blocks<'_>,
    ) -> Result<Result<Answer, Lost>, Malformed> {
        let group = usize::from(header.group);
        let Some(GroupSpec { every, instances }) = self.request.groups.get(group) else {
            return Err(Malformed::Group(header.group));
        };
        for &index in instances {
            blocks.read(index, &self.ports[index].inputs, &mut self.inputs)?;
        }
        let order = Order { group, tick: header.tick, inputs: &self.inputs };
        let replied = inner.order(&order).and_then(|Ticket { group }| {
            inner.reply(Ticket { group }, header.tick.saturating_add(*every), &mut self.outputs)
        });
        Ok(replied.map(|reply| Answer {
            extras: ReplyExtras { terminated: reply.terminated, ..ReplyExtras::default() },
            delivered: instances.clone(),
        }))
    }
}

/// A failure as one of the instance that it names, or of the first.
fn lost(request: &OpenRequest, mut failure: Failure) -> Lost {
    let named = request.instances.iter().find(|held| Some(&held.name) == failure.instance.as_ref());
    let held = named.or(request.instances.first());
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
        let mut service = Service::new(Arc::clone(&board), LogBuffer::new(board));
        let hello = Outgoing::new(&header(Kind::Hello)).finish(&serde_json::to_vec(&Handshake::this()).unwrap());
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
        let held = |index, unit| open_request::InstanceSpec {
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
            let request = OpenRequest { step_ns: 1, folder, units, instances: vec![instance], groups };
            let mut service = greeted();
            let answer = service.answer(&Outgoing::new(&header(Kind::Open)).finish(&bytes(&request))).unwrap();
            assert_eq!(Incoming::read(&answer).unwrap().header.schema, 0, "a layout that cannot be has no number");
            assert!(service.is_over());
        }
    }

    proptest! {
        #[test]
        fn whatever_comes_is_answered_or_refused(
            extras in prop::collection::vec(any::<u8>(), 0..60), kind in 0..8_usize, raw: bool,
        ) {
            let kinds = [
                Kind::Hello, Kind::Open, Kind::Initialise, Kind::Start, Kind::Step, Kind::Finish, Kind::Save, Kind::Restore,
            ];
            let message = if raw { extras } else { Outgoing::new(&header(kinds[kind])).finish(&extras) };
            // Neither panics, and what is answered is a message.
            if let Ok(answer) = greeted().answer(&message) {
                prop_assert!(Incoming::read(&answer).is_ok());
            }
        }
    }
}
