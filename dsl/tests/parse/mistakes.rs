//! Typical mistakes, and what users read of them.

use super::{errors, messages};

/// What users read of several one-line scripts, each with one mistake.
fn all(scripts: &[&str]) -> String {
    for script in scripts {
        assert_eq!(messages(script).len(), 1, "a follow-up in: {script}\n{}", errors(script));
    }
    scripts.iter().map(|script| errors(script)).collect()
}

#[test]
fn statements_begun_wrongly_show_their_model_line() {
    insta::assert_snapshot!(all(&[
        "stop at 3 s",
        "stop",
        "step = 5 ms",
        "asert clear: x > 3 m",
        "fault eye.scan: freeze",
        "speed = 3 m/s",
        "quad.mass = 3 kg",
        "if x > 3 m",
        "x",
        "step 5 ms stop 90 s",
        "let step = 5 ms",
        "param größe = 3 m",
        "let speed 3 m/s",
        "scenario Wind",
        "record",
        "}",
    ]));
}

#[test]
fn units_and_parts_are_named_in_quotes_with_their_clauses() {
    insta::assert_snapshot!(all(&[
        "fmu quad = quadcopter",
        "fmu quad = 'quadcopter'",
        "fmu quad \"quadcopter\"",
        "fmu quad = \"quadcopter",
        "fmu quad = \"quadcopter\" evry 5 ms",
        "fmu quad = \"quadcopter\" mass = 1 kg",
        "fmu quad = \"quadcopter\" { mass 1 kg }",
        "fmu quad = \"quadcopter\" { mass = 1 kg drag = 2 }",
        "use wing[1] = \"uav.scn\" every 5 ms",
    ]));
}

#[test]
fn connections_point_from_a_value_to_a_port() {
    insta::assert_snapshot!(all(&[
        "x => 3 m",
        "quad.state -> 3 m",
        "quad.state -> ",
        "-> ctrl.state",
        "ctrl.state <- quad.state",
        "quad.state --> ctrl.state",
        "quad.state -> ctrl.state eye.vehicle",
        "quad.state -> ctrl.state -> eye.vehicle",
        "quad. -> ctrl.state",
        "quad.state",
    ]));
}

#[test]
fn blocks_hold_actions_in_braces() {
    insta::assert_snapshot!(all(&[
        "at 3 s set quad.mass = 3 kg",
        "at 3 s { sett quad.mass = 3 kg }",
        "at 3 s lasting { set quad.mass = 3 kg }",
        "at 3 s { }",
        "when { set quad.mass = 3 kg }",
        "while x > 3 m { fault eye.scan freeze }",
        "for i 1..3 {\n}",
        "sweep seed in 1..3",
        "sweep { seed = 3 }",
    ]));
}

#[test]
fn claims_compare_with_the_signs_and_words_of_the_language() {
    insta::assert_snapshot!(all(&[
        "assert clear always x > 3 m",
        "assert clear: x = 3 m",
        "assert clear: x => 3 m",
        "assert clear: x ≥ 3 m",
        "assert clear: x > 3 m && y > 3 m",
        "assert clear: !landed",
        "assert clear: alway x > 3 m",
        "assert clear: x > 3 m ands y > 3 m",
        "assert clear: hold 2 s landed",
        "assert clear: eventually within 3 s",
        "assert clear: eventually within > 3 m",
    ]));
}

#[test]
fn values_have_digits_signs_and_brackets_in_their_places() {
    insta::assert_snapshot!(all(&[
        "let a = .5 m",
        "let a = 5. m",
        "let a = 1.2.3 m",
        "let a = 1_000 m",
        "let a = 1e999",
        "let a = - 5 degC",
        "let a = [1 -2] m",
        "let a = [1 2] m",
        "let a = max(1, 2",
        "let a = (1 + 2]",
        "let a = 1 + 2)",
        "let a = 2 ^ 3",
        "let a = 3;",
        "let a = 3 // metres",
        "let a = 3\u{a0}m",
        "let a = 3 *",
    ]));
}

