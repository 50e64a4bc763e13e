//! A unit's archive: checked entry by entry before its contents are used or written.
//!
//! An archive may come from an untrusted source. It is refused if an entry would be written outside the unit's folder,
//! has the same name as another, is anything but a regular file or folder, or expands to an implausible size. Unpacking
//! writes into a new folder, which is removed if anything fails.

mod layout;
mod survey;

use super::error::UnitError;
use super::library::library_among;
use fmi2::description::check::check;
use fmi2::description::{Finding, ModelDescription, read};
use sha2::{Digest, Sha256};
use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, BufReader, Read, Seek};
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use survey::{Entry, Survey};
use zip::ZipArchive;

/// The one file that every archive must have.
const DESCRIPTION: &str = "modelDescription.xml";

/// A unit, unpacked into a folder of its own.
#[derive(Debug)]
pub struct Unpacked {
    /// The folder.
    pub folder: PathBuf,
    /// The content of its `modelDescription.xml`.
    pub description: ModelDescription,
    /// Warnings about the archive and the description.
    pub findings: Vec<Finding>,
    /// SHA-256 of the archive, as 64 hexadecimal digits.
    pub sha256: String,
}

/// A problem of an archive, without the archive's name, which the caller adds.
#[derive(Debug, PartialEq, Eq)]
struct Problem {
    entry: Option<String>,
    text: String,
}

impl Problem {
    fn new(text: impl Into<String>) -> Self {
        Self { entry: None, text: text.into() }
    }

    fn of(entry: &str, text: impl Into<String>) -> Self {
        Self { entry: Some(entry.to_owned()), text: text.into() }
    }

    fn at(self, archive: &Path) -> UnitError {
        UnitError::Archive { archive: archive.to_path_buf(), entry: self.entry, problem: self.text }
    }
}

/// Unpacks an archive into a folder that must not exist yet; only its owner gets access to it.
///
/// # Errors
/// The archive is broken or unsafe, has no readable description, or its files cannot be written. No folder is left
/// then.
pub fn unpack(fmu: &Path, into: &Path) -> Result<Unpacked, UnitError> {
    let sha256 = hash(fmu).map_err(file_error("reading", fmu))?;
    let (mut archive, survey) = open(fmu)?;
    let (description, findings) = description(&mut archive, &survey, fmu)?;
    make_folder(into).map_err(file_error("making the folder", into))?;
    match extract(&mut archive, &survey, fmu, into) {
        Ok(()) => Ok(Unpacked { folder: into.to_path_buf(), description, findings, sha256 }),
        Err(error) => {
            // An error of the removal is ignored: the first error is the one that the user can act on.
            fs::remove_dir_all(into).ok();
            Err(error)
        }
    }
}

/// Reads the description out of an archive, without unpacking anything.
///
/// # Errors
/// The archive is broken or unsafe, or has no readable description.
pub fn read_description(fmu: &Path) -> Result<(ModelDescription, Vec<Finding>), UnitError> {
    let (mut archive, survey) = open(fmu)?;
    description(&mut archive, &survey, fmu)
}

/// Reads the description of a unit that is unpacked in a folder.
///
/// # Errors
/// There is no description, or it cannot be read.
pub fn read_unpacked(folder: &Path) -> Result<ModelDescription, UnitError> {
    let path = folder.join(DESCRIPTION);
    let bytes = fs::read(&path).map_err(file_error("reading", &path))?;
    read::read(&bytes)
        .map(|(description, _)| description)
        .map_err(|finding| Problem::new(finding.to_string()).at(&path))
}

/// Reads the description of a unit that this platform can load, without unpacking anything.
///
/// # Errors
/// The archive is broken or unsafe, has no readable description, or has no library for co-simulation on this platform.
pub fn read_loadable(fmu: &Path) -> Result<(ModelDescription, Vec<Finding>), UnitError> {
    let (mut archive, survey) = open(fmu)?;
    let (description, findings) = description(&mut archive, &survey, fmu)?;
    let files = survey.entries.iter().filter(|entry| !entry.is_folder).map(|entry| &entry.name);
    let is_code = |name: &&String| name.starts_with("binaries/") || name.starts_with("sources/");
    let mut present: Vec<_> = files.filter(is_code).cloned().collect();
    present.sort();
    library_among(present, &description)?;
    Ok((description, findings))
}

/// Checks an archive by every rule of the standard: the places of its files and the content of its description.
/// Findings are sorted by position, those about the archive first. Nothing is unpacked.
///
/// # Errors
/// The archive is broken or unsafe, or has no readable description.
pub fn examine(fmu: &Path) -> Result<(ModelDescription, Vec<Finding>), UnitError> {
    let (mut archive, survey) = open(fmu)?;
    let (description, mut findings) = description(&mut archive, &survey, fmu)?;
    for entry in &survey.entries {
        contents(&mut archive, entry, &mut io::sink()).map_err(|problem| problem.at(fmu))?;
    }
    let files = survey.entries.iter().filter(|entry| !entry.is_folder).map(|entry| entry.name.as_str());
    if let Some(co_simulation) = &description.co_simulation {
        findings.extend(layout::check(&files.collect::<Vec<_>>(), &co_simulation.model_identifier));
    }
    findings.extend(check(&description));
    findings.sort_by_key(|finding| finding.position);
    Ok((description, findings))
}

