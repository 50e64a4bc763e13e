//! Faulty workers: a real service replies, and its replies are changed before they are sent.

use super::*;
use crate::bus::link::{LinkListener, put};
use crate::bus::worker::{LogBuffer, Service};
use crate::run::stepping::tests::spec;
use crate::run::worker::Terminated;
use ::tests::foreign::Foreign;
use ::tests::program::repository;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use unit::archive::unpack;
use unit::board::BoardLayout;

/// Changes a reply; `None` does not send it.
type Fault = fn(Vec<u8>) -> Option<Vec<u8>>;

const TICK: u64 = 7;
/// Offsets of fields in a message.
const SEQUENCE_AT: usize = 16;
const TICK_AT: usize = 24;
const EXTRAS_AT: usize = 36;
const FIRST_BLOCK_AT: usize = 40;

fn changed(mut bytes: Vec<u8>, at: usize, to: u8) -> Option<Vec<u8>> {
    bytes[at] = to;
    Some(bytes)
}

/// Adds the end of an instance that the worker does not hold.
fn report_foreign_instance(bytes: Vec<u8>) -> Option<Vec<u8>> {
    let ended = Terminated { instance: 99, last_successful_time_s: 0.0 };
    let extras = ReplyExtras { terminated: vec![ended], ..ReplyExtras::default() }.bytes();
    let mut message = changed(bytes, EXTRAS_AT, u8::try_from(extras.len()).unwrap())?;
    message.extend(extras);
    Some(message)
}

/// Serves as a worker does, with a fault in replies of this kind.
fn serve(address: &Address, kind: Kind, fault: Fault, over: &AtomicBool) {
    let board = Arc::new(Board::open(&address.board()).unwrap());
    let mut service = Service::new(Arc::clone(&board), LogBuffer::new(Arc::clone(&board)));
    let link = LinkListener::bind(&address.socket()).unwrap();
    let mut replies = None;
    while !over.load(Ordering::Acquire) {
        let Ok((run, order)) = link.receive_within(Duration::from_millis(20)) else { continue };
        board.beat();
        let replies = replies.get_or_insert_with(|| link.reply_publisher(&run).unwrap());
        let order_kind = crate::bus::wire::Incoming::read(&order).unwrap().header.kind;
        let reply = service.execute(&order).unwrap();
        let reply = if order_kind.reply() == Some(kind) { fault(reply) } else { Some(reply) };
        if let Some(reply) = reply {
            put(replies, &reply).unwrap();
        }
        if service.is_over() {
            break;
        }
    }
    link.close();
}

