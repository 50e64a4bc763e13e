//! The order of one step, seen through fake units.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod checkpoint_files;
mod checkpoints;
mod endings;
mod events;
mod fake;
mod faults;

use dsl::scenario::{BooleanExpression, Drive, InitialStep, Margin, RealExpression};
use fake::{P, Script, U, V, Y, counter, port, repeater, signal, unit};

const TIME: RealExpression = RealExpression::Time;

fn number(value: f64) -> RealExpression {
    RealExpression::Constant(value)
}

#[test]
fn an_arrow_passes_the_value_of_the_source_when_the_step_began() {
    let script = Script::new(vec![counter(1, 0), repeater(1, 0)]).connect(0, 1, false);
    let ran = script.record(&[(0, Y), (1, U), (1, Y)]).run();
    assert_eq!(ran.column(0), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(ran.column(1), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0]);
    assert_eq!(ran.column(2), [0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
}

#[test]
fn a_double_arrow_passes_the_value_of_the_source_when_the_step_ends() {
    let script = Script::new(vec![counter(1, 0), repeater(1, 1), repeater(1, 2)]);
    let ran = script.connect(0, 1, true).connect(1, 2, true).record(&[(0, Y), (1, U), (2, U), (2, Y)]).run();
    assert_eq!(ran.column(0), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(ran.column(1), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 6.0]);
    assert_eq!(ran.column(2), ran.column(1));
    assert_eq!(ran.column(3), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn a_slow_unit_shows_its_result_when_its_period_ends() {
    let ran = Script::new(vec![counter(3, 0), repeater(1, 0)]).connect(0, 1, false).record(&[(0, Y), (1, U)]).run();
    assert_eq!(ran.column(0), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
    assert_eq!(ran.column(1), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
}

#[test]
fn a_slow_source_fills_its_period_with_its_value_at_the_periods_end() {
    let ran = Script::new(vec![counter(3, 0), repeater(1, 1)]).connect(0, 1, true).record(&[(0, Y), (1, U)]).run();
    assert_eq!(ran.column(0), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
    assert_eq!(ran.column(1), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
}

#[test]
fn a_slow_target_holds_what_it_got_when_its_step_began() {
    let script = Script::new(vec![counter(1, 0), repeater(3, 1), repeater(3, 0)]);
    let ran = script.connect(0, 1, true).connect(0, 2, false).record(&[(1, U), (2, U), (0, Y)]).run();
    assert_eq!(ran.column(0), [1.0, 1.0, 1.0, 4.0, 4.0, 4.0, 4.0]);
    assert_eq!(ran.column(1), [0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 3.0]);
    assert_eq!(ran.column(2), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn a_computed_connection_may_read_several_sources_and_time() {
    let sum = || RealExpression::Add(Box::new(signal(0)), Box::new(TIME));
    let script = Script::new(vec![counter(1, 0), repeater(1, 1)]);
    let script = script.compute(sum(), port(1, U), true).compute(sum(), port(1, V), false);
    let ran = script.record(&[(1, U), (1, V)]).run();
    assert_eq!(ran.column(0), [1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 11.0]);
    assert_eq!(ran.column(1), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 10.0]);
}

/// Three claims, both kinds of connections, their initial values and a `set` that use a value.
fn uses(value: &RealExpression, shared: Vec<RealExpression>) -> fake::Ran {
    let below = |limit| {
        let value = RealExpression::Subtract(Box::new(number(limit)), Box::new(value.clone()));
        dsl::scenario::Formula::Margin(Margin { value, strict: true })
    };
    let mut script = Script::new(vec![counter(1, 0), repeater(1, 1)]);
    script.scenario.shared = shared;
    let script = script.compute(value.clone(), port(1, U), true).compute(value.clone(), port(1, V), false);
    let script = script.initially(InitialStep::Get { instance: 0, variables: vec![Y] });
    let script = script.initially(InitialStep::Set { instance: 1, connections: vec![0, 1] });
    let script = script.at(2, Some(4), port(1, P), value.clone());
    script.always(below(5.0)).always(below(30.0)).always(below(100.0)).record(&[(1, U), (1, V), (1, P), (1, Y)]).run()
}

#[test]
fn a_shared_value_is_the_same_as_one_written_out() {
    let sum = || RealExpression::Add(Box::new(signal(0)), Box::new(TIME));
    let twice = |of| RealExpression::Multiply(Box::new(of), Box::new(number(2.0)));
    let written = uses(&twice(sum()), Vec::new());
    let shared = uses(&RealExpression::Shared(1), vec![sum(), twice(RealExpression::Shared(0))]);
    assert_eq!(shared.column(0), [2.0, 6.0, 10.0, 14.0, 18.0, 22.0, 22.0]);
    assert_eq!(shared.column(1), [0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 20.0]);
    assert_eq!((shared.rows, shared.standings), (written.rows, written.standings));
}

#[test]
fn a_window_overrides_the_connection_and_undoes_itself() {
    for direct in [false, true] {
        let script = Script::new(vec![counter(1, 0), repeater(1, usize::from(direct))]).connect(0, 1, direct);
        let ran = script.at(2, Some(4), port(1, U), number(-1.0)).record(&[(1, U)]).run();
        let first = if direct { 1.0 } else { 0.0 };
        assert_eq!(ran.column(0), [first, first + 1.0, -1.0, -1.0, first + 4.0, first + 5.0, first + 5.0]);
    }
}

#[test]
fn the_value_of_a_set_is_tracked_while_it_is_open() {
    let script = Script::new(vec![counter(1, 0), repeater(1, 0)]);
    let ran = script.at(1, Some(3), port(1, U), signal(0)).at(4, None, port(1, U), TIME).record(&[(1, U)]).run();
    assert_eq!(ran.column(0), [0.5, 1.0, 2.0, 0.5, 4.0, 5.0, 5.0]);
}

#[test]
fn a_tunable_parameter_is_set_and_returns_to_its_value() {
    let script = Script::new(vec![unit(1, 0, |step| step.p)]).at(1, Some(3), port(0, P), number(9.0));
    let ran = script.record(&[(0, P), (0, Y)]).run();
    assert_eq!(ran.column(0), [7.0, 9.0, 9.0, 7.0, 7.0, 7.0, 7.0]);
    assert_eq!(ran.column(1), [0.0, 7.0, 9.0, 9.0, 7.0, 7.0, 7.0]);
}

#[test]
fn a_later_set_without_end_replaces_the_one_before_and_a_window_returns_to_it() {
    let script = Script::new(vec![repeater(1, 0)]).at(1, None, port(0, U), number(1.0));
    let script = script.at(2, None, port(0, U), number(2.0)).at(3, Some(4), port(0, U), number(3.0));
    let ran = script.at(4, Some(5), port(0, U), number(4.0)).record(&[(0, U)]).run();
    assert_eq!(ran.column(0), [0.5, 1.0, 2.0, 3.0, 4.0, 2.0, 2.0]);
}

#[test]
fn an_undriven_input_keeps_its_start_value() {
    let ran = Script::new(vec![repeater(1, 0)]).record(&[(0, U), (0, V)]).run();
    assert_eq!(ran.rows, vec![vec![0.5, 0.25]; 7]);
}

#[test]
fn rises_holds_at_the_sample_at_which_its_condition_begins_to_hold() {
    let above = |limit: f64| {
        let value = RealExpression::Subtract(Box::new(TIME), Box::new(number(limit)));
        let is = BooleanExpression::Margin(Margin { value, strict: false });
        dsl::scenario::Condition { is, held_ticks: 0 }
    };
    let mut script = Script::new(vec![repeater(1, 0)]);
    script.scenario.conditions = vec![above(0.0), above(3.0)];
    let either = BooleanExpression::Or(vec![BooleanExpression::Rises(0), BooleanExpression::Rises(1)]);
    let shown = dsl::scenario::Formula::Condition(BooleanExpression::Not(Box::new(either)));
    script.fail_fast = true;
    script.scenario.stop_tick = 9;
    let ran = script.always(shown.clone()).record(&[(0, U)]).run();
    assert_eq!(ran.rows.len(), 1, "the first sample counts as a rise");
    let mut script = Script::new(vec![repeater(1, 0)]);
    script.scenario.conditions = vec![above(10.0), above(3.0)];
    script.fail_fast = true;
    assert_eq!(script.always(shown).record(&[(0, U)]).run().rows.len(), 4);
}

#[test]
fn initialization_carries_values_in_its_order() {
    let script = Script::new(vec![counter(1, 0), repeater(1, 0)]);
    let mut script = script.compute(number(5.0), port(0, U), false).connect(0, 1, false);
    let set = |instance, connection| InitialStep::Set { instance, connections: vec![connection] };
    script = script.initially(set(0, 0)).initially(InitialStep::Get { instance: 0, variables: vec![Y] });
    let ran = script.initially(set(1, 1)).record(&[(0, Y), (1, Y)]).run();
    assert_eq!(ran.rows[0], [5.0, 6.0]);
}

#[test]
fn all_orders_of_a_wave_go_out_before_the_first_reply_is_awaited() {
    let script = Script::new(vec![counter(1, 0), counter(1, 0), repeater(1, 1)]).on_workers(&[0, 1, 0]);
    let mut script = script.compute(RealExpression::Add(Box::new(signal(0)), Box::new(signal(1))), port(2, U), true);
    script.scenario.stop_tick = 1;
    let asked = script.run().asked;
    assert_eq!(asked, ["0 order 0", "0 order 1", "1 reply 0", "1 reply 1", "0 order 0", "1 reply 0"]);
}

#[test]
fn a_slow_reply_is_awaited_when_it_is_due() {
    let script = Script::new(vec![counter(3, 0), counter(1, 0)]).connect(0, 1, false).on_workers(&[0, 1]);
    let mut script = script.record(&[(1, Y)]);
    script.scenario.stop_tick = 3;
    let asked = script.run().asked;
    let order_of = |what: &str| asked.iter().position(|asked| asked == what).unwrap();
    assert!(order_of("2 reply 1") < order_of("3 reply 0"));
}

#[test]
fn the_number_of_workers_changes_no_row() {
    let script = || {
        let sum = RealExpression::Add(Box::new(signal(0)), Box::new(signal(2)));
        let script = Script::new(vec![counter(1, 0), repeater(2, 1), counter(3, 0), repeater(1, 2)]);
        let script = script.connect(0, 1, true).compute(sum, port(3, U), false).compute(signal(1), port(3, V), true);
        script.record(&[(0, Y), (1, U), (1, Y), (2, Y), (3, U), (3, V), (3, Y)])
    };
    let alone = script().run();
    for workers in [[0, 1, 2, 3], [1, 0, 1, 0]] {
        assert_eq!(script().on_workers(&workers).run().rows, alone.rows);
    }
    assert_eq!(alone.rows.len(), 7);
}

#[test]
fn a_set_takes_the_value_of_another_port_of_its_type() {
    let mut script = Script::new(vec![counter(1, 0), repeater(1, 0)]).record(&[(1, U)]);
    let set = dsl::scenario::Set { target: port(1, U), value: Drive::Copy(port(0, Y)) };
    script.scenario.events.push(dsl::scenario::Event::at(2, None, vec![set]));
    assert_eq!(script.run().column(0), [0.5, 0.5, 2.0, 3.0, 4.0, 5.0, 5.0]);
}
