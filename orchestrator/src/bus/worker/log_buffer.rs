//! Log messages and logged calls of a worker's units, from when they are written until the next reply takes them along.
//!
//! They wait on the board: it is a file mapped by the coordinator too, so they are not lost if a unit crashes the process.
//! The board's ring is small and waits for its reader when full. Nothing reads it during an order, so this buffer
//! moves its content to the process's memory before that.

use crate::run::message::Message;
use std::sync::{Arc, Mutex, PoisonError};
use unit::board::Board;
use unit::logger::LogMessage;

/// Log messages of one reply beyond so many bytes are dropped and counted, so that a reply stays shorter than the longest
/// message of a link. Logged calls are never dropped: a call log must be complete.
const MOST_BYTES: usize = 8 << 20;

/// Messages that wait for a reply.
#[derive(Debug)]
pub struct LogBuffer {
    board: Arc<Board>,
    /// Messages that were moved from the board to make room there.
    moved: Mutex<Moved>,
}

#[derive(Debug, Default)]
struct Moved {
    messages: Vec<Message>,
    bytes: usize,
    dropped: usize,
}

impl LogBuffer {
    pub fn new(board: Arc<Board>) -> Arc<Self> {
        Arc::new(Self { board, moved: Mutex::default() })
    }

    /// Adds a log message or a logged call. A unit may log from any thread; the lock keeps two of them from seeing the same
    /// room on the board.
    pub fn push(&self, message: &Message) {
        let Ok(bytes) = postcard::to_stdvec(message) else { return };
        let mut moved = self.moved.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.board.has_room_for(&bytes) {
            moved.move_from(&self.board);
        }
        self.board.push_message(&bytes);
    }

    /// Takes all messages out, in order.
    pub fn take(&self) -> Vec<Message> {
        let mut moved = self.moved.lock().unwrap_or_else(PoisonError::into_inner);
        moved.move_from(&self.board);
        let Moved { mut messages, dropped, .. } = std::mem::take(&mut *moved);
        let last_log =
            messages.iter().rev().find_map(|message| if let Message::Log(log) = message { Some(log) } else { None });
        if let Some(last) = last_log.filter(|_| dropped > 0).cloned() {
            let text = format!("… ({dropped} more messages of this step are left out)");
            messages.push(Message::Log(LogMessage { text, ..last }));
        }
        messages
    }
}

impl Moved {
    fn move_from(&mut self, board: &Board) {
        board.pop_messages(|bytes| {
            match postcard::from_bytes(bytes) {
                Ok(Message::Log(_)) if self.bytes > MOST_BYTES => self.dropped += 1,
                Ok(message) => {
                    self.bytes += bytes.len();
                    self.messages.push(message);
                }
                // A unit has overwritten a part of the board, which is in its process's memory.
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

    fn log(text: String) -> Message {
        let (instance, category) = (Some(0), String::new());
        Message::Log(LogMessage { instance, tick: 1, counts_at: 2, status: 0, category, text })
    }

    fn texts(messages: Vec<Message>) -> Vec<String> {
        let text = |message| if let Message::Log(log) = message { Some(log.text) } else { None };
        messages.into_iter().filter_map(text).collect()
    }

    #[test]
    fn more_log_messages_than_the_board_holds_are_kept_in_order() {
        let log_buffer = log_buffer();
        let expected: Vec<_> = (0..3000).map(|i| format!("{i} {}", "x".repeat(1000))).collect();
        expected.iter().for_each(|text| log_buffer.push(&log(text.clone())));
        assert!(texts(log_buffer.take()) == expected);
        assert_eq!(log_buffer.take(), []);
    }

    #[test]
    fn log_messages_beyond_the_limit_are_dropped_and_counted() {
        let log_buffer = log_buffer();
        let long = "x".repeat(60_000);
        (0..1000).for_each(|_| log_buffer.push(&log(long.clone())));
        let texts = texts(log_buffer.take());
        assert!(texts.len() < 200, "{}", texts.len());
        let last = &texts[texts.len() - 1];
        assert_eq!(last, &format!("… ({} more messages of this step are left out)", 1001 - texts.len()));
    }
}
