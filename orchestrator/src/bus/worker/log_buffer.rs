//! What units say until the next reply takes it along: on the board, where it outlives the process.

use crate::run::message::Message;
use std::sync::{Arc, Mutex, PoisonError};
use unit::board::Board;
use unit::logger::LogMessage;

/// One reply takes no more bytes of words than these; the rest is dropped, and how much that was is told. Calls are never.
const MOST_BYTES: usize = 8 << 20;

/// LogOrder that wait for a reply.
#[derive(Debug)]
pub struct LogBuffer {
    board: Arc<Board>,
    /// What was taken from the board to make room.
    taken: Mutex<Taken>,
}

#[derive(Debug, Default)]
struct Taken {
    said: Vec<Message>,
    bytes: usize,
    dropped: usize,
}

impl LogBuffer {
    pub fn new(board: Arc<Board>) -> Arc<Self> {
        Arc::new(Self { board, taken: Mutex::default() })
    }

    /// Keeps what a unit said, or a call; any thread may.
    pub fn say(&self, told: &Message) {
        let Ok(bytes) = postcard::to_stdvec(told) else { return };
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.board.has_room_for(&bytes) {
            taken.take_from(&self.board);
        }
        self.board.push_message(&bytes);
    }

    /// Hands over all that was said.
    pub fn take(&self) -> Vec<Message> {
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        taken.take_from(&self.board);
        let Taken { mut said, dropped, .. } = std::mem::take(&mut *taken);
        let last_words =
            said.iter().rev().find_map(|told| if let Message::Log(said) = told { Some(said) } else { None });
        if let Some(last) = last_words.filter(|_| dropped > 0).cloned() {
            let text = format!("… ({dropped} more messages of this step are left out)");
            said.push(Message::Log(LogMessage { text, ..last }));
        }
        said
    }
}

impl Taken {
    fn take_from(&mut self, board: &Board) {
        board.pop_messages(|bytes| {
            match postcard::from_bytes(bytes) {
                Ok(Message::Log(_)) if self.bytes > MOST_BYTES => self.dropped += 1,
                Ok(told) => {
                    self.bytes += bytes.len();
                    self.said.push(told);
                }
                // A unit scribbled on the board.
                Err(_) => self.dropped += 1,
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use unit::board::BoardLayout;

    fn log_buffer() -> Arc<LogBuffer> {
        LogBuffer::new(Arc::new(Board::private(&BoardLayout { notes: 1, columns: 0, claims: 0 }).unwrap()))
    }

    fn said(text: String) -> Message {
        let (instance, category) = (Some(0), String::new());
        Message::Log(LogMessage { instance, tick: 1, counts_at: 2, status: 0, category, text })
    }

    fn texts(told: Vec<Message>) -> Vec<String> {
        let text = |told| if let Message::Log(said) = told { Some(said.text) } else { None };
        told.into_iter().filter_map(text).collect()
    }

    #[test]
    fn more_words_than_the_board_holds_are_kept_in_order() {
        let log_buffer = log_buffer();
        let expected: Vec<_> = (0..3000).map(|i| format!("{i} {}", "x".repeat(1000))).collect();
        expected.iter().for_each(|text| log_buffer.say(&said(text.clone())));
        assert!(texts(log_buffer.take()) == expected);
        assert_eq!(log_buffer.take(), []);
    }

    #[test]
    fn a_flood_of_words_is_cut_and_that_is_told() {
        let log_buffer = log_buffer();
        let long = "x".repeat(60_000);
        (0..1000).for_each(|_| log_buffer.say(&said(long.clone())));
        let told = texts(log_buffer.take());
        assert!(told.len() < 200, "{}", told.len());
        let last = &told[told.len() - 1];
        assert_eq!(last, &format!("… ({} more messages of this step are left out)", 1001 - told.len()));
    }
}
