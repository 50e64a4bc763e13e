//! The board: memory that a process with units and the one that looks after it both map, so that last words outlive a crash.
//!
//! ```text
//! header │ call notes, one for each stepping thread │ claims │ ring of rows │ ring of messages
//! ```
//!
//! The process with units writes, the other reads; only the flags and the rings' read positions go the other way. (A worker
//! takes its own words back to send them along; the other reads what it left when it died.) All of
//! it is words that both sides touch through atomics only, so whatever a unit scribbles over the board the parent reads
//! numbers, and every number that it uses as a place or a length it checks first.

mod claim;
mod mapping;
mod note;
mod ring;

pub use claim::ClaimNote;
pub use note::{InCall, Note, Now};

use claim::CLAIM_WORDS;
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
/// Bytes that the ring of rows takes, roughly: a power of two of rows, at least [`MIN_ROWS`] and at most [`MAX_ROWS`].
const ROW_RING_BYTES: usize = 4 << 20;
const MIN_ROWS: usize = 8;
const MAX_ROWS: usize = 1 << 16;
/// Words of the ring of messages.
const MESSAGE_RING_WORDS: usize = (1 << 20) / 8;

/// Words of the header; the flags have a cache line of their own.
const HEADER_WORDS: usize = 16;
const MAGIC_AT: usize = 0;
const NOTES_AT: usize = 1;
const COLUMNS_AT: usize = 2;
const CLAIMS_AT: usize = 3;
const TICK_AT: usize = 8;
const STOP_AT: usize = 9;
const PULSE_AT: usize = 10;

/// Where each part begins, in words.
#[derive(Clone, Copy, Debug)]
struct Places {
    notes: usize,
    claims: usize,
    rows: usize,
    row_capacity: usize,
    messages: usize,
    words: usize,
}

impl BoardLayout {
    /// Where the parts lie, or `None` if the numbers are beyond any memory.
    fn places(&self) -> Option<Places> {
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
        Some(Places { notes, claims, rows, row_capacity, messages, words })
    }
}

/// One process's view of a board. Cheap to share: `&Board` may be used by any thread.
#[derive(Debug)]
pub struct Board {
    mapping: Arc<Mapping>,
    layout: BoardLayout,
    places: Places,
    rows: Rows,
    messages: Messages,
}

impl Board {
    /// Makes the file, readable and writable for its owner only, and maps it. An existing file is an error.
    ///
    /// # Errors
    /// The file cannot be made, has no room on its disk, or cannot be mapped.
    pub fn create(path: &Path, layout: &BoardLayout) -> io::Result<Self> {
        let places = layout.places().ok_or_else(|| impossible(layout))?;
        let board = Self::over(Mapping::create(path, places.words)?, *layout, places);
        for (at, value) in [(NOTES_AT, layout.notes), (COLUMNS_AT, layout.columns), (CLAIMS_AT, layout.claims)] {
            board.word(at).store(value as u64, Ordering::Relaxed);
        }
        board.word(MAGIC_AT).store(MAGIC, Ordering::Release);
        Ok(board)
    }

