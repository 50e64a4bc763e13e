//! The board: memory mapped by a process with units and by the one that watches it, so that its notes outlive a crash.
//!
//! ```text
//! header │ call notes, one for each stepping thread │ claims │ ring of rows │ ring of messages
//! ```
//!
//! The process with units writes and the other reads; only the stop flag and the rings' read positions go the other
//! way. (A worker on the bus reads its own messages back to send them; if it dies, the watching process reads what is
//! left.) Both sides access all of it as 64-bit words through atomics only. A unit may overwrite any of it by mistake:
//! the reader then still reads valid integers, and it checks every one that it uses as an offset or a length.

mod claim;
mod mapping;
mod note;
mod ring;

pub use claim::ClaimNote;
pub use note::{InCall, Note, Now};
pub use ring::RowWriter;

use claim::CLAIM_WORDS;
use fmi2::printable;
use mapping::Mapping;
use note::NOTE_WORDS;
use ring::{Messages, RING_WORDS, Rows};
use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// How many of each thing a board holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardLayout {
    /// Call notes, one for each stepping thread.
    pub notes: usize,
    /// Values in a row besides its tick.
    pub columns: usize,
    /// Claims.
    pub claims: usize,
}

/// First word of a board's file; the last digits count the versions of the layout.
const MAGIC: u64 = 0x4c4f_434b_5354_0001;
/// Target size of the ring of rows. Its capacity is a power of two of rows, from [`MIN_ROWS`] to [`MAX_ROWS`].
const ROW_RING_BYTES: usize = 4 << 20;
const MIN_ROWS: usize = 8;
const MAX_ROWS: usize = 1 << 16;
/// Words of the ring of messages.
const MESSAGE_RING_WORDS: usize = (1 << 20) / 8;

/// Words of the header. The layout is in the first cache line; what changes during a run is in the second.
const HEADER_WORDS: usize = 16;
const MAGIC_AT: usize = 0;
const NOTES_AT: usize = 1;
const COLUMNS_AT: usize = 2;
const CLAIMS_AT: usize = 3;
const TICK_AT: usize = 8;
const STOP_AT: usize = 9;
const PULSE_AT: usize = 10;

/// Where each part begins, in words, and the sizes that follow from the layout.
#[derive(Clone, Copy, Debug)]
struct Offsets {
    notes: usize,
    claims: usize,
    rows: usize,
    row_capacity: usize,
    messages: usize,
    words: usize,
}

impl BoardLayout {
    /// The offsets of the parts, or `None` if the board would not fit into an address space.
    fn offsets(&self) -> Option<Offsets> {
        let row_words = self.columns.checked_add(1)?;
        let fitting = (ROW_RING_BYTES / 8 / row_words).clamp(MIN_ROWS, MAX_ROWS);
        let row_capacity = (fitting + 1).next_power_of_two() / 2;
        let notes = HEADER_WORDS;
        let claims = notes.checked_add(self.notes.checked_mul(NOTE_WORDS)?)?;
        let rows = claims.checked_add(self.claims.checked_mul(CLAIM_WORDS)?)?;
        debug_assert!(rows.is_multiple_of(8), "rings begin on a cache line");
        let row_ring = row_capacity.checked_mul(row_words)?.checked_add(RING_WORDS)?;
        // Every part begins on a cache line.
        let messages = rows.checked_add(row_ring)?.checked_next_multiple_of(8)?;
        let words = messages.checked_add(RING_WORDS + MESSAGE_RING_WORDS)?;
        words.checked_mul(8).filter(|&bytes| isize::try_from(bytes).is_ok())?;
        Some(Offsets { notes, claims, rows, row_capacity, messages, words })
    }
}

/// One process's view of a board. Any thread may use a `&Board`.
#[derive(Debug)]
pub struct Board {
    mapping: Arc<Mapping>,
    layout: BoardLayout,
    offsets: Offsets,
    rows: Rows,
    messages: Messages,
}

impl Board {
    /// Creates the file, readable and writable for its owner only, and maps it. An existing file is an error.
    ///
    /// # Errors
    /// The file cannot be created, its disk is full, or it cannot be mapped.
    pub fn create(path: &Path, layout: &BoardLayout) -> io::Result<Self> {
        let offsets = layout.offsets().ok_or_else(|| too_large(layout))?;
        let board = Self::from_mapping(Mapping::create(path, offsets.words)?, *layout, offsets);
        for (at, value) in [(NOTES_AT, layout.notes), (COLUMNS_AT, layout.columns), (CLAIMS_AT, layout.claims)] {
            board.word(at).store(value as u64, Ordering::Relaxed);
        }
        // Last, and paired with the acquire in `open`: a process that sees the magic number sees the layout too.
        board.word(MAGIC_AT).store(MAGIC, Ordering::Release);
        Ok(board)
    }

