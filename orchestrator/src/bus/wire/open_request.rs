//! The extras of messages: handshake, request of instances, initial values, log messages and failures.

use crate::run::message::Message;
use crate::run::run_spec::path_bytes;
use crate::run::worker::{Lost, Terminated};
use dsl::scenario::Preset;
use flatten::values::{Slot, ValueType, Values};
use flatten::wiring::VariableSlot;
use fmi2::description::ModelDescription;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::PathBuf;
use unit::call_log::LONGEST_PIECE;

/// The version of all messages.
pub const PROTOCOL: u32 = 2;

/// The most bytes of one log message or failure.
const LONGEST_TEXT: usize = 256 << 10;

/// Identifies a program; JSON, so that every version can read that of every other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Handshake {
    /// [`PROTOCOL`]
    pub protocol: u32,
    /// The version of Lockstep.
    pub lockstep: String,
    /// System and processor: results have the same bytes only where arithmetic is the same.
    pub target: String,
}

impl Handshake {
    /// This program.
    #[must_use]
    pub fn this() -> Self {
        use std::env::consts::{ARCH, OS};
        Self { protocol: PROTOCOL, lockstep: env!("CARGO_PKG_VERSION").to_owned(), target: format!("{ARCH}-{OS}") }
    }

    /// Checks that the two programs understand each other and give results of the same bytes.
    ///
    /// # Errors
    /// The first respect in which they differ.
    pub fn agrees_with(&self, other: &Self) -> Result<(), String> {
        let differ =
            |what: &str, ours: &str, theirs: &str| Err(format!("its worker has {what} {theirs}, this program {ours}"));
        if self.protocol != other.protocol {
            return differ("protocol", &self.protocol.to_string(), &other.protocol.to_string());
        }
        if self.lockstep != other.lockstep {
            return differ("version", &self.lockstep, &other.lockstep);
        }
        if self.target != other.target {
            return differ("target", &self.target, &other.target);
        }
        Ok(())
    }
}

/// What a worker is to hold.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OpenRequest {
    /// The tick at which the run begins.
    pub start_tick: u64,
    /// The communication step in nanoseconds.
    pub step_ns: u64,
    /// The folder that `file("…")` is relative to.
    #[serde(with = "path_bytes")]
    pub folder: PathBuf,
    /// The units of its instances, each once.
    pub units: Vec<Unit>,
    /// Its instances, in the script's order.
    pub instances: Vec<InstanceSpec>,
    /// Its groups.
    pub groups: Vec<GroupSpec>,
}

/// A unit as a worker needs to know it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unit {
    /// Its name in messages for the user.
    pub name: String,
    /// The folder of its unpacked archive.
    #[serde(with = "path_bytes")]
    pub folder: PathBuf,
    /// SHA-256 of its archive.
    pub sha256: String,
}

/// An instance as a worker needs to know it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct InstanceSpec {
    /// Its index in the scenario.
    pub index: usize,
    /// Its name in the script.
    pub name: String,
    /// Index of its unit in [`OpenRequest::units`].
    pub unit: usize,
    /// The values that are set before initialization.
    pub presets: Vec<Preset>,
    /// Whether its FMI calls are logged.
    pub log_calls: bool,
    /// The variables of its blocks in orders, as indices into the unit's description.
    pub inputs: Vec<usize>,
    /// The variables of its blocks in replies.
    pub outputs: Vec<usize>,
}

/// Instances that step together and whose outputs return in one reply.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GroupSpec {
    /// The period in ticks.
    pub every: u64,
    /// The instances by their index in the scenario.
    pub instances: Vec<usize>,
}

impl OpenRequest {
    /// The number of the layout of blocks: equal where every value has the same meaning on both sides. Each side computes
    /// it from the descriptions that it has read itself, so that a unit that was replaced meanwhile is detected before the
    /// first step. `None` if a variable does not exist.
    #[must_use]
    pub fn schema<'d>(&self, description_of: impl Fn(usize) -> Option<&'d ModelDescription>) -> Option<u64> {
        let mut hash = Sha256::new();
        for instance in &self.instances {
            let description = description_of(instance.unit)?;
            let unit = self.units.get(instance.unit)?;
            for (direction, variables) in [("in", &instance.inputs), ("out", &instance.outputs)] {
                hash.update(format!("{}\0{}\0{direction}\0{}\0", instance.name, unit.sha256, variables.len()));
                for &index in variables {
                    let variable = description.variables.get(index)?;
                    hash.update(format!("{}\0{:?}\0", variable.name, ValueType::of(variable)));
                }
            }
        }
        hash.finalize().first_chunk().map(|first| u64::from_le_bytes(*first))
    }
}

