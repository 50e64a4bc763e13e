//! Names of units of measure that loaded units define differently, or that are names of the script too.

use super::fixtures::{flight, scenario, shown};
use dsl::scenario::Value;

fn tanks(lines: &str) -> String {
    format!("scenario \"Test\"\nstep 10 ms\nstop 60 s\n{lines}\n")
}

#[test]
fn a_literal_takes_the_meaning_of_the_unit_that_it_goes_to() {
    let made = scenario(&tanks(
        "param ten = 10 'gal'\nfmu a = \"us\" { v = ten }\nfmu b = \"uk\" { v = 10 'gal' }\nfmu c = \"uk\" { v = ten }",
    ));
    let presets = made.instances.iter().flat_map(|instance| &instance.presets).map(|preset| &preset.value);
    assert_eq!(presets.collect::<Vec<_>>(), [&Value::Real(10.0); 3]);
    assert_eq!(made.parameters[0].value, "10 gal");
}

#[test]
fn a_literal_takes_the_meaning_of_the_variable_that_it_is_compared_with() {
    let made = scenario(&tanks(
        "fmu a = \"us\"\nfmu b = \"uk\"\nassert full: always b.w > 9 'gal'\n\
         assert near: always a.w == 1 'gal' ± 1 'gal'\nassert more: always b.w + 1 'gal' > 1 m^3\n\
         assert plain: always (b.w in 'gal') > 9",
    ));
    let shown = made
        .claims
        .iter()
        .map(|claim| format!("{}: {:?} {:?}\n{:?}", claim.name, claim.limit, claim.unit, claim.formula));
    insta::assert_snapshot!(shown.collect::<Vec<_>>().join("\n"), @r#"
    full: Some(Limit { value: 9.0, upper: false }) Some(MarginUnit { name: "gal", factor: 0.00454609 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Affine { of: Signal(Port { instance: 1, variable: 2 }), factor: 0.00454609, offset: 0.0 }, Constant(0.04091481)), strict: true }))
    near: None Some(MarginUnit { name: "gal", factor: 0.003785411784 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Constant(0.003785411784), Call(Abs, [Subtract(Affine { of: Signal(Port { instance: 0, variable: 2 }), factor: 0.003785411784, offset: 0.0 }, Constant(0.003785411784))])), strict: false }))
    more: Some(Limit { value: 1.0, upper: false }) Some(MarginUnit { name: "m^3", factor: 1.0 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(Add(Affine { of: Signal(Port { instance: 1, variable: 2 }), factor: 0.00454609, offset: 0.0 }, Constant(0.00454609)), Constant(1.0)), strict: true }))
    plain: Some(Limit { value: 9.0, upper: false }) Some(MarginUnit { name: "", factor: 1.0 })
    Always(TickWindow { from: 0, to: None }, Margin(Margin { value: Subtract(InverseAffine { of: Affine { of: Signal(Port { instance: 1, variable: 2 }), factor: 0.00454609, offset: 0.0 }, factor: 0.00454609, offset: 0.0 }, Constant(9.0)), strict: true }))
    "#);
}

#[test]
fn a_name_with_two_meanings_needs_a_variable_that_it_goes_to() {
    let lines = "fmu a = \"us\"\nfmu b = \"uk\"\nfmu w = \"heater\"\nlet x = 2 * 3 'gal'\nlet y = max(1 'gal', a.w)\n\
                 assert z: always a.w + b.w < 5 'gal'\n5 'gal' / 1 m^2 -> w.plain";
    insta::assert_snapshot!(shown(&tanks(lines)), @r"
    error[E33]: `gal` has two meanings here
     --> test.scn:7:13
      |
    7 | let x = 2 * 3 'gal'
      |             ^^^^^^^ 0.003785411784 m^3 in a, 0.00454609 m^3 in b
      |
      = help: only a value that goes to or is compared with a variable takes its FMU's meaning; write another unit

    error[E33]: `gal` has two meanings here
     --> test.scn:8:13
      |
    8 | let y = max(1 'gal', a.w)
      |             ^^^^^^^ 0.003785411784 m^3 in a, 0.00454609 m^3 in b
      |
      = help: only a value that goes to or is compared with a variable takes its FMU's meaning; write another unit

    error[E33]: `gal` has two meanings here
     --> test.scn:9:30
      |
    9 | assert z: always a.w + b.w < 5 'gal'
      |                              ^^^^^^^ 0.003785411784 m^3 in a, 0.00454609 m^3 in b
      |
      = help: only a value that goes to or is compared with a variable takes its FMU's meaning; write another unit

    error[E33]: `gal` has two meanings here
      --> test.scn:10:1
       |
    10 | 5 'gal' / 1 m^2 -> w.plain
       | ^^^^^^^ 0.003785411784 m^3 in a, 0.00454609 m^3 in b
       |
       = help: only a value that goes to or is compared with a variable takes its FMU's meaning; write another unit
    ");
}

#[test]
fn a_value_named_like_a_unit_is_one_error_at_its_declaration() {
    let lines = "let s = 2 s\nassert a: always norm(wind.velocity) < 3 m/s\nassert b: always norm(wind.velocity) < 4 m/s\n\
                 at 1 s { set quad.wind = [1, 0, 0] m/s }\nparam g = 9.81 m/s^2";
    insta::assert_snapshot!(shown(&flight(lines)), @r"
    error[E11]: `s` is a unit of measure too, so that `9.81 m/s^2` (line 11) cannot be read
     --> test.scn:7:5
      |
    7 | let s = 2 s
      |     ^
      |
      = help: rename it
    ");
}
