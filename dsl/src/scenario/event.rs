//! Windows of `at`, `when` and `while`, and what happens in them.

use serde::{Deserialize, Serialize};

use super::{Drive, Port, RealExpression};

/// A window in which actions are in force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// When it opens.
    pub trigger: Trigger,
    /// The ticks after which it closes and undoes itself; without, an `at` or `when` stays.
    pub lasting: Option<u64>,
    /// What is in force while it is open, in the script's order.
    pub actions: Vec<Action>,
}

/// When a window opens. The resolver gives [`Trigger::At`] alone: it refuses `when` and `while`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trigger {
    /// At a tick.
    At(u64),
    /// Each time a condition, a slot of [`Scenario::conditions`](super::Scenario::conditions), begins to hold.
    When(usize),
    /// As long as such a condition holds.
    While(usize),
}

/// What a window does. The resolver gives [`Action::Set`] alone: it refuses faults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// One element of a `set`.
    Set(Set),
    /// A fault of connections.
    Fault(Fault),
}

/// One element of a `set`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Set {
    /// An input or a tunable parameter.
    pub target: Port,
    /// The value, tracked while the window is open.
    pub value: Drive,
}

/// What goes wrong on connections that one path names; loss, freeze and delay act on all of them as one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// The driven inputs.
    pub targets: Vec<Port>,
    /// What goes wrong.
    pub kind: FaultKind,
}

/// The kinds of faults; reals are in the targets' unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FaultKind {
    /// Adds a value.
    Bias(RealExpression),
    /// Adds a normal draw of this standard deviation to each element.
    Noise(RealExpression),
    /// Holds the last value with this probability.
    Loss(RealExpression),
    /// Holds the last value.
    Freeze,
    /// Delays values by this many ticks.
    Delay(u64),
}

impl Event {
    /// A window that opens at a tick.
    #[must_use]
    pub fn at(tick: u64, lasting: Option<u64>, sets: Vec<Set>) -> Self {
        Self { trigger: Trigger::At(tick), lasting, actions: sets.into_iter().map(Action::Set).collect() }
    }

    /// The elements that it sets.
    pub fn sets(&self) -> impl Iterator<Item = &Set> {
        self.actions.iter().filter_map(|action| match action {
            Action::Set(set) => Some(set),
            Action::Fault(_) => None,
        })
    }
}

#[test]
fn an_event_sets_what_its_actions_set() {
    let set = |variable, value| Set { target: Port { instance: 0, variable }, value: Drive::Integer(value) };
    let mut event = Event::at(3, Some(2), vec![set(0, 1), set(1, 2)]);
    event.actions.insert(1, Action::Fault(Fault { targets: Vec::new(), kind: FaultKind::Freeze }));
    assert_eq!(event.sets().map(|set| set.target.variable).collect::<Vec<_>>(), [0, 1]);
}
