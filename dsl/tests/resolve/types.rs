//! Errors about types and shapes.

use super::fixtures::{flight, shown};

#[test]
fn types_have_to_be_equal() {
    let lines = "ctrl.thrust -> ctrl.armed\nctrl.thrust -> ctrl.count\nquad.landed -> quad.moment\n\"x\" -> ctrl.raw";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E21]: `ctrl.armed` takes a Boolean, found a number
     --> test.scn:7:1
      |
    7 | ctrl.thrust -> ctrl.armed
      | ^^^^^^^^^^^    ---------- takes a Boolean
      | |
      | gives a number
      |
      = help: a comparison is a Boolean: `x > 0.5`

    error[E21]: `ctrl.count` takes an Integer, a real is not narrowed to one
     --> test.scn:8:1
      |
    8 | ctrl.thrust -> ctrl.count
      | ^^^^^^^^^^^    ---------- takes an Integer
      | |
      | gives N  (kg m/s^2, quadcopter_controller)
      |
      = help: connect an Integer output, or write a whole number

    error[E21]: `quad.moment` takes a Real, found a Boolean
     --> test.scn:9:1
      |
    9 | quad.landed -> quad.moment
      | ^^^^^^^^^^^    ----------- takes a Real
      | |
      | gives a Boolean
      |
      = help: types have to be equal; only an Integer widens to a Real

    error[E21]: `ctrl.raw` takes a Real, found a text
      --> test.scn:10:1
       |
    10 | "x" -> ctrl.raw
       | ^^^    -------- takes a Real
       | |
       | gives a text
       |
       = help: types have to be equal; only an Integer widens to a Real
    "#);
}

#[test]
fn an_item_that_an_enumeration_lacks_names_the_nearest() {
    insta::assert_snapshot!(shown(&flight("\"hovr\" -> ctrl.mode\nassert a: always ctrl.now == \"fly\"")), @r#"
    error[E34]: `ctrl.mode` has no item `hovr`
     --> test.scn:7:1
      |
    7 | "hovr" -> ctrl.mode
      | ^^^^^^
      |
      = help: did you mean "hover"? Its items are `idle`, `hover` and `land`

    error[E34]: `ctrl.now` has no item `fly`
     --> test.scn:8:30
      |
    8 | assert a: always ctrl.now == "fly"
      |                              ^^^^^
      |
      = help: its items are `idle`, `hover` and `land`
    "#);
}

#[test]
fn a_group_of_several_units_does_not_compute() {
    insta::assert_snapshot!(shown(&flight("assert a: always norm(quad.state) < 3 m")), @r#"
    error[E23]: `quad.state` does not compute: it holds m  (quadcopter) and 1  (quadcopter)
     --> test.scn:7:23
      |
    7 | assert a: always norm(quad.state) < 3 m
      |                       ^^^^^^^^^^
      |
      = help: such a group connects as a whole; take one part, for example `quad.state.position.x`
    "#);
}

#[test]
fn vectors_have_no_order_and_one_length() {
    let lines =
        "assert a: always quad.state.position < 3 m\nassert b: always dist(quad.state.position, [1, 2] m) < 3 m";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E22]: `quad.state.position` is a vector and has no order
     --> test.scn:7:18
      |
    7 | assert a: always quad.state.position < 3 m
      |                  ^^^^^^^^^^^^^^^^^^^
      |
      = help: compare `norm(…)`, `dist(a, b)`, `max(…)` or one part

    error[E22]: a vector of 3 meets a vector of 2
     --> test.scn:8:23
      |
    8 | assert b: always dist(quad.state.position, [1, 2] m) < 3 m
      |                       ^^^^^^^^^^^^^^^^^^^  -------- 2 elements
      |                       |
      |                       3 elements
      |
      = help: pick the members that belong together, for example `.{x, y}`
    "#);
}

#[test]
fn reals_are_equal_within_a_tolerance_and_chains_go_one_way() {
    let lines = "assert a: always quad.roll == 3 deg\nassert b: always 3 m < quad.height > 1 m\nassert c: always quad.roll != 3 deg";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E29]: reals are equal within a tolerance only
     --> test.scn:7:28
      |
    7 | assert a: always quad.roll == 3 deg
      |                            ^^
      |
      = help: write `quad.roll == 3 deg ± 0.01 deg`

    error[E29]: a chain of comparisons goes one way
     --> test.scn:8:18
      |
    8 | assert b: always 3 m < quad.height > 1 m
      |                  ^^^^^^^^^^^^^^^^^^^^^^^
      |
      = help: write `a < b < c` or `a > b > c`, else join two with `and`

    error[E29]: reals are equal within a tolerance only
     --> test.scn:9:28
      |
    9 | assert c: always quad.roll != 3 deg
      |                            ^^
      |
      = help: write `not (quad.roll == 3 deg ± 0.01 deg)`
    "#);
}

#[test]
fn the_largest_of_one_number_shows_the_claim() {
    insta::assert_snapshot!(shown(&flight("assert a: max(quad.roll) < 3 deg")), @r#"
    error[E31]: `max` of one number is that number
     --> test.scn:7:11
      |
    7 | assert a: max(quad.roll) < 3 deg
      |           ^^^^^^^^^^^^^^
      |
      = help: over time this is a claim: `always quad.roll < …`
    "#);
}

#[test]
fn functions_take_what_they_can() {
    let lines = "let a = sqrt(3 m)\nlet b = abs(1, 2)\nlet c = exp(3 m)\nlet d = not 3\nlet e = file(3)";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E02]: `sqrt` has no value for a length
     --> test.scn:7:14
      |
    7 | let a = sqrt(3 m)
      |              ^^^ m
      |
      = help: take the number out with `in`, or divide by a quantity

    error[E31]: `abs` takes one argument, found 2
     --> test.scn:8:9
      |
    8 | let b = abs(1, 2)
      |         ^^^^^^^^^
      |
      = help: for example `abs(x)`

    error[E02]: `exp` has no value for a length
     --> test.scn:9:13
      |
    9 | let c = exp(3 m)
      |             ^^^ m
      |
      = help: take the number out with `in`, or divide by a quantity

    error[E21]: expected a condition, `3` is a number
      --> test.scn:10:13
       |
    10 | let d = not 3
       |             ^
       |
       = help: a condition compares, for example `x > 3 m`

    error[E31]: `file` takes the path as a text, found a number
      --> test.scn:11:14
       |
    11 | let e = file(3)
       |              ^
       |
       = help: for example `file("yard.csv")`
    "#);
}

#[test]
fn a_fraction_is_no_integer() {
    insta::assert_snapshot!(shown(&flight("fmu two = \"quadcopter_controller\" { levels = 2.5, unset = 0 m, stream = 1 }")), @r#"
    error[E38]: `two.levels` takes an Integer, and 2.5 is none
     --> test.scn:7:46
      |
    7 | fmu two = "quadcopter_controller" { levels = 2.5, unset = 0 m, stream = 1 }
      |                                              ^^^
      |
      = help: Integers are whole and go from -2147483648 to 2147483647
    "#);
}

#[test]
fn a_trace_holds_no_text() {
    insta::assert_snapshot!(shown(&flight("record ctrl.said")), @r#"
    error[E21]: `ctrl.said` is a String, and a trace holds numbers
     --> test.scn:7:8
      |
    7 | record ctrl.said
      |        ^^^^^^^^^
      |
      = help: record the other members by name
    "#);
}
