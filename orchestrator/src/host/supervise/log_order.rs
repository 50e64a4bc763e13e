//! LogOrder of units, told in one order wherever the units are: by the tick at which they count, then by instance.

use std::collections::BTreeMap;
use unit::logger::LogMessage;

/// LogOrder that wait for more than these bytes are told at once, in the order in which they came.
const MOST_BYTES: usize = 16 << 20;

/// LogOrder that wait until nobody can say anything any more that comes before them.
#[derive(Debug, Default)]
pub(super) struct LogOrder {
    waiting: BTreeMap<(u64, usize, u64), LogMessage>,
    heard: u64,
    bytes: usize,
}

impl LogOrder {
    /// Takes what a unit said. What belongs to no instance comes last of its tick.
    pub fn hear(&mut self, said: LogMessage) {
        self.bytes += size(&said);
        self.heard += 1;
        self.waiting.insert((said.counts_at, said.instance.unwrap_or(usize::MAX), self.heard), said);
    }

    /// Hands over, in order, what counts before this tick.
    pub fn before(&mut self, tick: u64) -> impl Iterator<Item = LogMessage> + use<> {
        let later = self.waiting.split_off(&(tick, 0, 0));
        let told = std::mem::replace(&mut self.waiting, later);
        self.bytes -= told.values().map(size).sum::<usize>();
        told.into_values()
    }

    /// Hands over everything, in order.
    pub fn all(&mut self) -> impl Iterator<Item = LogMessage> + use<> {
        self.bytes = 0;
        std::mem::take(&mut self.waiting).into_values()
    }

    /// Whether so much waits that it has to be told.
    pub fn are_many(&self) -> bool {
        self.bytes > MOST_BYTES
    }
}

/// Bytes that a message takes while it waits.
fn size(said: &LogMessage) -> usize {
    /// Of the message itself and of its place in order.
    const AROUND: usize = 128;
    said.text.len() + said.category.len() + AROUND
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(instance: impl Into<Option<usize>>, counts_at: u64, text: &str) -> LogMessage {
        let (instance, category, text) = (instance.into(), String::new(), text.to_owned());
        LogMessage { instance, tick: 0, counts_at, status: 0, category, text }
    }

    fn texts(told: impl Iterator<Item = LogMessage>) -> Vec<String> {
        told.map(|said| said.text).collect()
    }

    #[test]
    fn words_come_by_tick_then_by_instance_then_as_they_were_said() {
        let mut log_order = LogOrder::default();
        for word in [said(1, 5, "d"), said(0, 5, "b"), said(0, 5, "c"), said(None, 5, "e"), said(2, 3, "a")] {
            log_order.hear(word);
        }
        assert_eq!(texts(log_order.before(5)), ["a"]);
        assert_eq!(texts(log_order.before(5)), [""; 0]);
        assert_eq!(texts(log_order.before(6)), ["b", "c", "d", "e"]);
    }

    #[test]
    fn too_many_words_do_not_wait() {
        let mut log_order = LogOrder::default();
        let long = "x".repeat(MOST_BYTES / 2);
        for tick in 0..3 {
            log_order.hear(said(0, tick, &long));
        }
        assert!(log_order.are_many());
        assert_eq!(log_order.all().count(), 3);
        assert!(!log_order.are_many());
    }
}
