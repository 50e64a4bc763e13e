//! Scripts with mistakes: everything that users read of them, and that each fix removes its finding and adds none.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::fixtures::findings;
use dsl::diagnostic::{Diagnostic, Fix, render};

/// The scripts of the corpus with their names, sorted.
fn scripts() -> BTreeMap<String, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/broken");
    let entries = fs::read_dir(folder).expect("the corpus is there");
    let read = |path: std::path::PathBuf| {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        (name, fs::read_to_string(path).expect("a script"))
    };
    entries.map(|entry| read(entry.expect("an entry").path())).collect()
}

/// How often each finding occurs, by what it says; a message that names a line says another one after some fixes.
fn counted(found: &[Diagnostic]) -> BTreeMap<(&str, &str), usize> {
    let mut counts = BTreeMap::new();
    for diagnostic in found {
        *counts.entry((diagnostic.code, &*diagnostic.message)).or_default() += 1;
    }
    counts
}

/// What is wrong with a fix, which removes a finding and adds none.
fn check_fix(name: &str, script: &str, found: &[Diagnostic], diagnostic: &Diagnostic, fix: &Fix) -> Option<String> {
    let changed = fix.applied(script);
    let (sources, left) = findings(&changed);
    let (before, after) = (counted(found), counted(&left));
    let key = (diagnostic.code, &*diagnostic.message);
    let shown = || format!("{name}: {}: {}\n{}", diagnostic.message, fix.text, render(&sources, &left, false));
    if after.get(&key).copied().unwrap_or(0) >= before[&key] {
        return Some(format!("the finding stays: {}", shown()));
    }
    let is_known = |(finding, count): (_, usize)| before.get(&finding).is_some_and(|known| count <= *known);
    (!after.into_iter().all(is_known)).then(|| format!("a new finding: {}", shown()))
}

/// The lines of a script that a fix changes, as they are then.
fn changed_lines(script: &str, fix: &Fix) -> String {
    let changed = fix.applied(script);
    let known: Vec<_> = script.lines().collect();
    changed.lines().filter(|line| !known.contains(line)).collect::<Vec<_>>().join("\n      ")
}

#[test]
fn every_fix_removes_its_finding_and_adds_none() {
    let mut wrong = Vec::new();
    for (name, script) in scripts() {
        let (sources, found) = findings(&script);
        assert!(!found.is_empty(), "{name}: nothing is wrong");
        let mut shown = render(&sources, &found, false);
        for diagnostic in &found {
            for fix in &diagnostic.fixes {
                shown.push_str(&format!("fix: {}\n      {}\n", fix.text, changed_lines(&script, fix)));
                wrong.extend(check_fix(&name, &script, &found, diagnostic, fix));
            }
        }
        insta::assert_snapshot!(format!("broken_{name}"), shown);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_finding_of_a_broken_script_has_a_place_in_it() {
    for (name, script) in scripts() {
        for diagnostic in findings(&script).1 {
            let span = diagnostic.labels[0].span;
            assert!(span.end > 0 && span.end as usize <= script.len(), "{name}: {}", diagnostic.message);
        }
    }
}
