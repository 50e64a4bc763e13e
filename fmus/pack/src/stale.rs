//! Determines whether a packed unit is older than its sources, without starting cargo.

use crate::UnitCrate;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The file beside an archive that lists the sources it was built from, as cargo wrote it.
pub(crate) fn source_list(archive: &Path) -> PathBuf {
    archive.with_extension("d")
}

/// Whether the archive is missing or older than a source of its unit: the files in cargo's dep-info file, the
/// manifests, the lock file, and the files packed beside the library.
#[must_use]
pub fn is_stale(unit: &UnitCrate, archive: &Path) -> bool {
    let Some(packed) = modified(archive) else { return true };
    let Ok(listed) = std::fs::read_to_string(source_list(archive)) else { return true };
    let beside = ["Cargo.toml", "README.md", "reference_in.csv", "reference.csv"].map(|file| unit.folder.join(file));
    let above = ["Cargo.toml", "Cargo.lock"].map(|file| unit.workspace.join(file));
    let optional = beside.into_iter().chain(above).any(|file| modified(&file).is_some_and(|changed| changed > packed));
    optional || sources(&listed).iter().any(|file| modified(file).is_none_or(|changed| changed > packed))
}

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|metadata| metadata.modified()).ok()
}

/// The files after the colon of a dep-info line; blanks in names are escaped by a backslash.
fn sources(dep_info: &str) -> Vec<PathBuf> {
    let Some((_, list)) = dep_info.lines().next().and_then(|line| line.split_once(": ")) else { return Vec::new() };
    let blank = '\u{0}';
    let protected = list.replace("\\ ", &blank.to_string());
    protected.split(' ').filter(|name| !name.is_empty()).map(|name| name.replace(blank, " ").into()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn names_with_blanks_in_dep_info_are_not_split() {
        assert_eq!(
            sources("/t/libx.so: /a/b.rs /a/my\\ file.rs\n"),
            [Path::new("/a/b.rs"), Path::new("/a/my file.rs")]
        );
    }

    #[test]
    fn an_archive_is_stale_once_a_listed_source_is_newer_or_missing() {
        let root = tempfile::tempdir().unwrap();
        let unit = UnitCrate { name: "x".into(), folder: root.path().into(), workspace: root.path().into() };
        let source = root.path().join("lib.rs");
        let archive = root.path().join("x.fmu");
        std::fs::write(&source, "").unwrap();
        std::fs::write(root.path().join("x.d"), format!("libx.so: {}\n", source.display())).unwrap();
        assert!(is_stale(&unit, &archive), "no archive yet");
        std::fs::write(&archive, "").unwrap();
        let later = SystemTime::now() + Duration::from_secs(5);
        std::fs::File::options().write(true).open(&archive).unwrap().set_modified(later).unwrap();
        assert!(!is_stale(&unit, &archive));
        let even_later = later + Duration::from_secs(5);
        std::fs::File::options().write(true).open(&source).unwrap().set_modified(even_later).unwrap();
        assert!(is_stale(&unit, &archive), "the source is newer");
        std::fs::remove_file(&source).unwrap();
        assert!(is_stale(&unit, &archive), "the source is gone");
    }
}
