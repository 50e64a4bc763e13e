//! What large scripts and descriptions cost, at one size and at ten times that size.
//!
//! `cargo bench -p dsl --bench scaling` shows both sizes of each text below each other: a cost that is linear grows ten
//! times. Each measurement goes from the text to what a user reads.

mod large;

use divan::{Bencher, black_box};
use fmi2::description::check::check;
use fmi2::description::read::read;
use large::{understand, units};

fn main() {
    divan::main();
}

fn measure(bencher: Bencher<'_, '_>, script: &str, ports: usize, is_good: bool) {
    let units = units(ports);
    let (is_understood, findings) = understand(script, &units);
    assert_eq!(is_understood, is_good, "{}", findings.get(..2000).unwrap_or(&findings));
    bencher.bench(|| understand(black_box(script), &units));
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn connections_of_two_units(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &large::connections_of_two_units(count), count / 2, true);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn connections_of_many_instances(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &large::connections_of_many_instances(count), 2, true);
}

#[divan::bench(args = [10_000, 100_000], sample_count = 3, sample_size = 1)]
fn lines(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &large::lines(count), 2, true);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn undefined_names(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &large::undefined_names(count), 2, false);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn duplicate_names(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &large::duplicate_names(count), 2, false);
}

#[divan::bench(args = [600, 6_000], sample_count = 3, sample_size = 1)]
fn lists_of_distances(bencher: Bencher<'_, '_>, connections: usize) {
    measure(bencher, &large::lists_of_distances(connections), connections, true);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn windows(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &large::windows(count), 2, true);
}

#[divan::bench(args = [1_000, 10_000], sample_count = 3, sample_size = 1)]
fn syntax_errors(bencher: Bencher<'_, '_>, count: usize) {
    measure(bencher, &large::syntax_errors(count), 2, false);
}

#[divan::bench(args = [10_000, 100_000], sample_count = 3, sample_size = 1)]
fn bad_variables(bencher: Bencher<'_, '_>, count: usize) {
    let description = large::bad_variables(count);
    bencher.bench(|| {
        let read = read(black_box(description.as_bytes()));
        read.map(|(model, findings)| findings.len() + check(&model).len())
    });
}
