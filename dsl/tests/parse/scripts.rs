//! Whole scripts: the reference's examples, line breaks, comments and places.

use dsl::source::{Sources, Span};
use dsl::syntax::StatementKind;

use super::{only, tree};

#[test]
fn the_examples_of_the_reference_parse() {
    let examples = [
        (include_str!("../../corpus/parse/quadcopter_among_obstacles.scn"), 34),
        (include_str!("../../corpus/parse/auv_with_range_finder.scn"), 28),
        (include_str!("../../corpus/parse/uav.scn"), 6),
        (include_str!("../../corpus/parse/formation.scn"), 21),
    ];
    for (script, statements) in examples {
        assert_eq!(tree(script).statements.len(), statements, "{script}");
    }
}

#[test]
fn an_empty_file_has_no_statements() {
    for script in ["", "\n", "\r\n \t\r\n", "# nothing but a comment", "\n# a comment\n\n"] {
        assert_eq!(tree(script).statements, [], "{script:?}");
    }
}

#[test]
fn line_breaks_and_comments_in_brackets_mean_nothing() {
    let broken = "let a = max( # first\n  1 m, # \"quoted\" (\n\n  [2,\r\n 3] m\n)\n";
    let StatementKind::Let(broken) = only(broken) else { panic!("no let") };
    let StatementKind::Let(straight) = only("let a = max(1 m, [2, 3] m)") else { panic!("no let") };
    assert_eq!(kinds(&broken.value), kinds(&straight.value));
}

#[test]
fn lines_go_on_after_operators_and_before_words_that_join() {
    let broken = "assert a: x > 3 m\n  and y > 3 m\n\n  implies z <\n 3 m\nstep 5 ms\n";
    let statements = tree(broken).statements;
    let straight = tree("assert a: x > 3 m and y > 3 m implies z < 3 m\nstep 5 ms").statements;
    assert_eq!(statements.len(), 2);
    assert_eq!(kinds(&statements[0].kind), kinds(&straight[0].kind));
    assert_eq!(tree("a.b\n-> c.d,\n  e.f\n").statements.len(), 1);
}

#[test]
fn signs_in_texts_and_comments_are_no_brackets() {
    assert_eq!(tree("scenario \"( [ { # -> \"\n# ( [ {\nstep 5 ms # (\nstop 3 s").statements.len(), 3);
}

#[test]
fn a_byte_order_mark_and_carriage_returns_do_not_shift_places() {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", "\u{feff}step 5 ms\r\nstop 3 s\r\n");
    let file = dsl::parse::parse(&sources, text).file;
    let words: Vec<_> = file.statements.iter().map(|statement| sources.slice(statement.span)).collect();
    assert_eq!(words, ["step 5 ms", "stop 3 s"]);
    assert_eq!(sources.line_and_column(file.statements[1].span), (2, 1));
}

#[test]
fn comment_lines_right_above_a_statement_are_its_documentation() {
    let script = "# the file\n\n# how fast\n  # it goes\r\nparam a = 3 # not this\nlet b = 4\n";
    let mut sources = Sources::default();
    let text = sources.add("a.scn", script);
    let file = dsl::parse::parse(&sources, text).file;
    let documentation = |span: Option<Span>| span.map(|span| sources.slice(span));
    assert_eq!(documentation(file.statements[0].documentation), Some("# how fast\n  # it goes"));
    assert_eq!(documentation(file.statements[1].documentation), None);
}

#[test]
fn spans_cover_what_was_written_and_no_blank_more() {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", "assert a: (x + 1 m) * 2   <  3 m   # so far\n");
    let file = dsl::parse::parse(&sources, text).file;
    let StatementKind::Assert { claim, .. } = &file.statements[0].kind else { panic!("no assert") };
    assert_eq!(sources.slice(file.statements[0].span), "assert a: (x + 1 m) * 2   <  3 m");
    assert_eq!(sources.slice(claim.span), "(x + 1 m) * 2   <  3 m");
    let dsl::syntax::ExpressionKind::Comparison { first, rest } = &claim.kind else { panic!("no comparison") };
    assert_eq!(sources.slice(first.span), "(x + 1 m) * 2");
    assert_eq!(sources.slice(rest[0].operator_span), "<");
    let dsl::syntax::ExpressionKind::Arithmetic(_, sum, _) = &first.kind else { panic!("no product") };
    assert_eq!((sources.slice(sum.span), sum.parenthesised), ("(x + 1 m)", true));
}

#[test]
fn reserved_words_are_free_after_a_dot_and_as_keys() {
    assert_eq!(tree("radio.loss -> a.step\nfmu a = \"b\" {\n  step = 1,\n  at.set[1] = 2\n}\n").statements.len(), 2);
}

/// A tree without its places.
pub(super) fn kinds(part: &impl std::fmt::Debug) -> String {
    let shown = format!("{part:?}");
    let mut parts = shown.split("Span {");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kinds, part| kinds + part.split_once('}').map_or("", |(_, after)| after))
}
