//! The words of the language for what a window of the script does, as results and pictures show them.

use dsl::scenario::{Action, Event, FaultKind, Trigger};

/// The word with which the statement begins.
#[must_use]
pub fn trigger(event: &Event) -> &'static str {
    match event.trigger {
        Trigger::At(_) => "at",
        Trigger::When(_) => "when",
        Trigger::While(_) => "while",
    }
}

/// What is in force in the window, each kind once, in the order of the script.
#[must_use]
pub fn does(event: &Event) -> Vec<&'static str> {
    let mut words = Vec::new();
    for word in event.actions.iter().map(word) {
        if !words.contains(&word) {
            words.push(word);
        }
    }
    words
}

fn word(action: &Action) -> &'static str {
    match action {
        Action::Set(_) => "set",
        Action::Fault(fault) => match fault.kind {
            FaultKind::Bias(_) => "bias",
            FaultKind::Noise(_) => "noise",
            FaultKind::Loss(_) => "loss",
            FaultKind::Freeze => "freeze",
            FaultKind::Delay(_) => "delay",
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dsl::scenario::Fault;

    #[test]
    fn a_window_is_told_in_the_words_of_the_language() {
        let mut event = Event::at(3, None, Vec::new());
        let fault = |kind| Action::Fault(Fault { targets: Vec::new(), kind });
        event.actions = vec![fault(FaultKind::Freeze), fault(FaultKind::Delay(2)), fault(FaultKind::Freeze)];
        assert_eq!((trigger(&event), does(&event)), ("at", vec!["freeze", "delay"]));
    }
}
