//! Windows of `when` and `while`, and `stop when`, seen through fake units.

use crate::fake::{P, Script, U, Y, counter, port, repeater, unit};
use crate::{TIME, number};
use dsl::scenario::{
    Action, BooleanExpression, Condition, Drive, Event, Margin, RealExpression, Set, StopWhen, Trigger,
};
use flatten::wiring::Change;
use orchestrator::run::message::{Finish, Reason};

/// Holds at these ticks.
pub fn at_ticks(ticks: &[u32]) -> BooleanExpression {
    let at = |tick: &u32| {
        let distance = RealExpression::Subtract(Box::new(TIME), Box::new(number(f64::from(*tick))));
        let distance = RealExpression::Call(dsl::scenario::Function::Abs, vec![distance]);
        let value = RealExpression::Subtract(Box::new(number(0.5)), Box::new(distance));
        BooleanExpression::Margin(Margin { value, strict: true })
    };
    BooleanExpression::Or(ticks.iter().map(at).collect())
}

impl Script {
    /// Adds a condition and returns its slot.
    pub fn condition(&mut self, is: BooleanExpression, held_ticks: u64) -> usize {
        self.scenario.conditions.push(Condition { is, held_ticks });
        self.scenario.conditions.len() - 1
    }

    pub fn event(mut self, trigger: Trigger, lasting: Option<u64>, actions: Vec<Action>) -> Self {
        let statement = format!("a.scn:{}", self.scenario.events.len() + 4);
        self.scenario.events.push(Event { trigger, lasting, actions, statement, condition: String::new() });
        self
    }

    pub fn when(mut self, ticks: &[u32], held: u64, lasting: Option<u64>, actions: Vec<Action>) -> Self {
        let slot = self.condition(at_ticks(ticks), held);
        self.event(Trigger::When(slot), lasting, actions)
    }

    pub fn in_ticks(mut self, ticks: &[u32], actions: Vec<Action>) -> Self {
        let slot = self.condition(at_ticks(ticks), 0);
        self.event(Trigger::While(slot), None, actions)
    }
}

pub fn set(instance: usize, variable: usize, value: f64) -> Vec<Action> {
    vec![Action::Set(Set { target: port(instance, variable), value: Drive::Real(number(value)) })]
}

/// A counter drives the input of a repeater; its input without windows is 0, 1, 2, 3, 4, 5, 5.
fn connected() -> Script {
    Script::new(vec![counter(1, 0), repeater(1, 0)]).connect(0, 1, false).record(&[(1, U)])
}

fn column(script: Script) -> Vec<f64> {
    script.run().column(0)
}

#[test]
fn while_holds_exactly_as_long_as_its_condition() {
    assert_eq!(column(connected().in_ticks(&[2, 3], set(1, U, -1.0))), [0.0, 1.0, -1.0, -1.0, 4.0, 5.0, 5.0]);
    assert_eq!(column(connected().in_ticks(&[0, 2], set(1, U, -1.0))), [-1.0, 1.0, -1.0, 3.0, 4.0, 5.0, 5.0]);
}

#[test]
fn when_opens_at_each_edge_unless_it_is_open() {
    let table: [(&[u32], u64, [f64; 7]); 6] = [
        // It closes although its condition still holds, and waits for the next edge.
        (&[1, 2, 3, 4, 5], 2, [0.0, -1.0, -1.0, 3.0, 4.0, 5.0, 5.0]),
        // Before the start counts as false.
        (&[0, 1, 2], 2, [-1.0, -1.0, 2.0, 3.0, 4.0, 5.0, 5.0]),
        // An open window is not restarted by another edge.
        (&[1, 3, 4, 5], 3, [0.0, -1.0, -1.0, -1.0, 4.0, 5.0, 5.0]),
        // One that closes at an edge opens again.
        (&[1, 3], 2, [0.0, -1.0, -1.0, -1.0, -1.0, 5.0, 5.0]),
        (&[1, 4], 1, [0.0, -1.0, 2.0, 3.0, -1.0, 5.0, 5.0]),
        // The run ends before it takes the events of its last tick.
        (&[6], 1, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0]),
    ];
    for (ticks, lasting, expected) in table {
        assert_eq!(column(connected().when(ticks, 0, Some(lasting), set(1, U, -1.0))), expected, "{ticks:?}");
    }
}

#[test]
fn held_counts_the_time_for_which_a_condition_holds_without_a_break() {
    for (ticks, held, expected) in [
        (&[1, 2, 3, 4, 5][..], 2, [0.0, 1.0, 2.0, -1.0, 4.0, 5.0, 5.0]),
        (&[0, 1, 3, 4, 5], 2, [0.0, 1.0, 2.0, 3.0, 4.0, -1.0, -1.0]),
        (&[0, 1, 2], 2, [0.0, 1.0, -1.0, 3.0, 4.0, 5.0, 5.0]),
        (&[0, 1], 2, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0]),
    ] {
        assert_eq!(column(connected().when(ticks, held, Some(1), set(1, U, -1.0))), expected, "{ticks:?}");
    }
}

