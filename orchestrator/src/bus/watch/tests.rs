//! What a subscriber in the run's own session receives, without a network.

use super::*;
use crate::example::{description, scenario};
use crate::run::run_options::RunOptions;
use crate::run::run_spec::UnitSpec;
use dsl::scenario::{Column, Port};
use serde_json::Value;
use std::collections::VecDeque;
use std::path::PathBuf;
use unit::board::BoardLayout;
use zenoh::sample::Sample;
use zenoh::{Session, Wait};

/// A run of `quad.height` and `quad.method`.
fn spec() -> RunSpec {
    let mut scenario = scenario();
    for (name, variable) in [("quad.height", 0), ("quad.method", 1)] {
        scenario.columns.push(Column::of_port(name, Port { instance: 0, variable }));
    }
    let (name, description, sha256) = ("quadcopter".to_owned(), description(), String::new());
    let unit = UnitSpec { name, folder: PathBuf::new(), description, sha256 };
    RunSpec {
        scenario,
        units: vec![unit],
        folder: PathBuf::new(),
        board: PathBuf::new(),
        options: RunOptions { live: true, ..RunOptions::default() },
        worker_of: None,
        saves: Vec::new(),
        from: None,
    }
}

/// A run that has begun, and the session that publishes it.
fn begun(rate: Rate) -> (Box<Watch>, Session, Arc<Board>) {
    let listening = Listening::at(ANY_LOCAL_PORT).unwrap();
    let session = listening.session.clone();
    let board = Arc::new(Board::private(&BoardLayout { notes: 1, columns: 2, claims: 0 }).unwrap());
    let watch = Watch::new(listening, &spec(), rate).unwrap().on(&board);
    (Box::new(watch), session, board)
}

fn finish(watch: Box<Watch>) {
    watch.finish(RunState::Finished).unwrap();
}

/// Publishes a run of 100 ticks; returns the messages received, each with the last chunk of its key.
fn received(rate: Rate, end: fn(Box<Watch>)) -> Vec<(String, Value)> {
    let (mut watch, session, board) = begun(rate);
    let (sender, received) = mpsc::channel();
    let callback = move |sample: Sample| {
        assert_eq!(*sample.encoding(), zenoh::bytes::Encoding::APPLICATION_JSON);
        let chunk = sample.key_expr().rsplit('/').next().unwrap_or_default().to_owned();
        sender.send((chunk, serde_json::from_slice(&sample.payload().to_bytes()).unwrap())).unwrap();
    };
    session.declare_subscriber("lockstep/*/live/**").callback(callback).background().wait().unwrap();
    while watch.shared.watched.load(Ordering::Relaxed) < 2 {
        thread::yield_now();
    }
    for tick in 0..100 {
        board.set_tick(tick);
        watch.row(tick, &[(tick as f64).to_bits(), 2]).unwrap();
    }
    end(watch);
    received.try_iter().collect()
}

fn ticks_of_values(received: &[(String, Value)]) -> Vec<u64> {
    let values = received.iter().filter(|(chunk, _)| chunk == "quad");
    values.map(|(_, message)| message["tick"].as_u64().unwrap()).collect()
}

#[test]
fn a_sample_includes_the_last_row_and_then_the_end() {
    let received = received(Rate::Sample, finish);
    let ticks = ticks_of_values(&received);
    assert!(ticks.is_sorted_by(|one, next| one < next) && ticks.last() == Some(&99), "{ticks:?}");
    let [.., (values, last_row), (live, end)] = &received[..] else { panic!("{received:?}") };
    assert_eq!((values.as_str(), live.as_str()), ("quad", "live"));
    assert_eq!(last_row["values"], serde_json::json!({ "height": 99.0, "method": 2 }));
    assert_eq!((&end["state"], &end["tick"]), (&Value::from("finished"), &Value::from(99)));
}

#[test]
fn the_end_of_a_run_whose_results_cannot_be_written_is_published_as_that_of_a_broken_run() {
    let received = received(Rate::Sample, drop);
    let [.., (live, end)] = &received[..] else { panic!("{received:?}") };
    assert_eq!((live.as_str(), &end["state"]), ("live", &Value::from("broken")));
}

#[test]
fn every_row_is_received_in_order_at_the_rate_of_every_tick() {
    assert_eq!(ticks_of_values(&received(Rate::EveryTick, finish)), (0..100).collect::<Vec<_>>());
}

#[test]
fn no_row_is_copied_while_there_is_no_subscriber() {
    let (mut watch, _session, _board) = begun(Rate::EveryTick);
    watch.row(0, &[0, 0]).unwrap();
    let mut words = VecDeque::new();
    watch.shared.rows().exchange(&mut words);
    assert_eq!(words, Vec::<u64>::new());
}

#[test]
fn a_query_for_the_schema_returns_what_the_values_are() {
    let (watch, session, _board) = begun(Rate::Sample);
    let replies = session.get(format!("lockstep/{}/schema/*", watch.run())).wait().unwrap();
    let reply = replies.recv().unwrap();
    let schema: Value = serde_json::from_slice(&reply.result().unwrap().payload().to_bytes()).unwrap();
    assert_eq!((&schema[0]["variable"], &schema[0]["unit"]), (&Value::from("height"), &Value::from("m")));
    assert_eq!((&schema[1]["variable"], &schema[1]["type"]), (&Value::from("method"), &Value::from("Enumeration")));
}
