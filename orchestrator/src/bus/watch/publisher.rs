//! The thread that puts on keys what the run has left for those who watch.

use super::keys;
use super::payload::{self, Moment, Variable};
use super::session::Listening;
use super::{Rate, SAMPLE_EVERY, Shared};
use crate::flatten::claims::info;
use crate::flatten::columns;
use crate::host::supervise::standings;
use crate::run::run_spec::RunSpec;
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

/// A key that somebody may watch.
#[derive(Debug)]
struct Key {
    publisher: pubsub::Publisher<'static>,
    watched: Arc<AtomicBool>,
}

/// The recorded variables of an instance and their key.
#[derive(Debug)]
struct WatchedInstance {
    key: Key,
    variables: Vec<Variable>,
}

/// Everything that is put, and when.
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
    told_tick: Option<u64>,
    told: Instant,
}

impl Publisher {
    /// Declares the keys of a run. Instances of which nothing is recorded have none.
    pub fn new(
        listening: &Listening,
        shared: Arc<Shared>,
        rate: Rate,
        run: String,
        spec: &RunSpec,
    ) -> Result<Self, zenoh::Error> {
        let session = listening.session.clone();
        let scenario = &spec.scenario;
        let description_of = |instance: usize| &spec.units[spec.unit_of[instance]].description;
        let signals: Vec<_> = columns::of(scenario, description_of).collect();
        let mut instances = Vec::new();
        for (index, instance) in scenario.instances.iter().enumerate() {
            let columns = scenario.columns.iter().enumerate().filter(|(_, column)| column.port.instance == index);
            let columns: Vec<_> = columns.map(|(column, _)| column).collect();
            if columns.is_empty() {
                continue;
            }
            let schema = json_text(&columns.iter().map(|&column| &signals[column]).collect::<Vec<_>>());
            answer(&session, keys::schema(&run, &instance.name), schema)?;
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
            told_tick: None,
            told: Instant::now(),
        })
    }

    /// Puts until it hears how the run ended, then puts the rest and closes the session. Returns how many rows came too
    /// fast.
    pub fn run(mut self, ending: &Receiver<RunState>) -> u64 {
        let end = loop {
            match ending.recv_timeout(self.rate.look_every()) {
                Err(RecvTimeoutError::Timeout) => self.put(RunState::Running),
                Ok(end) => break end,
                Err(RecvTimeoutError::Disconnected) => break RunState::Broken,
            }
        };
        self.put(end);
        // Whoever watched is told or gone.
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

    /// How far the run is, if that has changed since it was told; at the end whether it has or not.
    fn put_state(&mut self, state: RunState) {
        let Some(board) = self.shared.board.get() else { return };
        let tick = board.tick();
        if state == RunState::Running && (self.told_tick == Some(tick) || self.told.elapsed() < SAMPLE_EVERY) {
            return;
        }
        let moment = Moment { run: &self.run, tick, step_ns: self.step_ns };
        let claims = &self.claims;
        if self.state.put(|| payload::state(moment, state, claims, &standings(board, claims.len()))) {
            (self.told_tick, self.told) = (Some(tick), Instant::now());
        }
    }
}

impl Key {
    /// Puts on a key are dropped rather than waited for, and give way to everything else.
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

    /// Puts a payload if somebody watches, and says whether somebody does.
    fn put(&self, payload: impl FnOnce() -> Vec<u8>) -> bool {
        let watched = self.watched.load(Ordering::Relaxed);
        if watched {
            // Whoever watches is no reason to end a run.
            self.publisher.put(payload()).wait().ok();
        }
        watched
    }
}

/// Answers whoever asks for a key with a text.
fn answer(session: &Session, key: String, text: String) -> Result<(), zenoh::Error> {
    let reply = {
        let key = key.clone();
        move |query: zenoh::query::Query| {
            // Who asked may be gone.
            query.reply(&key, text.as_str()).encoding(Encoding::APPLICATION_JSON).wait().ok();
        }
    };
    session.declare_queryable(key).callback(reply).background().wait()
}
