//! The messages between coordinator and worker as bytes: little endian, decoded by total functions.
//!
//! ```text
//!  0 u32 "LKS1"   4 u16 kind   6 u16 group   8 u64 schema   16 u64 sequence   24 u64 tick   32 u32 blocks   36 u32 extras
//! block: u32 instance · u32 zero · u32 n_real · u32 n_int · u32 n_bool · u32 n_string
//!        f64 × n_real · i32 × n_int · u8 × n_bool, 0 or 1 · zeros up to 8 · n_string × (u32 length, UTF-8) · zeros up to 8
//! extras: the last bytes of the message, what an order or reply carries besides its blocks
//! ```
//!
//! A block is always complete, so every message can be decoded without the ones before it. Its layout is that of the
//! instance's [`Ports`]; equal schema numbers mean that both sides use the same layout. Blocks are decoded
//! straight into the values of a run, without a copy between.

mod blocks;
pub mod open_request;

pub use blocks::Blocks;

use flatten::values::Values;
use flatten::wiring::Ports;
use std::fmt;

const MAGIC: u32 = u32::from_le_bytes(*b"LKS1");
const HEADER_BYTES: usize = 40;
const BLOCKS_AT: usize = 32;
const EXTRAS_AT: usize = 36;

/// The kind of a message. A reply has the number of its order plus 16.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Kind {
    /// The coordinator's [`open_request::Handshake`]; the extras are JSON, so that any version can read them.
    Hello = 1,
    /// The instances to make, their units and their ports.
    Open = 2,
    /// Enter initialization mode, or set or get variables in it; see [`open_request::Initial`].
    Initialise = 3,
    /// Exit initialization mode; the reply has all outputs.
    Start = 4,
    /// A group takes a step: the order has its inputs, the reply its outputs.
    Step = 5,
    /// Terminate and free all instances.
    Finish = 6,
    /// Serialize the state of all instances.
    Save = 7,
    /// Restore the state of all instances.
    Restore = 8,
    /// The reply to [`Kind::Hello`].
    Welcome = 17,
    /// The reply to [`Kind::Open`].
    Opened = 18,
    /// The reply to [`Kind::Initialise`].
    Initialised = 19,
    /// The reply to [`Kind::Start`].
    Started = 20,
    /// The reply to [`Kind::Step`].
    Stepped = 21,
    /// The reply to [`Kind::Finish`].
    Finished = 22,
    /// The reply to [`Kind::Save`].
    Saved = 23,
    /// The reply to [`Kind::Restore`].
    Restored = 24,
}

impl Kind {
    const ORDERS: [(Self, Self); 8] = [
        (Self::Hello, Self::Welcome),
        (Self::Open, Self::Opened),
        (Self::Initialise, Self::Initialised),
        (Self::Start, Self::Started),
        (Self::Step, Self::Stepped),
        (Self::Finish, Self::Finished),
        (Self::Save, Self::Saved),
        (Self::Restore, Self::Restored),
    ];

    fn from_number(number: u16) -> Option<Self> {
        Self::ORDERS.into_iter().flat_map(<[Self; 2]>::from).find(|&kind| kind as u16 == number)
    }

    /// The kind of the reply to an order; `None` for a reply.
    #[must_use]
    pub fn reply(self) -> Option<Self> {
        Self::ORDERS.into_iter().find(|&(order, _)| order == self).map(|(_, reply)| reply)
    }
}

/// The first part of every message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// The kind of the message.
    pub kind: Kind,
    /// The group that steps, counted among the worker's own.
    pub group: u16,
    /// The number of the layout of blocks, see [`open_request::OpenRequest::schema`]; zero before [`Kind::Open`].
    pub schema: u64,
    /// Orders to one worker are counted from 0; a reply repeats the number of its order.
    pub sequence: u64,
    /// The tick at which the step begins, or which the run has reached.
    pub tick: u64,
}

/// A message that is being written.
#[derive(Debug)]
pub struct Outgoing {
    bytes: Vec<u8>,
    blocks: u32,
}

impl Outgoing {
    /// Begins a message.
    #[must_use]
    pub fn new(header: &Header) -> Self {
        let mut bytes = Vec::with_capacity(256);
        bytes.extend(MAGIC.to_le_bytes());
        bytes.extend((header.kind as u16).to_le_bytes());
        bytes.extend(header.group.to_le_bytes());
        for number in [header.schema, header.sequence, header.tick] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([0; HEADER_BYTES - BLOCKS_AT]);
        Self { bytes, blocks: 0 }
    }

