//! How runs end, seen through fake units.

use crate::fake::{Answer, Fake, Script, Step, U, Y, answering, counter, port, repeater, signal, unit};
use crate::number;
use dsl::scenario::{Formula, Margin, RealExpression};
use fmi2::calls::Call;
use orchestrator::run::message::{Finish, Reason};
use results::verdict::Verdict;
use unit::failure::{Cause, Doing};

fn below(instance: usize, limit: f64) -> Formula {
    let value = RealExpression::Subtract(Box::new(number(limit)), Box::new(signal(instance)));
    Formula::Margin(Margin { value, strict: true })
}

/// A unit that counts, but answers otherwise when its step begins at a tick.
fn otherwise_at(every: u64, wave: usize, tick: u64, answer: fn(&Step) -> Answer) -> Fake {
    answering(
        every,
        wave,
        move |step| {
            if step.tick == tick { answer(step) } else { Answer::Value(f64::from(step.before + 1)) }
        },
    )
}

#[test]
fn the_run_ends_at_the_stop_time_with_the_inputs_as_they_last_acted() {
    let ran = Script::new(vec![counter(1, 0), repeater(1, 0)]).connect(0, 1, false).record(&[(0, Y), (1, U)]).run();
    assert_eq!(ran.result, Ok(Finish { last_tick: 6, reason: Reason::StopTime }));
    assert_eq!(ran.rows.last().unwrap(), &[6.0, 5.0]);
}

#[test]
fn a_unit_that_ends_where_its_step_ends_leaves_a_last_row() {
    let done = |step: &Step| Answer::Terminated { y: 99.0, last_successful_time_s: step.tick as f64 + 1.0 };
    for (wave, direct) in [(0, false), (1, true)] {
        let script = Script::new(vec![otherwise_at(1, 0, 3, done), repeater(1, wave)]).connect(0, 1, direct);
        let ran = script.always(below(0, 100.0)).record(&[(0, Y), (1, U)]).run();
        assert_eq!(ran.result, Ok(Finish { last_tick: 4, reason: Reason::Terminated(0) }));
        assert_eq!(ran.column(0), [0.0, 1.0, 2.0, 3.0, 99.0]);
        assert_eq!(ran.rows[3][1], ran.rows[4][1]);
        assert_eq!(ran.verdicts, [Verdict::Holds]);
    }
}

#[test]
fn of_units_that_end_at_one_tick_the_first_in_the_script_is_reported() {
    let done = |step: &Step| Answer::Terminated { y: 0.0, last_successful_time_s: step.tick as f64 + 1.0 };
    // The second unit steps first, so it is the first to report its end.
    let script = Script::new(vec![answering(1, 1, done), answering(1, 0, done)]);
    let ran = script.connect(1, 0, false).record(&[(0, Y), (1, Y)]).run();
    assert_eq!(ran.result, Ok(Finish { last_tick: 1, reason: Reason::Terminated(0) }));
}

