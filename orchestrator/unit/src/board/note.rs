//! The call in progress: what a stepping thread is doing, noted before each call and after the last call of a batch.
//!
//! The loop makes its calls in batches at one simulated time. The time is stored once for each batch and each call
//! costs one more store. The note is cleared only at the end of a batch: what happens between two calls counts as part
//! of the first.

use super::mapping::Mapping;
use crate::exit;
use crate::failure::Doing;
use fmi2::calls::Call;
use std::process::abort;
use std::ptr::NonNull;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::{fmt, mem, thread};

/// Words of one note: a cache line, so that threads which write neighbouring notes do not share one (false sharing).
pub(super) const NOTE_WORDS: usize = 8;

const TICK_AT: usize = 0;
const COUNT_AT: usize = 1;
/// `instance << 8 | doing`; the low byte is zero outside of calls.
const DOING_AT: usize = 2;
const COUNTS_AT: usize = 3;
/// The call that returned in a copy of the process too, packed as at `DOING_AT`, and its tick.
const COPIED_AT: usize = 4;
const COPIED_TICK_AT: usize = 5;

const OUTSIDE: u64 = 0;
/// Beside instance and call: an exception, or the end of the thread, has left the call.
const UNWOUND: u64 = 1 << 63;
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
    /// Whether an exception, or the end of the thread, has left the call. The process ends.
    pub unwound: bool,
    /// How many batches the thread has begun. As long as no field of this struct changes, the thread is in the same
    /// call.
    pub count: u64,
}

/// One thread's note on a board. Clones refer to the same note; only one thread may write it.
#[derive(Clone)]
pub struct Note {
    words: NonNull<[AtomicU64; NOTE_WORDS]>,
    /// Keeps `words` mapped.
    mapping: Arc<Mapping>,
}

// SAFETY: `words` points into `mapping`, which is `Send` and `Sync`, and is read and written through atomics only.
unsafe impl Send for Note {}
// SAFETY: as for `Send`.
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

    /// Begins a batch of calls. The thread must not begin another one until the returned value is dropped.
    #[inline]
    pub fn at(&self, tick: u64, time_s: f64) -> Now<'_> {
        self.counting_at(tick, time_s, tick)
    }

    /// Begins a batch of calls whose results take effect at a later tick.
    #[inline]
    pub fn counting_at(&self, tick: u64, time_s: f64, counts_at: u64) -> Now<'_> {
        let words = self.words();
        // Relaxed is enough: `Now::call` publishes these with a release store before any call is visible to a reader.
        words[TICK_AT].store(tick, Ordering::Relaxed);
        words[COUNTS_AT].store(counts_at, Ordering::Relaxed);
        let count = words[COUNT_AT].load(Ordering::Relaxed);
        words[COUNT_AT].store(count.wrapping_add(1), Ordering::Relaxed);
        Now { words, tick, time_s, counts_at }
    }

    /// The call in progress; `None` between batches, or if the word does not hold a valid call.
    ///
    /// If the thread continues meanwhile, tick and count may already be those of a later batch.
    #[must_use]
    pub fn read(&self) -> Option<InCall> {
        // Pairs with the release in `Now::call`: tick and count are those of this call or later ones, never earlier.
        self.call_at(DOING_AT, TICK_AT)
    }

    /// The call that also returned in a copy of the process (`fork`), if one did.
    #[must_use]
    pub fn copied(&self) -> Option<InCall> {
        // Pairs with the release in `end_copy`.
        self.call_at(COPIED_AT, COPIED_TICK_AT)
    }

    /// Ends this process, a copy made by a unit in which this call returned too. The note ends the run in the original.
    pub(crate) fn end_copy(&self, tick: u64, instance: usize, doing: Doing) -> ! {
        let words = self.words();
        words[COPIED_TICK_AT].store(tick, Ordering::Relaxed);
        words[COPIED_AT].store(packed(instance, doing), Ordering::Release);
        exit::at_once(1)
    }

    fn call_at(&self, packed_at: usize, tick_at: usize) -> Option<InCall> {
        let words = self.words();
        let packed = words[packed_at].load(Ordering::Acquire);
        Some(InCall {
            tick: words[tick_at].load(Ordering::Relaxed),
            instance: usize::try_from((packed & !UNWOUND) >> 8).ok()?,
            doing: decode(packed & 0xff)?,
            unwound: packed & UNWOUND != 0,
            count: words[COUNT_AT].load(Ordering::Relaxed),
        })
    }

    /// The tick of the last batch.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.words()[TICK_AT].load(Ordering::Relaxed)
    }

    /// The tick at which the results of the last batch take effect.
    #[must_use]
    pub fn counts_at(&self) -> u64 {
        self.words()[COUNTS_AT].load(Ordering::Relaxed)
    }
}

/// A batch of calls at one simulated time; when it is dropped, the note says that no call is in progress.
///
/// In one batch the same function of an instance must not be called twice in succession: the process that watches the
/// note could not tell that from one call that hangs.
#[derive(Debug)]
pub struct Now<'a> {
    words: &'a [AtomicU64; NOTE_WORDS],
    /// The tick, as the note holds it.
    pub tick: u64,
    /// The same time in seconds, tick × step, for units and error messages.
    pub time_s: f64,
    /// The tick at which the results of the calls take effect; for a step this is the step's end.
    pub counts_at: u64,
}

impl Now<'_> {
    /// Makes a call of foreign code and notes it. If an exception or the end of the thread leaves the call, this is noted too
    /// and the process ends: no frame of this program may be unwound by either.
    #[inline]
    pub fn call<T>(&self, instance: usize, doing: Doing, foreign: impl FnOnce() -> T) -> T {
        self.words[DOING_AT].store(packed(instance, doing), Ordering::Release);
        let guard = UnwindGuard(self.words);
        let result = foreign();
        mem::forget(guard);
        result
    }
}

/// Dropped only by unwinding.
struct UnwindGuard<'a>(&'a [AtomicU64; NOTE_WORDS]);

impl Drop for UnwindGuard<'_> {
    /// Small enough to be inlined, so that the address stays in a register during a call.
    #[inline(always)]
    fn drop(&mut self) {
        end_unwound(self.0);
    }
}

#[cold]
#[inline(never)]
fn end_unwound(words: &[AtomicU64; NOTE_WORDS]) {
    // A panic is a mistake of this program, which its hook has reported.
    if !thread::panicking() {
        words[DOING_AT].fetch_or(UNWOUND, Ordering::Release);
        abort();
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
fn packed(instance: usize, doing: Doing) -> u64 {
    (instance as u64) << 8 | code(doing)
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
