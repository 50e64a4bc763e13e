//! The worker's side of the protocol: executes orders and composes the replies.
//!
//! Orders come in the sequence hello, open, initialise, start, step, finish. An order at the wrong time or with invalid
//! content ends the worker: its coordinator never sends one, so the sender is not the coordinator or its memory is damaged.
//! A failure of a unit is a regular reply.

use super::LogBuffer;
use crate::bus::link::LONGEST_MESSAGE;
use crate::bus::wire::open_request::{self, GroupSpec, Handshake, Initial, OpenRequest, ReplyExtras, SelectedValues};
use crate::bus::wire::{Blocks, Header, Incoming, Kind, Malformed, Outgoing};
use crate::run::instantiate::{Instantiator, NewInstance, enter_initialization};
use crate::run::message::Message;
use crate::run::run_spec::UnitSpec;
use crate::run::worker::{InProcess, Instantiated, Lost, Order, Shutdown, Ticket, Worker};
use flatten::values::Values;
use flatten::wiring::{Group, InstancePorts, Ports};
use fmi2::description::ModelDescription;
use std::sync::Arc;
use unit::archive::read_unpacked;
use unit::board::Board;
use unit::failure::{Cause, Doing, Failure};

/// The state of one run in its worker.
pub struct Service {
    board: Arc<Board>,
    log_buffer: Arc<LogBuffer>,
    stage: Stage,
    schema: u64,
}

/// The phase of the run.
enum Stage {
    /// No message was received.
    New,
    /// Coordinator and worker have exchanged their versions.
    HandshakeDone,
    /// Instances are instantiated; they are freed when this is dropped.
    Instantiated(Box<HeldInstances>, Vec<Instantiated>),
    /// Instances are in initialization mode or step.
    Initialized(Box<HeldInstances>, Box<InProcess>),
    /// All instances are freed.
    Finished,
}

/// The requested instances with the memory for their inputs and outputs.
struct HeldInstances {
    request: OpenRequest,
    /// By index in the scenario; empty for instances of other workers.
    ports: Vec<InstancePorts>,
    inputs: Values,
    outputs: Values,
}

impl Service {
    pub fn new(board: Arc<Board>, log_buffer: Arc<LogBuffer>) -> Self {
        Self { board, log_buffer, stage: Stage::New, schema: 0 }
    }

    /// Whether no further order is accepted.
    pub fn is_over(&self) -> bool {
        matches!(self.stage, Stage::Finished)
    }

