//! A worker in another process: its orders and replies are messages.
//!
//! A reply is awaited when its result is due, within the time limit of a unit's call and as long as the process has a
//! heartbeat. The board of a process that died or hangs shows the call in which that happened.
//!
//! Each end relies on promises of the other. The worker executes orders in sequence and sends one reply to each, with the
//! order's number, group and tick. The coordinator sends an order to a group only when the reply to the previous one was
//! taken. All replies are checked; after the first wrong one the worker is killed and every further call returns that failure.

mod answers;
#[cfg(test)]
mod tests;

use super::hang_monitor::HangMonitor;
use super::worker_processes::WorkerProcesses;
use crate::bus::link::Link;
use crate::bus::wire::open_request::{
    GroupSpec, Handshake, Initial, InstanceSpec, OpenRequest, ReplyExtras, SelectedValues, Unit, bytes,
};
use crate::bus::wire::{Header, Kind, Outgoing};
use crate::bus::worker::Address;
use crate::host::supervise::failure;
use crate::run::message::MessageSink;
use crate::run::run_spec::RunSpec;
use crate::run::worker::{Lost, Order, Reply, Shutdown, Ticket, Worker};
use flatten::values::Values;
use flatten::wiring::{InstancePorts, Plan, VariableSlot};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;
use unit::board::Board;
use unit::failure::{Cause, Failure};

/// How long a process may take to listen; long, as many may start at once on a loaded machine.
const START_DEADLINE: Duration = Duration::from_secs(30);

/// What the coordinator needs to reach a worker.
#[derive(Debug)]
pub struct WorkerHandle {
    /// Its socket and board in the run's folder.
    pub address: Address,
    /// Its board.
    pub board: Arc<Board>,
    /// All worker processes of the run.
    pub processes: Arc<WorkerProcesses>,
    /// The monitor of all workers of the run.
    pub hang_monitor: Arc<HangMonitor>,
}

/// A worker in another process.
pub struct Remote<'a> {
    spec: &'a RunSpec,
    handle: WorkerHandle,
    link: Option<Link>,
    /// Takes log messages and logged calls of its units.
    sink: MessageSink,
    schema: u64,
    /// Its instances with their ports, in the script's order.
    ports: Vec<(usize, InstancePorts)>,
    /// Its groups by their number in the run, each with its number in this worker.
    groups: BTreeMap<usize, (u16, GroupSpec)>,
    request: OpenRequest,
    /// How many orders were sent, and how many replies to them have arrived.
    orders: u64,
    replies: u64,
    /// Orders of steps whose replies were not taken yet, by the group's number in the run.
    under_way: BTreeMap<usize, PendingOrder>,
    /// Replies that arrived while another one was awaited, by the number of their order.
    early: BTreeMap<u64, Vec<u8>>,
    /// The failure after which the process was killed.
    dead: Option<Lost>,
}

/// An order whose reply is to be awaited.
#[derive(Clone, Copy, Debug)]
pub struct PendingOrder {
    header: Header,
}

impl std::fmt::Debug for Remote<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Remote").field("handle", &self.handle).field("orders", &self.orders).finish_non_exhaustive()
    }
}

