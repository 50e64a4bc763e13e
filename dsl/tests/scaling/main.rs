//! Large scripts and descriptions: each test takes well below a second, and minutes where a cost grows with the square of a
//! size.

#[path = "../../benches/scaling/large.rs"]
mod large;

use fmi2::description::check::check;
use fmi2::description::read::read;
use large::{understand, units};

/// The last line of what a user reads of a script's mistakes.
fn last_line(script: &str) -> String {
    let (is_good, findings) = understand(script, &units(2));
    assert!(!is_good, "this script has no mistake");
    findings.trim_end().lines().last().unwrap_or_default().to_owned()
}

fn is_good(script: &str, ports: usize) {
    let (is_good, findings) = understand(script, &units(ports));
    assert!(is_good, "{findings}");
}

#[test]
fn connections_cost_as_much_as_they_are() {
    is_good(&large::connections_of_two_units(6_000), 3_000);
    is_good(&large::connections_of_many_instances(4_000), 2);
}

#[test]
fn names_and_claims_cost_as_much_as_their_lines() {
    is_good(&large::lines(20_000), 2);
}

#[test]
fn connections_cost_nothing_for_names_that_they_do_not_use() {
    is_good(&large::lists_of_distances(300), 300);
}

#[test]
fn windows_over_one_input_cost_as_much_as_they_are() {
    is_good(&large::windows(6_000), 2);
}

#[test]
fn undefined_names_cost_as_much_as_they_are() {
    assert_eq!(last_line(&large::undefined_names(8_000)), "... and 7,900 more errors");
}

#[test]
fn duplicate_names_cost_as_much_as_they_are() {
    assert_eq!(last_line(&large::duplicate_names(20_000)), "... and 19,899 more errors");
}

#[test]
fn syntax_errors_cost_as_much_as_they_are() {
    assert_eq!(last_line(&large::syntax_errors(20_000)), "... and 19,900 more errors");
}

#[test]
fn mistakes_of_a_description_cost_as_much_as_they_are() {
    let description = large::bad_variables(50_000);
    let (model, odd) = read(description.as_bytes()).expect("a description that can be read");
    assert_eq!((model.variables.len(), odd.len()), (50_000, 1_001));
    assert!(check(&model).len() >= 100_000);
}