#[test]
fn a_unit_that_ends_within_its_step_leaves_the_row_before() {
    let done = |step: &Step| Answer::Terminated { y: f64::NAN, last_successful_time_s: step.tick as f64 + 0.5 };
    for (wave, direct) in [(0, false), (1, true)] {
        let script = Script::new(vec![otherwise_at(1, 0, 3, done), repeater(1, wave)]).connect(0, 1, direct);
        let ran = script.always(below(0, 100.0)).record(&[(0, Y)]).run();
        assert_eq!(ran.result, Ok(Finish { last_tick: 3, reason: Reason::Terminated(0) }));
        assert_eq!(ran.column(0), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(ran.verdicts, [Verdict::Holds]);
    }
}

#[test]
fn a_status_counts_when_its_result_is_due() {
    let script = |direct: bool| {
        let units = vec![otherwise_at(3, 0, 3, |_| Answer::Error), repeater(1, usize::from(direct))];
        Script::new(units).connect(0, 1, direct).always(below(0, 100.0)).always(below(0, 0.5)).record(&[(0, Y)]).run()
    };
    let ran = script(false);
    assert_eq!(ran.rows.len(), 6, "until the period that began at 3 ends at 6");
    assert_eq!(ran.result.unwrap_err().time_s, Some(3.0));
    assert_eq!(ran.verdicts, [Verdict::Unjudged, Verdict::Fails]);
    assert_eq!(script(true).rows.len(), 3, "a `=>` reads it in the tick of the order");
}

#[test]
fn a_fast_source_is_awaited_at_once_only_where_a_slow_target_reads_it() {
    let script = |tick| {
        let fails = answering(1, 0, move |step| if step.tick == tick { Answer::Error } else { Answer::Value(0.0) });
        Script::new(vec![fails, repeater(3, 1)]).connect(0, 1, true).record(&[(0, Y)]).run().rows.len()
    };
    assert_eq!([script(3), script(4)], [3, 5]);
}

#[test]
fn of_several_failures_the_first_in_the_script_is_reported() {
    let fails = |every| otherwise_at(every, 0, 0, |_| Answer::Error);
    let ran = Script::new(vec![counter(1, 0), fails(2), fails(2), fails(1)]).on_workers(&[0, 2, 1, 0]).run();
    assert_eq!(ran.result.unwrap_err().instance.as_deref(), Some("3"), "it is due before the others");
    let ran = Script::new(vec![counter(1, 0), fails(2), fails(2)]).on_workers(&[0, 2, 1]).run();
    assert_eq!(ran.result.unwrap_err().instance.as_deref(), Some("1"));
}

#[test]
fn a_connected_value_that_is_no_number_breaks_the_run() {
    let nan = || unit(1, 0, |step| if step.tick == 2 { f64::NAN } else { 0.0 });
    let ran = Script::new(vec![nan(), repeater(1, 0)]).connect(0, 1, false).record(&[(0, Y)]).run();
    let failure = ran.result.unwrap_err();
    assert_eq!(failure.instance.as_deref(), Some("a"));
    assert_eq!((failure.doing, failure.time_s), (Doing::Call(Call::GetReal), Some(3.0)));
    assert_eq!(failure.cause, Cause::NonFinite { variable: "y".into(), value: "NaN".into() });
    assert_eq!(ran.rows.len(), 3);
    let direct = Script::new(vec![nan(), repeater(1, 1)]).connect(0, 1, true).record(&[(0, Y)]).run();
    assert_eq!((direct.result.unwrap_err(), direct.rows.len()), (failure, 2));
}

#[test]
fn a_value_that_is_no_number_is_refused_when_it_is_awaited_also_where_its_reader_is_slower() {
    let script = |tick| {
        let nan = unit(1, 0, move |step| if step.tick == tick { f64::NAN } else { 0.0 });
        let ran = Script::new(vec![nan, repeater(3, 1)]).connect(0, 1, true).record(&[(0, Y)]).run();
        (ran.result.unwrap_err().time_s, ran.rows.len())
    };
    assert_eq!([script(3), script(4)], [(Some(4.0), 3), (Some(5.0), 5)]);
}

#[test]
fn an_asserted_infinity_breaks_the_run_and_a_recorded_one_is_recorded() {
    let infinite = || unit(1, 0, |_| f64::INFINITY);
    let ran = Script::new(vec![infinite()]).always(below(0, 1.0)).record(&[(0, Y)]).run();
    assert!(matches!(ran.result.unwrap_err().cause, Cause::NonFinite { value, .. } if value == "inf"));
    let ran = Script::new(vec![infinite()]).record(&[(0, Y)]).run();
    assert_eq!(ran.result, Ok(Finish { last_tick: 6, reason: Reason::StopTime }));
    assert_eq!(ran.rows[1], [f64::INFINITY]);
}

#[test]
fn a_lost_claim_ends_the_run_only_with_fail_fast() {
    let script = || Script::new(vec![counter(1, 0)]).always(below(0, 100.0)).always(below(0, 2.5)).record(&[(0, Y)]);
    let ran = script().run();
    assert_eq!(ran.result, Ok(Finish { last_tick: 6, reason: Reason::StopTime }));
    assert_eq!(ran.verdicts, [Verdict::Holds, Verdict::Fails]);
    let ran = Script { fail_fast: true, ..script() }.run();
    assert_eq!(ran.result, Ok(Finish { last_tick: 3, reason: Reason::ClaimLost(1) }));
    assert_eq!(ran.column(0), [0.0, 1.0, 2.0, 3.0]);
    assert_eq!(ran.verdicts, [Verdict::Unjudged, Verdict::Fails]);
}

#[test]
fn an_interrupted_run_keeps_its_rows_and_what_was_decided() {
    let mut script = Script::new(vec![counter(1, 0)]).always(below(0, 100.0)).always(below(0, 1.5)).record(&[(0, Y)]);
    script.stop_requested_at = Some(4);
    let ran = script.run();
    assert_eq!(ran.result, Ok(Finish { last_tick: 4, reason: Reason::Interrupted }));
    assert_eq!(ran.column(0), [0.0, 1.0, 2.0, 3.0, 4.0]);
    assert_eq!(ran.verdicts, [Verdict::Unjudged, Verdict::Fails]);
}

#[test]
fn the_result_of_a_step_that_overruns_the_stop_time_is_dropped() {
    let fails = otherwise_at(4, 0, 4, |_| Answer::Error);
    let ran = Script::new(vec![fails]).at(0, None, port(0, U), number(1.0)).record(&[(0, Y)]).run();
    assert_eq!(ran.result, Ok(Finish { last_tick: 6, reason: Reason::StopTime }));
    assert_eq!(ran.column(0), [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
}