impl<'a> Remote<'a> {
    /// Connects to a worker, which is to hold the groups that have its number in the plan.
    ///
    /// # Errors
    /// Its process ended or did not listen in time.
    pub fn connect(
        spec: &'a RunSpec,
        plan: &Plan,
        handle: WorkerHandle,
        sink: MessageSink,
        run: &str,
    ) -> Result<Self, Failure> {
        let number = handle.address.number;
        let of_worker = plan.groups.iter().enumerate().filter(|(_, group)| group.worker == number);
        let groups = of_worker.zip(0..).map(|((index, group), local)| {
            (index, (local, GroupSpec { every: group.every, instances: group.instances.clone() }))
        });
        let groups: BTreeMap<_, _> = groups.collect();
        let mut held: Vec<usize> = groups.values().flat_map(|(_, group)| group.instances.clone()).collect();
        held.sort_unstable();
        let ports: Vec<_> = held.iter().map(|&index| (index, plan.ports[index].clone())).collect();
        let request = request(spec, &ports, groups.values().map(|(_, group)| group.clone()).collect());
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
            replies: 0,
            under_way: BTreeMap::new(),
            early: BTreeMap::new(),
            dead: None,
        };
        remote.establish_link(run)?;
        Ok(remote)
    }

    /// Sends this program's versions.
    ///
    /// # Errors
    /// The worker is lost.
    pub fn shake_hands(&mut self) -> Result<PendingOrder, Lost> {
        let this = serde_json::to_vec(&Handshake::this()).unwrap_or_default();
        self.send_order(Kind::Hello, 0, &this)
    }

    /// Sends the units and instances that the worker is to hold.
    ///
    /// # Errors
    /// The worker is lost.
    pub fn open(&mut self) -> Result<PendingOrder, Lost> {
        let schema = self.request.schema(|unit| {
            let spec = self.spec.units.iter().find(|spec| spec.name == self.request.units[unit].name);
            spec.map(|spec| &spec.description)
        });
        self.schema = schema.unwrap_or_else(|| unreachable!("a plan's units have all variables that its plan has"));
        let request = bytes(&self.request);
        self.send_order(Kind::Open, 0, &request)
    }

    /// Orders its instances to enter initialization mode.
    ///
    /// # Errors
    /// The worker is lost.
    pub fn enter(&mut self) -> Result<PendingOrder, Lost> {
        self.send_order(Kind::Initialise, 0, &bytes(&Initial::Enter))
    }

    /// Awaits a reply that has no values.
    ///
    /// # Errors
    /// The order failed, or the worker is lost.
    pub fn confirm(&mut self, pending: PendingOrder) -> Result<(), Lost> {
        self.await_reply(pending, |_, _| Ok(())).map(drop)
    }

    fn send_order(&mut self, kind: Kind, tick: u64, extras: &[u8]) -> Result<PendingOrder, Lost> {
        let (header, outgoing) = self.next_header(kind, 0, tick)?;
        self.send(header, outgoing.finish(extras))
    }

    fn next_header(&mut self, kind: Kind, group: u16, tick: u64) -> Result<(Header, Outgoing), Lost> {
        if let Some(dead) = &self.dead {
            return Err(dead.clone());
        }
        let header = Header { kind, group, schema: self.schema, sequence: self.orders, tick };
        self.orders += 1;
        Ok((header, Outgoing::new(&header)))
    }

    fn send(&mut self, header: Header, message: Vec<u8>) -> Result<PendingOrder, Lost> {
        let WorkerHandle { address: Address { number, .. }, hang_monitor, .. } = &self.handle;
        // With orders left to execute, its time goes on: a call that hangs may be that of an earlier order.
        if self.orders <= self.replies + 1 {
            hang_monitor.restart(*number);
        }
        let sent = match &self.link {
            Some(link) => link.send(message, |waited| hang_monitor.check(*number, waited)),
            None => Err(Cause::Other("its worker hung up".to_owned())),
        };
        sent.map(|()| PendingOrder { header }).map_err(|cause| self.give_up(header.tick, cause))
    }

    /// The loss of this worker: assigned to the instance whose call stands on its board, else to its first instance.
    fn lost(&self, tick: u64, cause: Cause) -> Lost {
        let first = self.ports.first().map_or(0, |&(index, _)| index);
        let note = self.handle.board.note(0);
        let call = note.copied().or_else(|| note.read());
        let call = call.filter(|call| self.ports.iter().any(|(index, _)| *index == call.instance));
        let mut failure = failure(call, tick, &self.spec.scenario, cause);
        let instance = call.map_or(first, |call| call.instance);
        let name = self.spec.scenario.instances.get(instance).map(|instance| instance.name.clone());
        failure.instance = failure.instance.or(name);
        Lost { instance, failure }
    }
}