#[test]
fn what_stays_is_replaced_by_what_comes_later_and_a_window_returns_to_it() {
    let script = connected().when(&[1, 5], 0, None, set(1, U, -1.0)).when(&[2], 0, None, set(1, U, -2.0));
    assert_eq!(column(script.in_ticks(&[3], set(1, U, -3.0))), [0.0, -1.0, -2.0, -3.0, -2.0, -1.0, -1.0]);
    let script = connected().when(&[1], 0, None, set(1, U, -1.0)).when(&[1], 0, None, set(1, U, -2.0));
    assert_eq!(column(script)[1], -2.0, "actions apply in the order of the file");
    let script = connected().at(1, None, port(1, U), number(-1.0)).in_ticks(&[1, 2], set(1, U, -3.0));
    assert_eq!(column(script), [0.0, -3.0, -3.0, -1.0, -1.0, -1.0, -1.0]);
}

#[test]
fn a_tunable_parameter_follows_its_window() {
    let script = Script::new(vec![unit(1, 0, |step| step.p)]).in_ticks(&[1, 2], set(0, P, 9.0));
    assert_eq!(column(script.record(&[(0, P)])), [7.0, 9.0, 9.0, 7.0, 7.0, 7.0, 7.0]);
}

#[test]
fn two_open_windows_over_one_port_break_the_run_and_are_named() {
    let table = [
        (connected().in_ticks(&[2, 3], set(1, U, 1.0)).in_ticks(&[3], set(1, U, 2.0)), 3.0),
        (connected().at(1, Some(4), port(1, U), number(1.0)).when(&[2], 0, Some(1), set(1, U, 2.0)), 2.0),
        (connected().in_ticks(&[2, 3], set(1, U, 1.0)).when(&[3], 0, None, set(1, U, 2.0)), 3.0),
    ];
    for (mut script, at_s) in table {
        script.scenario.events[0].statement = "a.scn:4".to_owned();
        let ran = script.run();
        let failure = ran.result.unwrap_err();
        let expected = format!("the run: the windows of a.scn:4 and a.scn:5 act on `b.u` at one time, at {at_s} s");
        assert_eq!(failure.to_string(), expected);
        assert_eq!(ran.rows.len() as f64, at_s);
    }
    let one_after_another = connected().in_ticks(&[2], set(1, U, -1.0)).in_ticks(&[3], set(1, U, -2.0));
    assert_eq!(column(one_after_another), [0.0, 1.0, -1.0, -2.0, 4.0, 5.0, 5.0], "one closes before the other opens");
}

#[test]
fn every_change_of_a_window_is_reported_in_order() {
    let script = connected().in_ticks(&[2, 4], set(1, U, 1.0)).when(&[0, 2], 0, None, set(0, P, 1.0));
    let ran = script.at(2, Some(4), port(1, P), number(1.0)).run();
    let change = |(tick, event, opened)| Change { tick, event, opened };
    let expected = [
        (0, 1, true),
        (2, 0, true),
        (2, 1, true),
        (2, 2, true),
        (3, 0, false),
        (4, 2, false),
        (4, 0, true),
        (5, 0, false),
    ];
    assert_eq!(ran.changes, expected.map(change));
}

#[test]
fn stop_when_ends_the_run_with_the_row_at_which_its_condition_holds() {
    for (ticks, held, rows) in [(&[3, 4][..], 0, 4), (&[0], 0, 1), (&[1, 2, 3], 2, 4), (&[1, 3], 1, 7)] {
        let mut script = connected();
        let condition = script.condition(at_ticks(ticks), held);
        script.scenario.stop_when = Some(StopWhen { condition, text: String::new() });
        let ran = script.run();
        assert_eq!(ran.rows.len(), rows, "{ticks:?}");
        let reason = if rows == 7 { Reason::StopTime } else { Reason::StopWhen };
        assert_eq!(ran.result, Ok(Finish { last_tick: rows as u64 - 1, reason }));
    }
    let mut script = connected().record(&[(0, Y)]);
    let condition = script.condition(at_ticks(&[2]), 0);
    script.scenario.stop_when = Some(StopWhen { condition, text: String::new() });
    let ran = script.run();
    assert_eq!(ran.rows, [[0.0, 0.0], [1.0, 1.0], [1.0, 2.0]], "the last row has the inputs as they last acted");
}
