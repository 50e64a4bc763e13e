//! What is said besides blocks: who calls whom, which instances a worker holds, what a reply tells in words.

use crate::flatten::values::{Slot, Values};
use crate::flatten::wiring::VariableSlot;
use crate::run::message::Message;
use crate::run::run_spec::path_bytes;
use crate::run::worker::{Lost, Terminated};
use dsl::scenario::Preset;
use fmi2::description::{BaseType, ModelDescription};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::path::PathBuf;
use unit::call_log::LONGEST_PIECE;

/// The version of everything that travels.
pub const PROTOCOL: u32 = 1;

/// What is said at once has no more bytes.
const MOST_WORDS: usize = 256 << 10;

/// Who speaks; JSON, so that every version can read that of every other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Handshake {
    /// [`PROTOCOL`]
    pub protocol: u32,
    /// The version of Lockstep.
    pub lockstep: String,
    /// System and processor: equal bytes are promised for equal arithmetic only.
    pub target: String,
}

impl Handshake {
    /// This program.
    #[must_use]
    pub fn this() -> Self {
        use std::env::consts::{ARCH, OS};
        Self { protocol: PROTOCOL, lockstep: env!("CARGO_PKG_VERSION").to_owned(), target: format!("{ARCH}-{OS}") }
    }

    /// Whether results of the two can be expected to have the same bytes.
    ///
    /// # Errors
    /// In which respect they differ.
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

/// What a worker is to held.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OpenRequest {
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

/// A unit as a worker is told of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Unit {
    /// What messages call it.
    pub name: String,
    /// Where it lies unpacked.
    #[serde(with = "path_bytes")]
    pub folder: PathBuf,
    /// SHA-256 of its archive.
    pub sha256: String,
}

/// An instance as a worker is told of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct InstanceSpec {
    /// Its index in the scenario.
    pub index: usize,
    /// Its name in the script.
    pub name: String,
    /// Which of the units it is.
    pub unit: usize,
    /// What is set before initialization.
    pub presets: Vec<Preset>,
    /// Whether its calls are told.
    pub log_calls: bool,
    /// The variables of a block towards it, as indices into the unit's description.
    pub inputs: Vec<usize>,
    /// The variables of a block from it.
    pub outputs: Vec<usize>,
}

/// Instances that step and deliver together.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GroupSpec {
    /// The period in ticks.
    pub every: u64,
    /// The instances by their index in the scenario.
    pub instances: Vec<usize>,
}

impl OpenRequest {
    /// A number for the layout of blocks: equal where both sides mean the same by every value. Each side computes it from
    /// the descriptions that it has read itself; `None` if a variable is not there.
    #[must_use]
    pub fn schema<'d>(&self, description_of: impl Fn(usize) -> Option<&'d ModelDescription>) -> Option<u64> {
        let mut hash = Sha256::new();
        for held in &self.instances {
            let description = description_of(held.unit)?;
            let unit = self.units.get(held.unit)?;
            for (direction, variables) in [("in", &held.inputs), ("out", &held.outputs)] {
                hash.update(format!("{}\0{}\0{direction}\0{}\0", held.name, unit.sha256, variables.len()));
                for &index in variables {
                    let variable = description.variables.get(index)?;
                    hash.update(format!("{}\0{:?}\0", variable.name, variable.base_type()));
                }
            }
        }
        hash.finalize().first_chunk().map(|first| u64::from_le_bytes(*first))
    }
}

/// What an order of initialization wants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Initial {
    /// All instances enter initialization mode.
    Enter,
    /// These variables of an instance are set.
    Set(Picked),
    /// These variables of an instance are read; their values come back in the same order.
    Get(Picked),
}

/// Some variables of an instance with their values, each type in its own order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Picked {
    /// The instance.
    pub instance: usize,
    /// Type and value reference of each.
    pub variables: Vec<(BaseType, u32)>,
    /// The values.
    pub values: Values,
}

