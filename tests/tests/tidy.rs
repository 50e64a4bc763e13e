//! The repository keeps the habits of its house.

#[test]
fn the_tree_is_tidy() {
    let findings = tests::tidy::findings(&tests::program::repository()).unwrap();
    assert!(findings.is_empty(), "{} findings:\n{}", findings.len(), findings.join("\n"));
}