/// The extras of [`Kind::Initialise`](super::Kind::Initialise).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Initial {
    /// All instances enter initialization mode.
    Enter,
    /// These variables of an instance are set.
    Set(SelectedValues),
    /// These variables of an instance are read; their values come back in the same order.
    Get(SelectedValues),
}

/// Some variables of an instance with their values, each type in its own order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SelectedValues {
    /// The instance.
    pub instance: usize,
    /// Type of each variable, and its index in the unit's description.
    pub variables: Vec<(ValueType, usize)>,
    /// The values.
    pub values: Values,
}

impl SelectedValues {
    /// Copies the values of these slots out of all values.
    #[must_use]
    pub fn select(instance: usize, slots: &[VariableSlot], all: &Values) -> Self {
        let mut values = Values::default();
        for variable in slots {
            let slot = values.add(variable.slot.base);
            values.copy_slot(slot, all, variable.slot);
        }
        let variables = slots.iter().map(|variable| (variable.slot.base, variable.variable)).collect();
        Self { instance, variables, values }
    }

    /// The variables with their slots in [`SelectedValues::values`]; `None` if the number of values differs.
    #[must_use]
    pub fn slots(&self) -> Option<Vec<VariableSlot>> {
        let mut counted = Values::default();
        let slots = self.variables.iter().map(|&(base, variable)| VariableSlot { slot: counted.add(base), variable });
        let slots = slots.collect();
        (counted.end() == self.values.end()).then_some(slots)
    }

    /// Copies the values to these slots among all values: the inverse of [`SelectedValues::select`].
    pub fn copy_to(&self, slots: &[VariableSlot], all: &mut Values) {
        let mut counted = Values::default();
        for variable in slots {
            let slot: Slot = counted.add(variable.slot.base);
            all.copy_slot(variable.slot, &self.values, slot);
        }
    }
}

/// The extras of a reply; empty for most steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplyExtras {
    /// Log messages and logged calls of its units since the previous reply.
    pub messages: Vec<Message>,
    /// Instances that have terminated.
    pub terminated: Vec<Terminated>,
    /// The failure, if the order failed; the reply has no blocks then.
    pub lost: Option<Lost>,
    /// The values of the variables of [`Initial::Get`].
    pub values: Values,
    /// Serialized states, by index of the instance.
    pub states: Vec<(usize, Vec<u8>)>,
}

impl ReplyExtras {
    /// Encodes the extras; empty ones have no bytes, so that the reply of most steps costs nothing here.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        if *self == Self::default() { Vec::new() } else { bytes(self) }
    }

    /// Decodes extras; `None` if the bytes are invalid.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        if bytes.is_empty() { Some(Self::default()) } else { read(bytes) }
    }

    /// Whether a worker that holds these instances may send this: log messages, calls and failures of its own instances,
    /// each of limited length. A unit can write anywhere in its worker's memory, so replies are checked.
    #[must_use]
    pub fn is_limited_to(&self, holds: impl Fn(usize) -> bool) -> bool {
        let is_allowed = |message: &Message| match message {
            Message::Log(log) => log.instance.is_none_or(&holds) && log.text.len() + log.category.len() <= LONGEST_TEXT,
            Message::Calls(piece) => holds(piece.instance) && piece.bytes.len() <= LONGEST_PIECE,
            Message::Saved(_) | Message::Finished(_) | Message::Broken(_) | Message::Window(_) => false,
        };
        let lost = self.lost.as_ref();
        self.messages.iter().all(is_allowed)
            && self.terminated.iter().all(|ended| holds(ended.instance))
            && lost.is_none_or(|lost| holds(lost.instance) && bytes(lost).len() <= LONGEST_TEXT)
    }
}

/// Encodes extras.
#[must_use]
pub fn bytes(value: &impl Serialize) -> Vec<u8> {
    match postcard::to_stdvec(value) {
        Ok(bytes) => bytes,
        Err(error) => unreachable!("plain data always has bytes: {error}"),
    }
}

