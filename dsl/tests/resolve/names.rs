//! Errors about names, declarations and statements.

use super::fixtures::{flight, headings, shown, shown_with};

#[test]
fn a_misspelt_variable_names_the_nearest_one() {
    insta::assert_snapshot!(shown(&flight("let a = quad.state.positon.x")), @r#"
    error[E01]: `quad.state` has no variable `positon`
     --> test.scn:7:20
      |
    7 | let a = quad.state.positon.x
      |                    ^^^^^^^
      |
      = help: did you mean `position`? All 19: lockstep describe quadcopter
    "#);
}

#[test]
fn a_misspelt_instance_names_the_nearest_one() {
    insta::assert_snapshot!(shown(&flight("wind.velocity -> qaud.wind")), @r#"
    error[E01]: `qaud` is not declared in this script
     --> test.scn:7:18
      |
    7 | wind.velocity -> qaud.wind
      |                  ^^^^
      |
      = help: did you mean `quad`?
    "#);
}

#[test]
fn an_element_past_the_end_of_an_array_names_the_range() {
    insta::assert_snapshot!(shown(&flight("3 rad/s -> quad.rotor_speed[3]")), @r#"
    error[E01]: `quad.rotor_speed` has no element `[3]`
     --> test.scn:7:28
      |
    7 | 3 rad/s -> quad.rotor_speed[3]
      |                            ^^^
      |
      = help: its elements go from `[1]` to `[2]`
    "#);
}

#[test]
fn a_misspelt_function_names_the_nearest_one() {
    insta::assert_snapshot!(shown(&flight("assert a: always nrom(quad.state.position) < 3 m")), @r#"
    error[E01]: there is no function `nrom`
     --> test.scn:7:18
      |
    7 | assert a: always nrom(quad.state.position) < 3 m
      |                  ^^^^
      |
      = help: did you mean `norm`?
    "#);
}

#[test]
fn a_whole_unit_is_no_value() {
    insta::assert_snapshot!(shown(&flight("quad -> ctrl.state")), @r#"
    error[E01]: `quad` is a whole unit, and one of its ports is meant here
     --> test.scn:7:1
      |
    7 | quad -> ctrl.state
      | ^^^^
      |
      = help: for example `quad.wind.x`
    "#);
}

#[test]
fn a_name_is_declared_once() {
    insta::assert_snapshot!(shown(&flight("param quad = 3")), @r#"
    error[E24]: `quad` is declared twice
     --> test.scn:7:7
      |
    5 | fmu quad = "quadcopter"
      |     ---- declared here first
    6 | fmu ctrl = "quadcopter_controller" { unset = 0 m }
    7 | param quad = 3
      |       ^^^^
      |
      = help: rename one of them
    "#);
}

#[test]
fn a_let_may_not_be_called_seed() {
    insta::assert_snapshot!(shown(&flight("let seed = 3")), @r#"
    error[E24]: `seed` has a meaning already
     --> test.scn:7:5
      |
    7 | let seed = 3
      |     ^^^^ the parameter of all random numbers
      |
      = help: write `param seed = …`
    "#);
}

#[test]
fn names_that_define_each_other_are_shown_as_a_circle() {
    insta::assert_snapshot!(shown(&flight("let a = b + 1\nlet b = a + 1\nassert c: always a < 3")), @r#"
    error[E28]: these names define each other: a from b from a
     --> test.scn:7:5
      |
    7 | let a = b + 1
      |     ^
    8 | let b = a + 1
      |     -
      |
      = help: give one of them a value of its own
    "#);
}

#[test]
fn a_unit_that_was_not_found_is_reported_once_without_errors_for_its_ports() {
    insta::assert_snapshot!(shown(&flight("fmu eye = \"eagle\"\neye.x -> quad.wind\nassert a: always eye.x > 3 m")), @r#"
    error[E26]: there is no unit `eagle`
     --> test.scn:7:11
      |
    7 | fmu eye = "eagle"
      |           ^^^^^^^
      |
      = help: units of this workspace: quadcopter, wind
    "#);
}

#[test]
fn a_script_without_its_first_lines_says_which_are_missing_and_a_part_only_that_it_is_one() {
    insta::assert_snapshot!(shown("let a = 3\n"), @r#"
    error[E25]: this file has no `scenario` line
     --> test.scn:1:1
      |
    1 | let a = 3
      | ^^^^^^^^^
      |
      = help: a script begins like `scenario "Quadcopter in wind"`; a file without that line is a part of others
    "#);
    let all = headings("step 10 ms\nlet a = 3\n");
    assert_eq!(all.matches("error[E25]").count(), 2, "{all}");
}

#[test]
fn repeated_statements_and_periods_are_refused() {
    insta::assert_snapshot!(shown(&flight("stop 5 s\nfmu air = \"wind\" every 20 ms every 30 ms { stream = 4 }")), @r#"
    error[E25]: `stop` stands twice
     --> test.scn:7:6
      |
    3 | stop 60 s
      |      ---- the first
    ...
    7 | stop 5 s
      |      ^^^
      |
      = help: a script has one of it

    error[E25]: `air` has two periods
     --> test.scn:8:36
      |
    8 | fmu air = "wind" every 20 ms every 30 ms { stream = 4 }
      |                        -----       ^^^^^
      |                        |
      |                        the first
      |
      = help: write one `every`
    "#);
}

#[test]
fn a_parameter_that_is_set_to_another_kind_is_one_error() {
    let script = flight("param gust = 4 m/s\ngust -> quad.wind.x");
    let found = shown_with(&script, &["gust = 6"]);
    assert_eq!(found.matches("error[").count(), 1, "{found}");
    let help = headings(&flight("param gust = 6\ngust -> quad.wind.x\n7 -> quad.wind.y"));
    assert!(help.contains("write the unit: `gust * 1 m/s`") && help.contains("write the unit: `7 m/s`"), "{help}");
}

#[test]
fn an_unknown_parameter_of_the_command_line_is_shown_in_its_own_text() {
    insta::assert_snapshot!(shown_with(&flight("param gust = 4 m/s"), &["gsut = 3 m/s"]), @r#"
    error[E01]: the script has no parameter `gsut`
     --> --set:1:1
      |
    1 | gsut = 3 m/s
      | ^^^^
      |
      = help: did you mean `gust`?
    "#);
}

#[test]
fn a_setting_of_another_dimension_is_refused() {
    insta::assert_snapshot!(shown_with(&flight("param gust = 4 m/s"), &["gust = 3 m"]), @r#"
    error[E37]: `gust` cannot be set to this: its own value is a speed
     --> --set:1:8
      |
    1 | gust = 3 m
      |        ^^^ a length
      |
      = help: write a value of the same kind, for example `gust = 4 m/s`
    "#);
}

#[test]
fn a_reserved_name_is_one_error_however_often_it_is_used() {
    for (name, lines) in [
        ("pi", "fmu pi = \"quadcopter\"\npi.state -> ctrl.state\nwind.velocity -> pi.wind\nlet a = pi.roll"),
        ("time", "let time = 3 m\nlet a = time + 1 m\nassert b: time > 1 m"),
        ("seed", "fmu seed = \"wind\"\nseed.velocity -> quad.wind"),
    ] {
        let shown = shown(&flight(lines));
        assert!(shown.starts_with(&format!("error[E24]: `{name}` has a meaning already")), "{shown}");
        assert_eq!(shown.matches("error[").count(), 1, "{shown}");
    }
}

#[test]
fn names_of_a_loop_that_is_refused_are_not_missed_after_it() {
    let lines = "for i in 1..2.5 {\n  fmu uav[i] = \"quadcopter\"\n  for j in 1..2 { use pilot[j] = \"part.scn\" }\n}\n\
                 uav[1].state -> ctrl.state\nassert a: always pilot[2].x > 3 m\nrecord uav[*].roll, pilot[1].x";
    let shown = shown(&flight(lines));
    assert_eq!(shown.matches("error[").count(), 1, "{shown}");
}

#[test]
fn a_name_of_an_instance_and_of_a_value_is_one_error() {
    let shown = shown(&flight("let quad = 3 m\nlet b = quad + 1 m\nwind.velocity -> quad.wind"));
    assert_eq!(shown.matches("error[").count(), 1, "{shown}");
}

#[test]
fn wrong_files_are_errors_at_their_places_all_at_once() {
    let lines = "fmu a = \"quadcopter_controller\" { map = file(\"../x.py\"), unst = 3 }\nlet f = file(\"../y\")\n\
                 fmu b = \"quadcopter_controller\" { map = file(\"yard.csv\"), seed = 2 }";
    insta::assert_snapshot!(shown(&flight(lines)));
}
