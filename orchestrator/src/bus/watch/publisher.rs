//! The thread that publishes a run's rows, state and claims on its keys.

use super::keys;
use super::payload::{self, Moment, Variable};
use super::session::Listening;
use super::{Rate, SAMPLE_EVERY, Shared};
use crate::host::supervise::standings;
use crate::run::run_spec::RunSpec;
use flatten::claims::info;
use flatten::columns;
use results::json_text;
use results::run_record::RunState;
use results::verdict::ClaimInfo;
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Instant;
use zenoh::bytes::Encoding;
use zenoh::pubsub;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Session, Wait};

/// A key with its publisher.
#[derive(Debug)]
struct Key {
    publisher: pubsub::Publisher<'static>,
    /// Whether it has subscribers.
    watched: Arc<AtomicBool>,
}

/// The recorded variables of an instance and their key.
#[derive(Debug)]
struct WatchedInstance {
    key: Key,
    variables: Vec<Variable>,
}

/// All keys of a run and what is published on them.
#[derive(Debug)]
pub(super) struct Publisher {
    session: Session,
    shared: Arc<Shared>,
    rate: Rate,
    run: String,
    step_ns: u64,
    columns: usize,
    claims: Vec<ClaimInfo>,
    instances: Vec<WatchedInstance>,
    state: Key,
    taken: VecDeque<u64>,
    /// The last published state: its tick and when it was published.
    state_tick: Option<u64>,
    state_put: Instant,
}

impl Publisher {
    /// Declares the keys of a run. Instances without recorded variables have none.
    pub fn new(
        listening: &Listening,
        shared: Arc<Shared>,
        rate: Rate,
        run: String,
        spec: &RunSpec,
    ) -> Result<Self, zenoh::Error> {
        let session = listening.session.clone();
        let scenario = &spec.scenario;
        let description_of = |instance: usize| &spec.unit(instance).description;
        let signals: Vec<_> = columns::of(scenario, description_of).collect();
        let mut instances = Vec::new();
        for (index, instance) in scenario.instances.iter().enumerate() {
            let columns = scenario
                .columns
                .iter()
                .enumerate()
                .filter(|(_, column)| column.port().is_some_and(|port| port.instance == index));
            let columns: Vec<_> = columns.map(|(column, _)| column).collect();
            if columns.is_empty() {
                continue;
            }
            let schema = json_text(&columns.iter().map(|&column| &signals[column]).collect::<Vec<_>>());
            declare_reply(&session, keys::schema(&run, &instance.name), schema)?;
            let variable = |&column: &usize| Variable {
                name: signals[column].variable.unwrap_or_default().to_owned(),
                column,
                slot_type: signals[column].slot_type,
            };
            let key = Key::declare(&session, keys::values(&run, &instance.name), &shared)?;
            instances.push(WatchedInstance { key, variables: columns.iter().map(variable).collect() });
        }
        Ok(Self {
            state: Key::declare(&session, keys::live(&run), &shared)?,
            session,
            shared,
            rate,
            run,
            step_ns: scenario.step_ns,
            columns: scenario.columns.len(),
            claims: scenario.claims.iter().map(info).collect(),
            instances,
            taken: VecDeque::new(),
            state_tick: None,
            state_put: Instant::now(),
        })
    }

    /// Publishes until the end of the run is received, then publishes the rest and closes the session. Returns how many
    /// rows were dropped.
    pub fn run(mut self, ending: &Receiver<RunState>) -> u64 {
        let end = loop {
            match ending.recv_timeout(self.rate.period()) {
                Err(RecvTimeoutError::Timeout) => self.put(RunState::Running),
                Ok(end) => break end,
                Err(RecvTimeoutError::Disconnected) => break RunState::Broken,
            }
        };
        self.put(end);
        // The run is over; an error here has no consequence.
        self.session.close().wait().ok();
        self.shared.rows().dropped()
    }

    fn put(&mut self, state: RunState) {
        self.shared.rows().exchange(&mut self.taken);
        for row in self.taken.make_contiguous().chunks_exact(self.columns + 1) {
            let moment = Moment { run: &self.run, tick: row[0], step_ns: self.step_ns };
            for WatchedInstance { key, variables } in &self.instances {
                key.put(|| payload::values(moment, variables, &row[1..]));
            }
        }
        self.taken.clear();
        self.put_state(state);
    }

    /// Publishes the state if the tick has changed since the last time; at the end in any case.
    fn put_state(&mut self, state: RunState) {
        let Some(board) = self.shared.board.get() else { return };
        let tick = board.tick();
        if state == RunState::Running && (self.state_tick == Some(tick) || self.state_put.elapsed() < SAMPLE_EVERY) {
            return;
        }
        let moment = Moment { run: &self.run, tick, step_ns: self.step_ns };
        let claims = &self.claims;
        if self.state.put(|| payload::state(moment, state, claims, &standings(board, claims.len()))) {
            (self.state_tick, self.state_put) = (Some(tick), Instant::now());
        }
    }
}

impl Key {
    /// Declares a key. Its messages are dropped when a subscriber is slow, so that it cannot delay the run, and have the lowest
    /// priority. A listener of zenoh updates whether the key has subscribers.
    fn declare(session: &Session, key: String, shared: &Arc<Shared>) -> Result<Self, zenoh::Error> {
        let publisher = session
            .declare_publisher(key)
            .encoding(Encoding::APPLICATION_JSON)
            .congestion_control(CongestionControl::Drop)
            .priority(Priority::Background)
            .wait()?;
        let watched = Arc::new(AtomicBool::new(false));
        let (flag, all) = (Arc::clone(&watched), Arc::clone(shared));
        let changed = move |status: zenoh::matching::MatchingStatus| {
            flag.store(status.matching(), Ordering::Relaxed);
            all.count_key(status.matching());
        };
        publisher.matching_listener().callback(changed).background().wait()?;
        Ok(Self { publisher, watched })
    }

    /// Publishes a payload if the key has subscribers; returns whether it has.
    fn put(&self, payload: impl FnOnce() -> Vec<u8>) -> bool {
        let watched = self.watched.load(Ordering::Relaxed);
        if watched {
            // An error of publishing must not end a run.
            self.publisher.put(payload()).wait().ok();
        }
        watched
    }
}

/// Replies to queries for a key with a constant text.
fn declare_reply(session: &Session, key: String, text: String) -> Result<(), zenoh::Error> {
    let reply = {
        let key = key.clone();
        move |query: zenoh::query::Query| {
            // The client that sent the query may have disconnected.
            query.reply(&key, text.as_str()).encoding(Encoding::APPLICATION_JSON).wait().ok();
        }
    };
    session.declare_queryable(key).callback(reply).background().wait()
}
