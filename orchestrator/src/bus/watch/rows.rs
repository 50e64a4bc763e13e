//! The bounded queue of rows between the run and the publisher; when it is full the oldest row is dropped.

use std::collections::VecDeque;

/// A queue that drops its oldest row, so that adding one never waits. With a capacity of one it holds the newest row.
#[derive(Debug)]
pub struct Rows {
    /// The rows in order; each is its tick and then its slots.
    words: VecDeque<u64>,
    width: usize,
    capacity: usize,
    dropped: u64,
}

impl Rows {
    /// A queue for so many rows of so many columns.
    pub fn new(columns: usize, capacity: usize) -> Self {
        assert!(capacity > 0, "a queue has room for a row");
        Self { words: VecDeque::new(), width: columns + 1, capacity, dropped: 0 }
    }

    /// Adds the newest row.
    pub fn push(&mut self, tick: u64, slots: &[u64]) {
        assert_eq!(slots.len() + 1, self.width, "a row has one slot for each column");
        if self.words.len() == self.capacity * self.width {
            self.words.drain(..self.width);
            self.dropped += 1;
        }
        self.words.push_back(tick);
        self.words.extend(slots);
    }

    /// Takes all rows out, in order, in exchange for an empty queue whose memory is used for the next ones. The lock is held
    /// for this exchange only, not while rows are published.
    pub fn exchange(&mut self, empty: &mut VecDeque<u64>) {
        assert!(empty.is_empty(), "what was taken before was read");
        std::mem::swap(&mut self.words, empty);
    }

    /// How many rows were dropped.
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
    fn a_queue_for_one_row_holds_the_newest() {
        let mut rows = Rows::new(2, 1);
        for tick in 0..3 {
            rows.push(tick, &[10 * tick, 10 * tick + 1]);
        }
        assert_eq!(taken(&mut rows), [2, 20, 21]);
        assert_eq!(taken(&mut rows), Vec::<u64>::new());
    }

    #[test]
    fn a_queue_keeps_the_order_and_drops_and_counts_the_oldest() {
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
    fn a_row_without_columns_is_a_tick() {
        let mut rows = Rows::new(0, 1);
        rows.push(7, &[]);
        assert_eq!(taken(&mut rows), [7]);
    }
}