    /// Executes the order in a message and returns the reply.
    ///
    /// # Errors
    /// The message is invalid, or the order comes at the wrong time.
    pub fn execute(&mut self, message: &[u8]) -> Result<Vec<u8>, String> {
        let Incoming { header, mut blocks, extras } =
            Incoming::read(message).map_err(|malformed| malformed.to_string())?;
        let stage = std::mem::replace(&mut self.stage, Stage::Finished);
        let done = match (stage, header.kind) {
            (Stage::New, Kind::Hello) => return self.welcome(header, extras),
            (Stage::HandshakeDone, Kind::Open) => {
                let request = open_request::read(extras).ok_or_else(|| Malformed::ReplyExtras.to_string())?;
                self.open(request)
            }
            (Stage::Instantiated(held, mut instances), Kind::Initialise)
                if open_request::read(extras) == Some(Initial::Enter) =>
            {
                let OpenRequest { start_tick, step_ns, .. } = held.request;
                let entered = enter_initialization(&mut instances, &self.board.note(0), start_tick, step_ns);
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
            // Initialization failed here or in another worker: the instances are freed with the old stage.
            (Stage::Instantiated(..) | Stage::HandshakeDone, Kind::Finish) => Ok(Answer::default()),
            (_, kind) => return Err(format!("a message {kind:?} at the wrong time")),
        };
        blocks.end().map_err(|malformed| malformed.to_string())?;
        Ok(self.reply(header, done))
    }

    fn welcome(&mut self, header: Header, extras: &[u8]) -> Result<Vec<u8>, String> {
        // The coordinator compares the versions. The worker only replies with its own: were it to refuse, the user would not
        // be told which versions differ.
        serde_json::from_slice::<Handshake>(extras).map_err(|_| Malformed::ReplyExtras.to_string())?;
        self.stage = Stage::HandshakeDone;
        let this = serde_json::to_vec(&Handshake::this()).map_err(|error| error.to_string())?;
        Ok(self.begin_reply(header).finish(&this))
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
        // An impossible layout gets the number 0, which the coordinator rejects as different from its own.
        self.schema = request.schema(|unit| descriptions.get(unit).copied()).unwrap_or(0);
        let Some(held) = HeldInstances::new(request, &descriptions) else { return Ok(Answer::default()) };
        let mut instances = Vec::new();
        let log_buffer = Arc::clone(&self.log_buffer);
        let instantiator = Instantiator {
            units: &units,
            folder: &held.request.folder,
            note: self.board.note(0),
            start_tick: held.request.start_tick,
            step_ns: held.request.step_ns,
            sink: Arc::new(move |message| log_buffer.push(&message)),
        };
        let new_instances = held.request.instances.iter().map(|spec| NewInstance {
            index: spec.index,
            name: &spec.name,
            unit: spec.unit,
            presets: &spec.presets,
            log_calls: spec.log_calls,
        });
        let instantiated =
            instantiator.make(new_instances, &mut instances).map_err(|failure| lost(&held.request, failure));
        self.stage = Stage::Instantiated(Box::new(held), instances);
        instantiated.map(|()| Answer::default())
    }

    fn begin_reply(&self, order: Header) -> Outgoing {
        let kind = order.kind.reply().unwrap_or_else(|| unreachable!("{:?} was answered as an order", order.kind));
        Outgoing::new(&Header { kind, schema: self.schema, ..order })
    }

    /// The reply to an order: its result or failure, with what units have logged meanwhile.
    fn reply(&self, order: Header, done: Result<Answer, Lost>) -> Vec<u8> {
        let messages = self.log_buffer.take();
        let reply = self.compose(order, done, messages.clone());
        if reply.len() <= LONGEST_MESSAGE {
            return reply;
        }
        let text = format!("an answer of {} bytes is longer than the {LONGEST_MESSAGE} that can be sent", reply.len());
        let (doing, cause) = (Doing::BetweenCalls, Cause::Other(text));
        let failure = Failure { instance: None, doing, time_s: None, cause };
        let lost = match &self.stage {
            Stage::Instantiated(held, _) | Stage::Initialized(held, _) => lost(&held.request, failure),
            Stage::New | Stage::HandshakeDone | Stage::Finished => Lost { instance: 0, failure },
        };
        self.compose(order, Err(lost), messages)
    }

    fn compose(&self, order: Header, done: Result<Answer, Lost>, messages: Vec<Message>) -> Vec<u8> {
        let mut outgoing = self.begin_reply(order);
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
        outgoing.finish(&ReplyExtras { messages, ..extras }.bytes())
    }
}

/// The result of an order.
#[derive(Default)]
struct Answer {
    extras: ReplyExtras,
    /// The instances whose outputs are in the reply.
    delivered: Vec<usize>,
}

impl Answer {
    fn with(extras: ReplyExtras) -> Self {
        Self { extras, ..Self::default() }
    }
}

impl HeldInstances {
    /// `None` if the request names variables or instances that do not exist.
    fn new(request: OpenRequest, descriptions: &[&ModelDescription]) -> Option<Self> {
        /// More instances than any scenario has: a bound on the memory that a message can request.
        const MOST_INSTANCES: usize = 1 << 20;
        let last = request.instances.iter().map(|instance| instance.index).max();
        let count = last.map_or(Some(0), |last| last.checked_add(1).filter(|&count| count <= MOST_INSTANCES))?;
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
        InProcess::new((self.request.start_tick, self.request.step_ns), &groups, &self.ports, instances, board.note(0))
    }

