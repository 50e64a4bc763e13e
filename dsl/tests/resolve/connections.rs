//! Errors about connections, start values and windows.

use super::fixtures::{flight, shown};

#[test]
fn an_input_has_one_driver() {
    insta::assert_snapshot!(shown(&flight("wind.velocity -> quad.wind\n[1, 2, 3] m/s -> quad.wind")), @r#"
    error[E03]: `quad.wind` already gets its value from `wind.velocity` (line 7)
     --> test.scn:8:18
      |
    7 | wind.velocity -> quad.wind
      |                  --------- driven here first
    8 | [1, 2, 3] m/s -> quad.wind
      |                  ^^^^^^^^^
      |
      = help: an input has one driver; to combine two write `wind.velocity + [1, 2, 3] m/s -> quad.wind`
    "#);
}

#[test]
fn one_member_of_a_driven_group_has_a_driver_already() {
    insta::assert_snapshot!(shown(&flight("wind.velocity -> quad.wind\n1 m/s -> quad.wind.y")), @r#"
    error[E03]: `quad.wind.y` already gets its value from `wind.velocity` (line 7)
     --> test.scn:8:10
      |
    7 | wind.velocity -> quad.wind
      |                  --------- driven here first
    8 | 1 m/s -> quad.wind.y
      |          ^^^^^^^^^^^
      |
      = help: an input has one driver; drive the members of a group together or one by one
    "#);
}

#[test]
fn an_arrow_from_an_input_to_an_output_is_refused() {
    insta::assert_snapshot!(shown(&flight("quad.wind -> wind.velocity")), @r#"
    error[E04]: `wind.velocity` is an output and cannot be a target
     --> test.scn:7:14
      |
    7 | quad.wind -> wind.velocity
      | ---------    ^^^^^^^^^^^^^
      | |
      | an input
      |
      = help: turn the arrow: `wind.velocity -> quad.wind`
    "#);
}

#[test]
fn an_input_gives_no_value() {
    insta::assert_snapshot!(shown(&flight("wind.velocity -> quad.wind\nassert a: always quad.wind.x < 3 m/s")), @r#"
    error[E04]: `quad.wind.x` is an input and gives no value
     --> test.scn:8:18
      |
    8 | assert a: always quad.wind.x < 3 m/s
      |                  ^^^^^^^^^^^
      |
      = help: read what drives it: `wind.velocity`
    "#);
}

#[test]
fn a_parameter_is_no_target_of_an_arrow() {
    insta::assert_snapshot!(shown(&flight("3 kg -> quad.mass")), @r#"
    error[E05]: `quad.mass` cannot change during the run: its FMU says variability="fixed"
     --> test.scn:7:9
      |
    7 | 3 kg -> quad.mass
      |         ^^^^^^^^^
      |
      = help: an arrow ends in an input; set it in the fmu line
    "#);
}

#[test]
fn a_fixed_parameter_cannot_be_set_during_the_run() {
    insta::assert_snapshot!(shown(&flight("at 3 s { set quad.mass = 2 kg }")), @r#"
    error[E05]: `quad.mass` cannot change during the run: its FMU says variability="fixed"
     --> test.scn:7:14
      |
    7 | at 3 s { set quad.mass = 2 kg }
      |              ^^^^^^^^^
      |
      = help: set it in the fmu line, or `set` a tunable parameter: drag, trim
    "#);
}

#[test]
fn a_computed_output_takes_no_start_value() {
    insta::assert_snapshot!(shown(&flight("fmu two = \"quadcopter_controller\" { thrust = 3 N, unset = 0 m, stream = 1 }")), @r#"
    error[E05]: `two.thrust` cannot be set: it is computed by the unit
     --> test.scn:7:37
      |
    7 | fmu two = "quadcopter_controller" { thrust = 3 N, unset = 0 m, stream = 1 }
      |                                     ^^^^^^
      |
      = help: before the run parameters, inputs and start values can be set that the unit does not compute
    "#);
}

#[test]
fn a_start_value_is_given_once() {
    insta::assert_snapshot!(shown(&flight("fmu two = \"quadcopter\" { mass = 3 kg, mass = 4 kg }")), @r#"
    error[E03]: `mass` gets two start values
     --> test.scn:7:39
      |
    7 | fmu two = "quadcopter" { mass = 3 kg, mass = 4 kg }
      |                          ----         ^^^^
      |                          |
      |                          the first
      |
      = help: leave one of them
    "#);
}

#[test]
fn a_start_value_is_known_before_the_run() {
    insta::assert_snapshot!(shown(&flight("fmu two = \"quadcopter\" { mass = 3 kg * quad.roll }")), @r#"
    error[E27]: `3 kg * quad.roll` is not known before the run
     --> test.scn:7:33
      |
    7 | fmu two = "quadcopter" { mass = 3 kg * quad.roll }
      |                                 ^^^^^^^^^^^^^^^^
      |
      = help: numbers, parameters and what is computed from them stand here
    "#);
}

#[test]
fn two_units_that_wait_for_each_other_are_named() {
    insta::assert_snapshot!(shown(&flight("quad.state => ctrl.state\nctrl.rotor_speed => quad.rotor_speed")), @r#"
    error[E06]: these connections wait for each other within one step: quad => ctrl => quad
     --> test.scn:7:12
      |
    7 | quad.state => ctrl.state
      |            ^^
    8 | ctrl.rotor_speed => quad.rotor_speed
      |                  --
      |
      = help: make one of them `->`, it then brings where the source stood when the step began; usual choice, the plant's output: `quad.state -> ctrl.state` (line 7)
    "#);
}

#[test]
fn periods_of_which_neither_divides_the_other_are_refused() {
    let lines = "fmu slow = \"wind\" every 70 ms { stream = 1 }\nfmu fast = \"quadcopter\" every 50 ms\nslow.velocity => fast.wind";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E07]: `=>` needs periods of which one divides the other, but `slow` steps every 70 ms and `fast` every 50 ms
     --> test.scn:9:15
      |
    9 | slow.velocity => fast.wind
      |               ^^
      |
      = help: write `slow.velocity -> fast.wind`
    "#);
}

#[test]
fn a_direct_arrow_needs_a_unit_on_its_left() {
    insta::assert_snapshot!(shown(&flight("1 m/s * sin(2 rad/s * time) => quad.wind.x")), @r#"
    error[E07]: `=>` lets a unit step first, and none stands on its left
     --> test.scn:7:29
      |
    7 | 1 m/s * sin(2 rad/s * time) => quad.wind.x
      |                             ^^
      |
      = help: write `1 m/s * sin(2 rad/s * time) -> quad.wind.x`
    "#);
}

#[test]
fn two_open_windows_over_one_port_are_refused() {
    let lines = "at 1 s lasting 5 s { set quad.wind = [1, 2, 3] m/s }\nat 4 s lasting 5 s { set quad.wind.y = 0 m/s }";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E35]: two windows set `quad.wind.y` at one time
     --> test.scn:8:26
      |
    7 | at 1 s lasting 5 s { set quad.wind = [1, 2, 3] m/s }
      |                          --------- set here too
    8 | at 4 s lasting 5 s { set quad.wind.y = 0 m/s }
      |                          ^^^^^^^^^^^
      |
      = help: let one end before the other begins, or set it in one place
    "#);
}

#[test]
fn a_set_that_stays_cannot_begin_inside_a_window() {
    let lines = "at 1 s lasting 5 s { set quad.wind.x = 1 m/s }\nat 4 s { set quad.wind.x = 0 m/s }";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E35]: two windows set `quad.wind.x` at one time
     --> test.scn:8:14
      |
    7 | at 1 s lasting 5 s { set quad.wind.x = 1 m/s }
      |                          ----------- set here too
    8 | at 4 s { set quad.wind.x = 0 m/s }
      |              ^^^^^^^^^^^
      |
      = help: let one end before the other begins, or set it in one place
    "#);
}

#[test]
fn a_window_after_the_end_is_a_warning() {
    insta::assert_snapshot!(shown(&flight("at 90 s { set quad.wind.x = 1 m/s }")), @r#"
    warning[W04]: what happens at 90 s opens after the run has ended
     --> test.scn:7:4
      |
    3 | stop 60 s
      |      ---- the end
    ...
    7 | at 90 s { set quad.wind.x = 1 m/s }
      |    ^^^^
      |
      = help: nothing will come of it: choose an earlier time or a later `stop`
    "#);
}

#[test]
fn two_instances_with_one_seed_and_stream_are_a_warning() {
    insta::assert_snapshot!(shown(&flight("fmu gust = \"wind\"")), @r#"
    warning[W03]: `wind` and `gust` draw the same random numbers
     --> test.scn:7:5
      |
    4 | fmu wind = "wind"
      |     ---- same seed and stream
    ...
    7 | fmu gust = "wind"
      |     ^^^^
      |
      = help: give one of them another `stream`
    "#);
}

#[test]
fn missing_members_of_a_group_are_listed() {
    insta::assert_snapshot!(shown(&flight("wind.velocity -> ctrl.state")), @r#"
    error[E22]: `wind.velocity` has no member `position.x`, `position.y` and `position.z` for `ctrl.state`
     --> test.scn:7:1
      |
    7 | wind.velocity -> ctrl.state
      | ^^^^^^^^^^^^^    ---------- takes 3 members
      | |
      | gives x, y, z
      |
      = help: name the members on both sides, for example `a.{x, y} -> b.{u, v}`
    "#);
}

#[test]
fn a_list_of_the_wrong_length_is_refused() {
    insta::assert_snapshot!(shown(&flight("[1, 2] m/s -> quad.wind")), @r#"
    error[E22]: 2 values meet 3 inputs
     --> test.scn:7:1
      |
    7 | [1, 2] m/s -> quad.wind
      | ^^^^^^^^^^    --------- takes 3
      | |
      | gives 2
      |
      = help: pick the members that belong together, for example `.{x, y}`
    "#);
}

#[test]
fn one_value_does_not_fill_a_group() {
    insta::assert_snapshot!(shown(&flight("1 m/s -> quad.wind")), @r#"
    error[E22]: one value cannot fill `quad.wind`
     --> test.scn:7:1
      |
    7 | 1 m/s -> quad.wind
      | ^^^^^    --------- takes 3
      | |
      | one value
      |
      = help: write a list, for example `[1, 2, 3] m`
    "#);
}

#[test]
fn initial_values_that_wait_for_each_other_are_named() {
    let lines = "ctrl.rotor_speed[1] in rad/s * 1 m -> ctrl.setpoint.x";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E36]: these initial values wait for each other: ctrl.setpoint.x -> ctrl.rotor_speed[1] -> ctrl.setpoint.x
     --> test.scn:7:39
      |
    7 | ctrl.rotor_speed[1] in rad/s * 1 m -> ctrl.setpoint.x
      |                                       ^^^^^^^^^^^^^^^
      |
      = help: give one input of the circle a start value: `fmu ctrl = … { setpoint.x = … }`
    "#);
}

#[test]
fn what_rises_is_no_source_within_a_step() {
    for condition in ["rises(quad.height > 3 m)", "(not rises(quad.height > 3 m)) or quad.landed"] {
        assert!(shown(&flight(&format!("{condition} -> ctrl.armed"))).is_empty(), "{condition}");
        let refused = shown(&flight(&format!("let late = {condition}\nlate => ctrl.armed")));
        assert!(refused.starts_with("error[E07]: `rises` compares two samples"), "{refused}");
    }
    insta::assert_snapshot!(shown(&flight("rises(quad.landed) => ctrl.armed")), @"
    error[E07]: `rises` compares two samples, and `=>` brings what is in no sample yet
     --> test.scn:7:1
      |
    7 | rises(quad.landed) => ctrl.armed
      | ^^^^^^^^^^^^^^^^^^
      |
      = help: write `->`: what rises is seen at the next sample
    ");
}
