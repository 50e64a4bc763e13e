//! Every dependency has a licence that is compatible with ours, and no banned package is among them.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::process::Command;
use tests::program::repository;

/// Licences under which a package may be used; the MPL's terms concern changes of its own files, which we do not make.
const LICENCES: [&str; 13] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT-0",
    "MPL-2.0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Banned packages: generators that need libclang, and a second implementation of functions of another dependency.
const BANNED: [&str; 3] = ["bindgen", "clang-sys", "fmi"];

fn packages() -> Vec<Value> {
    let arguments = ["metadata", "--format-version", "1", "--locked", "--filter-platform", "x86_64-unknown-linux-gnu"];
    let output = Command::new(env!("CARGO")).args(arguments).current_dir(repository()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

/// Whether a licence expression is allowed: `OR` needs one side; `AND`, which binds tighter, needs both.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.trim();
    match (split_at_operator(expression, " OR "), split_at_operator(expression, " AND ")) {
        (Some((left, right)), _) => is_allowed(left) || is_allowed(right),
        (None, Some((left, right))) => is_allowed(left) && is_allowed(right),
        (None, None) => match expression.strip_prefix('(').and_then(|inside| inside.strip_suffix(')')) {
            Some(inside) => is_allowed(inside),
            None => LICENCES.contains(&expression),
        },
    }
}

/// Both sides of the first `word` outside parentheses.
fn split_at_operator<'e>(expression: &'e str, word: &str) -> Option<(&'e str, &'e str)> {
    let outside = |at: &usize| {
        let before = &expression[..*at];
        before.matches('(').count() == before.matches(')').count()
    };
    let at = expression.match_indices(word).map(|(at, _)| at).find(outside)?;
    Some((&expression[..at], &expression[at + word.len()..]))
}

#[test]
fn every_dependency_has_a_compatible_licence() {
    let packages = packages();
    assert!(packages.len() > 20, "cargo lists {} packages", packages.len());
    for package in packages {
        let licence = package["license"].as_str().unwrap_or_default().replace('/', " OR ");
        assert!(is_allowed(&licence), "{} {}: licence {licence:?}", package["name"], package["version"]);
    }
}

#[test]
fn no_banned_package_is_among_the_dependencies() {
    for package in packages() {
        assert!(!BANNED.contains(&package["name"].as_str().unwrap()), "{} is banned", package["name"]);
    }
}

#[test]
fn an_expression_is_allowed_by_one_of_its_alternatives() {
    assert!(is_allowed("MIT OR GPL-3.0"));
    assert!(is_allowed("(MIT OR Apache-2.0) AND Unicode-3.0"));
    assert!(!is_allowed("(MIT OR Apache-2.0) AND GPL-3.0"));
    assert!(!is_allowed("GPL-3.0"));
    assert!(!is_allowed("MIT AND GPL-3.0"));
    assert!(!is_allowed(""));
}
