//! Windows of `at`, `when` and `while`, what happens in them, and what ends a run before its time.

use serde::{Deserialize, Serialize};

use super::{BooleanExpression, Drive, Port, RealExpression, Slots};

/// A window in which actions are in force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// When it opens.
    pub trigger: Trigger,
    /// The ticks after which it closes and undoes itself; without, an `at` or `when` stays.
    pub lasting: Option<u64>,
    /// What is in force while it is open, in the script's order.
    pub actions: Vec<Action>,
    /// The name of its file and its line: `quad.scn:34`.
    pub statement: String,
    /// Its time or condition as written: `world.clearance < 3 m held 2 s`.
    pub condition: String,
}

/// When a window opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trigger {
    /// At a tick.
    At(u64),
    /// Each time a condition, a slot of [`Scenario::conditions`](super::Scenario::conditions), begins to hold.
    When(usize),
    /// As long as such a condition holds.
    While(usize),
}

/// A condition that a run follows from sample to sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Condition {
    /// What must hold.
    pub is: BooleanExpression,
    /// For how many ticks it must have held, for `held`; else 0.
    pub held_ticks: u64,
}

/// What a window does.
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
    /// The driven inputs, in the path's order.
    pub targets: Vec<Port>,
    /// What goes wrong.
    pub kind: FaultKind,
}

/// The kinds of faults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FaultKind {
    /// Adds a value: one for each target, in its unit.
    Bias(Vec<RealExpression>),
    /// Adds a normal draw of this standard deviation: one for each target, in its unit.
    Noise(Vec<RealExpression>),
    /// Holds the last value with this probability.
    Loss(RealExpression),
    /// Holds the last value.
    Freeze,
    /// Delays values by this many ticks.
    Delay(u64),
}

/// The places at which a window changes what an input gets, in the order in which a value passes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// `set`
    Set,
    /// `bias`
    Bias,
    /// `noise`
    Noise,
    /// `loss` and `freeze`
    Hold,
    /// `delay`
    Delay,
}

/// `stop when`: the run ends when a condition holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StopWhen {
    /// A slot of [`Scenario::conditions`](super::Scenario::conditions).
    pub condition: usize,
    /// The condition as written.
    pub text: String,
}

impl Event {
    /// A window that opens at a tick and is not written in a script.
    #[must_use]
    pub fn at(tick: u64, lasting: Option<u64>, sets: Vec<Set>) -> Self {
        let actions = sets.into_iter().map(Action::Set).collect();
        Self { trigger: Trigger::At(tick), lasting, actions, statement: String::new(), condition: String::new() }
    }

    /// Whether it closes by itself; else what it does stays.
    #[must_use]
    pub fn is_window(&self) -> bool {
        self.lasting.is_some() || matches!(self.trigger, Trigger::While(_))
    }

    /// The elements that it sets.
    pub fn sets(&self) -> impl Iterator<Item = &Set> {
        self.actions.iter().filter_map(|action| match action {
            Action::Set(set) => Some(set),
            Action::Fault(_) => None,
        })
    }

    /// Visits each port that its actions are computed from, as [`Drive::reads`] does.
    pub fn reads(&self, slots: Slots<'_>, visit: &mut dyn FnMut(Port)) {
        for action in &self.actions {
            match action {
                Action::Set(set) => set.value.reads(slots, visit),
                Action::Fault(fault) => fault.kind.values().iter().for_each(|value| value.reads(slots, visit)),
            }
        }
    }
}

impl Action {
    /// The ports that it acts on.
    #[must_use]
    pub fn targets(&self) -> &[Port] {
        match self {
            Self::Set(set) => std::slice::from_ref(&set.target),
            Self::Fault(fault) => &fault.targets,
        }
    }

    /// Where it acts.
    #[must_use]
    pub fn stage(&self) -> Stage {
        match self {
            Self::Set(_) => Stage::Set,
            Self::Fault(fault) => fault.kind.stage(),
        }
    }
}

impl FaultKind {
    /// Where it acts.
    #[must_use]
    pub fn stage(&self) -> Stage {
        match self {
            Self::Bias(_) => Stage::Bias,
            Self::Noise(_) => Stage::Noise,
            Self::Loss(_) | Self::Freeze => Stage::Hold,
            Self::Delay(_) => Stage::Delay,
        }
    }

    /// What it computes with.
    #[must_use]
    pub fn values(&self) -> &[RealExpression] {
        match self {
            Self::Bias(values) | Self::Noise(values) => values,
            Self::Loss(value) => std::slice::from_ref(value),
            Self::Freeze | Self::Delay(_) => &[],
        }
    }

    /// The same, to be changed.
    pub(crate) fn values_mut(&mut self) -> &mut [RealExpression] {
        match self {
            Self::Bias(values) | Self::Noise(values) => values,
            Self::Loss(value) => std::slice::from_mut(value),
            Self::Freeze | Self::Delay(_) => &mut [],
        }
    }

    /// Whether it uses random numbers.
    #[must_use]
    pub fn draws(&self) -> bool {
        matches!(self, Self::Noise(_) | Self::Loss(_))
    }
}

#[test]
fn an_event_sets_what_its_actions_set() {
    let set = |variable, value| Set { target: Port { instance: 0, variable }, value: Drive::Integer(value) };
    let mut event = Event::at(3, Some(2), vec![set(0, 1), set(1, 2)]);
    event.actions.insert(1, Action::Fault(Fault { targets: Vec::new(), kind: FaultKind::Freeze }));
    assert_eq!(event.sets().map(|set| set.target.variable).collect::<Vec<_>>(), [0, 1]);
}
