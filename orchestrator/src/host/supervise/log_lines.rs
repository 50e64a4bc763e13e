//! The lines of units' log messages; what an instance repeats is counted instead of printed again.

use dsl::scenario::Scenario;
use fmi2::printable;
use results::shortest_decimal;
use std::collections::{BTreeMap, VecDeque};
use unit::logger::LogMessage;
use unit::time::seconds;

/// How many different messages of an instance are remembered.
const REMEMBERED: usize = 8;
/// How many characters of a message are shown again beside the number of its repetitions.
const SHOWN_AGAIN: usize = 60;

/// A message that was printed.
#[derive(Debug)]
struct Printed {
    text: String,
    last: LogMessage,
    /// How often it came since then.
    again: u64,
}

/// The last messages of each instance, the latest of them at the end. Their order is that in which messages count, so the
/// lines do not depend on processes.
#[derive(Debug, Default)]
pub(super) struct LogLines {
    printed: BTreeMap<Option<usize>, VecDeque<Printed>>,
}

impl LogLines {
    /// The lines for a message: none if the instance repeats it, and before it the number of repetitions of a message that is
    /// remembered no longer.
    pub fn of(&mut self, message: LogMessage, scenario: &Scenario) -> Vec<String> {
        let printed = self.printed.entry(message.instance).or_default();
        let is_same = |known: &Printed| known.last.status == message.status && known.text == message.text;
        if let Some(mut known) = printed.iter().position(is_same).and_then(|at| printed.remove(at)) {
            known.again += 1;
            known.last = LogMessage { text: String::new(), ..message };
            printed.push_back(known);
            return Vec::new();
        }
        let forgotten = if printed.len() < REMEMBERED { None } else { printed.pop_front() };
        let mut lines: Vec<_> = forgotten.and_then(|known| repetitions(&known, scenario)).into_iter().collect();
        lines.push(log_line(&message, &message.text, scenario));
        let text = message.text.clone();
        let last = LogMessage { text: String::new(), ..message };
        printed.push_back(Printed { text, last, again: 0 });
        lines
    }

    /// The lines for all repetitions that have none yet.
    pub fn rest(&mut self, scenario: &Scenario) -> Vec<String> {
        let printed = std::mem::take(&mut self.printed);
        printed.into_values().flatten().filter_map(|known| repetitions(&known, scenario)).collect()
    }
}

/// The line for the repetitions of a message, if there are any.
fn repetitions(known: &Printed, scenario: &Scenario) -> Option<String> {
    let until = shortest_decimal(seconds(known.last.tick, scenario.step_ns));
    let count = match known.again {
        0 => return None,
        1 => format!("and 1 more like it at {until} s"),
        more => format!("and {more} more like it until {until} s"),
    };
    let text = printable::line(known.text.trim());
    let shown = match text.char_indices().nth(SHOWN_AGAIN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    };
    Some(log_line(&known.last, &format!("{count}: {shown}"), scenario))
}

/// A text with the instance, status and time of a message.
fn log_line(message: &LogMessage, text: &str, scenario: &Scenario) -> String {
    let time = shortest_decimal(seconds(message.tick, scenario.step_ns));
    let instance = message.instance.and_then(|instance| scenario.instances.get(instance));
    let name = printable::line(instance.map_or("-", |instance| instance.name.as_str()));
    format!("{time} s  {name}  {}  {}", message.status_name(), printable::block(text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::scenario;

    fn message(instance: Option<usize>, tick: u64, status: i32, text: &str) -> LogMessage {
        LogMessage { instance, tick, counts_at: tick, status, category: String::new(), text: text.to_owned() }
    }

    fn lines(messages: impl IntoIterator<Item = LogMessage>) -> Vec<String> {
        let mut log_lines = LogLines::default();
        let mut lines: Vec<_> = messages.into_iter().flat_map(|message| log_lines.of(message, &scenario())).collect();
        lines.extend(log_lines.rest(&scenario()));
        lines
    }

    #[test]
    fn a_log_message_is_printed_with_time_instance_and_status() {
        let line = |instance, status, text: &str| lines([message(instance, 1234, status, text)]).concat();
        assert_eq!(line(Some(0), 1, "low battery: 7 %\n"), "12.34 s  quad  warning  low battery: 7 %");
        assert_eq!(line(None, 0, "hello"), "12.34 s  -  info  hello");
        assert_eq!(line(Some(0), 77, "what?"), "12.34 s  quad  status 77  what?");
    }

    #[test]
    fn a_log_message_cannot_be_taken_for_another_line_and_commands_nothing() {
        let forged = message(None, 100, 0, "a\r\n\tb\x1b[2J\x07c\nerror: broken\rx\u{9b}\n");
        let expected = "1 s  -  info  a\n  | \tb\u{fffd}[2J\u{fffd}c\n  | error: broken\u{fffd}x\u{fffd}";
        assert_eq!(lines([forged]), [expected]);
    }

    #[test]
    fn what_an_instance_repeats_is_counted() {
        let repeated = (0..1000).flat_map(|tick| [message(Some(0), tick, 1, "low"), message(None, tick, 1, "low")]);
        let once =
            [message(Some(0), 1000, 1, "empty"), message(Some(0), 1001, 1, "empty"), message(Some(0), 1002, 3, "low")];
        let expected = [
            "0 s  quad  warning  low",
            "0 s  -  warning  low",
            "10 s  quad  warning  empty",
            "10.02 s  quad  error  low",
            "9.99 s  -  warning  and 999 more like it until 9.99 s: low",
            "9.99 s  quad  warning  and 999 more like it until 9.99 s: low",
            "10.01 s  quad  warning  and 1 more like it at 10.01 s: empty",
        ];
        assert_eq!(lines(repeated.chain(once)), expected);
    }

    #[test]
    fn a_message_that_is_long_ago_is_counted_before_a_new_one() {
        let long = "x".repeat(100);
        let twice = [message(Some(0), 1, 0, &long), message(Some(0), 2, 0, &long)];
        let others = (3..20).map(|tick| message(Some(0), tick, 0, &tick.to_string()));
        let printed = lines(twice.into_iter().chain(others));
        let counted = format!("0.02 s  quad  info  and 1 more like it at 0.02 s: {}…", "x".repeat(60));
        assert_eq!((printed.len(), &printed[8]), (19, &counted));
    }
}
