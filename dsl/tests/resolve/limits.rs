//! The limits that descriptions declare, and the items of enumerations.

use super::fixtures::{flight, headings, scenario, shown, shown_with};
use dsl::scenario::Drive;

fn limited(lines: &str) -> String {
    flight(&format!("fmu a = \"limited\"\nfmu b = \"limited\"\n{lines}"))
}

#[test]
fn a_value_outside_the_limits_is_an_error_before_the_run() {
    insta::assert_snapshot!(shown(&limited("fmu c = \"limited\" { part = 100 }")), @r#"
    error[E38]: `c.part` cannot be 100: its description says min 0 and max 10
     --> test.scn:9:28
      |
    9 | fmu c = "limited" { part = 100 }
      |                            ^^^
      |
      = help: write a value within these limits
    "#);
    let lines = "fmu c = \"limited\" { angle = 91 deg, count = 0, method = \"land\", level = 49 cm }\n\
                 at 1 s { set a.part = -50, set b.part = 2 * 5.1 }\n0.4 m -> a.level\nat 2 s lasting 1 s { set a.level = 0 m }";
    insta::assert_snapshot!(headings(&limited(lines)), @r"
    error[E38]: `c.angle` cannot be 91 deg: its description says min -90 and max 90
    = help: write a value within these limits
    error[E38]: `c.count` cannot be 0: its description says min 1
    = help: write a value within these limits
    error[E38]: `c.method` cannot be 5: its description says the items 1, 2, 5 and max 2
    = help: write a value within these limits
    error[E38]: `c.level` cannot be 0.49 m: its description says min 0.5
    = help: write a value within these limits
    error[E38]: `a.part` cannot be -50: its description says min 0 and max 10
    = help: write a value within these limits
    error[E38]: `b.part` cannot be 10.2: its description says min 0 and max 10
    = help: write a value within these limits
    error[E38]: `a.level` cannot be 0.4 m: its description says min 0.5
    = help: write a value within these limits
    error[E38]: `a.level` cannot be 0 m: its description says min 0.5
    = help: write a value within these limits
    ");
}

#[test]
fn a_parameter_of_the_command_line_is_held_to_the_limits() {
    let script = limited("param p = 1\nfmu c = \"limited\" { part = p }");
    assert_eq!(shown_with(&script, &["p = 10"]), "");
    insta::assert_snapshot!(shown_with(&script, &["p = 11"]), @r#"
    error[E38]: `c.part` cannot be 11: its description says min 0 and max 10
      --> test.scn:10:28
       |
    10 | fmu c = "limited" { part = p }
       |                            ^
       |
       = help: write a value within these limits
    "#);
}

#[test]
fn a_value_at_its_limit_is_allowed() {
    scenario(&limited(
        "fmu c = \"limited\" { angle = 90 deg, count = 1, part = 10, level = 500 mm, method = \"hover\" }",
    ));
}

#[test]
fn an_integer_connects_to_an_enumeration_and_so_do_items_in_another_order() {
    let made = scenario(&limited("a.number -> b.mode\na.now -> b.turned\nassert same: always a.now == b.now"));
    assert!(made.connections.iter().all(|connection| matches!(connection.source, Drive::Copy(_))));
}

#[test]
fn items_of_other_values_are_shown_with_them() {
    insta::assert_snapshot!(shown(&limited("a.now -> b.moved")), @r#"
    error[E21]: `a.now` and `b.moved` have different items
     --> test.scn:9:1
      |
    9 | a.now -> b.moved
      | ^^^^^    ------- `idle` = 1, `hover` = 3, `land` = 5
      | |
      | `idle` = 1, `hover` = 2, `land` = 5
      |
      = help: compare and compute instead: `x == "item"`
    "#);
}

#[test]
fn a_bare_word_for_an_item_is_one_error_that_shows_the_item() {
    let lines = "fmu c = \"limited\" { method = Hover }\nat 1 s { set a.mode = fly, set a.turned = sin }";
    insta::assert_snapshot!(headings(&limited(lines)), @r#"
    error[E34]: `c.method` takes an item in quotes
    = help: write `"hover"`
    error[E34]: `a.mode` takes an item in quotes
    = help: its items are `idle`, `hover` and `land`
    error[E34]: `a.turned` takes an item in quotes
    = help: its items are `land`, `idle` and `hover`
    "#);
}

#[test]
fn what_grows_with_each_level_of_nesting_is_refused_before_it_fills_the_memory() {
    let nested =
        |start: &str, around: [&str; 2]| (0..40).fold(start.to_owned(), |text, _| around.join(&format!("({text})")));
    let equal = nested("quad.landed", ["", " == quad.landed"]);
    let chain = nested("quad.height > 1 m", ["0 <= count(", ") <= 3"]);
    let modulo = nested("quad.height", ["mod(", ", 2 m)"]);
    let list = (0..5).fold("1".to_owned(), |text, _| format!("[{text}; 4096]"));
    for lines in [
        format!("assert a: always {equal}"),
        format!("assert a: always {chain}"),
        format!("let a = {list}"),
        format!("let a = {modulo}"),
    ] {
        let found = headings(&flight(&lines));
        assert!(found.starts_with("error[E39]"), "{found}");
    }
}
