//! The tree of a script with syntax errors: everything but the statements that hold them.

use dsl::parse::parse;
use dsl::source::Sources;

/// The statements that a script with `errors` errors keeps, as they are written, each with its documentation.
fn kept(script: &str, errors: usize) -> Vec<String> {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", script);
    let parsed = parse(&sources, text);
    let shown = dsl::diagnostic::render(&sources, &parsed.diagnostics, false);
    assert_eq!(parsed.diagnostics.len(), errors, "{shown}");
    let with_documentation = |statement: &dsl::syntax::Statement| match statement.documentation {
        Some(comment) => format!("{} | {}", sources.slice(comment), sources.slice(statement.span)),
        None => sources.slice(statement.span).to_owned(),
    };
    parsed.file.statements.iter().map(with_documentation).collect()
}

#[test]
fn statements_before_between_and_after_errors_are_kept() {
    let script = "scenario \"é\"\nstep 5 ms\nlet a 3\n# two\nlet b = 2\nstop stop\na.y -> b.u\nrecord";
    assert_eq!(kept(script, 3), ["scenario \"é\"", "step 5 ms", "# two | let b = 2", "a.y -> b.u"]);
}

#[test]
fn the_end_of_a_script_is_kept_after_its_last_error() {
    let many = "let c = 1\n".repeat(2_000);
    assert_eq!(kept(&format!("let a 3\n{many}"), 1).len(), 2_000);
    assert_eq!(kept(&format!("{many}let a 3"), 1).len(), 2_000);
}

#[test]
fn a_statement_over_several_lines_is_left_out_as_a_whole() {
    let script = "let a = 1\nfmu q = \"quad\" {\n  mass = 1 kg\n  drag 2\n}\nlet b = max(1,\n  2 3)\nlet c = 3";
    assert_eq!(kept(script, 2), ["let a = 1", "let c = 3"]);
}

#[test]
fn what_follows_an_error_in_a_block_is_outside_of_it() {
    let script = "let a = 1\nfor i in 1..3 {\n  let b = 2\n  let c 3\n  let d = 4\n}\nlet e = 5";
    assert_eq!(kept(script, 1), ["let a = 1", "let d = 4", "let e = 5"]);
}

#[test]
fn a_sign_apart_from_its_number_leaves_the_tree_whole() {
    assert_eq!(kept("let a = - 5\nlet b = 1", 1), ["let a = - 5", "let b = 1"]);
}

#[test]
fn what_the_grammar_lets_through_is_not_reported_beside_syntax_errors() {
    assert_eq!(kept("a.y[*, 1] -> b.u\nlet a 3", 1), ["a.y[*, 1] -> b.u"]);
    assert_eq!(kept("a.y[*, 1] -> b.u\nlet a = 3", 1).len(), 2);
}
