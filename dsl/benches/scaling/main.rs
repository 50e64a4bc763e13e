//! What large scripts and descriptions cost, at one size and at ten times that size.
//!
//! `cargo bench -p dsl --bench scaling` shows both sizes of each text below each other: a cost that is linear grows ten
//! times. Each measurement goes from the text to what a user reads.

mod texts;

use std::sync::Arc;

use divan::{Bencher, black_box};
use dsl::diagnostic::render;
use dsl::parse::parse;
use dsl::resolve::{Request, Units, resolve};
use dsl::source::Sources;
use fmi2::description::check::check;
use fmi2::description::read::read;

fn main() {
    divan::main();
}

/// Units with two ports and with so many.
fn units(ports: usize) -> Units {
    let unit = |ports| match read(texts::description(ports).as_bytes()) {
        Ok((description, _)) => Arc::new(description),
        Err(finding) => panic!("the description of {ports} ports: {finding}"),
    };
    Units::from([("small".to_owned(), Ok(unit(2))), ("large".to_owned(), Ok(unit(ports)))])
}

/// From a script's text to its findings as a user reads them, or to its scenario.
fn understand(script: &str, units: &Units) -> (bool, String) {
    let mut sources = Sources::default();
    let text = sources.add("large.scn", script);
    let parsed = parse(&sources, text);
    if !parsed.diagnostics.is_empty() {
        return (false, render(&sources, &parsed.diagnostics, false));
    }
    let resolved = resolve(&Request { sources: &sources, file: &parsed.file, units, settings: &[] });
    (resolved.scenario.is_some(), render(&sources, &resolved.diagnostics, false))
}

fn measure(bencher: Bencher<'_, '_>, script: &str, ports: usize, is_good: bool) {
    let units = units(ports);
    let (is_understood, findings) = understand(script, &units);
    assert_eq!(is_understood, is_good, "{}", findings.get(..2000).unwrap_or(&findings));
    bencher.bench(|| understand(black_box(script), &units));
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn connections_of_two_units(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &texts::connections_of_two_units(count), count, true);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn connections_of_many_instances(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &texts::connections_of_many_instances(count), 2, true);
}

#[divan::bench(args = [10_000, 100_000], sample_count = 3, sample_size = 1)]
fn lines(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &texts::lines(count), 2, true);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn undefined_names(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &texts::undefined_names(count), 2, false);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn duplicate_names(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &texts::duplicate_names(count), 2, false);
}

#[divan::bench(args = [600, 6_000], sample_count = 3, sample_size = 1)]
fn lists_of_distances(bencher: Bencher<'_, '_>, connections: usize) {
    measure(bencher, &texts::lists_of_distances(connections), connections, true);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn windows(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &texts::windows(count), 2, true);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn syntax_errors(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &texts::syntax_errors(count), 2, false);
}

#[divan::bench(args = [10_000, 100_000], sample_count = 3, sample_size = 1)]
fn bad_variables(bencher: Bencher<'_, '_>, count: usize) {
    let description = texts::bad_variables(count);
    bencher.bench(|| {
        let read = read(black_box(description.as_bytes()));
        read.map(|(model, findings)| findings.len() + check(&model).len())
    });
}
