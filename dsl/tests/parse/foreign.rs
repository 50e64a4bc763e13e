//! Any bytes: nothing panics, nothing takes long, and every place is in the text.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use dsl::parse::{parse, parse_assignment};
use dsl::source::Sources;
use proptest::prelude::*;

/// The target for foreign bytes.
fn check_robustness(bytes: &[u8]) {
    let mut sources = Sources::default();
    let text = sources.add("foreign.scn", String::from_utf8_lossy(bytes));
    let parsed = parse(&sources, text);
    let places = parsed.diagnostics.iter().flat_map(|diagnostic| &diagnostic.labels).map(|label| label.span);
    for span in places.chain(parsed.file.statements.iter().map(|statement| statement.span)) {
        let (start, end) = (span.start as usize, span.end as usize);
        assert!(sources.text(text).get(start..end).is_some(), "{start}..{end} is no place in the text");
    }
    let shown = dsl::diagnostic::render(&sources, &parsed.diagnostics, false);
    assert_eq!(shown.is_empty(), parsed.diagnostics.is_empty());
    if let Err(diagnostics) = parse_assignment(&sources, text) {
        assert!(!diagnostics.is_empty(), "refused without a word");
    }
}

fn corpus() -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/parse");
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("the corpus: {error}"));
    let mut files: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    files.sort();
    files.iter().map(|file| fs::read(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))).collect()
}

#[test]
fn every_file_of_the_corpus_parses_without_panic() {
    let corpus = corpus();
    assert!(corpus.len() > 4, "the corpus is there");
    corpus.iter().for_each(|bytes| check_robustness(bytes));
}

#[test]
fn every_beginning_of_a_good_script_parses_without_panic() {
    let script = include_str!("../../corpus/parse/formation.scn");
    for end in (0..script.len()).step_by(3) {
        check_robustness(&script.as_bytes()[..end]);
    }
}

/// One change of a script: what is cut out, and what is put in its place.
fn change() -> impl Strategy<Value = (prop::sample::Index, usize, String)> {
    let signs = prop::sample::select(vec![
        "(", ")", "[", "]", "{", "}", "\"", "'", "#", "\n", "\r", "\t", "-", "->", "=>", "=", ",", ":", ".", "..", "~",
        "*", "±", "°", "é", "\u{0}", "\u{feff}", "not ", "always ", "until ", "implies ", "for ", "step ", "1e", "- 1",
    ]);
    (any::<prop::sample::Index>(), 0_usize..20, prop_oneof![signs.prop_map(str::to_owned), ".{0,4}"])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_scripts_parse_without_panic(
        file in any::<prop::sample::Index>(),
        changes in prop::collection::vec(change(), 1..6),
    ) {
        let mut bytes = file.get(&corpus()).clone();
        for (at, length, text) in changes {
            let at = at.index(bytes.len() + 1);
            let end = (at + length).min(bytes.len());
            bytes.splice(at..end, text.into_bytes());
        }
        check_robustness(&bytes);
    }

    #[test]
    fn any_bytes_parse_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        check_robustness(&bytes);
    }
}

#[test]
fn nesting_costs_no_more_than_length() {
    for (open, close) in [("(", ")"), ("[", "]"), ("max(1, ", ")"), ("not (", ")"), ("-(", ")"), ("a[", "]")] {
        // Time exponential in the depth would not end.
        check_robustness(format!("let a = {}1{}\n", open.repeat(120), close.repeat(120)).as_bytes());
        check_robustness(format!("let a = {}1\n", open.repeat(120)).as_bytes());
    }
    let deep = format!("let a = {}1{}\n", "(".repeat(256), ")".repeat(256));
    assert_eq!(super::tree(&deep).statements.len(), 1);
}

#[test]
fn chains_of_any_length_parse_without_panic() {
    for part in [
        "1 + ",
        "not ",
        "- -",
        "always ",
        "a implies ",
        "a until ",
        "a and ",
        "(",
        "{",
        "for i in 1..2 {\n",
        "a\nimplies ",
    ] {
        check_robustness(format!("let a = {}1\n", part.repeat(20_000)).as_bytes());
        check_robustness(part.repeat(20_000).as_bytes());
    }
}

/// How long a script of `lines` equal lines takes.
fn time(line: &str, lines: usize) -> Duration {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", line.repeat(lines));
    let start = Instant::now();
    let parsed = parse(&sources, text);
    let time = start.elapsed();
    assert_eq!(parsed.file.statements.len() + parsed.diagnostics.len(), lines);
    time
}

#[test]
fn ten_times_the_lines_take_about_ten_times_as_long() {
    let good = "assert c: always (a[1].x > 3 m and b.y < [1, -2, 3] m/s * 2) # why\n";
    for line in [good, "let a 3\n", "a.b -> 3\n", "let a = (1\n"] {
        let (short, long) = (time(line, 500), time(line, 5_000));
        assert!(long < 40 * short, "{short:?} and {long:?} for {line:?}");
    }
}