#[test]
fn every_error_of_a_file_is_shown_and_none_twice() {
    insta::assert_snapshot!(errors(
        "scenario \"Five mistakes\"
stop at 3 s
let a = (1 + 2
fmu quad = \"quadcopter\" {
  mass 1 kg
  step = 2
}
quad.state -> ctrl.state

for i in 1..3 {
  assrt close[i]: x > 3 m
  let b = 3
  at 3 s { set quad.mass 3 }
}
param c 3
"
    ));
}

#[test]
fn a_brace_that_is_never_closed_is_the_one_that_is_shown() {
    insta::assert_snapshot!(all(&[
        "fmu quad = \"quadcopter\" { mass = 1 kg\nfmu ctrl = \"quadcopter_controller\"\n",
        "at 3 s {\n  set quad.mass = 2 kg\nstop 60 s\n",
        "for i in 1..3 {\n  let a = 3\n",
        "fmu quad = \"quadcopter\" { mass = (1 kg\n}\nstop 60 s\n",
    ]));
}

#[test]
fn a_value_missing_at_the_end_of_a_line_is_missed_there() {
    assert_eq!(
        messages("let a = 1 +\n\nlet b = 3"),
        ["error[E00]: expected a value after `+`, found the end of the line"]
    );
}

#[test]
fn brackets_nested_too_deeply_are_one_error() {
    let deep = format!("step 5 ms\nlet a = {}1{}\nlet b 3\n", "(".repeat(300), ")".repeat(300));
    assert_eq!(messages(&deep), ["error[E00]: more than 256 brackets and operators inside each other"]);
}

#[test]
fn a_star_declares_no_name_and_is_reported_beside_an_index() {
    let star = "error[E22]: `*` is a whole index, as in `record a[*]`, and declares no name";
    for script in ["fmu a[*] = \"wind\"", "assert b[1, *]: a.x > 0", "record a.m[*, 1]"] {
        assert_eq!(messages(script), [star], "{script}");
    }
}

#[test]
fn a_closing_brace_is_expected_only_where_one_is_open() {
    let shown = all(&[
        "assert c12: a.speed > 3 m/s always",
        "assert c12: a.speed > 3 m/s eventually within 5 s",
        "assert c12: eventually a.speed > 3 m/s within 5 s",
        "assert c12: landed not",
        "stop when landed always",
        "record a.speed every 20 ms, a.velocity every 10 ms",
        "let a = 3 m 4",
        "step 5 ms 3",
        "for i in 1..3 {\n  let a = 3 m 4\n}",
    ]);
    assert!(!shown.contains("expected `}`"), "{shown}");
    insta::assert_snapshot!(shown);
}

#[test]
fn a_statement_in_braces_is_shown_at_the_brace_that_is_never_closed() {
    insta::assert_snapshot!(all(&[
        "fmu c = \"wind\" { mean = [1,2,3] m/s\na.velocity => c.vehicle.velocity\nrecord a.velocity\n",
        "fmu c = \"wind\" {\n  mean = [1,2,3] m/s\nlet a = 3\nfmu d = \"wind\" { seed = 1 }\n",
        "at 3 s { set a.x = 3\na.velocity -> c.vehicle.velocity\n",
        "fmu c = \"wind\" {\n  mean = [1,2,3] m/s\n  a.velocity => c.vehicle.velocity\n}\nrecord a.velocity\n",
        "at 3 s {\n  set a.x = 3\n  stop 60 s\n}\n",
    ]));
}

#[test]
fn a_backslash_in_a_text_begins_an_escape() {
    insta::assert_snapshot!(all(&[
        r#"let a = "C:\data""#,
        r#"fmu a = "dir\unit.fmu""#,
        r#"let a = "open\""#,
        r#"let a = "open\"#,
    ]));
}
