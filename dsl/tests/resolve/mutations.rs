//! Changed scripts: nothing panics, hangs, or is an error without a place. `LOCKSTEP_MUTATIONS=1000000` tries that many.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use super::fixtures::findings;
use dsl::diagnostic::{Diagnostic, render};
use dsl::format::format;
use dsl::source::Sources;

/// How many scripts each run of the tests tries.
const MUTATIONS: u64 = 2_000;
/// What a script of this size never takes, on a busy machine either.
const HANGS: Duration = Duration::from_secs(1);
const SIGNS: [&str; 40] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    "#",
    "\n",
    "\r\n",
    " ",
    ",",
    ":",
    ".",
    "..",
    "->",
    "=>",
    "=",
    "==",
    "<",
    "±",
    "+",
    "-",
    "*",
    "/",
    "^",
    "²",
    "°",
    "é",
    "\u{0}",
    "1e999",
    "-1",
    "0",
    "4294967296",
    "2 m/s*k",
    "1 degC",
    "seed",
    "not ",
    "always ",
];

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

/// Every script of the corpus that is UTF-8: good ones, broken ones, and what once was answered wrongly.
fn corpus() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    let folders = ["good", "parse", "broken"].map(|inner| folder.join(inner));
    let mut files: Vec<_> = folders
        .iter()
        .flat_map(|folder| fs::read_dir(folder).expect("the corpus is there").flatten().map(|entry| entry.path()))
        .collect();
    files.sort();
    files.iter().filter_map(|file| fs::read_to_string(file).ok()).collect()
}

/// A text in words, blanks and signs.
fn tokens(text: &str) -> Vec<String> {
    let class = |letter: char| match letter {
        '_' => 0,
        letter if letter.is_alphanumeric() => 0,
        ' ' => 1,
        _ => 2,
    };
    let letters: Vec<_> = text.chars().collect();
    letters.chunk_by(|a, b| class(*a) == class(*b) && class(*a) < 2).map(|part| part.iter().collect()).collect()
}

/// A script with a few changes.
fn mutated(tokens: &[String], words: &[String], random: &mut Random) -> String {
    let mut changed = tokens.to_vec();
    for _ in 0..=random.below(4) {
        let (at, other) = (random.below(changed.len()), random.below(changed.len()));
        match random.below(7) {
            0 => drop(changed.remove(at)),
            1 => changed.swap(at, other),
            2 => changed[at] = words[random.below(words.len())].clone(),
            3 => changed.insert(at, SIGNS[random.below(SIGNS.len())].to_owned()),
            4 => changed[at] = SIGNS[random.below(SIGNS.len())].to_owned(),
            5 => {
                let end = (at + random.below(20)).min(changed.len());
                drop(changed.drain(at..end));
            }
            _ => {
                let end = (at + random.below(60)).min(changed.len());
                let copy = changed[at..end].to_vec();
                drop(changed.splice(other..other, copy));
            }
        }
        if changed.is_empty() {
            break;
        }
    }
    changed.concat()
}

/// Fails with the script if it is not answered as it should be.
fn check(script: &str) {
    let start = Instant::now();
    let (sources, found) = findings(script);
    for diagnostic in &found {
        let span = diagnostic.labels.first().map(|label| label.span);
        let is_placed = span.is_some_and(|span| span.start <= span.end && span.end as usize <= sources.text(0).len());
        assert!(is_placed, "{} has no place in:\n{script}", diagnostic.message);
        for fix in &diagnostic.fixes {
            assert_ne!(fix.applied(sources.text(0)), sources.text(0), "`{}` changes nothing in:\n{script}", fix.text);
        }
    }
    if let Ok(once) = format(&sources, 0) {
        let mut again = Sources::default();
        let text = again.add("a.scn", &*once);
        assert_eq!(format(&again, text).as_ref(), Ok(&once), "formatted twice:\n{script}");
    }
    assert!(start.elapsed() < HANGS, "{:?} for:\n{script}", start.elapsed());
}

#[test]
fn changed_scripts_are_answered_at_once_and_every_error_has_a_place() {
    let count = std::env::var("LOCKSTEP_MUTATIONS").ok().and_then(|count| count.parse().ok()).unwrap_or(MUTATIONS);
    let scripts: Vec<_> = corpus().iter().map(|text| tokens(text)).collect();
    let words: Vec<_> = scripts.iter().flatten().cloned().collect();
    assert!(scripts.len() > 15, "the corpus is there");
    let is_answered = |seed: &u64| {
        let mut random = Random(*seed);
        let script = mutated(&scripts[random.below(scripts.len())], &words, &mut random);
        std::panic::catch_unwind(|| check(&script)).is_ok()
    };
    let wrong: Vec<u64> = (0..count).filter(|seed| !is_answered(seed)).take(10).collect();
    assert!(wrong.is_empty(), "the first mutations that are answered wrongly: {wrong:?}");
}

#[test]
fn every_script_of_the_corpus_is_answered() {
    corpus().iter().for_each(|script| check(script));
}

#[test]
fn the_good_scripts_of_the_corpus_are_good() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/good");
    let mut scripts = 0;
    for file in fs::read_dir(folder).expect("the corpus is there").flatten() {
        let (sources, found) = findings(&fs::read_to_string(file.path()).expect("the script"));
        assert!(!found.iter().any(Diagnostic::is_error), "{}", render(&sources, &found, false));
        scripts += 1;
    }
    assert!(scripts >= 2, "the corpus is there");
}
