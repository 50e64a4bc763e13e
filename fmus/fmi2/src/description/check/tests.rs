//! Each rule has a planted mistake: a good description, one text replaced in it, and the findings as a user sees them.

mod header;
mod lists;
mod variables;

use crate::description::check::check;
use crate::description::read::read;

/// A description without a mistake that has every element.
const GOOD: &str = include_str!("../../../corpus/description/tank.xml");

#[test]
fn a_good_description_has_no_findings() {
    assert_eq!(findings(GOOD), "");
}

/// What is found in a description, a line for each finding.
fn findings(xml: &str) -> String {
    let (model, mut findings) = read(xml.as_bytes()).expect("the description is readable");
    findings.extend(check(&model));
    findings.iter().map(|finding| format!("{finding}\n")).collect()
}

/// For each pair the good description is changed from the one text to the other; the answer shows the mistakes with what was
/// found. A mistake that goes unseen fails the test.
fn planted(mistakes: &[(&str, &str)]) -> String {
    let mut shown = String::new();
    for (from, to) in mistakes {
        assert_eq!(GOOD.matches(from).count(), 1, "`{from}` does not stand once in the good description");
        let found = findings(&GOOD.replace(from, to));
        assert!(!found.is_empty(), "nobody sees that `{from}` became `{to}`");
        shown += &format!("{from}\n-> {to}\n{found}\n");
    }
    shown
}