    /// A board in this process's own memory, where the loop runs in a thread of it or nobody looks after the run.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn private(layout: &BoardLayout) -> io::Result<Self> {
        let places = layout.places().ok_or_else(|| impossible(layout))?;
        Ok(Self::over(Mapping::private(places.words)?, *layout, places))
    }

    /// Maps a board that another process made.
    ///
    /// # Errors
    /// The file cannot be opened or mapped, or is no board of this version of Lockstep.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mapping = Mapping::open(path)?;
        let no_board = || io::Error::new(io::ErrorKind::InvalidData, format!("{} is no board", path.display()));
        let words = mapping.words();
        if words.len() < HEADER_WORDS || words[MAGIC_AT].load(Ordering::Acquire) != MAGIC {
            return Err(no_board());
        }
        let number = |at: usize| usize::try_from(words[at].load(Ordering::Relaxed)).map_err(|_| no_board());
        let layout = BoardLayout { notes: number(NOTES_AT)?, columns: number(COLUMNS_AT)?, claims: number(CLAIMS_AT)? };
        let places = layout.places().filter(|places| places.words == words.len()).ok_or_else(no_board)?;
        Ok(Self::over(mapping, layout, places))
    }

    fn over(mapping: Mapping, layout: BoardLayout, places: Places) -> Self {
        assert_eq!(mapping.words().len(), places.words, "a board's file has the length of its layout");
        let rows = Rows::new(mapping.words(), places.rows, places.row_capacity, layout.columns + 1);
        let messages = Messages::new(mapping.words(), places.messages, MESSAGE_RING_WORDS);
        Self { mapping: Arc::new(mapping), layout, places, rows, messages }
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

    /// The call note of stepping thread `i`. It keeps the board mapped.
    #[must_use]
    pub fn note(&self, i: usize) -> Note {
        assert!(i < self.layout.notes, "note {i} of a board with {}", self.layout.notes);
        Note::new(Arc::clone(&self.mapping), self.places.notes + i * NOTE_WORDS)
    }

    /// Adds a row; while the ring is full this waits for the parent. For one thread at a time.
    pub fn push_row(&self, tick: u64, slots: &[u64]) {
        self.rows.push(self.mapping.words(), tick, slots);
    }

    /// Hands over all rows that are there, in order, and says how many they were.
    pub fn pop_rows(&self, each: impl FnMut(u64, &[u64])) -> usize {
        self.rows.pop(self.mapping.words(), each)
    }

    /// Adds a message; any thread may, and while the ring is full it waits for the parent.
    ///
    /// False if it was dropped because it is longer than [`Board::LONGEST_MESSAGE`].
    pub fn push_message(&self, message: &[u8]) -> bool {
        self.messages.push(self.mapping.words(), message)
    }

    /// The bytes of the longest message that [`Board::push_message`] takes.
    pub const LONGEST_MESSAGE: usize = (MESSAGE_RING_WORDS - 1) * 8;

    /// Whether a message finds room without waiting.
    #[must_use]
    pub fn has_room_for(&self, message: &[u8]) -> bool {
        self.messages.has_room_for(self.mapping.words(), message)
    }

    /// Hands over all messages that are there, in order, and says how many they were.
    pub fn pop_messages(&self, each: impl FnMut(&[u8])) -> usize {
        self.messages.pop(self.mapping.words(), each)
    }

    /// Says how claim `i` stands. For one thread at a time.
    pub fn set_claim(&self, i: usize, note: &ClaimNote) {
        note.store(self.claim_words(i));
    }

    /// How claim `i` stood when it was last told; `None` before that.
    #[must_use]
    pub fn claim(&self, i: usize) -> Option<ClaimNote> {
        ClaimNote::load(self.claim_words(i))
    }

    fn claim_words(&self, i: usize) -> &[AtomicU64] {
        assert!(i < self.layout.claims, "claim {i} of a board with {}", self.layout.claims);
        let at = self.places.claims + i * CLAIM_WORDS;
        &self.mapping.words()[at..at + CLAIM_WORDS]
    }

    /// Says which tick the run has reached.
    #[inline]
    pub fn set_tick(&self, tick: u64) {
        self.word(TICK_AT).store(tick, Ordering::Release);
    }

    /// The tick that the run has reached.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.word(TICK_AT).load(Ordering::Acquire)
    }

    /// Gives a sign of life.
    pub fn beat(&self) {
        self.word(PULSE_AT).fetch_add(1, Ordering::Relaxed);
    }

    /// How many signs of life there were.
    #[must_use]
    pub fn pulse(&self) -> u64 {
        self.word(PULSE_AT).load(Ordering::Relaxed)
    }

    /// Asks the run to end after the tick that it is in.
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

fn impossible(layout: &BoardLayout) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, format!("no memory holds a board of {layout:?}"))
}

#[cfg(test)]
mod tests;