/// Does everything that unpacking does with the bytes of an archive, except writing files: the target of fuzz tests.
///
/// # Errors
/// The archive is broken or unsafe, or has no readable description.
pub fn inspect(bytes: &[u8]) -> Result<(ModelDescription, Vec<Finding>), UnitError> {
    let name = Path::new("archive");
    let mut archive = ZipArchive::new(io::Cursor::new(bytes)).map_err(|error| broken(&error).at(name))?;
    let survey = Survey::of(&mut archive).map_err(|problem| problem.at(name))?;
    for entry in &survey.entries {
        contents(&mut archive, entry, &mut io::sink()).map_err(|problem| problem.at(name))?;
    }
    description(&mut archive, &survey, name)
}

fn open(fmu: &Path) -> Result<(ZipArchive<BufReader<File>>, Survey), UnitError> {
    let file = open_file(fmu).map_err(file_error("opening", fmu))?;
    let mut archive = ZipArchive::new(BufReader::new(file)).map_err(|error| broken(&error).at(fmu))?;
    let survey = Survey::of(&mut archive).map_err(|problem| problem.at(fmu))?;
    Ok((archive, survey))
}

/// Opens what is a file: a pipe would be waited for.
fn open_file(path: &Path) -> io::Result<File> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    File::open(path)
}

fn broken(error: &zip::result::ZipError) -> Problem {
    Problem::new(format!("no readable zip archive: {error}"))
}

fn description<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    survey: &Survey,
    fmu: &Path,
) -> Result<(ModelDescription, Vec<Finding>), UnitError> {
    let entry = survey.file(DESCRIPTION).map_err(|problem| problem.at(fmu))?;
    if entry.size > read::MAX_BYTES as u64 {
        let text = format!("has {} bytes; at most {} are read", entry.size, read::MAX_BYTES);
        return Err(Problem::of(DESCRIPTION, text).at(fmu));
    }
    let mut bytes = Vec::new();
    contents(archive, entry, &mut bytes).map_err(|problem| problem.at(fmu))?;
    let (description, of_description) =
        read::read(&bytes).map_err(|finding| UnitError::Description { archive: fmu.to_path_buf(), finding })?;
    let findings = survey.findings.iter().cloned().chain(of_description).collect();
    Ok((description, findings))
}

/// Writes the contents of an entry and fails if their size is not the declared one. At most one byte beyond that is
/// read, so that a false declaration cannot fill the disk.
fn contents<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    entry: &Entry,
    to: &mut impl io::Write,
) -> Result<(), Problem> {
    let cannot_read = |error: &dyn std::fmt::Display| Problem::of(&entry.name, format!("cannot be read: {error}"));
    let file = archive.by_index(entry.index).map_err(|error| cannot_read(&error))?;
    let written = io::copy(&mut file.take(entry.size + 1), to).map_err(|error| match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::FileTooLarge => {
            Problem::of(&entry.name, format!("cannot be unpacked: {error}"))
        }
        _ => cannot_read(&error),
    })?;
    if written != entry.size {
        return Err(Problem::of(&entry.name, format!("announces {} bytes, but holds {written}", entry.size)));
    }
    Ok(())
}

fn extract<R: Read + Seek>(
    archive: &mut ZipArchive<R>,
    survey: &Survey,
    fmu: &Path,
    into: &Path,
) -> Result<(), UnitError> {
    for entry in &survey.entries {
        let path = into.join(&entry.name);
        if entry.is_folder {
            make_folder_all(&path).map_err(file_error("making the folder", &path))?;
            continue;
        }
        if let Some(parent) = path.parent() {
            make_folder_all(parent).map_err(file_error("making the folder", parent))?;
        }
        let mode = if entry.executable { 0o700 } else { 0o600 };
        let opened = OpenOptions::new().write(true).create_new(true).mode(mode).open(&path);
        let mut file = opened.map_err(file_error("writing", &path))?;
        contents(archive, entry, &mut file).map_err(|problem| problem.at(fmu))?;
    }
    Ok(())
}

fn make_folder(path: &Path) -> io::Result<()> {
    DirBuilder::new().mode(0o700).create(path)
}

fn make_folder_all(path: &Path) -> io::Result<()> {
    DirBuilder::new().mode(0o700).recursive(true).create(path)
}

fn hash(path: &Path) -> io::Result<String> {
    let mut hasher = Sha256::new();
    let mut file = open_file(path)?;
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => break,
            length => hasher.update(&buffer[..length]),
        }
    }
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

fn file_error(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> UnitError {
    let path = path.to_path_buf();
    move |error| UnitError::File { doing, path, error }
}

#[cfg(test)]
mod tests;
