//! Instances in another process: an order is a message, and so is its reply.
//!
//! An answer is awaited when it is due, for as long as a call of a unit may take and as long as the process gives signs of
//! life. Of a process that died or hangs its board still tells in which call that was.

mod answers;
#[cfg(test)]
mod tests;

use super::hang_monitor::HangMonitor;
use super::worker_processes::WorkerProcesses;
use crate::bus::link::Link;
use crate::bus::wire::open_request::{
    GroupSpec, Handshake, Initial, InstanceSpec, OpenRequest, Picked, ReplyExtras, Unit, bytes,
};
use crate::bus::wire::{Header, Kind, Outgoing};
use crate::bus::worker::Address;
use crate::flatten::values::Values;
use crate::flatten::wiring::{InstancePorts, VariableSlot, Wiring};
use crate::host::supervise::failure;
use crate::run::message::MessageSink;
use crate::run::run_spec::RunSpec;
use crate::run::worker::{Lost, Order, Reply, Shutdown, Ticket, Worker};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use unit::board::Board;
use unit::failure::{Cause, Failure};

/// How long a process may take to come up, on a machine on which many do.
const START_DEADLINE: Duration = Duration::from_secs(30);

/// What leads to a worker.
#[derive(Debug)]
pub struct WorkerHandle {
    /// Where it is.
    pub address: Address,
    /// Its board.
    pub board: Arc<Board>,
    /// The processes, its own among them.
    pub processes: Arc<WorkerProcesses>,
    /// Who looks after them.
    pub hang_monitor: Arc<HangMonitor>,
}

/// A worker in another process.
pub struct Remote<'a> {
    spec: &'a RunSpec,
    handle: WorkerHandle,
    link: Option<Link>,
    /// Where words and calls of its units go.
    sink: MessageSink,
    schema: u64,
    /// Its instances with their ports, in the script's order.
    ports: Vec<(usize, InstancePorts)>,
    /// Its groups, by their number in the run, with their number here and their instances.
    groups: BTreeMap<usize, (u16, GroupSpec)>,
    request: OpenRequest,
    orders: u64,
    /// SuperviseRequest whose replies nobody has awaited: what they were, by the group.
    under_way: BTreeMap<usize, PendingOrder>,
    /// Replies that came before they were awaited, by the number of their order.
    early: BTreeMap<u64, Vec<u8>>,
    dead: Option<Lost>,
}

/// An order whose reply is to be awaited.
#[derive(Clone, Copy, Debug)]
pub struct PendingOrder {
    header: Header,
}

impl std::fmt::Debug for Remote<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Remote").field("way", &self.handle).field("orders", &self.orders).finish_non_exhaustive()
    }
}

impl<'a> Remote<'a> {
    /// Calls the worker at this address, which is to hold what the wiring gives to a worker of its number.
    ///
    /// # Errors
    /// It did not come up.
    pub fn connect(
        spec: &'a RunSpec,
        wiring: &Wiring,
        handle: WorkerHandle,
        sink: MessageSink,
        run: &str,
    ) -> Result<Self, Failure> {
        let number = handle.address.number;
        let of_worker = wiring.groups.iter().enumerate().filter(|(_, group)| group.worker == number);
        let groups = of_worker.zip(0..).map(|((index, group), local)| {
            (index, (local, GroupSpec { every: group.every, instances: group.instances.clone() }))
        });
        let groups: BTreeMap<_, _> = groups.collect();
        let mut held: Vec<usize> = groups.values().flat_map(|(_, company)| company.instances.clone()).collect();
        held.sort_unstable();
        let ports: Vec<_> = held.iter().map(|&index| (index, wiring.ports[index].clone())).collect();
        let request = request(spec, &ports, groups.values().map(|(_, company)| company.clone()).collect());
        let mut remote = Self {
            spec,
            handle,
            link: None,
            sink,
            schema: 0,
            ports,
            groups,
            request,
            orders: 0,
            under_way: BTreeMap::new(),
            early: BTreeMap::new(),
            dead: None,
        };
        remote.call(run)?;
        Ok(remote)
    }

    /// Says who calls.
    ///
    /// # Errors
    /// The worker is gone.
    pub fn shake_hands(&mut self) -> Result<PendingOrder, Lost> {
        let this = serde_json::to_vec(&Handshake::this()).unwrap_or_default();
        self.ask(Kind::Hello, 0, &this)
    }

