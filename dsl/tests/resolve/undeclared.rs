//! Variables whose unit of measure is not known.

use super::fixtures::{flight, headings, scenario_with_warnings, shown};
use dsl::scenario::Value;

fn undefined(lines: &str) -> String {
    flight(&format!("fmu a = \"undefined\"\nfmu b = \"undefined\"\n{lines}"))
}

#[test]
fn a_name_without_definition_takes_numbers_of_that_name() {
    let made = scenario_with_warnings(&undefined(
        "fmu c = \"undefined\" { v = 36 km/h }\na.p -> b.v\nassert x: always a.p < 36 km/h",
    ));
    assert_eq!(made.0, "");
    assert_eq!(made.1.instances[5].presets[0].value, Value::Real(36.0));
    let claim = &made.1.claims[0];
    insta::assert_snapshot!(format!("{:?} {:?} {:?}", claim.limit, claim.unit, claim.formula), @r#"Some(Limit { value: 36.0, upper: true }) Some(MarginUnit { name: "km/h", factor: 1.0 }) Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Constant(36.0), Signal(Port { instance: 3, variable: 4 })), strict: true }))"#);
}

#[test]
fn other_names_pass_with_a_warning() {
    insta::assert_snapshot!(shown(&undefined("a.o -> b.v")), @r"
    warning[W01]: `a.o` is in cm/s and `b.v` in km/h, and `cm/s` and `km/h` have no definition: the number passes as it is
     --> test.scn:9:1
      |
    9 | a.o -> b.v
      | ^^^    --- takes km/h
      | |
      | gives cm/s
      |
      = help: to convert it write `(a.o as cm/s) in km/h -> b.v`; to accept it write `1 * a.o -> b.v`
    ");
    let lines = "fmu c = \"undefined\" { v = 10 m/s, w = 2 m }\na.q -> a.v\na.p -> a.known\n2 * a.q -> b.w\n\
                 assert x: always a.o < a.p\nassert y: always a.p < 10 m/s\nassert z: always a.q > a.p\n\
                 at 1 s { set c.w = a.o }";
    insta::assert_snapshot!(headings(&undefined(lines)), @r"
    warning[W01]: `c.v` is in km/h, which undefined does not define; 10 m/s is passed as 10 (m/s)
    = help: to convert it write `10 m/s in km/h`; to accept it write `10 m/s in m/s`
    warning[W01]: `c.w` is in fathom, which undefined does not define; 2 m is passed as 2 (m)
    = help: to accept it write `2 m in m`
    warning[W01]: `a.q` is in m/s and `a.v` in km/h, and `km/h` has no definition: the number passes as it is
    = help: to convert it write `a.q in km/h -> a.v`; to accept it write `1 * a.q -> a.v`
    warning[W01]: `a.p` is in km/h and `a.known` in m/s, and `km/h` has no definition: the number passes as it is
    = help: to convert it write `a.p as km/h -> a.known`; to accept it write `1 * a.p -> a.known`
    warning[W01]: `b.w` is in fathom, which undefined does not define; the value is passed in m/s
    = help: to accept it write `(2 * a.q) in m/s`
    warning[W01]: `a.o` is in cm/s and `a.p` in km/h, and `cm/s` and `km/h` have no definition: the numbers meet as they are
    = help: give a value without a defined unit its unit by `as`, for example `x as km/h`
    warning[W01]: `a.p` is in km/h, which undefined does not define; 10 m/s is passed as 10 (m/s)
    = help: to convert it write `10 m/s in km/h`; to accept it write `10 m/s in m/s`
    warning[W01]: `a.q` is in m/s and `a.p` in km/h, and `km/h` has no definition: the numbers meet as they are
    = help: give a value without a defined unit its unit by `as`, for example `x as km/h`
    warning[W01]: `a.o` is in cm/s and `c.w` in fathom, and `cm/s` and `fathom` have no definition: the number passes as it is
    = help: to accept it write `1 * a.o`
    ");
}

#[test]
fn what_the_help_says_has_no_warning() {
    let lines = "fmu c = \"undefined\" { v = 10 m/s in km/h }\n(a.o as cm/s) in km/h -> b.v\na.q in km/h -> a.v\n\
                 a.p as km/h -> a.known\n1 * a.o -> a.w\na.bare -> b.w\nassert y: always a.p < (10 m/s in km/h)";
    assert_eq!(shown(&undefined(lines)), "");
}

#[test]
fn a_value_in_si_has_one_way_to_accept_it() {
    insta::assert_snapshot!(shown(&flight("at 1 s { set ctrl.raw = 2 m }")), @r"
    warning[W01]: `ctrl.raw` declares no unit; 2 m is passed as 2 (m)
     --> test.scn:7:25
      |
    7 | at 1 s { set ctrl.raw = 2 m }
      |                         ^^^
      |
      = help: to accept it write `2 m in m`
    ");
}
