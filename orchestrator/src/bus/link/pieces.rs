//! Messages in pieces: a low-latency link of zenoh takes nothing longer than its buffer, and says nothing then.
//!
//! A piece is so much of a message and one byte more: zero in the last piece of a message.

/// The longest piece, without its last byte.
const LONGEST: usize = 40 << 10;
const LAST: u8 = 0;
const MORE: u8 = 1;

/// Cuts a message; an empty one is a piece as well.
pub fn cut(message: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    let mut rest = Some(message);
    std::iter::from_fn(move || {
        let (piece, behind) = rest?.split_at_checked(LONGEST).unwrap_or((rest?, &[]));
        rest = (!behind.is_empty()).then_some(behind);
        Some([piece, &[if rest.is_some() { MORE } else { LAST }]].concat())
    })
}

/// Joins pieces, which come in the order in which they were cut.
#[derive(Debug, Default)]
pub struct Joiner {
    begun: Vec<u8>,
}

impl Joiner {
    /// The message that is complete with this piece. One that grows longer than `longest` is handed over as it is then, so
    /// that whoever reads it sees that it is none.
    pub fn add(&mut self, piece: &[u8], longest: usize) -> Option<Vec<u8>> {
        let (&end, bytes) = piece.split_last().unwrap_or((&LAST, &[]));
        self.begun.extend_from_slice(bytes);
        let is_over = end != MORE || self.begun.len() > longest;
        is_over.then(|| std::mem::take(&mut self.begun))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(length: usize) -> Vec<u8> {
        (0..length).map(|at| (at % 251) as u8).collect()
    }

    #[test]
    fn what_was_cut_is_joined_again_and_only_when_it_is_whole() {
        let mut joiner = Joiner::default();
        for (length, pieces) in [(0, 1), (72, 1), (LONGEST, 1), (LONGEST + 1, 2), (3 * LONGEST, 3), (1 << 20, 26)] {
            let message = message(length);
            let cut: Vec<_> = cut(&message).collect();
            assert_eq!(cut.len(), pieces, "{length}");
            assert!(cut.iter().all(|piece| piece.len() <= LONGEST + 1));
            let joined: Vec<_> = cut.iter().filter_map(|piece| joiner.add(piece, usize::MAX)).collect();
            assert!(joined == [message], "{length}");
        }
    }

    #[test]
    fn whatever_comes_as_pieces_ends_as_a_message() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.add(&[], 10), Some(vec![]));
        assert_eq!(joiner.add(&[7, 200], 10), Some(vec![7]));
        assert_eq!(joiner.add(&[1, 2, 3, 4, 5, 6, MORE], 10), None);
        assert_eq!(joiner.add(&[1, 2, 3, 4, 5, 6, MORE], 10), Some(vec![1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6]));
        assert_eq!(joiner.add(&[1, LAST], 10), Some(vec![1]), "nothing is left of what was too long");
    }
}