    /// Says what the worker is to hold.
    ///
    /// # Errors
    /// The worker is gone.
    pub fn open(&mut self) -> Result<PendingOrder, Lost> {
        let schema = self.request.schema(|unit| {
            let spec = self.spec.units.iter().find(|spec| spec.name == self.request.units[unit].name);
            spec.map(|spec| &spec.description)
        });
        self.schema = schema.unwrap_or_else(|| unreachable!("a plan's units have all variables that its wiring has"));
        let request = bytes(&self.request);
        self.ask(Kind::Open, 0, &request)
    }

    /// Lets its instances enter initialization mode.
    ///
    /// # Errors
    /// The worker is gone.
    pub fn enter(&mut self) -> Result<PendingOrder, Lost> {
        self.ask(Kind::Initialise, 0, &bytes(&Initial::Enter))
    }

    /// Awaits a reply that brings nothing.
    ///
    /// # Errors
    /// What the worker says went wrong, or it is gone.
    pub fn confirm(&mut self, pending: PendingOrder) -> Result<(), Lost> {
        self.answer(pending, |_, _| Ok(())).map(drop)
    }

    fn ask(&mut self, kind: Kind, tick: u64, extras: &[u8]) -> Result<PendingOrder, Lost> {
        let (header, outgoing) = self.begin(kind, 0, tick)?;
        self.send(header, outgoing.finish(extras))
    }

    fn begin(&mut self, kind: Kind, group: u16, tick: u64) -> Result<(Header, Outgoing), Lost> {
        if let Some(dead) = &self.dead {
            return Err(dead.clone());
        }
        let header = Header { kind, group, schema: self.schema, sequence: self.orders, tick };
        self.orders += 1;
        Ok((header, Outgoing::new(&header)))
    }

    fn send(&mut self, header: Header, message: Vec<u8>) -> Result<PendingOrder, Lost> {
        let WorkerHandle { address: Address { number, .. }, hang_monitor, .. } = &self.handle;
        hang_monitor.begin(*number);
        let sent = match &self.link {
            Some(link) => link.send(message, |waited| hang_monitor.look(*number, waited)),
            None => Err(Cause::Other("its worker hung up".to_owned())),
        };
        sent.map(|()| PendingOrder { header }).map_err(|cause| self.give_up(header.tick, cause))
    }

    /// What is lost with this worker, told of its first instance unless its board knows better.
    fn lost(&self, tick: u64, cause: Cause) -> Lost {
        let first = self.ports.first().map_or(0, |&(index, _)| index);
        let call =
            self.handle.board.note(0).read().filter(|call| self.ports.iter().any(|(index, _)| *index == call.instance));
        let mut failure = failure(call, tick, &self.spec.scenario, cause);
        let instance = call.map_or(first, |call| call.instance);
        let name = self.spec.scenario.instances.get(instance).map(|instance| instance.name.clone());
        failure.instance = failure.instance.or(name);
        Lost { instance, failure }
    }
}