    /// Executes an order to initialized instances. The outer error is an invalid order, the inner one a unit's failure.
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
                let delivered = self.request.instances.iter().map(|instance| instance.index).collect();
                inner.start(&mut self.outputs).map(|()| Answer { delivered, ..Answer::default() })
            }
            Kind::Step => self.step(inner, header, blocks).map_err(|malformed| malformed.to_string())?,
            Kind::Save => {
                inner.save(header.tick).map(|states| Answer::with(ReplyExtras { states, ..ReplyExtras::default() }))
            }
            Kind::Restore => {
                let states: Vec<(usize, &[u8])> =
                    open_request::read(extras).ok_or_else(|| Malformed::ReplyExtras.to_string())?;
                let held = self.request.instances.iter().map(|instance| instance.index);
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
            Initial::Set(SelectedValues { instance, .. }) | Initial::Get(SelectedValues { instance, .. })
                if !self.request.instances.iter().any(|held| held.index == instance) =>
            {
                None
            }
            Initial::Set(selected) => {
                let slots = selected.slots().filter(|slots| inner.has_variables(selected.instance, slots))?;
                let set = inner.set_initial(selected.instance, &slots, &selected.values);
                Some(set.map(|()| Answer::default()))
            }
            Initial::Get(selected) => {
                let slots = selected.slots().filter(|slots| inner.has_variables(selected.instance, slots))?;
                let SelectedValues { instance, mut values, .. } = selected;
                let got = inner.get_initial(instance, &slots, &mut values);
                Some(got.map(|()| Answer::with(ReplyExtras { values, ..ReplyExtras::default() })))
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

/// Assigns a failure to the instance that it names, else to the first one.
fn lost(request: &OpenRequest, mut failure: Failure) -> Lost {
    let named = request.instances.iter().find(|instance| Some(&instance.name) == failure.instance.as_ref());
    let instance = named.or(request.instances.first());
    failure.instance = failure.instance.or_else(|| instance.map(|instance| instance.name.clone()));
    Lost { instance: instance.map_or(0, |instance| instance.index), failure }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::wire::open_request::bytes;
    use proptest::prelude::*;
    use unit::board::BoardLayout;

    fn service_after_hello() -> Service {
        let board = Arc::new(Board::private(&BoardLayout { notes: 1, columns: 0, claims: 0 }).unwrap());
        let mut service = Service::new(Arc::clone(&board), LogBuffer::new(board));
        let hello = Outgoing::new(&header(Kind::Hello)).finish(&serde_json::to_vec(&Handshake::this()).unwrap());
        service.execute(&hello).unwrap();
        service
    }

    fn header(kind: Kind) -> Header {
        Header { kind, group: 0, schema: 0, sequence: 0, tick: u64::MAX }
    }

    #[test]
    fn an_order_at_the_wrong_time_is_rejected() {
        for kind in [Kind::Hello, Kind::Start, Kind::Step, Kind::Save, Kind::Initialise] {
            assert!(service_after_hello().execute(&Outgoing::new(&header(kind)).finish(&[])).is_err(), "{kind:?}");
        }
    }

    #[test]
    fn an_instance_with_an_impossible_index_or_unit_is_not_instantiated() {
        let spec = |index, unit| open_request::InstanceSpec {
            index,
            name: "a".to_owned(),
            unit,
            presets: Vec::new(),
            log_calls: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
        };
        for instance in [spec(usize::MAX, 0), spec(1 << 40, 0), spec(0, 7)] {
            let (folder, units, groups) = (std::path::PathBuf::new(), Vec::new(), Vec::new());
            let request = OpenRequest { start_tick: 0, step_ns: 1, folder, units, instances: vec![instance], groups };
            let mut service = service_after_hello();
            let reply = service.execute(&Outgoing::new(&header(Kind::Open)).finish(&bytes(&request))).unwrap();
            assert_eq!(Incoming::read(&reply).unwrap().header.schema, 0, "the number of an impossible layout is 0");
            assert!(service.is_over());
        }
    }

    proptest! {
        #[test]
        fn any_message_gets_a_valid_reply_or_is_rejected(
            extras in prop::collection::vec(any::<u8>(), 0..60), kind in 0..8_usize, raw: bool,
        ) {
            let kinds = [
                Kind::Hello, Kind::Open, Kind::Initialise, Kind::Start, Kind::Step, Kind::Finish, Kind::Save, Kind::Restore,
            ];
            let message = if raw { extras } else { Outgoing::new(&header(kinds[kind])).finish(&extras) };
            if let Ok(reply) = service_after_hello().execute(&message) {
                prop_assert!(Incoming::read(&reply).is_ok());
            }
        }
    }
}
