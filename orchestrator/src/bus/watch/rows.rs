//! Rows on their way from the run to the publisher: a queue with an end, in which the newest count.

use std::collections::VecDeque;

/// A queue that drops its oldest row rather than ask anybody to wait. With room for one it is a slot: the newest wins.
#[derive(Debug)]
pub struct Rows {
    /// Row after row: its tick, then its slots.
    words: VecDeque<u64>,
    width: usize,
    room: usize,
    dropped: u64,
}

impl Rows {
    /// Room for so many rows of so many columns.
    pub fn new(columns: usize, room: usize) -> Self {
        assert!(room > 0, "a queue has room for a row");
        Self { words: VecDeque::new(), width: columns + 1, room, dropped: 0 }
    }

    /// Adds the newest row.
    pub fn push(&mut self, tick: u64, slots: &[u64]) {
        assert_eq!(slots.len() + 1, self.width, "a row has one slot for each column");
        if self.words.len() == self.room * self.width {
            self.words.drain(..self.width);
            self.dropped += 1;
        }
        self.words.push_back(tick);
        self.words.extend(slots);
    }

    /// Takes all rows out, in order, in exchange for an empty queue whose memory serves the next ones.
    pub fn exchange(&mut self, empty: &mut VecDeque<u64>) {
        assert!(empty.is_empty(), "what was taken before was read");
        std::mem::swap(&mut self.words, empty);
    }

    /// How many rows nobody took in time.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(rows: &mut Rows) -> Vec<u64> {
        let mut words = VecDeque::new();
        rows.exchange(&mut words);
        words.into()
    }

    #[test]
    fn a_slot_holds_the_newest_row() {
        let mut rows = Rows::new(2, 1);
        for tick in 0..3 {
            rows.push(tick, &[10 * tick, 10 * tick + 1]);
        }
        assert_eq!(taken(&mut rows), [2, 20, 21]);
        assert_eq!(taken(&mut rows), Vec::<u64>::new());
    }

    #[test]
    fn a_queue_keeps_the_order_drops_the_oldest_and_counts_them() {
        let mut rows = Rows::new(1, 3);
        for tick in 0..3 {
            rows.push(tick, &[10 * tick]);
        }
        assert_eq!((taken(&mut rows), rows.dropped()), (vec![0, 0, 1, 10, 2, 20], 0));
        for tick in 3..8 {
            rows.push(tick, &[10 * tick]);
        }
        assert_eq!((taken(&mut rows), rows.dropped()), (vec![5, 50, 6, 60, 7, 70], 2));
    }

    #[test]
    fn a_row_without_columns_is_its_tick() {
        let mut rows = Rows::new(0, 1);
        rows.push(7, &[]);
        assert_eq!(taken(&mut rows), [7]);
    }
}
