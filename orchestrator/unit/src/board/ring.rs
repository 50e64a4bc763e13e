//! Rings with one writing and one reading process: rows of a fixed width, and messages of any length.
//!
//! Positions only increase and are taken modulo the capacity, a power of two. The reader keeps its own position in its
//! own memory and publishes it for the writer. It accepts no position or length from the board that leads out of the
//! ring.

use std::hint::spin_loop;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::Duration;

/// Words before a ring's data: a cache line for the writer's positions, then one for the reader's, against false
/// sharing.
pub(super) const RING_WORDS: usize = 16;

/// The writer's position: one past the last slot written.
const HEAD_AT: usize = 0;
/// The reader's position when the writer last loaded it. While this leaves room, the writer needs no access to the
/// reader's cache line.
const SEEN_AT: usize = 1;
/// The reader's position: the next slot to read.
const TAIL_AT: usize = 8;

/// While the ring is full the writer first spins so often, then sleeps: neither process can wake the other across the
/// board.
const SPINS: usize = 64;
const SLEEP: Duration = Duration::from_micros(50);

/// Where in the board's words a ring lies.
#[derive(Clone, Copy, Debug)]
struct RingLayout {
    at: usize,
    capacity: usize,
    stride: usize,
}

impl RingLayout {
    fn control(self, words: &[AtomicU64]) -> &[AtomicU64; RING_WORDS] {
        let (control, _) = words[self.at..].split_first_chunk().unwrap_or_else(|| unreachable!("a ring has a header"));
        control
    }

    /// The slot of a position. The mask makes any position valid.
    fn slot(self, words: &[AtomicU64], position: u64) -> &[AtomicU64] {
        let index = (position & (self.capacity as u64 - 1)) as usize;
        let at = self.at + RING_WORDS + index * self.stride;
        &words[at..at + self.stride]
    }

    /// Waits until `slots` more fit after `head`.
    fn wait_for_room(self, words: &[AtomicU64], head: u64, slots: u64) {
        let control = self.control(words);
        let fits = |tail: u64| head.wrapping_sub(tail).saturating_add(slots) <= self.capacity as u64;
        if fits(control[SEEN_AT].load(Ordering::Relaxed)) {
            // An earlier call stored this after an acquire load of the reader's position, so the reader has finished
            // with these slots. Calls do not overlap: one thread at a time writes.
            return;
        }
        for attempt in 0_usize.. {
            // Pairs with the release in `publish`: the reader's loads of the slots come before our stores to them.
            let tail = control[TAIL_AT].load(Ordering::Acquire);
            if fits(tail) {
                control[SEEN_AT].store(tail, Ordering::Relaxed);
                return;
            }
            if attempt < SPINS { spin_loop() } else { sleep(SLEEP) }
        }
    }
}

/// The reader's side, local to its process.
#[derive(Debug)]
struct Reader<T> {
    tail: u64,
    buffer: Vec<T>,
}

impl<T> Reader<T> {
    fn new(layout: RingLayout, words: &[AtomicU64]) -> Mutex<Self> {
        Mutex::new(Self { tail: layout.control(words)[TAIL_AT].load(Ordering::Acquire), buffer: Vec::new() })
    }

    /// How many slots can be read. If the writer's position is further ahead than the capacity, it was overwritten; the
    /// reader skips to it, because the data before it cannot be trusted.
    fn waiting(&mut self, layout: RingLayout, words: &[AtomicU64]) -> u64 {
        // Pairs with the release in `push`: the slots before this position are completely written.
        let head = layout.control(words)[HEAD_AT].load(Ordering::Acquire);
        let waiting = head.wrapping_sub(self.tail);
        if waiting <= layout.capacity as u64 {
            return waiting;
        }
        self.tail = head;
        0
    }

    fn publish(&self, layout: RingLayout, words: &[AtomicU64]) {
        layout.control(words)[TAIL_AT].store(self.tail, Ordering::Release);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A panic in a callback poisons the lock, but each statement leaves the guarded data consistent.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Writes the values of a row to where its reader will read them.
#[derive(Debug)]
pub struct RowWriter<'a> {
    slots: &'a [AtomicU64],
}

impl<'a> RowWriter<'a> {
    /// A row of as many columns as there are slots.
    #[must_use]
    pub fn new(slots: &'a [AtomicU64]) -> Self {
        Self { slots }
    }

    /// Stores the value of a column. Relaxed, since the row is published after all its values are stored.
    #[inline]
    pub fn set(&self, column: usize, value: u64) {
        self.slots[column].store(value, Ordering::Relaxed);
    }
}

/// Rows: a tick and as many values as the board has columns.
#[derive(Debug)]
pub(super) struct Rows {
    layout: RingLayout,
    reader: Mutex<Reader<u64>>,
}

impl Rows {
    pub fn new(words: &[AtomicU64], at: usize, capacity: usize, row_words: usize) -> Self {
        assert!(capacity.is_power_of_two(), "a ring's capacity is a power of two");
        let layout = RingLayout { at, capacity, stride: row_words };
        Self { layout, reader: Reader::new(layout, words) }
    }

