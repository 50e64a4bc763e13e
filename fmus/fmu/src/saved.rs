//! Saved states: kept in memory behind handles, or serialized to bytes that only the same unit reads.

use crate::instance::{Instance, Progress};
use crate::library::Unit;
use crate::refusal::Refusal;
use crate::step::Time;
use fmi2::c::Status;
use fmi2::calls::State;
use serde::{Deserialize, Serialize};
use twox_hash::XxHash3_128;

/// The first bytes of every serialized state; the last one is the version of this format.
const MAGIC: &[u8; 8] = b"LOCKSTP\x02";

/// A saved state.
pub(crate) struct Saved {
    unit: Box<dyn Unit>,
    progress: Progress,
}

/// The header between the magic and the payload.
#[derive(Serialize, Deserialize, PartialEq)]
struct Header {
    /// Identifies the unit's interface.
    guid: String,
    /// Size of the unit's struct: another build may have another hidden state.
    size: u64,
    /// Hash of the payload.
    checksum: u128,
}

/// The payload.
#[derive(Serialize, Deserialize)]
struct Payload {
    /// Index into [`State::ALL`].
    state: u8,
    experiment: Option<(f64, Option<f64>)>,
    now_ns: Option<i64>,
    now_s: f64,
    ended: bool,
    stale: bool,
    unit: Vec<u8>,
}

impl Instance {
    /// Keeps the present state, replacing the one at index `into` if there is one. Returns its index.
    pub(crate) fn save(&mut self, into: Option<usize>) -> usize {
        let progress = self.progress;
        if let Some(saved) = into.and_then(|index| self.saved.get_mut(index)) {
            saved.unit.copy_from(self.body.unit());
            saved.progress = progress;
        }
        into.unwrap_or_else(|| {
            self.saved.push(Box::new(Saved { unit: self.body.unit().duplicate(), progress }));
            self.saved.len() - 1
        })
    }

    /// Restores a saved state.
    pub(crate) fn restore(&mut self, index: usize) -> Result<Status, Refusal> {
        let saved = &self.saved[index];
        self.body.unit_mut().copy_from(&*saved.unit);
        self.progress = saved.progress;
        Ok(Status::Ok)
    }

    /// Serializes a saved state.
    pub(crate) fn to_bytes(&self, index: usize) -> Result<Vec<u8>, Refusal> {
        let Saved { unit, progress } = &*self.saved[index];
        let broken = |error: postcard::Error| Refusal::Serialize { cause: error.to_string() };
        let payload = Payload {
            state: progress.state as u8,
            experiment: progress.experiment,
            now_ns: if let Time::Nanoseconds(ns) = progress.now { Some(ns) } else { None },
            now_s: progress.now.as_s(),
            ended: progress.ended,
            stale: progress.stale,
            unit: unit.to_bytes().map_err(broken)?,
        };
        let payload = postcard::to_stdvec(&payload).map_err(broken)?;
        let header = postcard::to_stdvec(&self.header(&payload)).map_err(broken)?;
        Ok([MAGIC, &*header, &*payload].concat())
    }

    /// Reads a serialized state and keeps it, replacing the one at index `into` if there is one. Returns its index.
    pub(crate) fn read_bytes(&mut self, bytes: &[u8], into: Option<usize>) -> Result<usize, Refusal> {
        let refuse = |cause: &str| Refusal::Deserialize { cause: cause.to_owned() };
        let broken = |error: postcard::Error| refuse(&error.to_string());
        let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| refuse("they do not begin as one"))?;
        let (header, payload) = postcard::take_from_bytes::<Header>(rest).map_err(broken)?;
        let own = self.header(payload);
        if header.guid != own.guid {
            return Err(refuse(&format!("they belong to a unit with GUID {}", header.guid)));
        }
        if header.size != own.size {
            return Err(refuse("they belong to another build of this unit"));
        }
        if header.checksum != own.checksum {
            return Err(refuse("they are damaged or incomplete"));
        }
        let payload: Payload = postcard::from_bytes(payload).map_err(broken)?;
        let state = State::ALL.get(usize::from(payload.state)).copied();
        // Without a step in progress an instance has no other states.
        let state =
            state.filter(|state| !matches!(state, State::NotInstantiated | State::StepInProgress | State::Fatal));
        let progress = Progress {
            state: state.ok_or_else(|| refuse("they were saved in a state from which a run cannot continue"))?,
            experiment: payload.experiment,
            now: payload.now_ns.map_or(Time::Seconds(payload.now_s), Time::Nanoseconds),
            ended: payload.ended,
            stale: payload.stale,
        };
        let unit = self.body.unit().read_from(&payload.unit).map_err(broken)?;
        let read = Saved { unit, progress };
        if let Some(saved) = into.and_then(|index| self.saved.get_mut(index)) {
            **saved = read;
        } else {
            self.saved.push(Box::new(read));
        }
        Ok(into.unwrap_or(self.saved.len() - 1))
    }

    fn header(&self, payload: &[u8]) -> Header {
        Header {
            guid: self.body.described().description.guid.clone(),
            size: self.body.slots().size as u64,
            checksum: XxHash3_128::oneshot(payload),
        }
    }
}
