//! Sorts the log messages of units, so that their order does not depend on processes: by tick, then by instance.

use std::collections::BTreeMap;
use unit::logger::LogMessage;

/// If the waiting messages take more than these bytes, all of them are handed over without waiting for earlier ones.
const MOST_BYTES: usize = 16 << 20;

/// Log messages that wait until no message that precedes them can arrive any more.
#[derive(Debug, Default)]
pub(super) struct LogOrder {
    waiting: BTreeMap<(u64, usize, u64), LogMessage>,
    received: u64,
    bytes: usize,
}

impl LogOrder {
    /// Adds a message. Those without an instance come last within their tick.
    pub fn add(&mut self, message: LogMessage) {
        self.bytes += size(&message);
        self.received += 1;
        self.waiting.insert((message.counts_at, message.instance.unwrap_or(usize::MAX), self.received), message);
    }

    /// Removes and returns, in order, the messages that count before this tick.
    pub fn before(&mut self, tick: u64) -> impl Iterator<Item = LogMessage> + use<> {
        let later = self.waiting.split_off(&(tick, 0, 0));
        let messages = std::mem::replace(&mut self.waiting, later);
        self.bytes -= messages.values().map(size).sum::<usize>();
        messages.into_values()
    }

    /// Removes and returns all messages, in order.
    pub fn all(&mut self) -> impl Iterator<Item = LogMessage> + use<> {
        self.bytes = 0;
        std::mem::take(&mut self.waiting).into_values()
    }

    /// Whether so many messages wait that they have to be handed over.
    pub fn are_many(&self) -> bool {
        self.bytes > MOST_BYTES
    }
}

/// Bytes that a message takes while it waits.
fn size(message: &LogMessage) -> usize {
    /// The message itself and its key.
    const AROUND: usize = 128;
    message.text.len() + message.category.len() + AROUND
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(instance: impl Into<Option<usize>>, counts_at: u64, text: &str) -> LogMessage {
        let (instance, category, text) = (instance.into(), String::new(), text.to_owned());
        LogMessage { instance, tick: 0, counts_at, status: 0, category, text }
    }

    fn texts(messages: impl Iterator<Item = LogMessage>) -> Vec<String> {
        messages.map(|message| message.text).collect()
    }

    #[test]
    fn messages_are_ordered_by_tick_then_by_instance_then_by_arrival() {
        let mut log_order = LogOrder::default();
        for next in
            [message(1, 5, "d"), message(0, 5, "b"), message(0, 5, "c"), message(None, 5, "e"), message(2, 3, "a")]
        {
            log_order.add(next);
        }
        assert_eq!(texts(log_order.before(5)), ["a"]);
        assert_eq!(texts(log_order.before(5)), [""; 0]);
        assert_eq!(texts(log_order.before(6)), ["b", "c", "d", "e"]);
    }

    #[test]
    fn too_many_messages_do_not_wait() {
        let mut log_order = LogOrder::default();
        let long = "x".repeat(MOST_BYTES / 2);
        for tick in 0..3 {
            log_order.add(message(0, tick, &long));
        }
        assert!(log_order.are_many());
        assert_eq!(log_order.all().count(), 3);
        assert!(!log_order.are_many());
    }
}
