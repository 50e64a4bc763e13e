//! The call in progress: what a stepping thread is doing, told before every call of a unit and when it calls no more.
//!
//! The loop makes many calls at one moment. Each costs one store; the moment is told once, and so is its end, so that
//! what happens between two calls counts to the former.

use super::mapping::Mapping;
use crate::failure::Doing;
use fmi2::calls::Call;
use std::fmt;
use std::ptr::NonNull;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Words of one note: a cache line, so that threads do not disturb each other.
pub(super) const NOTE_WORDS: usize = 8;

const TICK_AT: usize = 0;
const COUNT_AT: usize = 1;
/// `instance << 8 | doing`; the low byte is zero outside of calls.
const DOING_AT: usize = 2;
const COUNTS_AT: usize = 3;

const OUTSIDE: u64 = 0;
/// The code of [`Doing::Load`]; calls have their own numbers.
const LOADING: u64 = 255;

/// Where a stepping thread is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InCall {
    /// The tick in which the call was made.
    pub tick: u64,
    /// Index of the instance.
    pub instance: usize,
    /// The call.
    pub doing: Doing,
    /// How many moments the thread has begun. As long as nothing in here changes, it is in the same call.
    pub count: u64,
}

/// One thread's note on a board. Clones are the same note; only one thread should write it.
#[derive(Clone)]
pub struct Note {
    words: NonNull<[AtomicU64; NOTE_WORDS]>,
    /// Keeps `words` mapped.
    mapping: Arc<Mapping>,
}

// SAFETY: `words` points into `mapping`, which is `Send` and `Sync`, and is read and written through atomics only.
unsafe impl Send for Note {}
// SAFETY: as above.
unsafe impl Sync for Note {}

impl Note {
    pub(super) fn new(mapping: Arc<Mapping>, at: usize) -> Self {
        let words = &mapping.words()[at..at + NOTE_WORDS];
        Self { words: NonNull::from(words).cast(), mapping }
    }

    #[inline]
    fn words(&self) -> &[AtomicU64; NOTE_WORDS] {
        // SAFETY: `new` took a slice of exactly this length out of `mapping`, which lives as long as `self`.
        unsafe { self.words.as_ref() }
    }

    /// Begins calls at one moment, the only ones of this thread until what is returned is dropped.
    #[inline]
    pub fn at(&self, tick: u64, time_s: f64) -> Now<'_> {
        self.counting_at(tick, time_s, tick)
    }

    /// The same for calls whose result counts at a later tick.
    #[inline]
    pub fn counting_at(&self, tick: u64, time_s: f64, counts_at: u64) -> Now<'_> {
        let words = self.words();
        words[TICK_AT].store(tick, Ordering::Relaxed);
        words[COUNTS_AT].store(counts_at, Ordering::Relaxed);
        let count = words[COUNT_AT].load(Ordering::Relaxed);
        words[COUNT_AT].store(count.wrapping_add(1), Ordering::Relaxed);
        Now { words, tick, time_s, counts_at }
    }

    /// The call in progress; `None` between calls, or if something else than a call was written here.
    ///
    /// While the thread runs on, tick and count may already be those of a later call.
    #[must_use]
    pub fn read(&self) -> Option<InCall> {
        let words = self.words();
        let packed = words[DOING_AT].load(Ordering::Acquire);
        Some(InCall {
            tick: words[TICK_AT].load(Ordering::Relaxed),
            instance: usize::try_from(packed >> 8).ok()?,
            doing: decode(packed & 0xff)?,
            count: words[COUNT_AT].load(Ordering::Relaxed),
        })
    }

    /// The tick of the last call.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.words()[TICK_AT].load(Ordering::Relaxed)
    }

    /// The tick at which the result of the last call counts.
    #[must_use]
    pub fn counts_at(&self) -> u64 {
        self.words()[COUNTS_AT].load(Ordering::Relaxed)
    }
}

/// A moment at which calls are made; when it is dropped, the note says that the thread makes none.
///
/// At one moment no instance is called twice by the same function, or a watcher would not see that it gets on.
#[derive(Debug)]
pub struct Now<'a> {
    words: &'a [AtomicU64; NOTE_WORDS],
    /// The tick, which notes tell.
    pub tick: u64,
    /// The same in seconds, tick × step, which units and people want.
    pub time_s: f64,
    /// The tick at which what the calls bring counts: a step's end for a step.
    pub counts_at: u64,
}

impl Now<'_> {
    /// Says that a call begins.
    #[inline]
    pub fn enter(&self, instance: usize, doing: Doing) {
        self.words[DOING_AT].store((instance as u64) << 8 | code(doing), Ordering::Release);
    }
}

impl Drop for Now<'_> {
    #[inline]
    fn drop(&mut self) {
        self.words[DOING_AT].store(OUTSIDE, Ordering::Release);
    }
}

impl fmt::Debug for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Note").field(&self.read()).field(&Arc::strong_count(&self.mapping)).finish()
    }
}

#[inline]
fn code(doing: Doing) -> u64 {
    match doing {
        Doing::BetweenCalls => OUTSIDE,
        Doing::Load => LOADING,
        Doing::Call(call) => call as u64,
    }
}

fn decode(code: u64) -> Option<Doing> {
    match code {
        LOADING => Some(Doing::Load),
        _ => Call::from_number(u8::try_from(code).ok()?).map(Doing::Call),
    }
}