impl Picked {
    /// Picks values out of all.
    #[must_use]
    pub fn out_of(instance: usize, picks: &[VariableSlot], all: &Values) -> Self {
        let mut values = Values::default();
        for pick in picks {
            let slot = values.add(pick.slot.base);
            values.copy_slot(slot, all, pick.slot);
        }
        let variables = picks.iter().map(|pick| (pick.slot.base, pick.reference)).collect();
        Self { instance, variables, values }
    }

    /// The same variables with places in [`Picked::values`]; `None` if there is not a value for each.
    #[must_use]
    pub fn picks(&self) -> Option<Vec<VariableSlot>> {
        let mut counted = Values::default();
        let picks = self.variables.iter().map(|&(base, reference)| VariableSlot { slot: counted.add(base), reference });
        let picks = picks.collect();
        (counted.end() == self.values.end()).then_some(picks)
    }

    /// Puts the values where they belong among all.
    pub fn put_into(&self, picks: &[VariableSlot], all: &mut Values) {
        let mut counted = Values::default();
        for pick in picks {
            let slot: Slot = counted.add(pick.slot.base);
            all.copy_slot(pick.slot, &self.values, slot);
        }
    }
}

/// What a reply says besides its blocks; mostly nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplyExtras {
    /// LogOrder and calls of its units since the reply before.
    pub said: Vec<Message>,
    /// Instances that are done for good.
    pub terminated: Vec<Terminated>,
    /// What went wrong; there are no blocks then.
    pub lost: Option<Lost>,
    /// What was asked for by [`Initial::Get`].
    pub values: Values,
    /// Serialized states, by index of the instance.
    pub states: Vec<(usize, Vec<u8>)>,
}

impl ReplyExtras {
    /// As bytes: none where there is nothing to say.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        if *self == Self::default() { Vec::new() } else { bytes(self) }
    }

    /// What bytes say; `None` if they say nothing that can be understood.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        if bytes.is_empty() { Some(Self::default()) } else { read(bytes) }
    }

    /// Whether a worker that holds these instances may say this: words and calls of theirs, no longer than a board takes,
    /// and nothing of others.
    #[must_use]
    pub fn is_of(&self, holds: impl Fn(usize) -> bool) -> bool {
        let its_own = |told: &Message| match told {
            Message::Log(said) => {
                said.instance.is_none_or(&holds) && said.text.len() + said.category.len() <= MOST_WORDS
            }
            Message::Calls(piece) => holds(piece.instance) && piece.bytes.len() <= LONGEST_PIECE,
            Message::Saved(_) | Message::Finished(_) | Message::Broken(_) => false,
        };
        let lost = self.lost.as_ref();
        self.said.iter().all(its_own)
            && self.terminated.iter().all(|ended| holds(ended.instance))
            && lost.is_none_or(|lost| holds(lost.instance) && bytes(lost).len() <= MOST_WORDS)
    }
}

/// What goes along with a message, as bytes.
#[must_use]
pub fn bytes(value: &impl Serialize) -> Vec<u8> {
    match postcard::to_stdvec(value) {
        Ok(bytes) => bytes,
        Err(error) => unreachable!("plain data always has bytes: {error}"),
    }
}

