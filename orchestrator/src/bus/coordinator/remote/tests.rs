//! Workers that lie: a real one answers, and what it says is changed on the handle.

use super::*;
use crate::bus::link::{Listening, put};
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

/// Exchanges an answer of a kind; `None` keeps it back.
type Lie = fn(Vec<u8>) -> Option<Vec<u8>>;

const TICK: u64 = 7;
/// Where things stand in a message.
const SEQUENCE_AT: usize = 16;
const TICK_AT: usize = 24;
const ASIDE_AT: usize = 36;
const FIRST_BLOCK_AT: usize = 40;

fn changed(mut bytes: Vec<u8>, at: usize, to: u8) -> Option<Vec<u8>> {
    bytes[at] = to;
    Some(bytes)
}

/// Says that an instance is done for good that is not there.
fn speak_for_others(bytes: Vec<u8>) -> Option<Vec<u8>> {
    let ended = Terminated { instance: 99, last_successful_time_s: 0.0 };
    let extras = ReplyExtras { terminated: vec![ended], ..ReplyExtras::default() }.bytes();
    let mut message = changed(bytes, ASIDE_AT, u8::try_from(extras.len()).unwrap())?;
    message.extend(extras);
    Some(message)
}

/// Answers as a worker does, but lies in answers of this kind.
fn serve(address: &Address, kind: Kind, lie: Lie, over: &AtomicBool) {
    let board = Arc::new(Board::open(&address.board()).unwrap());
    let mut service = Service::new(Arc::clone(&board), LogBuffer::new(Arc::clone(&board)));
    let line = Listening::on(&address.socket()).unwrap();
    let mut answers = None;
    while !over.load(Ordering::Acquire) {
        let Ok((run, order)) = line.next_within(Duration::from_millis(20)) else { continue };
        board.beat();
        let answers = answers.get_or_insert_with(|| line.answer(&run).unwrap());
        let pending = crate::bus::wire::Incoming::read(&order).unwrap().header.kind;
        let answer = service.answer(&order).unwrap();
        let told = if pending.reply() == Some(kind) { lie(answer) } else { Some(answer) };
        if let Some(told) = told {
            put(answers, &told).unwrap();
        }
        if service.is_over() {
            break;
        }
    }
    line.close();
}

/// Goes through a whole run of one step with a worker that lies; what becomes of it, and what its unit said.
fn told_by(kind: Kind, lie: Lie) -> (Result<Values, String>, usize) {
    let (folder, fmu) = Foreign::default().build();
    let unpacked = unpack(&fmu, &folder.path().join("unpacked")).unwrap();
    let spec = spec(10, &unpacked);
    let descriptions = [&unpacked.description; 2];
    let wiring = Wiring::new(&spec.scenario, &descriptions, &[0, 1]);
    let address = Address { home: folder.path().to_owned(), number: 0 };
    let board = Arc::new(Board::create(&address.board(), &BoardLayout { notes: 1, columns: 0, claims: 0 }).unwrap());
    let processes = Arc::new(WorkerProcesses::start(&repository().join("tests/foreign/idle.sh"), [&address]).unwrap());
    let words = Arc::new(Mutex::new(0));
    let event = Arc::clone(&words);
    let sink: MessageSink = Arc::new(move |_| *event.lock().unwrap() += 1);
    let hang_monitor = Arc::new(HangMonitor::new(&[Arc::clone(&board)], Some(Duration::from_millis(400))));
    let handle = WorkerHandle { address: address.clone(), board, processes, hang_monitor };
    let over = Arc::new(AtomicBool::new(false));
    let until = Arc::clone(&over);
    let worker = thread::spawn(move || serve(&address, kind, lie, &until));
    let mut outputs = wiring.outputs.clone();
    let go = || -> Result<(), Failure> {
        let mut remote = Remote::connect(&spec, &wiring, handle, sink, "0123456789abcdef")?;
        let mut fly = || {
            for step in [Remote::shake_hands, Remote::open, Remote::enter] {
                let pending = step(&mut remote)?;
                remote.confirm(pending)?;
            }
            remote.start(&mut outputs)?;
            let ticket = remote.order(&Order { group: 0, tick: TICK, inputs: &wiring.inputs })?;
            remote.reply(ticket, TICK + 1, &mut outputs)?;
            remote.finish(TICK + 1, Shutdown::Orderly)
        };
        let ran = fly().map_err(|lost| lost.failure);
        if ran.is_err() {
            assert!(remote.order(&Order { group: 0, tick: TICK, inputs: &wiring.inputs }).is_err(), "it stays lost");
            remote.finish(TICK, Shutdown::Immediate).unwrap();
        }
        ran
    };
    let told = go().map_err(|failure| failure.to_string());
    over.store(true, Ordering::Release);
    worker.join().unwrap();
    let words = *words.lock().unwrap();
    (told.map(|()| outputs), words)
}

#[test]
fn an_honest_worker_brings_the_outputs_and_the_words_of_its_unit() {
    let (told, words) = told_by(Kind::Stepped, Some);
    // y = 0 + h (2 u - 0) with the step of a millisecond, and u = 0.
    assert_eq!(told.map(|outputs| outputs.reals), Ok(vec![0.0, 0.0]));
    assert_eq!(words, 2, "after being made and when it was done");
}

#[test]
fn every_lie_of_a_worker_is_told_with_instance_and_time() {
    let lies: [(Kind, Lie, &str); 13] = [
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
            |bytes| Some(String::from_utf8_lossy(&bytes).replace("\"protocol\":1", "\"protocol\":9").into_bytes()),
            "`a`: its worker has protocol 9, this program 1, at 0 s",
        ),
        (Kind::Stepped, speak_for_others, "`a`: its worker spoke for others, at 0.007 s"),
        (Kind::Finished, |_| Some(Vec::new()), "`a`: its worker answered with a message that is cut short, at 0.008 s"),
    ];
    for (kind, lie, expected) in lies {
        let (told, _) = told_by(kind, lie);
        assert_eq!(told.map(drop), Err(expected.to_owned()), "{kind:?}");
    }
}
