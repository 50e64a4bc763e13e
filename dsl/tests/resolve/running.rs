//! Running values in claims, conditions and `let`s, and `mod`.

use super::fixtures::{flight, headings, scenario};
use dsl::scenario::{Formula, RealExpression, Running, RunningKind};

#[test]
fn a_running_value_is_shared_by_all_that_use_it_and_has_a_unit() {
    let lines =
        "let error = rms(quad.roll, 15 s)\nassert a: finally error < 2 deg\nassert b: always after 20 s error < 3 deg";
    let scenario = scenario(&flight(lines));
    let [RealExpression::Running(running)] = scenario.shared.as_slice() else { panic!("{:?}", scenario.shared) };
    let Running { kind, from_tick, step_s, .. } = running;
    assert_eq!((*kind, *from_tick, *step_s), (RunningKind::Rms, 1500, 0.01));
    let Formula::Finally(_) = scenario.claims[0].formula else { panic!() };
    assert_eq!(scenario.claims[0].unit.as_ref().map(|unit| unit.name.as_str()), Some("deg"));
}

#[test]
fn one_that_is_used_once_has_a_slot_too_and_an_inner_one_comes_first() {
    let scenario = scenario(&flight("assert a: finally highest(average(quad.height)) < 3 m"));
    let kinds = scenario.shared.iter().map(|shared| match shared {
        RealExpression::Running(running) => running.kind,
        _ => panic!("{shared:?}"),
    });
    assert_eq!(kinds.collect::<Vec<_>>(), [RunningKind::Average, RunningKind::Highest]);
}

#[test]
fn units_follow_from_the_kind_and_vectors_give_vectors() {
    let lines = "assert a: finally integral(quad.height) < 3 m*s\nassert b: always slope(quad.height) < 3 m/s\n\
                 assert c: finally count(ctrl.now == \"idle\") <= 3\nassert d: finally duration(quad.landed) < 4 s\n\
                 assert e: finally count(quad.landed) == 2\nassert f: finally norm(average(quad.state.position)) < 3 m\n\
                 assert g: finally lowest(mod(quad.roll, 360 deg)) > 1 deg";
    assert_eq!(headings(&flight(lines)), "");
}

#[test]
fn wrong_running_values_are_errors() {
    let lines = "average(wind.velocity) -> quad.wind\nassert a: always rms(quad.roll, 15 s) < 2 deg\n\
                 assert b: finally count(rises(quad.landed)) < 3\nassert c: finally rms(quad.roll, 1 s, 2 s) < 2 deg\n\
                 assert d: finally rms(quad.roll, 70 s) < 2 deg\nassert e: finally count(quad.roll) < 3\n\
                 assert f: always mod(quad.roll, 3 m) < 2 deg";
    insta::assert_snapshot!(headings(&flight(lines)), @r"
    error[E30]: `average(wind.velocity)` is a running value, which no unit can be given
    = help: put it into a unit; in a script running values stand in claims, conditions and `let`s
    error[E09]: `a` asks from 0 s on for a running value whose samples count from 15 s on
    = help: ask for it at the end, `finally …`, or later: `always after 15 s …`
    error[E31]: a running value takes no `rises`
    = help: `count` counts how often a condition became true: leave `rises` away
    error[E31]: `rms` takes one or two arguments, found 3
    = help: for example `rms(x)`, or `rms(x, 15 s)` with the first time that counts
    error[E09]: `d` asks from 60 s on for a running value whose samples count from 70 s on
    = help: give it an earlier first time, or write `stop 70 s`
    error[E21]: expected a condition, `quad.roll` is a number
    = help: a condition compares, for example `x > 3 m`
    error[E02]: `mod` would mix an angle with a length
    = help: both sides need the same dimension; units of it are converted
    ");
}
