//! Messages cut into pieces that zenoh's low-latency transport can carry.
//!
//! That transport does not split messages. Its receiver has a buffer of 64 kB and closes the link at a longer one; the
//! sender gets no error. A piece is a part of a message and one byte behind it: 0 in the last piece of a message, else 1.

/// The longest piece without that byte; zenoh's header must fit into the buffer too.
const LONGEST: usize = 40 << 10;
const LAST: u8 = 0;
const MORE: u8 = 1;

/// Cuts a message; an empty one is one piece.
pub fn cut(message: &[u8]) -> impl Iterator<Item = Vec<u8>> {
    let mut rest = Some(message);
    std::iter::from_fn(move || {
        let (piece, remaining) = rest?.split_at_checked(LONGEST).unwrap_or((rest?, &[]));
        rest = (!remaining.is_empty()).then_some(remaining);
        Some([piece, &[if rest.is_some() { MORE } else { LAST }]].concat())
    })
}

/// Joins pieces, which arrive in the order in which they were cut.
#[derive(Debug, Default)]
pub struct Joiner {
    partial: Vec<u8>,
}

impl Joiner {
    /// Returns the message if this piece completes it. A message that grows longer than `longest` is returned incomplete:
    /// memory stays bounded, and the decoder rejects it.
    pub fn add(&mut self, piece: &[u8], longest: usize) -> Option<Vec<u8>> {
        let (&end, bytes) = piece.split_last().unwrap_or((&LAST, &[]));
        self.partial.extend_from_slice(bytes);
        let is_complete = end != MORE || self.partial.len() > longest;
        is_complete.then(|| std::mem::take(&mut self.partial))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(length: usize) -> Vec<u8> {
        (0..length).map(|at| (at % 251) as u8).collect()
    }

    #[test]
    fn cut_pieces_join_to_the_same_message_and_only_once_it_is_complete() {
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
    fn every_sequence_of_pieces_ends_as_a_message_of_bounded_length() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.add(&[], 10), Some(vec![]));
        assert_eq!(joiner.add(&[7, 200], 10), Some(vec![7]));
        assert_eq!(joiner.add(&[1, 2, 3, 4, 5, 6, MORE], 10), None);
        assert_eq!(joiner.add(&[1, 2, 3, 4, 5, 6, MORE], 10), Some(vec![1, 2, 3, 4, 5, 6, 1, 2, 3, 4, 5, 6]));
        assert_eq!(joiner.add(&[1, LAST], 10), Some(vec![1]), "nothing is left of what was too long");
    }
}
