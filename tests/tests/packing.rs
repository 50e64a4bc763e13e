//! Packed units have the same bytes whatever the path of their sources.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::{Path, PathBuf};
use std::process::Command;
use tests::program::{Said, lockstep, repository};

/// Copies the repository's tracked files, so that the copy has neither the original's path nor its build results.
fn clone_into(folder: &Path) {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(repository()).output().unwrap();
    assert!(listed.status.success(), "git lists the repository's files");
    for file in String::from_utf8(listed.stdout).unwrap().split('\0').filter(|file| !file.is_empty()) {
        let (from, to) = (repository().join(file), folder.join(file));
        std::fs::create_dir_all(to.parent().unwrap()).unwrap();
        std::fs::copy(from, to).unwrap();
    }
}

fn pack(folder: &Path, unit: &str) -> PathBuf {
    let packing =
        Command::new(lockstep()).args(["pack", unit]).current_dir(folder).env_remove("CARGO_TARGET_DIR").output();
    let said = Said::from(packing.unwrap());
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(!said.err.contains("glibc"), "our units load where glibc is 2.28: {}", said.err);
    folder.join("target/fmus").join(unit).with_extension("fmu")
}

#[test]
fn two_clones_at_different_paths_pack_the_same_bytes() {
    let root = tempfile::tempdir().unwrap();
    let archives = ["a", "a longer path/with a blank/b"].map(|place| {
        let folder = root.path().join(place);
        clone_into(&folder);
        std::fs::read(pack(&folder, "wind")).unwrap()
    });
    let [first, second] = &archives;
    assert!(!first.is_empty());
    let differ = first.iter().zip(second).position(|(a, b)| a != b);
    assert!(first == second, "archives of {} and {} bytes differ from byte {differ:?} on", first.len(), second.len());
}
