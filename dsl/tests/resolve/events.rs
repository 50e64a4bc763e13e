//! `when`, `while`, `stop when` and faults: what they mean, and every error about them.

use super::fixtures::{flight, headings, scenario, scenario_with, shown, shown_with};
use dsl::scenario::{Action, Event, FaultKind, RealExpression, Stage, StopWhen, Trigger};

fn number(value: f64) -> RealExpression {
    RealExpression::Constant(value)
}

/// The faults of the first event of a script in which all inputs of `ctrl` that matter are driven.
fn faults(kinds: &str) -> Vec<FaultKind> {
    let event = &scenario(&wired(&format!("at 1 s {{ fault {kinds} }}"))).events[0];
    let kind = |action: &Action| match action {
        Action::Fault(fault) => fault.kind.clone(),
        Action::Set(_) => panic!("no fault"),
    };
    event.actions.iter().map(kind).collect()
}

fn wired(lines: &str) -> String {
    let wires = "quad.state -> ctrl.state\nctrl.rotor_speed -> quad.rotor_speed\nquad.landed -> ctrl.armed\n\
        fmu heat = \"heater\"\nheat.temp -> heat.tempC\nctrl.now -> ctrl.mode\n";
    flight(&format!("{wires}{lines}"))
}

#[test]
fn windows_follow_conditions_and_name_their_statements() {
    let lines = "when quad.landed held 500 ms lasting 2 s { set quad.drag = 0.2 }
while quad.roll > 3 deg { set quad.trim = 0.1 rad }
when quad.landed { set quad.wind.x = 1 m/s }
stop when quad.landed held 500 ms
at 2 s lasting 1 s { set quad.wind.y = 1 m/s }";
    let scenario = scenario(&flight(lines));
    let shown_parts: Vec<_> = scenario
        .events
        .iter()
        .map(|Event { trigger, lasting, statement, condition, .. }| {
            (*trigger, *lasting, statement.as_str(), condition.as_str())
        })
        .collect();
    assert_eq!(
        shown_parts,
        [
            (Trigger::When(0), Some(200), "test.scn:7", "quad.landed held 500 ms"),
            (Trigger::While(1), None, "test.scn:8", "quad.roll > 3 deg"),
            (Trigger::When(2), None, "test.scn:9", "quad.landed"),
            (Trigger::At(200), Some(100), "test.scn:11", "2 s"),
        ]
    );
    assert_eq!(scenario.stop_when, Some(StopWhen { condition: 0, text: "quad.landed held 500 ms".to_owned() }));
    let held: Vec<_> = scenario.conditions.iter().map(|condition| condition.held_ticks).collect();
    assert_eq!(held, [50, 0, 0]);
}

