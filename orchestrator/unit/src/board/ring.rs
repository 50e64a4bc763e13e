//! Rings with one writing and one reading process: rows of a fixed width, and messages of any length.
//!
//! Positions count up for ever and are taken modulo the capacity, a power of two. The reader keeps its own position and
//! only tells it to the writer; of what it finds it believes nothing that leads out of the ring.

use std::hint::spin_loop;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::Duration;

/// Words before a ring's data: the writer's cache line, then the reader's.
pub(super) const RING_WORDS: usize = 16;

/// How far the writer has come.
const HEAD_AT: usize = 0;
/// How far the reader had come when the writer last looked.
const SEEN_AT: usize = 1;
/// How far the reader has come.
const TAIL_AT: usize = 8;

const SPINS: usize = 64;
const NAP: Duration = Duration::from_micros(50);

/// Tells where in the board's words a ring lies.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: usize,
    capacity: usize,
    stride: usize,
}

impl Place {
    fn control(self, words: &[AtomicU64]) -> &[AtomicU64; RING_WORDS] {
        let (control, _) = words[self.at..].split_first_chunk().unwrap_or_else(|| unreachable!("a ring has a header"));
        control
    }

    /// The slot of a position; any position has one.
    fn slot(self, words: &[AtomicU64], position: u64) -> &[AtomicU64] {
        let index = (position & (self.capacity as u64 - 1)) as usize;
        let at = self.at + RING_WORDS + index * self.stride;
        &words[at..at + self.stride]
    }