    /// Adds the values of an instance's ports.
    pub fn block(&mut self, instance: usize, ports: &Ports, values: &Values) {
        blocks::write(&mut self.bytes, instance, ports, values);
        self.blocks += 1;
    }

    /// Ends the message with its extras.
    #[must_use]
    pub fn finish(mut self, extras: &[u8]) -> Vec<u8> {
        self.bytes[BLOCKS_AT..EXTRAS_AT].copy_from_slice(&self.blocks.to_le_bytes());
        self.bytes[EXTRAS_AT..HEADER_BYTES].copy_from_slice(&length(extras.len()).to_le_bytes());
        self.bytes.extend(extras);
        self.bytes
    }
}

/// A length as it is encoded.
fn length(length: usize) -> u32 {
    u32::try_from(length).unwrap_or_else(|_| unreachable!("{length} is more than any message holds"))
}

/// A message that was received.
#[derive(Debug)]
pub struct Incoming<'a> {
    /// Its header.
    pub header: Header,
    /// Its blocks.
    pub blocks: Blocks<'a>,
    /// Its extras.
    pub extras: &'a [u8],
}

impl<'a> Incoming<'a> {
    /// Reads a message.
    ///
    /// # Errors
    /// The bytes are not a message.
    pub fn read(bytes: &'a [u8]) -> Result<Self, Malformed> {
        let (head, rest) = bytes.split_first_chunk::<HEADER_BYTES>().ok_or(Malformed::Short)?;
        let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| head[at + i]));
        let long = |at: usize| u64::from_le_bytes(std::array::from_fn(|i| head[at + i]));
        let half = |at: usize| u16::from_le_bytes([head[at], head[at + 1]]);
        if word(0) != MAGIC {
            return Err(Malformed::Foreign);
        }
        let kind = Kind::from_number(half(4)).ok_or(Malformed::Kind(half(4)))?;
        let header = Header { kind, group: half(6), schema: long(8), sequence: long(16), tick: long(24) };
        let extras = usize::try_from(word(EXTRAS_AT)).ok().and_then(|extras| rest.len().checked_sub(extras));
        let (blocks, extras) = rest.split_at(extras.ok_or(Malformed::Short)?);
        Ok(Self { header, blocks: Blocks::new(blocks, word(BLOCKS_AT)), extras })
    }
}

/// Why bytes are not the message that they should be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Malformed {
    /// They end too early.
    Short,
    /// They do not begin with the magic number.
    Foreign,
    /// The kind has an unknown number.
    Kind(u16),
    /// A block belongs to another instance, or is missing.
    Instance {
        /// The instance whose block should follow.
        expected: usize,
        /// The instance of the block that follows, if one does.
        found: Option<u32>,
    },
    /// The counts of values in a block differ from the counts of the instance's variables.
    Counts(usize),
    /// The worker has no such group.
    Group(u16),
    /// A field that must be zero is not.
    Reserved(u32),
    /// A Boolean is neither 0 nor 1.
    Boolean(u8),
    /// A text is not UTF-8.
    Text,
    /// There are more bytes or blocks than expected, or padding is not zero.
    LeftOver,
    /// The extras cannot be decoded.
    ReplyExtras,
}

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short => f.write_str("a message that is cut short"),
            Self::Foreign => f.write_str("something that is no message of ours"),
            Self::Kind(kind) => write!(f, "a message of unknown kind {kind}"),
            Self::Instance { expected, found: Some(found) } => {
                write!(f, "values of instance {found} where those of instance {expected} belong")
            }
            Self::Instance { expected, found: None } => write!(f, "no values of instance {expected}"),
            Self::Counts(instance) => write!(f, "other numbers of values than instance {instance} has"),
            Self::Group(group) => write!(f, "a step of group {group}, which it does not have"),
            Self::Reserved(word) => write!(f, "{word} where zero belongs"),
            Self::Boolean(value) => write!(f, "a Boolean of {value}"),
            Self::Text => f.write_str("a text that is no UTF-8"),
            Self::LeftOver => f.write_str("more than was asked for"),
            Self::ReplyExtras => f.write_str("words that cannot be read"),
        }
    }
}

#[cfg(test)]
mod tests;
