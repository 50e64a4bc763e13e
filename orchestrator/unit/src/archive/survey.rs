//! The entries of an archive, checked by their names, kinds and sizes before any of them is read.

use super::Problem;
use fmi2::description::{Finding, Position, Severity};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek};
use zip::ZipArchive;

/// The largest number of entries.
pub const MAX_ENTRIES: usize = 10_000;
/// The largest number of bytes in all files together.
pub const MAX_BYTES: u64 = 1 << 30;
/// The largest compression ratio of an entry that unpacks to more than [`RATIO_FREE_BYTES`].
pub const MAX_RATIO: u64 = 200;
/// Up to this size any compression ratio is accepted: small files are often repetitive, and cannot fill a disk.
pub const RATIO_FREE_BYTES: u64 = 1 << 20;

/// One file or folder.
#[derive(Debug)]
pub struct Entry {
    /// Its index in the archive.
    pub index: usize,
    /// The path in the unit's folder: relative, with forward slashes, without `.` and `..`.
    pub name: String,
    /// Whether it is a folder.
    pub is_folder: bool,
    /// Its size in bytes as declared in the archive.
    pub size: u64,
    /// Whether its owner has the right to execute it.
    pub executable: bool,
}

/// The entries, in the archive's order.
#[derive(Debug)]
pub struct Survey {
    /// No two have the same name.
    pub entries: Vec<Entry>,
    /// Warnings about what is unusual but harmless.
    pub findings: Vec<Finding>,
}

impl Survey {
    /// Checks the directory of an archive.
    pub fn of<R: Read + Seek>(archive: &mut ZipArchive<R>) -> Result<Self, Problem> {
        if archive.len() > MAX_ENTRIES {
            return Err(Problem::new(format!("{} entries; at most {MAX_ENTRIES} are unpacked", archive.len())));
        }
        if archive.has_duplicate_names() {
            return Err(Problem::new("two entries have the same name"));
        }
        let mut survey = Self { entries: Vec::with_capacity(archive.len()), findings: Vec::new() };
        let mut total: u64 = 0;
        for index in 0..archive.len() {
            let Some(entry) = survey.entry(archive, index)? else { continue };
            total = total.saturating_add(entry.size);
            if total > MAX_BYTES {
                return Err(Problem::of(&entry.name, format!("brings the unit beyond {MAX_BYTES} bytes")));
            }
            survey.entries.push(entry);
        }
        survey.refuse_collisions()?;
        Ok(survey)
    }

    /// An entry; none for the unit's own folder, `./`, which is there without it.
    fn entry<R: Read + Seek>(&mut self, archive: &mut ZipArchive<R>, index: usize) -> Result<Option<Entry>, Problem> {
        let unreadable = |error: zip::result::ZipError| Problem::new(format!("entry {index} cannot be read: {error}"));
        let file = archive.by_index_raw(index).map_err(unreadable)?;
        let raw = file.name().map_err(unreadable)?.into_owned();
        let name = self.safe_name(&raw)?;
        if file.encrypted() {
            return Err(Problem::of(&raw, "is encrypted"));
        }
        // The file type bits of a Unix mode; zero where the archive was made on another system.
        const KIND: u32 = 0o170_000;
        let (folder, regular) = (0o040_000, 0o100_000);
        let mode = file.unix_mode().unwrap_or(0);
        if file.is_symlink() || ![0, folder, regular].contains(&(mode & KIND)) {
            return Err(Problem::of(&raw, "is a link or a device; only files and folders are unpacked"));
        }
        let (size, compressed) = (file.size(), file.compressed_size());
        if size > RATIO_FREE_BYTES && size / MAX_RATIO > compressed {
            let text = format!("grows from {compressed} to {size} bytes; at most {MAX_RATIO} times is believed");
            return Err(Problem::of(&raw, text));
        }
        let is_folder = file.is_dir() || raw.ends_with('\\');
        if is_folder && size > 0 {
            return Err(Problem::of(&raw, "is a folder with contents of its own"));
        }
        match (name.is_empty(), is_folder) {
            (true, false) => Err(Problem::of(&raw, "has no name")),
            (true, true) => {
                self.warn(format!("entry `{raw}` is the folder of the unit itself; leave it out"));
                Ok(None)
            }
            _ => Ok(Some(Entry { index, name, is_folder, size, executable: mode & 0o100 != 0 })),
        }
    }

    /// The name as a relative path that does not leave the unit's folder; empty for that folder itself.
    fn safe_name(&mut self, raw: &str) -> Result<String, Problem> {
        let refuse = |why: &str| Err(Problem::of(raw, why));
        let name = raw.replace('\\', "/");
        if name.contains('\0') {
            return refuse("has a zero character in its name");
        }
        if name.starts_with('/') {
            return refuse("has an absolute path");
        }
        if let [letter, b':', ..] = name.as_bytes()
            && letter.is_ascii_alphabetic()
        {
            return refuse("has a path with a drive letter");
        }
        if name.split('/').any(|part| part == "..") {
            return refuse("leads out of its folder by `..`");
        }
        let parts: Vec<_> = name.split('/').filter(|part| !["", "."].contains(part)).collect();
        let tidy = parts.join("/");
        if tidy.is_empty() {
            return Ok(tidy);
        }
        if raw.contains('\\') {
            self.warn(format!("entry `{raw}` has backslashes in its path; expected `{name}`"));
        } else if name.trim_end_matches('/') != tidy {
            self.warn(format!("entry `{raw}` has empty parts in its path; expected `{tidy}`"));
        }
        Ok(tidy)
    }

    fn warn(&mut self, message: String) {
        let (severity, position) = (Severity::Warning, Position::default());
        self.findings.push(Finding { severity, rule: "2.3", position, message });
    }

    /// Refuses entries that would be the same file, here or on a file system that ignores case, and files whose name
    /// other entries use as a folder.
    fn refuse_collisions(&self) -> Result<(), Problem> {
        let mut seen = BTreeMap::new();
        let mut folders = BTreeSet::new();
        for Entry { name, .. } in &self.entries {
            let lower = name.to_lowercase();
            folders.extend(lower.match_indices('/').map(|(at, _)| lower[..at].to_owned()));
            if let Some(other) = seen.insert(lower, name) {
                let text = if other == name {
                    "is there twice".to_owned()
                } else {
                    format!("differs from `{other}` by upper and lower case only")
                };
                return Err(Problem::of(name, text));
            }
        }
        match self.entries.iter().find(|entry| !entry.is_folder && folders.contains(&entry.name.to_lowercase())) {
            Some(entry) => Err(Problem::of(&entry.name, "is both a file and a folder")),
            None => Ok(()),
        }
    }

    /// The file of this name.
    pub fn file(&self, name: &str) -> Result<&Entry, Problem> {
        let found = |entry: &&Entry| !entry.is_folder && entry.name == name;
        self.entries.iter().find(found).ok_or_else(|| {
            let alike =
                |entry: &&Entry| entry.name.rsplit('/').next().is_some_and(|last| last.eq_ignore_ascii_case(name));
            Problem::new(match self.entries.iter().find(alike) {
                Some(entry) => format!("no `{name}` at its root; there is `{}`", entry.name),
                None => format!("no `{name}` at its root: not an FMU"),
            })
        })
    }
}