/// Decodes extras; `None` if the bytes are invalid or too many.
#[must_use]
pub fn read<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Option<T> {
    postcard::take_from_bytes(bytes).ok().filter(|(_, rest)| rest.is_empty()).map(|(value, _)| value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::message::{CallPiece, Finish, Reason};
    use unit::failure::{Cause, Doing, Failure};
    use unit::logger::LogMessage;

    #[test]
    fn another_protocol_version_or_target_is_rejected() {
        let this = Handshake::this();
        assert_eq!(this.agrees_with(&this), Ok(()));
        let other = Handshake { protocol: 99, ..this.clone() };
        assert_eq!(this.agrees_with(&other), Err("its worker has protocol 99, this program 2".to_owned()));
        let other = Handshake { target: "pdp11-unix".to_owned(), ..this.clone() };
        assert!(this.agrees_with(&other).is_err_and(|message| message.contains("target pdp11-unix")));
    }

    #[test]
    fn selected_values_are_copied_back_to_their_slots() {
        let all = Values {
            reals: vec![0.0, f64::NAN, 2.0],
            integers: vec![3],
            booleans: vec![1],
            texts: vec!["a".to_owned(), "b".to_owned()],
        };
        let variable = |base, index, variable| VariableSlot { slot: Slot { base, index }, variable };
        let slots = [variable(ValueType::Real, 2, 8), variable(ValueType::Text, 1, 9), variable(ValueType::Real, 1, 7)];
        let selected = SelectedValues::select(4, &slots, &all);
        assert_eq!((selected.values.reals[0], selected.values.texts.as_slice()), (2.0, ["b".to_owned()].as_slice()));
        let local = selected.slots().unwrap();
        assert_eq!(
            local.iter().map(|variable| (variable.slot.index, variable.variable)).collect::<Vec<_>>(),
            [(0, 8), (0, 9), (1, 7)]
        );
        let mut back = Values { reals: vec![9.0; 3], texts: vec![String::new(); 2], ..all.clone() };
        selected.copy_to(&slots, &mut back);
        assert!(back.reals[0] == 9.0 && back.reals[1].is_nan() && back.reals[2] == 2.0 && back.texts[1] == "b");
        let missing = SelectedValues { values: Values::default(), ..selected };
        assert!(missing.slots().is_none());
    }

    #[test]
    fn empty_extras_have_no_bytes_and_invalid_bytes_are_rejected() {
        assert_eq!(ReplyExtras::default().bytes(), [0_u8; 0]);
        assert_eq!(ReplyExtras::read(&[]), Some(ReplyExtras::default()));
        let extras = ReplyExtras { states: vec![(1, vec![2, 3])], ..ReplyExtras::default() };
        let mut bytes = extras.bytes();
        assert_eq!(ReplyExtras::read(&bytes), Some(extras));
        bytes.push(0);
        assert_eq!(ReplyExtras::read(&bytes), None);
    }

    #[test]
    fn a_worker_may_send_messages_of_its_own_instances_only() {
        let holds = |instance| instance == 3;
        let log = |instance, length| {
            let (category, text) = (String::new(), "x".repeat(length));
            Message::Log(LogMessage { instance, tick: 0, counts_at: 0, status: 0, category, text })
        };
        let with_message = |message| ReplyExtras { messages: vec![message], ..ReplyExtras::default() };
        let calls = |instance| Message::Calls(CallPiece { instance, bytes: Vec::new() });
        for own in [log(Some(3), 9), log(None, 9), calls(3)] {
            assert!(with_message(own).is_limited_to(holds));
        }
        let finished = Message::Finished(Finish { last_tick: 0, reason: Reason::StopTime });
        for other in [log(Some(2), 9), log(Some(3), LONGEST_TEXT + 1), calls(2), Message::Saved(1), finished] {
            assert!(!with_message(other).is_limited_to(holds));
        }
        let ended = Terminated { instance: 99, last_successful_time_s: 0.0 };
        assert!(!ReplyExtras { terminated: vec![ended], ..ReplyExtras::default() }.is_limited_to(holds));
        let (doing, cause) = (Doing::BetweenCalls, Cause::Other("x".repeat(LONGEST_TEXT)));
        let lost = |instance, cause| Lost { instance, failure: Failure { instance: None, doing, time_s: None, cause } };
        assert!(ReplyExtras { lost: Some(lost(3, Cause::Signal(9))), ..ReplyExtras::default() }.is_limited_to(holds));
        assert!(!ReplyExtras { lost: Some(lost(2, Cause::Signal(9))), ..ReplyExtras::default() }.is_limited_to(holds));
        assert!(!ReplyExtras { lost: Some(lost(3, cause)), ..ReplyExtras::default() }.is_limited_to(holds));
    }

    proptest::proptest! {
        #[test]
        fn any_bytes_are_decoded_without_a_panic(bytes: Vec<u8>) {
            let _ = (ReplyExtras::read(&bytes), read::<OpenRequest>(&bytes).is_some(), read::<Initial>(&bytes));
        }
    }
}
