//! How a claim stands, in two copies, so that a process which dies while it writes one leaves the previous one intact.

use std::sync::atomic::{AtomicU64, Ordering, fence};

/// Words of one claim: the number of times it was stored, then two copies. The count selects the valid copy.
pub(super) const CLAIM_WORDS: usize = 16;

const COUNT_AT: usize = 0;
const COPIES_AT: usize = 4;
const COPY_WORDS: usize = 5;

/// Reading retries while the writer overtakes it, but not for ever: an overwritten count must not hang the reader.
const TRIES: usize = 100;

/// How a claim stands so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClaimNote {
    /// The verdict as its number; the crate that writes it defines the numbers.
    pub verdict: u8,
    /// The margin in SI units, or ±∞.
    pub margin: f64,
    /// The tick of the worst point.
    pub worst_tick: u64,
    /// The tick of the first violation.
    pub first_tick: u64,
    /// The part of the claim that the margin comes from.
    pub part: u32,
}

impl ClaimNote {
    pub(super) fn store(&self, words: &[AtomicU64]) {
        let count = words[COUNT_AT].load(Ordering::Relaxed).wrapping_add(1);
        let copy = copy(words, count);
        // This copy holds the standing before the previous one, and a slow reader may still be reading it. The fence
        // pairs with the one in `load`: a reader that saw any of the stores below also sees the count of the previous
        // `store`, which is not the count that it began with, and so it tries again.
        fence(Ordering::Release);
        copy[0].store(u64::from(self.verdict), Ordering::Relaxed);
        copy[1].store(self.margin.to_bits(), Ordering::Relaxed);
        copy[2].store(self.worst_tick, Ordering::Relaxed);
        copy[3].store(self.first_tick, Ordering::Relaxed);
        copy[4].store(u64::from(self.part), Ordering::Relaxed);
        words[COUNT_AT].store(count, Ordering::Release);
    }

    pub(super) fn load(words: &[AtomicU64]) -> Option<Self> {
        let mut read = None;
        for _ in 0..TRIES {
            let count = words[COUNT_AT].load(Ordering::Acquire);
            if count == 0 {
                return None;
            }
            let copy = copy(words, count).each_ref().map(|word| word.load(Ordering::Relaxed));
            // Keeps the second load of the count after the loads of the copy; see `store`.
            fence(Ordering::Acquire);
            read = Some(Self {
                verdict: u8::try_from(copy[0]).unwrap_or(u8::MAX),
                margin: f64::from_bits(copy[1]),
                worst_tick: copy[2],
                first_tick: copy[3],
                part: u32::try_from(copy[4]).unwrap_or(u32::MAX),
            });
            if words[COUNT_AT].load(Ordering::Relaxed) == count {
                break;
            }
        }
        read
    }
}

fn copy(words: &[AtomicU64], count: u64) -> [&AtomicU64; COPY_WORDS] {
    let at = COPIES_AT + if count.is_multiple_of(2) { 0 } else { COPY_WORDS };
    std::array::from_fn(|i| &words[at + i])
}