impl Worker for Remote<'_> {
    fn set_initial(&mut self, instance: usize, slots: &[VariableSlot], inputs: &Values) -> Result<(), Lost> {
        let selected = Initial::Set(SelectedValues::select(instance, slots, inputs));
        let pending = self.send_order(Kind::Initialise, 0, &bytes(&selected))?;
        self.confirm(pending)
    }

    fn get_initial(&mut self, instance: usize, slots: &[VariableSlot], outputs: &mut Values) -> Result<(), Lost> {
        let requested = SelectedValues::select(instance, slots, outputs);
        let pending = self.send_order(Kind::Initialise, 0, &bytes(&Initial::Get(requested.clone())))?;
        let ReplyExtras { values, .. } = self.await_reply(pending, |_, _| Ok(()))?;
        let received = SelectedValues { values, ..requested };
        if received.slots().is_none() {
            return Err(self.give_up(0, Cause::Other("its worker answered with other values than asked".to_owned())));
        }
        received.copy_to(slots, outputs);
        Ok(())
    }

    fn start(&mut self, outputs: &mut Values) -> Result<(), Lost> {
        let pending = self.send_order(Kind::Start, 0, &[])?;
        self.await_reply(pending, |ports, blocks| {
            ports.iter().try_for_each(|(index, ports)| blocks.read(*index, &ports.outputs, outputs))
        })
        .map(drop)
    }

    fn order(&mut self, order: &Order<'_>) -> Result<Ticket, Lost> {
        let (local, group) = &self.groups[&order.group];
        let (local, instances) = (*local, group.instances.clone());
        let (header, mut outgoing) = self.next_header(Kind::Step, local, order.tick)?;
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
        let ReplyExtras { terminated, .. } = self.await_reply(pending, |ports, blocks| {
            instances.iter().try_for_each(|&index| blocks.read(index, &find(ports, index).outputs, outputs))
        })?;
        Ok(Reply { terminated })
    }

    fn save(&mut self, tick: u64) -> Result<Vec<(usize, Vec<u8>)>, Lost> {
        let pending = self.send_order(Kind::Save, tick, &[])?;
        let ReplyExtras { states, .. } = self.await_reply(pending, |_, _| Ok(()))?;
        if !states.iter().map(|(index, _)| index).eq(self.ports.iter().map(|(index, _)| index)) {
            return Err(self.give_up(tick, Cause::Other("its worker answered with other states than asked".to_owned())));
        }
        Ok(states)
    }

    fn restore(&mut self, tick: u64, states: &[(usize, &[u8])]) -> Result<(), Lost> {
        let pending = self.send_order(Kind::Restore, tick, &bytes(&states))?;
        self.confirm(pending)
    }

    fn finish(&mut self, tick: u64, shutdown: Shutdown) -> Result<(), Lost> {
        if self.dead.is_some() {
            return Ok(());
        }
        if shutdown == Shutdown::Immediate {
            let (_, outgoing) = self.next_header(Kind::Finish, 0, tick)?;
            // It may not have read its last order, so a write can block; the first check ends the wait.
            let stop_waiting = |_| Some(Cause::Other("it takes nothing".to_owned()));
            self.link.as_ref().map_or(Ok(()), |link| link.send_in_thread(outgoing.finish(&[]), stop_waiting)).ok();
            return Ok(());
        }
        // Steps that end after the run: their results are not needed, but their log messages are shown.
        // One by one: the reply to an order that is still in `under_way` may arrive while another one is awaited.
        while let Some((_, pending)) = self.under_way.pop_first() {
            self.drain(pending)?;
        }
        let pending = self.send_order(Kind::Finish, tick, &[])?;
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

/// The request to a worker that is to hold the instances with these ports.
fn request(spec: &RunSpec, ports: &[(usize, InstancePorts)], groups: Vec<GroupSpec>) -> OpenRequest {
    let (mut units, mut places) = (Vec::new(), BTreeMap::new());
    let mut unit_of = |index: usize| {
        *places.entry(spec.scenario.instances[index].unit).or_insert_with(|| {
            let unit = spec.unit(index);
            let (name, folder, sha256) = (unit.name.clone(), unit.folder.clone(), unit.sha256.clone());
            units.push(Unit { name, folder, sha256 });
            units.len() - 1
        })
    };
    let instance_spec = |(index, ports): &(usize, InstancePorts)| {
        let instance = &spec.scenario.instances[*index];
        let variables = |ports: &flatten::wiring::Ports| {
            let ranges = [&ports.reals, &ports.integers, &ports.booleans, &ports.texts];
            ranges.into_iter().flat_map(|range| range.variables.iter().copied()).collect()
        };
        InstanceSpec {
            index: *index,
            name: instance.name.clone(),
            unit: unit_of(*index),
            presets: instance.presets.clone(),
            log_calls: spec.options.logs_calls_of(&instance.name),
            inputs: variables(&ports.inputs),
            outputs: variables(&ports.outputs),
        }
    };
    let instances = ports.iter().map(instance_spec).collect();
    let dsl::scenario::Scenario { start_tick, step_ns, .. } = spec.scenario;
    OpenRequest { start_tick, step_ns, folder: spec.folder.clone(), units, instances, groups }
}