    /// Waits until `slots` more fit behind `head`.
    fn wait_for_room(self, words: &[AtomicU64], head: u64, slots: u64) {
        let control = self.control(words);
        let fits = |tail: u64| head.wrapping_sub(tail).saturating_add(slots) <= self.capacity as u64;
        if fits(control[SEEN_AT].load(Ordering::Relaxed)) {
            // Whoever wrote this had acquired the reader's position before.
            return;
        }
        for attempt in 0_usize.. {
            let tail = control[TAIL_AT].load(Ordering::Acquire);
            if fits(tail) {
                control[SEEN_AT].store(tail, Ordering::Relaxed);
                return;
            }
            if attempt < SPINS { spin_loop() } else { sleep(NAP) }
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
    fn new(place: Place, words: &[AtomicU64]) -> Mutex<Self> {
        Mutex::new(Self { tail: place.control(words)[TAIL_AT].load(Ordering::Acquire), buffer: Vec::new() })
    }

    /// How many slots wait to be read. A head that cannot be ours is as good as none: everything up to it is skipped.
    fn waiting(&mut self, place: Place, words: &[AtomicU64]) -> u64 {
        let head = place.control(words)[HEAD_AT].load(Ordering::Acquire);
        let waiting = head.wrapping_sub(self.tail);
        if waiting <= place.capacity as u64 {
            return waiting;
        }
        self.tail = head;
        0
    }

    fn publish(&self, place: Place, words: &[AtomicU64]) {
        place.control(words)[TAIL_AT].store(self.tail, Ordering::Release);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // What it guards is whole after every statement.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Rows: a tick and as many values as the board has columns.
#[derive(Debug)]
pub(super) struct Rows {
    place: Place,
    reader: Mutex<Reader<u64>>,
}

impl Rows {
    pub fn new(words: &[AtomicU64], at: usize, capacity: usize, row_words: usize) -> Self {
        assert!(capacity.is_power_of_two(), "a ring's capacity is a power of two");
        let place = Place { at, capacity, stride: row_words };
        Self { place, reader: Reader::new(place, words) }
    }

    pub fn push(&self, words: &[AtomicU64], tick: u64, slots: &[u64]) {
        assert_eq!(slots.len() + 1, self.place.stride, "a row has as many values as the board has columns");
        let control = self.place.control(words);
        let head = control[HEAD_AT].load(Ordering::Relaxed);
        self.place.wait_for_room(words, head, 1);
        let (first, rest) = self.place.slot(words, head).split_first().unwrap_or_else(|| unreachable!("a tick"));
        first.store(tick, Ordering::Relaxed);
        for (word, &value) in rest.iter().zip(slots) {
            word.store(value, Ordering::Relaxed);
        }
        control[HEAD_AT].store(head.wrapping_add(1), Ordering::Release);
    }

    pub fn pop(&self, words: &[AtomicU64], mut each: impl FnMut(u64, &[u64])) -> usize {
        let mut reader = lock(&self.reader);
        let waiting = reader.waiting(self.place, words);
        // The writer gets room in portions: neither for each row, nor only when all of them are read.
        let portion = (self.place.capacity as u64 / 8).max(1);
        for _ in 0..waiting {
            let row = self.place.slot(words, reader.tail);
            reader.buffer.clear();
            reader.buffer.extend(row.iter().map(|word| word.load(Ordering::Relaxed)));
            reader.tail = reader.tail.wrapping_add(1);
            if reader.tail.is_multiple_of(portion) {
                reader.publish(self.place, words);
            }
            if let [tick, slots @ ..] = reader.buffer.as_slice() {
                each(*tick, slots);
            }
        }
        reader.publish(self.place, words);
        waiting as usize
    }
}

/// Words that a message takes.
fn words_of(message: &[u8]) -> usize {
    1 + message.len().div_ceil(8)
}

/// Messages: a word with the length in bytes, then the bytes, filled up to whole words.
#[derive(Debug)]
pub(super) struct Messages {
    place: Place,
    /// Lets one thread of the process write at a time.
    writer: Mutex<()>,
    reader: Mutex<Reader<u8>>,
}

impl Messages {
    pub fn new(words: &[AtomicU64], at: usize, capacity: usize) -> Self {
        assert!(capacity.is_power_of_two(), "a ring's capacity is a power of two");
        let place = Place { at, capacity, stride: 1 };
        Self { place, writer: Mutex::new(()), reader: Reader::new(place, words) }
    }

    pub fn push(&self, words: &[AtomicU64], message: &[u8]) -> bool {
        let needed = words_of(message);
        if needed > self.place.capacity {
            return false;
        }
        let _one_at_a_time = lock(&self.writer);
        let control = self.place.control(words);
        let head = control[HEAD_AT].load(Ordering::Relaxed);
        self.place.wait_for_room(words, head, needed as u64);
        let chunks = message.chunks(8).map(|chunk| {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            u64::from_le_bytes(word)
        });
        for (position, value) in (head..).zip(std::iter::once(message.len() as u64).chain(chunks)) {
            self.place.slot(words, position)[0].store(value, Ordering::Relaxed);
        }
        control[HEAD_AT].store(head.wrapping_add(needed as u64), Ordering::Release);
        true
    }

    /// Whether a message finds room as far as the reader has come by now.
    pub fn has_room_for(&self, words: &[AtomicU64], message: &[u8]) -> bool {
        let _one_at_a_time = lock(&self.writer);
        let [head, tail] = [HEAD_AT, TAIL_AT].map(|at| self.place.control(words)[at].load(Ordering::Acquire));
        head.wrapping_sub(tail).saturating_add(words_of(message) as u64) <= self.place.capacity as u64
    }

    pub fn pop(&self, words: &[AtomicU64], mut each: impl FnMut(&[u8])) -> usize {
        let mut reader = lock(&self.reader);
        let mut waiting = reader.waiting(self.place, words);
        let word = |position: u64| self.place.slot(words, position)[0].load(Ordering::Relaxed);
        let mut popped = 0;
        while waiting > 0 {
            let length = word(reader.tail);
            let needed = 1 + length.div_ceil(8);
            if needed > waiting {
                // Not written by us: what follows has no beginning.
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
            reader.publish(self.place, words);
        }
        reader.publish(self.place, words);
        popped
    }
}