impl Worker for Remote<'_> {
    fn set_initial(&mut self, instance: usize, picks: &[VariableSlot], inputs: &Values) -> Result<(), Lost> {
        let picked = Initial::Set(Picked::out_of(instance, picks, inputs));
        let pending = self.ask(Kind::Initialise, 0, &bytes(&picked))?;
        self.confirm(pending)
    }

    fn get_initial(&mut self, instance: usize, picks: &[VariableSlot], outputs: &mut Values) -> Result<(), Lost> {
        let wanted = Picked::out_of(instance, picks, outputs);
        let pending = self.ask(Kind::Initialise, 0, &bytes(&Initial::Get(wanted.clone())))?;
        let ReplyExtras { values, .. } = self.answer(pending, |_, _| Ok(()))?;
        let got = Picked { values, ..wanted };
        if got.picks().is_none() {
            return Err(self.give_up(0, Cause::Other("its worker answered with other values than asked".to_owned())));
        }
        got.put_into(picks, outputs);
        Ok(())
    }

    fn start(&mut self, outputs: &mut Values) -> Result<(), Lost> {
        let pending = self.ask(Kind::Start, 0, &[])?;
        self.answer(pending, |ports, blocks| {
            ports.iter().try_for_each(|(index, ports)| blocks.read(*index, &ports.outputs, outputs))
        })
        .map(drop)
    }

    fn order(&mut self, order: &Order<'_>) -> Result<Ticket, Lost> {
        let (local, company) = &self.groups[&order.group];
        let (local, instances) = (*local, company.instances.clone());
        let (header, mut outgoing) = self.begin(Kind::Step, local, order.tick)?;
        for instance in instances {
            outgoing.block(instance, &self.ports(instance).inputs, order.inputs);
        }
        let pending = self.send(header, outgoing.finish(&[]))?;
        self.under_way.insert(order.group, pending);
        Ok(Ticket { group: order.group })
    }

    fn reply(&mut self, ticket: Ticket, _: u64, outputs: &mut Values) -> Result<Reply, Lost> {
        let pending = self.under_way.remove(&ticket.group);
        let pending = pending.unwrap_or_else(|| unreachable!("group {} has no order under way", ticket.group));
        let instances = self.groups[&ticket.group].1.instances.clone();
        let ReplyExtras { terminated, .. } = self.answer(pending, |ports, blocks| {
            instances.iter().try_for_each(|&index| blocks.read(index, &find(ports, index).outputs, outputs))
        })?;
        Ok(Reply { terminated })
    }

    fn save(&mut self, tick: u64) -> Result<Vec<(usize, Vec<u8>)>, Lost> {
        let pending = self.ask(Kind::Save, tick, &[])?;
        let ReplyExtras { states, .. } = self.answer(pending, |_, _| Ok(()))?;
        if !states.iter().map(|(index, _)| index).eq(self.ports.iter().map(|(index, _)| index)) {
            return Err(self.give_up(tick, Cause::Other("its worker answered with other states than asked".to_owned())));
        }
        Ok(states)
    }

    fn restore(&mut self, tick: u64, states: &[(usize, &[u8])]) -> Result<(), Lost> {
        let pending = self.ask(Kind::Restore, tick, &bytes(&states))?;
        self.confirm(pending)
    }

    fn finish(&mut self, tick: u64, leaving: Shutdown) -> Result<(), Lost> {
        if self.dead.is_some() {
            return Ok(());
        }
        if leaving == Shutdown::Immediate {
            let (_, outgoing) = self.begin(Kind::Finish, 0, tick)?;
            // It may not have taken its last order; then it is not waited for.
            let leave = |_| Some(Cause::Other("it takes nothing".to_owned()));
            self.link.as_ref().map_or(Ok(()), |link| link.send_aside(outgoing.finish(&[]), leave)).ok();
            return Ok(());
        }
        // What units said in steps that end after the run is told all the same.
        for pending in std::mem::take(&mut self.under_way).into_values() {
            self.overrun(pending)?;
        }
        let pending = self.ask(Kind::Finish, tick, &[])?;
        let finished = self.confirm(pending);
        self.link = None;
        finished
    }
}

impl Remote<'_> {
    fn ports(&self, instance: usize) -> &InstancePorts {
        find(&self.ports, instance)
    }
}

fn find(ports: &[(usize, InstancePorts)], instance: usize) -> &InstancePorts {
    let found = ports.iter().find(|(index, _)| *index == instance);
    found.map_or_else(|| unreachable!("instance {instance} is not with this worker"), |(_, ports)| ports)
}

/// What a worker is told that is to hold these ports.
fn request(spec: &RunSpec, ports: &[(usize, InstancePorts)], groups: Vec<GroupSpec>) -> OpenRequest {
    let mut units: Vec<Unit> = Vec::new();
    let mut unit_of = |index: usize| {
        let spec = &spec.units[spec.unit_of[index]];
        units.iter().position(|unit| unit.name == spec.name).unwrap_or_else(|| {
            let (name, folder, sha256) = (spec.name.clone(), spec.folder.clone(), spec.sha256.clone());
            units.push(Unit { name, folder, sha256 });
            units.len() - 1
        })
    };
    let held = |(index, ports): &(usize, InstancePorts)| {
        let instance = &spec.scenario.instances[*index];
        let variables = |ports: &crate::flatten::wiring::Ports| {
            let spans = [&ports.reals, &ports.integers, &ports.booleans, &ports.texts];
            spans.into_iter().flat_map(|span| span.variables.iter().copied()).collect()
        };
        InstanceSpec {
            index: *index,
            name: instance.name.clone(),
            unit: unit_of(*index),
            presets: instance.presets.clone(),
            log_calls: spec.log_calls.contains(index),
            inputs: variables(&ports.inputs),
            outputs: variables(&ports.outputs),
        }
    };
    let instances = ports.iter().map(held).collect();
    OpenRequest { step_ns: spec.scenario.step_ns, folder: spec.folder.clone(), units, instances, groups }
}
