//! What `implies`, `until` and `finally` mean.

use super::fixtures::{flight, headings, scenario, shown};
use dsl::scenario::{Claim, Formula, Gated, TickWindow, Until};

fn claim(text: &str) -> Claim {
    scenario(&flight(&format!("assert a: {text}"))).claims.remove(0)
}

#[test]
fn implies_is_a_closed_gate_or_its_body_and_its_negation_an_open_one_and_the_negated_body() {
    let Formula::Gated(Gated { any: true, gate, body }) = claim("quad.landed implies quad.height < 1 m").formula else {
        panic!()
    };
    assert!(matches!((*gate, *body), (Formula::Condition(_), Formula::Margin(_))));
    let negated = claim("not (quad.landed implies quad.height < 1 m)").formula;
    assert!(matches!(negated, Formula::Gated(Gated { any: false, .. })));
}

#[test]
fn until_binds_tighter_than_implies_and_has_a_window() {
    let formula = claim("quad.landed implies quad.height < 1 m until within 2..3 s quad.roll > 3 deg").formula;
    let Formula::Gated(Gated { body, .. }) = formula else { panic!("{formula:?}") };
    let Formula::Until(Until { any: true, window, .. }) = *body else { panic!("{body:?}") };
    assert_eq!(window, TickWindow { from: 200, to: Some(300) });
    assert!(matches!(
        claim("not (quad.height < 1 m until quad.landed)").formula,
        Formula::Until(Until { any: false, .. })
    ));
}

#[test]
fn a_gate_has_any_dimension_and_may_hold_temporal_words() {
    let claim = claim("always (time > 20 s and (eventually within 2 s quad.landed) implies quad.height > 2 m)");
    assert_eq!(claim.unit.map(|unit| unit.name).as_deref(), Some("m"));
    let gate = "time > 20 s and (eventually within 2 s quad.landed)";
    assert_eq!(claim.gates, [format!("{gate} never happened, up to 58 s, the last time that is judged")]);
    let parts: Vec<_> = claim.parts.iter().map(|part| (part.text.as_str(), part.window.as_str())).collect();
    let parts_of_claim =
        [("time > 20 s", "always"), ("", "always eventually within 2 s"), ("quad.height > 2 m", "always")];
    assert_eq!(parts, parts_of_claim);
    assert_eq!(claim.parts[1].signals, ["quad.landed"]);
    assert_eq!(claim.limit.map(|limit| limit.value), Some(2.0));
}

#[test]
fn a_condition_of_a_moment_may_hold_implies() {
    let lines = "quad.landed implies quad.roll > 3 deg -> ctrl.armed";
    assert_eq!(headings(&flight(lines)), "");
}

#[test]
fn finally_stands_at_the_top_or_in_a_gate() {
    assert!(matches!(claim("finally quad.height < 1 m").formula, Formula::Finally(_)));
    assert!(matches!(claim("finally (quad.landed implies quad.roll < 3 deg)").formula, Formula::Finally(_)));
    assert!(matches!(claim("(finally quad.landed) implies always quad.roll < 3 deg").formula, Formula::Gated(_)));
    let lines = "assert b: always (finally quad.landed)\nassert c: finally (always quad.landed)\n\
                 assert d: always ((finally quad.landed) implies quad.roll < 3 deg)";
    insta::assert_snapshot!(headings(&flight(lines)), @r"
    error[E30]: `finally` stands at the top of a claim or in a gate
    = help: make an `assert` of its own: `assert end: finally …`
    error[E30]: `finally` asks for the last sample, where no window of time is left
    = help: a claim about the end without `finally`: `eventually always …`
    ");
}

#[test]
fn a_temporal_word_over_until_or_implies_wants_parentheses() {
    let lines = "assert b: always quad.landed implies quad.roll < 3 deg\n\
                 assert c: eventually quad.roll < 3 deg until within 2 s quad.landed";
    insta::assert_snapshot!(headings(&flight(lines)), @r"
    error[E12]: `always` reaches to the end of the line, over the `implies`
    = help: write `always (quad.landed implies quad.roll < 3 deg)`, or `(always quad.landed) implies quad.roll < 3 deg`
    error[E12]: `eventually` reaches to the end of the line, over the `until`
    = help: write `eventually (quad.roll < 3 deg until within 2 s quad.landed)`, or `(eventually quad.roll < 3 deg) until within 2 s quad.landed`
    ");
}

#[test]
fn an_until_that_looks_past_the_end_is_an_error() {
    let lines = "assert b: always (quad.landed implies (hold for 2 s quad.roll < 3 deg) until within 59 s quad.landed)";
    insta::assert_snapshot!(shown(&flight(lines)), @r"
    error[E09]: `b` looks 61 s ahead (59 s until + 2 s hold), the run ends at 60 s
     --> test.scn:7:8
      |
    3 | stop 60 s
      |      ---- the end
    ...
    7 | assert b: always (quad.landed implies (hold for 2 s quad.roll < 3 deg) until within 59 s quad.landed)
      |        ^
      |
      = help: shorten the claim or write `stop 61 s`
    ");
}

#[test]
fn a_list_may_repeat_its_element() {
    assert_eq!(headings(&flight("let w = [3 m/s; 3]\nw -> quad.wind")), "");
    insta::assert_snapshot!(headings(&flight("[3; 0] m/s -> quad.wind")), @r"
    error[E38]: a list of 0 elements
    = help: `[w; 4]` is `[w, w, w, w]`; the number goes from 1 to 4096
    ");
}