#[test]
fn what_is_wrong_with_a_condition_is_said() {
    let lines = "when quad.roll { set quad.drag = 0.2 }
while always quad.landed { set quad.drag = 0.2 }
when quad.landed held 3 ms { set quad.drag = 0.2 }
when quad.landed lasting 0 s { set quad.drag = 0.2 }
stop when quad.roll";
    insta::assert_snapshot!(headings(&flight(lines)), @r#"
    error[E21]: expected a condition, `quad.roll` is a number
    = help: a condition compares, for example `x > 3 m`
    error[E30]: `always` looks ahead in time, which only claims do
    = help: write it in an `assert`, or in a `let` that only asserts use
    error[E08]: 3 ms does not fall on the 10 ms grid
    = help: 10 ms, or `step 1 ms`
    error[E38]: `0 s` is no time at all
    = help: this time has to be longer than zero
    error[E21]: expected a condition, `quad.roll` is a number
    = help: a condition compares, for example `x > 3 m`
    "#);
}

#[test]
fn stop_when_needs_a_latest_time_and_stands_once() {
    let script = "scenario \"Test\"\nstep 10 ms\nfmu quad = \"quadcopter\"\nstop when quad.landed\n";
    insta::assert_snapshot!(headings(script), @r#"
    error[E25]: this script does not say when to stop
    = help: `stop when` alone may never end the run: write the latest time too, for example `stop 60 s`
    "#);
    insta::assert_snapshot!(headings(&flight("stop when quad.landed\nstop when quad.roll > 1 deg")), @r#"
    error[E25]: `stop when` stands twice
    = help: a script has one of it
    "#);
}

#[test]
fn faults_take_values_in_the_units_of_their_targets() {
    assert_eq!(faults("ctrl.state.position.x: bias 10 cm"), [FaultKind::Bias(vec![number(0.1)])]);
    assert_eq!(faults("ctrl.state.position: noise 2 m"), [FaultKind::Noise(vec![number(2.0); 3])]);
    let each = FaultKind::Bias(vec![number(1.0), number(2.0), number(3.0)]);
    assert_eq!(faults("ctrl.state.position: bias [1, 2, 3] m"), [each]);
    assert_eq!(faults("heat.tempC: bias 2 K"), [FaultKind::Bias(vec![number(2.0)])]);
    assert_eq!(
        faults("ctrl.state: loss 20 %, delay 240 ms, noise 1 m"),
        [FaultKind::Loss(number(0.2)), FaultKind::Delay(24), FaultKind::Noise(vec![number(1.0); 3])]
    );
    assert_eq!(faults("ctrl.armed: freeze"), [FaultKind::Freeze]);
    assert_eq!(faults("ctrl.mode: loss 1"), [FaultKind::Loss(number(1.0))]);
}

#[test]
fn a_fault_covers_the_driven_part_of_its_path() {
    let lines = wired("at 1 s { fault quad.rotor_speed[2]: freeze }\nat 2 s lasting 1 s { fault ctrl.state: freeze }");
    let events = scenario(&lines).events;
    let targets = |event: &Event| event.actions[0].targets().iter().map(|port| port.variable).collect::<Vec<_>>();
    assert_eq!((targets(&events[0]), targets(&events[1])), (vec![4], vec![0, 1, 2]));
    assert_eq!(events[0].actions[0].stage(), Stage::Hold);
}

#[test]
fn the_seed_of_faults_is_that_of_the_script() {
    let noisy = wired("at 1 s { fault ctrl.state: noise 1 m }");
    assert_eq!(scenario(&noisy).seed, 1);
    assert_eq!(scenario_with(&noisy, &["seed = 7"]).seed, 7);
    assert_eq!(scenario(&wired("param seed = 3\nat 1 s { fault ctrl.state: loss 5 % }")).seed, 3);
    assert_eq!(scenario(&wired("param seed = 3\nat 1 s { fault ctrl.state: freeze }")).seed, 0);
    insta::assert_snapshot!(headings(&wired("param seed = 0.5\nat 1 s { fault ctrl.state: noise 1 m }")), @r#"
    error[E38]: the seed of `noise` and `loss` is a whole number
    = help: write for example `seed = 1`
    "#);
    let set = shown_with(&noisy, &["seed = 2.5"]);
    assert!(set.starts_with("error[E38]: the seed of `noise` and `loss` is a whole number\n --> --set:1:8"), "{set}");
}

#[test]
fn what_is_wrong_with_a_fault_is_said() {
    let lines = "at 1 s lasting 1 s { fault ctrl.state: nosie 1 m }
at 3 s lasting 1 s { fault ctrl.state: noise }
at 5 s lasting 1 s { fault ctrl.state: freeze 3 s }
at 7 s lasting 1 s { fault ctrl.armed: bias 1 }
at 9 s lasting 1 s { fault heat.tempC: bias 2 degC }
at 11 s lasting 1 s { fault ctrl.state: bias 2 s }
at 13 s lasting 1 s { fault ctrl.state: noise -1 m }
at 15 s lasting 1 s { fault ctrl.state: loss 120 % }
at 17 s lasting 1 s { fault ctrl.state: loss 1 m }
at 19 s lasting 1 s { fault ctrl.state: delay 5 ms }
at 21 s lasting 1 s { fault ctrl.state: bias [1, 2] m }
at 23 s lasting 1 s { fault quad.state: freeze }
at 25 s lasting 1 s { fault quad.drag: freeze }
at 27 s lasting 1 s { fault quad.moment: freeze }
at 29 s lasting 1 s { fault ctrl.state: jitter }
at 31 s lasting 1 s { fault ctrl.state: delay 50000 s }
at 33 s lasting 1 s { fault ctrl.state: bias 2 }";
    insta::assert_snapshot!(headings(&wired(lines)), @r#"
    error[E45]: there is no fault `nosie`
    = help: did you mean `noise`?
    error[E45]: `noise` needs a value
    = help: write for example `noise 10 cm`
    error[E45]: `freeze` takes no value: it holds the last one
    = help: write `freeze`, or `loss 5 %` to hold it at times
    error[E21]: `bias` adds to a Real, and `ctrl.armed` is none
    = help: `loss`, `freeze` and `delay` act on values of any type
    error[E32]: `bias` is a difference, and `2 degC` is a point on a scale
    = help: write the difference in K, for example `2 K`
    error[E02]: `bias` of `ctrl.state.position.x` is a length, found s
    = help: it takes a value such as `1 m`
    error[E38]: `noise` is a standard deviation, and `-1 m` is below zero
    = help: write a value of zero or more
    error[E38]: `120 %` is not a probability
    = help: a probability is from 0 to 1, which is 100 %
    error[E02]: expected a probability, found m
    = help: write for example `loss 5 %`
    error[E08]: 5 ms does not fall on the 10 ms grid
    = help: 10 ms, or `step 5 ms`
    error[E22]: 2 values meet 3 driven inputs
    = help: write one value for each, or one for all of them
    error[E04]: `quad.state` is an output and cannot be a target
    = help: a fault acts on a connection: name the input that the connection drives
    error[E04]: `quad.drag` is a parameter, and a fault acts on a connection
    = help: name the input of the connection; `set` changes tunable parameters
    error[E45]: a fault acts on a connection, and none drives `quad.moment`
    = help: connect it, or change its value by `set`
    error[E45]: there is no fault `jitter`
    = help: the faults are `bias`, `noise`, `loss`, `freeze` and `delay`
    error[E39]: this delay keeps 5000000 steps of 3 values, and at most 10000000 are kept
    = help: shorten the delay, or write a longer `step`
    error[E02]: `bias` of `ctrl.state.position.x` is a length, found a plain number
    = help: write the unit: `2 m`
    "#);
}

#[test]
fn a_point_on_a_scale_is_no_noise() {
    insta::assert_snapshot!(shown(&wired("at 1 s { fault heat.tempC: noise 2 degC }")), @r#"
    error[E32]: `noise` is a difference, and `2 degC` is a point on a scale
      --> test.scn:13:34
       |
    13 | at 1 s { fault heat.tempC: noise 2 degC }
       |                                  ^^^^^^
       |
       = help: write the difference in K, for example `2 K`
    "#);
}

#[test]
fn windows_of_sets_and_faults_may_not_touch_one_port_at_one_time() {
    let lines = "at 1 s lasting 2 s { fault ctrl.state: noise 1 m, loss 5 % }
at 2 s lasting 2 s { set ctrl.state.position.y = 1 m }
at 5 s lasting 1 s { fault ctrl.state.position.x: loss 5 %, freeze }
while quad.landed { set quad.drag = 0.1, set quad.drag = 0.2 }
while quad.landed { set quad.wind.x = 1 m/s }
when quad.landed lasting 1 s { set quad.wind.x = 2 m/s }";
    insta::assert_snapshot!(shown(&wired(lines)), @r#"
    error[E35]: two windows act on `ctrl.state.position.y` at one time
      --> test.scn:14:26
       |
    13 | at 1 s lasting 2 s { fault ctrl.state: noise 1 m, loss 5 % }
       |                                        ----- here too
    14 | at 2 s lasting 2 s { set ctrl.state.position.y = 1 m }
       |                          ^^^^^^^^^^^^^^^^^^^^^
       |
       = help: let one end before the other begins, or write both into one window

    error[E35]: one window has two faults of `ctrl.state.position.x` that exclude each other
      --> test.scn:15:61
       |
    15 | at 5 s lasting 1 s { fault ctrl.state.position.x: loss 5 %, freeze }
       |                                                   ----      ^^^^^^
       |                                                   |
       |                                                   the other one
       |
       = help: leave one of them: each window has one `bias`, one `noise`, one `loss` or `freeze`, one `delay`

    error[E35]: one window sets `quad.drag` twice
      --> test.scn:16:46
       |
    16 | while quad.landed { set quad.drag = 0.1, set quad.drag = 0.2 }
       |                         ---------            ^^^^^^^^^
       |                         |
       |                         set here too
       |
       = help: leave one of them
    "#);
}
