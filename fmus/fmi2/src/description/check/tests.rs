//! Each rule is tested by a planted mistake: a valid description with one text replaced, and the findings as shown.

mod header;
mod lists;
mod variables;

use crate::description::check::check;
use crate::description::read::read;

/// A valid description that has every element.
const GOOD: &str = include_str!("../../../corpus/description/tank.xml");

#[test]
fn a_good_description_has_no_findings() {
    assert_eq!(findings(GOOD), "");
}

/// The findings in a description, one line each.
fn findings(xml: &str) -> String {
    let (model, mut findings) = read(xml.as_bytes()).expect("the description is readable");
    findings.extend(check(&model));
    findings.iter().map(|finding| format!("{finding}\n")).collect()
}

/// Replaces in the valid description the first text of each pair by the second; returns the mistakes with their
/// findings. A mistake without a finding fails the test.
fn planted(mistakes: &[(&str, &str)]) -> String {
    let mut shown = String::new();
    for (from, to) in mistakes {
        assert_eq!(GOOD.matches(from).count(), 1, "`{from}` does not stand once in the good description");
        let found = findings(&GOOD.replace(from, to));
        assert!(!found.is_empty(), "no finding for the change of `{from}` to `{to}`");
        shown += &format!("{from}\n-> {to}\n{found}\n");
    }
    shown
}