/// Connects to a faulty worker; `worker_of` gives the worker of each of the two instances, and this one is worker 0. Returns
/// the result or failure of `run`, and the number of log messages.
fn with_worker<R>(
    (kind, fault): (Kind, Fault),
    worker_of: [usize; 2],
    run: impl FnOnce(&mut Remote<'_>, &Plan, &HangMonitor) -> Result<R, Failure>,
) -> (Result<R, String>, usize) {
    let (folder, fmu) = Foreign::default().build();
    let unpacked = unpack(&fmu, &folder.path().join("unpacked")).unwrap();
    let spec = spec(10, &unpacked);
    let descriptions = [&unpacked.description; 2];
    let plan = Plan::new(&spec.scenario, &descriptions, &worker_of);
    let address = Address { home: folder.path().to_owned(), number: 0 };
    let board = Arc::new(Board::create(&address.board(), &BoardLayout { notes: 1, columns: 0, claims: 0 }).unwrap());
    let processes = Arc::new(WorkerProcesses::start(&repository().join("tests/foreign/idle.sh"), [&address]).unwrap());
    let count = Arc::new(Mutex::new(0));
    let counter = Arc::clone(&count);
    let sink: MessageSink = Arc::new(move |_| *counter.lock().unwrap() += 1);
    let hang_monitor = Arc::new(HangMonitor::new(&[Arc::clone(&board)], Some(Duration::from_millis(400))));
    let monitor = Arc::clone(&hang_monitor);
    let handle = WorkerHandle { address: address.clone(), board, processes, hang_monitor };
    let over = Arc::new(AtomicBool::new(false));
    let stop = Arc::clone(&over);
    let worker = thread::spawn(move || serve(&address, kind, fault, &stop));
    let connected = Remote::connect(&spec, &plan, handle, sink, "0123456789abcdef");
    let result = connected.and_then(|mut remote| run(&mut remote, &plan, &monitor));
    over.store(true, Ordering::Release);
    worker.join().unwrap();
    let count = *count.lock().unwrap();
    (result.map_err(|failure| failure.to_string()), count)
}

/// Brings a worker to where steps can be ordered.
fn start(remote: &mut Remote<'_>, outputs: &mut Values) -> Result<(), Lost> {
    for step in [Remote::shake_hands, Remote::open, Remote::enter] {
        let pending = step(remote)?;
        remote.confirm(pending)?;
    }
    remote.start(outputs)
}

/// Makes a whole run of one step with a faulty worker; returns its outputs or failure, and the number of log messages.
fn run_with(kind: Kind, fault: Fault) -> (Result<Values, String>, usize) {
    with_worker((kind, fault), [0, 1], |remote, plan, _| {
        let mut outputs = plan.outputs.clone();
        let mut run_once = || {
            start(remote, &mut outputs)?;
            let ticket = remote.order(&Order { group: 0, tick: TICK, inputs: &plan.inputs })?;
            remote.reply(ticket, TICK + 1, &mut outputs)?;
            remote.finish(TICK + 1, Shutdown::Orderly)
        };
        let ran = run_once().map_err(|lost| lost.failure);
        if ran.is_err() {
            assert!(remote.order(&Order { group: 0, tick: TICK, inputs: &plan.inputs }).is_err(), "it stays lost");
            remote.finish(TICK, Shutdown::Immediate).unwrap();
        }
        ran.map(|()| outputs)
    })
}

#[test]
fn replies_of_two_groups_of_a_worker_may_be_awaited_in_any_order() {
    let (result, _) = with_worker((Kind::Stepped, Some), [0, 0], |remote, plan, _| {
        let mut outputs = plan.outputs.clone();
        let order = |remote: &mut Remote<'_>, group, tick| remote.order(&Order { group, tick, inputs: &plan.inputs });
        let mut run = || {
            start(remote, &mut outputs)?;
            let tickets = [order(remote, 0, TICK)?, order(remote, 1, TICK)?];
            for ticket in tickets.into_iter().rev() {
                remote.reply(ticket, TICK + 1, &mut outputs)?;
            }
            // Two steps that end after the run; the one of the later group was ordered first.
            order(remote, 1, TICK + 1)?;
            order(remote, 0, TICK + 1)?;
            remote.finish(TICK + 1, Shutdown::Orderly)
        };
        run().map_err(|lost| lost.failure)
    });
    assert_eq!(result, Ok(()));
}

#[test]
fn another_order_does_not_extend_the_time_of_the_first() {
    let (result, _) = with_worker((Kind::Stepped, |_| None), [0, 0], |remote, plan, monitor| {
        start(remote, &mut plan.outputs.clone()).map_err(|lost| lost.failure)?;
        let mut checks_until_found = |group, most| {
            remote.order(&Order { group, tick: TICK, inputs: &plan.inputs }).map_err(|lost| lost.failure)?;
            // Until the worker has executed the order: each new call restarts the time.
            thread::sleep(Duration::from_millis(100));
            Ok((1..=most).find(|_| monitor.check(0, Duration::from_millis(50)).is_some()))
        };
        let first = checks_until_found(0, 5)?;
        let second = checks_until_found(1, 20)?;
        remote.finish(TICK, Shutdown::Immediate).ok();
        Ok((first, second))
    });
    assert_eq!(result, Ok((None, Some(4))), "the first check begins the time of 0.4 s");
}

#[test]
fn a_worker_without_a_fault_returns_outputs_and_log_messages() {
    let (result, messages) = run_with(Kind::Stepped, Some);
    // y = 0 + h (2 u - 0) with the step of a millisecond, and u = 0.
    assert_eq!(result.map(|outputs| outputs.reals), Ok(vec![0.0, 0.0]));
    assert_eq!(messages, 2, "after instantiation and at the end");
}

#[test]
fn every_fault_of_a_worker_is_reported_with_instance_and_time() {
    let faults: [(Kind, Fault, &str); 13] = [
        (
            Kind::Stepped,
            |_| Some(b"garbage".to_vec()),
            "`a`: its worker answered with a message that is cut short, at 0.007 s",
        ),
        (
            Kind::Stepped,
            |_| Some(vec![b'x'; 64]),
            "`a`: its worker answered with something that is no message of ours, at 0.007 s",
        ),
        (
            Kind::Stepped,
            |bytes| changed(bytes, TICK_AT, 6),
            "`a`: its worker answered for tick 6, expected 7, at 0.007 s",
        ),
        (
            Kind::Stepped,
            |bytes| changed(bytes, SEQUENCE_AT, 99),
            "`a`: its worker answered order 99, expected 4, at 0.007 s",
        ),
        (
            Kind::Stepped,
            |bytes| changed(bytes, 8, 0),
            "`a`: its worker has another layout of values: the unit is not the one that was checked, at 0.007 s",
        ),
        (Kind::Stepped, |bytes| changed(bytes, 4, 22), "`a`: its worker answered Finished to Step, at 0.007 s"),
        (
            Kind::Stepped,
            |bytes| changed(bytes, FIRST_BLOCK_AT, 1),
            "`a`: its worker answered with values of instance 1 where those of instance 0 belong, at 0.007 s",
        ),
        (
            Kind::Stepped,
            |mut bytes| {
                bytes.push(0);
                Some(bytes)
            },
            "`a`: its worker answered with more than was asked for, at 0.007 s",
        ),
        (Kind::Stepped, |_| None, "`a`: its worker has not answered for 0.4 s, at 0.007 s"),
        (
            Kind::Opened,
            |bytes| changed(bytes, 8, 0),
            "`a`: its worker has another layout of values: the unit is not the one that was checked, at 0 s",
        ),
        (
            Kind::Welcome,
            |bytes| Some(String::from_utf8_lossy(&bytes).replace("\"protocol\":2", "\"protocol\":9").into_bytes()),
            "`a`: its worker has protocol 9, this program 2, at 0 s",
        ),
        (Kind::Stepped, report_foreign_instance, "`a`: its worker spoke for others, at 0.007 s"),
        (Kind::Finished, |_| Some(Vec::new()), "`a`: its worker answered with a message that is cut short, at 0.008 s"),
    ];
    for (kind, fault, expected) in faults {
        let (result, _) = run_with(kind, fault);
        assert_eq!(result.map(drop), Err(expected.to_owned()), "{kind:?}");
    }
}
