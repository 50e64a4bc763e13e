//! Every scenario of `scenarios/` runs, its claims hold, and its trace equals the golden one in `tests/golden/`.
//!
//! A golden trace is every n-th row of the whole trace, below 200 kB, after a comment with the SHA-256 of the whole.
//! `tests/run --update` writes them anew.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tests::flight::Flight;
use tests::program::{repository, run};

const GOLDEN_BYTES: usize = 190_000;

fn scenarios() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(repository().join("scenarios")).unwrap().map(|entry| entry.unwrap().path());
    let mut scripts: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "scn")).collect();
    scripts.sort();
    assert!(!scripts.is_empty());
    scripts
}

/// The header and as many evenly spaced rows as fit, after the hash of the whole trace.
fn decimated(trace: &str) -> String {
    let rows: Vec<_> = trace.lines().collect();
    let step = trace.len().div_ceil(GOLDEN_BYTES);
    let mut hash = String::new();
    for byte in Sha256::digest(trace.as_bytes()) {
        write!(hash, "{byte:02x}").unwrap();
    }
    let mut golden = format!("# sha256 {hash}, every {step}. of {} rows\n{}\n", rows.len() - 1, rows[0]);
    for row in rows[1..].iter().step_by(step) {
        golden.push_str(row);
        golden.push('\n');
    }
    golden
}

fn run_into(script: &Path, out: &Path, more: &[&str]) -> String {
    let arguments = ["run", script.to_str().unwrap(), "--out", out.to_str().unwrap()];
    let said = run(&repository(), &[&arguments, more].concat());
    assert_eq!(said.code, Some(0), "{}\n{}{}", script.display(), said.out, said.err);
    std::fs::read_to_string(out.join("trace.csv")).unwrap()
}

#[test]
fn every_scenario_reproduces_its_golden_trace() {
    let out = tempfile::tempdir().unwrap();
    for script in scenarios() {
        let name = script.file_stem().unwrap().to_str().unwrap().to_owned();
        let golden = decimated(&run_into(&script, &out.path().join(&name), &[]));
        let path = repository().join("tests/golden").join(&name).with_extension("csv");
        if std::env::var_os("LOCKSTEP_UPDATE").is_some() {
            std::fs::write(&path, &golden).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        let line = kept.lines().zip(golden.lines()).position(|(a, b)| a != b).map(|index| index + 1);
        assert!(kept == golden, "{name}: the trace differs from {} from its line {line:?} on", path.display());
    }
}

/// Runs a script in two ways and compares the files that must have the same bytes.
fn compare(script: &Path, ways: [&[&str]; 2]) {
    let out = tempfile::tempdir().unwrap();
    let folders = ["first", "second"].map(|folder| out.path().join(folder));
    for (folder, way) in folders.iter().zip(ways) {
        run_into(script, folder, way);
    }
    let [first, second] = folders.each_ref().map(|folder| folder.to_str().unwrap());
    let said = run(&repository(), &["diff", first, second]);
    assert_eq!(said.code, Some(0), "{} {ways:?}: {}", script.display(), said.out);
    for file in ["trace.csv", "trace.parquet", "signals.json", "verdict.json"] {
        let [first, second] = folders.each_ref().map(|folder| std::fs::read(folder.join(file)).unwrap());
        assert!(first == second, "{} {ways:?}: {file} differs", script.display());
    }
}

#[test]
fn a_repeated_run_of_a_scenario_gives_the_same_bytes() {
    scenarios().iter().for_each(|script| compare(script, [&[], &[]]));
}

#[test]
fn an_isolated_run_of_a_scenario_gives_the_same_bytes() {
    scenarios().iter().for_each(|script| compare(script, [&[], &["--isolate"]]));
}

#[test]
fn each_instance_of_an_isolated_run_has_its_own_process() {
    for script in scenarios() {
        let instances = std::fs::read_to_string(&script).unwrap().lines().filter(|l| l.starts_with("fmu ")).count();
        let out = tempfile::tempdir().unwrap();
        let arguments =
            ["run", script.to_str().unwrap(), "--isolate", "--pace", "1", "--out", out.path().to_str().unwrap()];
        let program = Flight::start(&repository(), &arguments);
        assert_eq!(program.children(instances).len(), instances, "{}", script.display());
    }
}