    /// A board in this process's own memory, for a loop that runs in a thread of this process or is not watched.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn private(layout: &BoardLayout) -> io::Result<Self> {
        let offsets = layout.offsets().ok_or_else(|| too_large(layout))?;
        Ok(Self::from_mapping(Mapping::private(offsets.words)?, *layout, offsets))
    }

    /// Maps a board that another process created.
    ///
    /// # Errors
    /// The file cannot be opened or mapped, or is not a board of this version of Lockstep.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mapping = Mapping::open(path)?;
        let not_a_board =
            || io::Error::new(io::ErrorKind::InvalidData, format!("{} is no board", printable::path(path)));
        let words = mapping.words();
        if words.len() < HEADER_WORDS || words[MAGIC_AT].load(Ordering::Acquire) != MAGIC {
            return Err(not_a_board());
        }
        let number = |at: usize| usize::try_from(words[at].load(Ordering::Relaxed)).map_err(|_| not_a_board());
        let layout = BoardLayout { notes: number(NOTES_AT)?, columns: number(COLUMNS_AT)?, claims: number(CLAIMS_AT)? };
        let offsets = layout.offsets().filter(|offsets| offsets.words == words.len()).ok_or_else(not_a_board)?;
        Ok(Self::from_mapping(mapping, layout, offsets))
    }

    fn from_mapping(mapping: Mapping, layout: BoardLayout, offsets: Offsets) -> Self {
        assert_eq!(mapping.words().len(), offsets.words, "a board's file has the length of its layout");
        let rows = Rows::new(mapping.words(), offsets.rows, offsets.row_capacity, layout.columns + 1);
        let messages = Messages::new(mapping.words(), offsets.messages, MESSAGE_RING_WORDS);
        Self { mapping: Arc::new(mapping), layout, offsets, rows, messages }
    }

    #[inline]
    fn word(&self, at: usize) -> &AtomicU64 {
        &self.mapping.words()[at]
    }

    /// How many of each thing this board holds.
    #[must_use]
    pub fn layout(&self) -> &BoardLayout {
        &self.layout
    }

    /// The call note of stepping thread `i`. The note keeps the board mapped.
    #[must_use]
    pub fn note(&self, i: usize) -> Note {
        assert!(i < self.layout.notes, "note {i} of a board with {}", self.layout.notes);
        Note::new(Arc::clone(&self.mapping), self.offsets.notes + i * NOTE_WORDS)
    }

    /// Adds a row, which `fill` writes in its place in the ring; while the ring is full, waits for the reader. `fill` sets
    /// every column, as one that it leaves out shows the value of an earlier row. Only one thread at a time may call this,
    /// and `fill` may not.
    #[inline]
    pub fn write_row(&self, tick: u64, fill: impl FnOnce(RowWriter<'_>)) {
        self.rows.write(self.mapping.words(), tick, fill);
    }

    /// Calls `each` with every row in the ring, in order, and returns how many there were.
    pub fn pop_rows(&self, each: impl FnMut(u64, &[u64])) -> usize {
        self.rows.pop(self.mapping.words(), each)
    }

    /// Adds a message; while the ring is full, waits for the reader. Any thread may call this.
    ///
    /// Returns false if the message was dropped because it is longer than [`Board::LONGEST_MESSAGE`].
    pub fn push_message(&self, message: &[u8]) -> bool {
        self.messages.push(self.mapping.words(), message)
    }

    /// The length in bytes of the longest message that [`Board::push_message`] accepts.
    pub const LONGEST_MESSAGE: usize = (MESSAGE_RING_WORDS - 1) * 8;

    /// Whether a message fits without waiting.
    #[must_use]
    pub fn has_room_for(&self, message: &[u8]) -> bool {
        self.messages.has_room_for(self.mapping.words(), message)
    }

    /// Calls `each` with every message in the ring, in order, and returns how many there were.
    pub fn pop_messages(&self, each: impl FnMut(&[u8])) -> usize {
        self.messages.pop(self.mapping.words(), each)
    }

    /// Stores how claim `i` stands. Only one thread at a time may call this.
    pub fn set_claim(&self, i: usize, note: &ClaimNote) {
        note.store(self.claim_words(i));
    }

    /// How claim `i` stood when it was last stored; `None` if it never was.
    #[must_use]
    pub fn claim(&self, i: usize) -> Option<ClaimNote> {
        ClaimNote::load(self.claim_words(i))
    }

    fn claim_words(&self, i: usize) -> &[AtomicU64] {
        assert!(i < self.layout.claims, "claim {i} of a board with {}", self.layout.claims);
        let at = self.offsets.claims + i * CLAIM_WORDS;
        &self.mapping.words()[at..at + CLAIM_WORDS]
    }

    /// Stores the tick that the run has reached.
    #[inline]
    pub fn set_tick(&self, tick: u64) {
        self.word(TICK_AT).store(tick, Ordering::Release);
    }

    /// The tick that the run has reached.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.word(TICK_AT).load(Ordering::Acquire)
    }

    /// Increments the heartbeat counter.
    pub fn beat(&self) {
        self.word(PULSE_AT).fetch_add(1, Ordering::Relaxed);
    }

    /// The heartbeat counter; while it increases, the process is alive.
    #[must_use]
    pub fn pulse(&self) -> u64 {
        self.word(PULSE_AT).load(Ordering::Relaxed)
    }

    /// Asks the run to end after the present tick.
    pub fn request_stop(&self) {
        self.word(STOP_AT).store(1, Ordering::Release);
    }

    /// Whether the run was asked to end.
    #[must_use]
    #[inline]
    pub fn stop_requested(&self) -> bool {
        self.word(STOP_AT).load(Ordering::Acquire) != 0
    }
}

fn too_large(layout: &BoardLayout) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("no memory holds a board of {layout:?}"))
}

#[cfg(test)]
mod tests;