/// What bytes say, if all of them say it.
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
    fn another_protocol_version_or_target_is_told_apart() {
        let this = Handshake::this();
        assert_eq!(this.agrees_with(&this), Ok(()));
        let other = Handshake { protocol: 99, ..this.clone() };
        assert_eq!(this.agrees_with(&other), Err("its worker has protocol 99, this program 1".to_owned()));
        let other = Handshake { target: "pdp11-unix".to_owned(), ..this.clone() };
        assert!(this.agrees_with(&other).is_err_and(|said| said.contains("target pdp11-unix")));
    }

    #[test]
    fn picked_values_find_their_places_again() {
        let all = Values {
            reals: vec![0.0, f64::NAN, 2.0],
            integers: vec![3],
            booleans: vec![1],
            texts: vec!["a".to_owned(), "b".to_owned()],
        };
        let pick = |base, index, reference| VariableSlot { slot: Slot { base, index }, reference };
        let picks = [pick(BaseType::Real, 2, 8), pick(BaseType::String, 1, 9), pick(BaseType::Real, 1, 7)];
        let picked = Picked::out_of(4, &picks, &all);
        assert_eq!((picked.values.reals[0], picked.values.texts.as_slice()), (2.0, ["b".to_owned()].as_slice()));
        let local = picked.picks().unwrap();
        assert_eq!(
            local.iter().map(|pick| (pick.slot.index, pick.reference)).collect::<Vec<_>>(),
            [(0, 8), (0, 9), (1, 7)]
        );
        let mut back = Values { reals: vec![9.0; 3], texts: vec![String::new(); 2], ..all.clone() };
        picked.put_into(&picks, &mut back);
        assert!(back.reals[0] == 9.0 && back.reals[1].is_nan() && back.reals[2] == 2.0 && back.texts[1] == "b");
        let missing = Picked { values: Values::default(), ..picked };
        assert!(missing.picks().is_none());
    }

    #[test]
    fn a_reply_without_words_has_no_bytes_and_garbage_is_none() {
        assert_eq!(ReplyExtras::default().bytes(), [0_u8; 0]);
        assert_eq!(ReplyExtras::read(&[]), Some(ReplyExtras::default()));
        let extras = ReplyExtras { states: vec![(1, vec![2, 3])], ..ReplyExtras::default() };
        let mut bytes = extras.bytes();
        assert_eq!(ReplyExtras::read(&bytes), Some(extras));
        bytes.push(0);
        assert_eq!(ReplyExtras::read(&bytes), None);
    }

    #[test]
    fn a_worker_speaks_for_its_own_instances_only() {
        let holds = |instance| instance == 3;
        let said = |instance, length| {
            let (category, text) = (String::new(), "x".repeat(length));
            Message::Log(LogMessage { instance, tick: 0, counts_at: 0, status: 0, category, text })
        };
        let saying = |told| ReplyExtras { said: vec![told], ..ReplyExtras::default() };
        let calls = |instance| Message::Calls(CallPiece { instance, bytes: Vec::new() });
        for its_own in [said(Some(3), 9), said(None, 9), calls(3)] {
            assert!(saying(its_own).is_of(holds));
        }
        let finished = Message::Finished(Finish { last_tick: 0, reason: Reason::StopTime });
        for other in [said(Some(2), 9), said(Some(3), MOST_WORDS + 1), calls(2), Message::Saved(1), finished] {
            assert!(!saying(other).is_of(holds));
        }
        let ended = Terminated { instance: 99, last_successful_time_s: 0.0 };
        assert!(!ReplyExtras { terminated: vec![ended], ..ReplyExtras::default() }.is_of(holds));
        let (doing, cause) = (Doing::BetweenCalls, Cause::Other("x".repeat(MOST_WORDS)));
        let lost = |instance, cause| Lost { instance, failure: Failure { instance: None, doing, time_s: None, cause } };
        assert!(ReplyExtras { lost: Some(lost(3, Cause::Signal(9))), ..ReplyExtras::default() }.is_of(holds));
        assert!(!ReplyExtras { lost: Some(lost(2, Cause::Signal(9))), ..ReplyExtras::default() }.is_of(holds));
        assert!(!ReplyExtras { lost: Some(lost(3, cause)), ..ReplyExtras::default() }.is_of(holds));
    }

    proptest::proptest! {
        #[test]
        fn any_bytes_are_read_without_a_panic(bytes: Vec<u8>) {
            let _ = (ReplyExtras::read(&bytes), read::<OpenRequest>(&bytes).is_some(), read::<Initial>(&bytes));
        }
    }
}
