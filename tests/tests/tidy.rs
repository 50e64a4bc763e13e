//! The repository follows its house style.

#[test]
fn the_tree_has_no_violations() {
    let findings = tests::tidy::findings(&tests::program::repository()).unwrap();
    assert!(findings.is_empty(), "{} findings:\n{}", findings.len(), findings.join("\n"));
}