    #[inline]
    pub fn write(&self, words: &[AtomicU64], tick: u64, fill: impl FnOnce(RowWriter<'_>)) {
        let control = self.layout.control(words);
        let head = control[HEAD_AT].load(Ordering::Relaxed);
        self.layout.wait_for_room(words, head, 1);
        let (first, slots) = self.layout.slot(words, head).split_first().unwrap_or_else(|| unreachable!("a tick"));
        first.store(tick, Ordering::Relaxed);
        fill(RowWriter::new(slots));
        // After `fill`: if it panics, the row is not published and the next one is written in its place.
        control[HEAD_AT].store(head.wrapping_add(1), Ordering::Release);
    }

    pub fn pop(&self, words: &[AtomicU64], mut each: impl FnMut(u64, &[u64])) -> usize {
        let mut reader = lock(&self.reader);
        let waiting = reader.waiting(self.layout, words);
        // Publishing each row would move the cache line between the processors each time; publishing only at the end
        // would let the writer wait longer than needed.
        let portion = (self.layout.capacity as u64 / 8).max(1);
        for _ in 0..waiting {
            let row = self.layout.slot(words, reader.tail);
            reader.buffer.clear();
            reader.buffer.extend(row.iter().map(|word| word.load(Ordering::Relaxed)));
            reader.tail = reader.tail.wrapping_add(1);
            if reader.tail.is_multiple_of(portion) {
                reader.publish(self.layout, words);
            }
            if let [tick, slots @ ..] = reader.buffer.as_slice() {
                each(*tick, slots);
            }
        }
        reader.publish(self.layout, words);
        waiting as usize
    }
}

/// The words that a message occupies.
fn words_of(message: &[u8]) -> usize {
    1 + message.len().div_ceil(8)
}

/// Messages: a word with the length in bytes, then the bytes, padded to whole words.
#[derive(Debug)]
pub(super) struct Messages {
    layout: RingLayout,
    /// Held while writing: units may log from any thread, and the ring supports one writer at a time.
    writer: Mutex<()>,
    reader: Mutex<Reader<u8>>,
}

impl Messages {
    pub fn new(words: &[AtomicU64], at: usize, capacity: usize) -> Self {
        assert!(capacity.is_power_of_two(), "a ring's capacity is a power of two");
        let layout = RingLayout { at, capacity, stride: 1 };
        Self { layout, writer: Mutex::new(()), reader: Reader::new(layout, words) }
    }

    pub fn push(&self, words: &[AtomicU64], message: &[u8]) -> bool {
        let needed = words_of(message);
        if needed > self.layout.capacity {
            return false;
        }
        let _writing = lock(&self.writer);
        let control = self.layout.control(words);
        let head = control[HEAD_AT].load(Ordering::Relaxed);
        self.layout.wait_for_room(words, head, needed as u64);
        let chunks = message.chunks(8).map(|chunk| {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            u64::from_le_bytes(word)
        });
        for (position, value) in (head..).zip(std::iter::once(message.len() as u64).chain(chunks)) {
            self.layout.slot(words, position)[0].store(value, Ordering::Relaxed);
        }
        control[HEAD_AT].store(head.wrapping_add(needed as u64), Ordering::Release);
        true
    }

    /// Whether a message fits, given the reader's present position.
    pub fn has_room_for(&self, words: &[AtomicU64], message: &[u8]) -> bool {
        let _writing = lock(&self.writer);
        let [head, tail] = [HEAD_AT, TAIL_AT].map(|at| self.layout.control(words)[at].load(Ordering::Acquire));
        head.wrapping_sub(tail).saturating_add(words_of(message) as u64) <= self.layout.capacity as u64
    }

    pub fn pop(&self, words: &[AtomicU64], mut each: impl FnMut(&[u8])) -> usize {
        let mut reader = lock(&self.reader);
        let mut waiting = reader.waiting(self.layout, words);
        let word = |position: u64| self.layout.slot(words, position)[0].load(Ordering::Relaxed);
        let mut popped = 0;
        while waiting > 0 {
            let length = word(reader.tail);
            let needed = 1 + length.div_ceil(8);
            if needed > waiting {
                // The length was overwritten, so the beginning of the next message is unknown: skip all that is there.
                reader.tail = reader.tail.wrapping_add(waiting);
                break;
            }
            let Reader { tail, buffer } = &mut *reader;
            buffer.clear();
            buffer.extend((1..needed).flat_map(|i| word(tail.wrapping_add(i)).to_le_bytes()));
            buffer.truncate(length as usize);
            *tail = tail.wrapping_add(needed);
            waiting -= needed;
            popped += 1;
            each(buffer);
            reader.publish(self.layout, words);
        }
        reader.publish(self.layout, words);
        popped
    }
}
