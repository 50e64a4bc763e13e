//! Errors about units of measure.

use super::fixtures::{flight, shown};

#[test]
fn a_force_is_no_torque() {
    insta::assert_snapshot!(shown(&flight("ctrl.thrust => quad.moment")), @r#"
    error[E02]: cannot connect a force to a torque
     --> test.scn:7:1
      |
    7 | ctrl.thrust => quad.moment
      | ^^^^^^^^^^^    ----------- takes N*m  (kg m^2/s^2, quadcopter)
      | |
      | gives N  (kg m/s^2, quadcopter_controller)
      |
      = help: compute it on the left, for example `ctrl.thrust * 0.2 m => quad.moment`
    "#);
}

#[test]
fn a_plain_number_is_no_mass() {
    insta::assert_snapshot!(shown(&flight("fmu two = \"quadcopter\" { mass = 1.6 }")), @r#"
    error[E02]: cannot set a mass to a plain number
     --> test.scn:7:33
      |
    7 | fmu two = "quadcopter" { mass = 1.6 }
      |                          ----   ^^^ gives a plain number
      |                          |
      |                          takes kg  (quadcopter)
      |
      = help: write the unit: `1.6 kg`
    "#);
}

#[test]
fn an_angle_connects_to_no_plain_number_but_computes_as_one() {
    insta::assert_snapshot!(shown(&flight("at 1 s { set quad.drag = 3 deg }\nat 2 s { set quad.drag = 3 deg * 1 }")), @r#"
    error[E02]: cannot set a plain number to an angle
     --> test.scn:7:26
      |
    7 | at 1 s { set quad.drag = 3 deg }
      |              ---------   ^^^^^ gives deg  (rad)
      |              |
      |              takes 1  (quadcopter)
      |
      = help: take the number out: `3 deg in deg`
    "#);
}

#[test]
fn a_sum_of_a_length_and_a_time_is_refused() {
    insta::assert_snapshot!(shown(&flight("let a = quad.height + 3 s")), @r#"
    error[E02]: cannot add a length and a time
     --> test.scn:7:9
      |
    7 | let a = quad.height + 3 s
      |         ^^^^^^^^^^^   --- s
      |         |
      |         ft  (m, quadcopter)
      |
      = help: both sides need the same dimension; units of it are converted
    "#);
}

#[test]
fn a_limit_without_unit_gets_the_unit_to_write_as_help() {
    insta::assert_snapshot!(shown(&flight("assert a: always 0 < quad.height < 5 m")), @r#"
    error[E02]: cannot compare a plain number with a length
     --> test.scn:7:18
      |
    7 | assert a: always 0 < quad.height < 5 m
      |                  ^   ----------- ft  (m, quadcopter)
      |                  |
      |                  a plain number
      |
      = help: write the unit: `0 ft`
    "#);
}

#[test]
fn a_degree_celsius_is_refused_in_sums_and_tolerances() {
    let lines = "let a = ctrl.temperature + 5 degC\nassert b: always ctrl.temperature == 20 degC ± 1 degC";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E32]: `5 degC` is a point on a scale, which a sum cannot take
     --> test.scn:7:28
      |
    7 | let a = ctrl.temperature + 5 degC
      |                            ^^^^^^
      |
      = help: write it in K: a difference of 1 degC is 1 K

    error[E32]: `1 degC` is a point on a scale, which a tolerance cannot take
     --> test.scn:8:48
      |
    8 | assert b: always ctrl.temperature == 20 degC ± 1 degC
      |                                                ^^^^^^
      |
      = help: write it in K: a difference of 1 degC is 1 K
    "#);
}

#[test]
fn a_quantity_for_a_variable_without_unit_is_a_warning() {
    insta::assert_snapshot!(shown(&flight("fmu two = \"quadcopter_controller\" { heading0 = -45 deg, unset = 0 m, stream = 1 }")), @r#"
    warning[W01]: `two.heading0` declares no unit; -45 deg is passed as -0.785398 (rad)
     --> test.scn:7:48
      |
    7 | fmu two = "quadcopter_controller" { heading0 = -45 deg, unset = 0 m, stream = 1 }
      |                                                ^^^^^^^
      |
      = help: to pass -45 write `-45 deg in deg`; to accept it write `-45 deg in rad`
    "#);
}

#[test]
fn an_unknown_unit_names_the_nearest() {
    insta::assert_snapshot!(shown(&flight("let a = 3 kgg\nlet b = 4 slgu")), @r#"
    error[E11]: `kgg` is not a unit
     --> test.scn:7:11
      |
    7 | let a = 3 kgg
      |           ^^^
      |
      = help: did you mean `kg*g`?

    error[E11]: `slgu` is not a unit
     --> test.scn:8:11
      |
    8 | let b = 4 slgu
      |           ^^^^
      |
      = help: did you mean `slug`?
    "#);
}

#[test]
fn a_script_name_inside_a_unit_needs_spaces() {
    insta::assert_snapshot!(shown(&flight("let g = 9.81 m/s^2\nlet w = 0.5 kg*g")), @r"
    error[E11]: `g` is a unit of measure too, so that `0.5 kg*g` (line 8) cannot be read
     --> test.scn:7:5
      |
    7 | let g = 9.81 m/s^2
      |     ^
      |
      = help: rename it
    ");
}

#[test]
fn a_unit_name_with_two_meanings_is_refused() {
    insta::assert_snapshot!(shown(&flight("let a = 3 lm")), @r#"
    error[E33]: `lm` has two meanings here
     --> test.scn:7:11
      |
    7 | let a = 3 lm
      |           ^^ 1 cd rad^2 in the built-in table, 9461000000000000 m in wind
      |
      = help: write the quantity in another unit
    "#);
}

#[test]
fn in_and_as_need_the_right_units() {
    let lines = "let a = quad.roll in m\nlet b = ctrl.bare in m\nlet c = quad.roll as deg";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E02]: `quad.roll` is not measured in m
     --> test.scn:7:22
      |
    7 | let a = quad.roll in m
      |         ---------    ^ m
      |         |
      |         deg  (rad, quadcopter)
      |
      = help: `in` needs a unit of the same dimension

    error[E33]: `ctrl.bare` declares no unit that could be taken out
     --> test.scn:8:9
      |
    8 | let b = ctrl.bare in m
      |         ^^^^^^^^^
      |
      = help: it is a number already; its unit is given by `as m`

    error[E33]: `quad.roll` has a unit already
     --> test.scn:9:9
      |
    9 | let c = quad.roll as deg
      |         ^^^^^^^^^ deg  (rad, quadcopter)
      |
      = help: units are converted by themselves; the number is `… in deg`
    "#);
}

#[test]
fn only_a_limit_above_zero_is_advised_as_a_divisor() {
    for limit in ["0 m", "-1 m"] {
        let message = shown(&flight(&format!("assert a: always (quad.height > {limit} and quad.roll < 35 deg)")));
        assert!(message.contains("make two asserts") && !message.contains(&format!("/ {limit}")), "{message}");
    }
}

#[test]
fn margins_of_two_dimensions_do_not_mix() {
    let lines = "assert a: always (quad.height > 1 m and quad.roll < 35 deg)\nassert b: always max(quad.height, quad.roll) < 1 m";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E10]: this claim would mix a margin in m with a margin in deg
     --> test.scn:7:19
      |
    7 | assert a: always (quad.height > 1 m and quad.roll < 35 deg)
      |                   ^^^^^^^^^^^^^^^^^     ------------------ margin in deg
      |                   |
      |                   margin in m
      |
      = help: make two asserts, or compare plain numbers: `quad.height / 1 m > 1` and `quad.roll / 35 deg < 1`

    error[E10]: `max` would mix a length with an angle
     --> test.scn:8:22
      |
    8 | assert b: always max(quad.height, quad.roll) < 1 m
      |                      ^^^^^^^^^^^  --------- deg  (rad, quadcopter)
      |                      |
      |                      ft  (m, quadcopter)
      |
      = help: both sides need the same dimension; units of it are converted
    "#);
}
