//! Errors about times and the reach of claims.

use super::fixtures::{flight, shown};

#[test]
fn a_time_off_the_grid_names_its_neighbours() {
    insta::assert_snapshot!(shown(&flight("at 12.345 s { set quad.drag = 0.2 }")), @r#"
    error[E08]: 12.345 s does not fall on the 10 ms grid
     --> test.scn:7:4
      |
    2 | step 10 ms
      |      ----- the grid
    ...
    7 | at 12.345 s { set quad.drag = 0.2 }
      |    ^^^^^^^^
      |
      = help: 12.34 s, 12.35 s, or `step 5 ms`
    "#);
}

#[test]
fn a_period_below_the_step_has_no_lower_neighbour() {
    insta::assert_snapshot!(shown(&flight("fmu two = \"quadcopter\" every 4 ms")), @r#"
    error[E08]: 4 ms does not fall on the 10 ms grid
     --> test.scn:7:30
      |
    2 | step 10 ms
      |      ----- the grid
    ...
    7 | fmu two = "quadcopter" every 4 ms
      |                              ^^^^
      |
      = help: 10 ms, or `step 2 ms`
    "#);
}

#[test]
fn a_time_without_unit_is_refused() {
    insta::assert_snapshot!(shown(&flight("at 12 { set quad.drag = 0.2 }")), @r#"
    error[E02]: expected a time, found a plain number
     --> test.scn:7:4
      |
    7 | at 12 { set quad.drag = 0.2 }
      |    ^^
      |
      = help: write the unit: `12 s`
    "#);
}

#[test]
fn a_time_that_is_known_in_the_run_only_is_refused() {
    insta::assert_snapshot!(shown(&flight("at quad.roll / 1 deg * 3 s { set quad.drag = 0.2 }")), @r#"
    error[E27]: `quad.roll / 1 deg * 3 s` is not known before the run
     --> test.scn:7:4
      |
    7 | at quad.roll / 1 deg * 3 s { set quad.drag = 0.2 }
      |    ^^^^^^^^^^^^^^^^^^^^^^^
      |
      = help: numbers, parameters and what is computed from them stand here
    "#);
}

#[test]
fn a_negative_time_and_an_empty_duration_are_refused() {
    insta::assert_snapshot!(shown(&flight("at -1 s lasting 0 s { set quad.drag = 0.2 }")), @r#"
    error[E38]: `-1 s` is not a time of a run
     --> test.scn:7:4
      |
    7 | at -1 s lasting 0 s { set quad.drag = 0.2 }
      |    ^^^^
      |
      = help: a time counts from the start and is at most 285 years

    error[E38]: `0 s` is no time at all
     --> test.scn:7:17
      |
    7 | at -1 s lasting 0 s { set quad.drag = 0.2 }
      |                 ^^^
      |
      = help: this time has to be longer than zero
    "#);
}

#[test]
fn a_step_is_a_whole_number_of_nanoseconds() {
    insta::assert_snapshot!(shown("scenario \"a\"\nstep 1 s / 60\nstop 1 s\n"), @r#"
    error[E08]: `1 s / 60` is not a whole number of nanoseconds
     --> test.scn:2:6
      |
    2 | step 1 s / 60
      |      ^^^^^^^^
      |
      = help: times are counted in nanoseconds, the nearest is `16666667 ns`
    "#);
}

#[test]
fn a_claim_past_the_end_says_how_far_it_looks() {
    insta::assert_snapshot!(shown(&flight("assert arrive: eventually within 60 s hold for 2 s quad.landed")), @r#"
    error[E09]: `arrive` looks 62 s ahead (60 s within + 2 s hold), the run ends at 60 s
     --> test.scn:7:8
      |
    3 | stop 60 s
      |      ---- the end
    ...
    7 | assert arrive: eventually within 60 s hold for 2 s quad.landed
      |        ^^^^^^
      |
      = help: shorten the claim or write `stop 62 s`
    "#);
}

#[test]
fn a_claim_that_exceeds_memory_is_refused() {
    let script = flight("assert late: always (eventually within 20 s quad.landed)").replace("step 10 ms", "step 1 us");
    insta::assert_snapshot!(shown(&script), @r"
    error[E39]: `late` looks 20000000 steps ahead, and at most 10000000 are kept
     --> test.scn:7:8
      |
    7 | assert late: always (eventually within 20 s quad.landed)
      |        ^^^^
      |
      = help: shorten the claim, or write a longer `step`
    ");
}

#[test]
fn a_window_that_ends_before_it_begins_is_refused() {
    insta::assert_snapshot!(shown(&flight("assert a: eventually within 5..2 s quad.landed")), @r#"
    error[E38]: the window `5..2 s` ends before it begins
     --> test.scn:7:29
      |
    7 | assert a: eventually within 5..2 s quad.landed
      |                             ^^^^^^
      |
      = help: write the near end first
    "#);
}

#[test]
fn a_temporal_word_over_and_needs_parentheses() {
    insta::assert_snapshot!(shown(&flight("assert a: eventually within 3 s quad.landed and quad.roll < 3 deg")), @r#"
    error[E12]: `eventually` reaches to the end of the line, over the `and`
     --> test.scn:7:11
      |
    7 | assert a: eventually within 3 s quad.landed and quad.roll < 3 deg
      |           ^^^^^^^^^^            --------------------------------- all of this
      |
      = help: write `eventually within 3 s (quad.landed and quad.roll < 3 deg)`, or `(eventually within 3 s quad.landed) and quad.roll < 3 deg`
    "#);
}

#[test]
fn temporal_words_belong_to_claims() {
    insta::assert_snapshot!(shown(&flight("let late = eventually quad.landed\nlate -> ctrl.armed\nassert a: late")), @r#"
    error[E30]: `eventually` looks ahead in time, which only claims do
     --> test.scn:8:1
      |
    7 | let late = eventually quad.landed
      |            ---------- here
    8 | late -> ctrl.armed
      | ^^^^
      |
      = help: write it in an `assert`, or in a `let` that only asserts use
    "#);
}
