//! Checkpoint files: the identity of the saved run and the serialized checkpoint, which another crate reads.
//!
//! ```text
//! magic │ format │ length of the content │ SHA-256 of the content │ content: version of Lockstep, identity, checkpoint
//! ```
//!
//! Numbers are little-endian; the content is serialized by postcard. All bytes are checked before use.

use super::TraceError;
use super::run_folder::PARTIAL;
use super::run_record::{Case, HashedFile, Parameter, RunRecord};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use unit::time::seconds;

/// How every checkpoint file begins.
pub const MAGIC: &[u8; 8] = b"LOCKCKPT";
/// The version of the layout.
pub const FORMAT: u32 = 5;

/// What must be equal in a run and in the saved run that it continues.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// SHA-256 of the script.
    pub script: String,
    /// The communication step.
    pub step_ns: u64,
    /// The parameters of the script.
    pub parameters: Vec<Parameter>,
    /// Number and seed of the draws of the case of the script's sweep.
    pub case: Option<(u64, Option<i64>)>,
    /// The units.
    pub units: Vec<HashedFile>,
    /// The other files that the run reads.
    pub files: Vec<HashedFile>,
}

/// Why a run cannot continue from a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CheckpointError {
    /// The file does not begin like a checkpoint file.
    NoCheckpoint,
    /// Its format has this number.
    Format(u32),
    /// Bytes are missing, changed or added.
    Damaged,
    /// Another version of Lockstep wrote it.
    Version(String),
    /// It was saved by another run.
    Different {
        /// What differs.
        differences: Vec<String>,
        /// The options of `lockstep run` that it was saved with, where nothing but parameters differs.
        settings: Vec<String>,
    },
    /// Nothing is left to run.
    AtTheEnd {
        /// The tick that it was saved at.
        tick: u64,
        /// The communication step.
        step_ns: u64,
    },
    /// Its identity is that of this run, but its content does not fit.
    Unfit,
}

impl CheckpointError {
    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::NoCheckpoint => "name a file that `lockstep run --save-at TIME FILE` wrote".to_owned(),
            Self::Version(version) => format!("continue with lockstep {version}, or save anew with --save-at"),
            Self::Different { settings, .. } if !settings.is_empty() => {
                format!("continue with {}, or save anew with --save-at", settings.join(" "))
            }
            Self::Different { .. } => "continue with what it was saved with, or save anew with --save-at".to_owned(),
            Self::AtTheEnd { .. } => "continue from an earlier checkpoint".to_owned(),
            Self::Format(_) | Self::Damaged | Self::Unfit => "save it anew with --save-at".to_owned(),
        }
    }
}

impl fmt::Display for CheckpointError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCheckpoint => f.write_str("it is no checkpoint of Lockstep"),
            Self::Format(found) => write!(f, "its format is {found}, this version of Lockstep reads format {FORMAT}"),
            Self::Damaged => f.write_str("it is damaged or incomplete"),
            Self::Version(version) => {
                write!(f, "lockstep {version} saved it, this is lockstep {}", env!("CARGO_PKG_VERSION"))
            }
            Self::Different { differences, .. } => {
                f.write_str("another run saved it")?;
                differences.iter().try_for_each(|difference| write!(f, "\n{difference}"))
            }
            Self::AtTheEnd { tick, step_ns } => {
                write!(f, "it was saved at {} s, where this run is over already", seconds(*tick, *step_ns))
            }
            Self::Unfit => f.write_str("it does not hold what a run of this script has"),
        }
    }
}

impl Identity {
    /// What identifies a run.
    #[must_use]
    pub fn of(record: &RunRecord, step_ns: u64) -> Self {
        Self {
            script: record.script.sha256.clone(),
            step_ns,
            parameters: record.parameters.clone(),
            case: record.case.map(|Case { number, draw_seed }| (number, draw_seed)),
            units: record.units.clone(),
            files: record.files.clone(),
        }
    }

    /// A checkpoint file around a serialized checkpoint.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn file_around(&self, checkpoint: &[u8]) -> Result<Vec<u8>, postcard::Error> {
        let content = postcard::to_extend(&(env!("CARGO_PKG_VERSION"), self), Vec::new())?;
        let content = [&content, checkpoint].concat();
        let length = (content.len() as u64).to_le_bytes();
        Ok([MAGIC, &FORMAT.to_le_bytes()[..], &length, &Sha256::digest(&content), &content].concat())
    }

    /// The serialized checkpoint in a file, if a run of this identity saved it.
    ///
    /// # Errors
    /// The file is no checkpoint, is damaged, or was saved by another version or run.
    pub fn checkpoint_in<'b>(&self, bytes: &'b [u8]) -> Result<&'b [u8], CheckpointError> {
        let content = content(bytes)?;
        let damaged = |_: postcard::Error| CheckpointError::Damaged;
        let (version, rest) = postcard::take_from_bytes::<&str>(content).map_err(damaged)?;
        if version != env!("CARGO_PKG_VERSION") {
            return Err(CheckpointError::Version(version.escape_debug().to_string()));
        }
        let (saved, checkpoint) = postcard::take_from_bytes::<Self>(rest).map_err(damaged)?;
        self.compare(&saved)?;
        Ok(checkpoint)
    }

    /// Returns all differences from the saved run as an error.
    fn compare(&self, saved: &Self) -> Result<(), CheckpointError> {
        let hash = |sha256: &str| format!("sha256 {}…", sha256.chars().take(12).collect::<String>().escape_debug());
        let hashes = |files: &[HashedFile]| -> Vec<_> {
            files.iter().map(|file| (file.name.clone(), hash(&file.sha256))).collect()
        };
        let values = |parameters: &[Parameter]| -> Vec<_> {
            parameters.iter().map(|parameter| (parameter.name.clone(), parameter.value.clone())).collect()
        };
        let mut differences = Vec::new();
        if self.script != saved.script {
            differences.push(format!("the script was {}, is {}", hash(&saved.script), hash(&self.script)));
        }
        differences.extend(changes("unit", &hashes(&saved.units), &hashes(&self.units)));
        differences.extend(changes("file", &hashes(&saved.files), &hashes(&self.files)));
        let (were, are) = (values(&saved.parameters), values(&self.parameters));
        let changed = changes("parameter", &were, &are);
        let settings = if differences.is_empty() {
            let case = saved.case.map(|(number, draw_seed)| {
                let seed = draw_seed.map(|seed| format!(" --set 'seed = {seed}'")).unwrap_or_default();
                format!("--case {number}{seed}")
            });
            let given =
                |name: &str| saved.case.is_none() || saved.parameters.iter().any(|it| it.set && it.name == name);
            let differing = were.iter().filter(|parameter| !are.contains(parameter) && given(&parameter.0));
            let set = differing.map(|(name, value)| format!("--set '{}'", format!("{name} = {value}").escape_debug()));
            case.into_iter().chain(set).collect()
        } else {
            Vec::new()
        };
        if self.step_ns != saved.step_ns {
            let [was, is] = [saved, self].map(|run| seconds(1, run.step_ns));
            differences.push(format!("the step was {was} s, is {is} s"));
        }
        differences.extend(changed);
        if differences.is_empty() { Ok(()) } else { Err(CheckpointError::Different { differences, settings }) }
    }
}

/// Whether there is something under a path that a checkpoint would replace and is none: a file with other content, a link,
/// a device. A folder is never replaced.
#[must_use]
pub fn is_another_file(path: &Path) -> bool {
    match fs::symlink_metadata(path) {
        Err(_) => false,
        Ok(found) if !found.is_file() => !found.is_dir(),
        Ok(_) => {
            let mut begin = [0; MAGIC.len()];
            let read = fs::File::open(path).and_then(|mut file| std::io::Read::read_exact(&mut file, &mut begin));
            read.is_err() || begin != *MAGIC
        }
    }
}

/// Checks the header and returns the content.
fn content(bytes: &[u8]) -> Result<&[u8], CheckpointError> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::NoCheckpoint)?;
    let (format, rest) = rest.split_first_chunk().ok_or(CheckpointError::Damaged)?;
    let format = u32::from_le_bytes(*format);
    if format != FORMAT {
        return Err(CheckpointError::Format(format));
    }
    let (length, rest) = rest.split_first_chunk().ok_or(CheckpointError::Damaged)?;
    let (hash, content) = rest.split_first_chunk::<32>().ok_or(CheckpointError::Damaged)?;
    let whole = u64::from_le_bytes(*length) == content.len() as u64 && *hash == *Sha256::digest(content);
    whole.then_some(content).ok_or(CheckpointError::Damaged)
}

/// The differences of one kind, by name.
fn changes(kind: &str, were: &[(String, String)], are: &[(String, String)]) -> Vec<String> {
    let value = |of: &[(String, String)], name: &str| {
        let found = of.iter().find(|(other, _)| other == name);
        found.map_or_else(|| "not there".to_owned(), |(_, value)| value.escape_debug().to_string())
    };
    let added = are.iter().filter(|(name, _)| were.iter().all(|(other, _)| other != name));
    let names = were.iter().chain(added).map(|(name, _)| (name, value(were, name), value(are, name)));
    let changed = names.filter(|(_, was, is)| was != is);
    changed.map(|(name, was, is)| format!("{kind} `{}` was {was}, is {is}", name.escape_debug())).collect()
}

/// The checkpoint files that a run is to leave.
#[derive(Clone, Debug, Default)]
pub struct Saving {
    /// The identity of the run.
    pub identity: Identity,
    /// Each with the tick after whose row it is saved.
    pub files: Vec<(u64, PathBuf)>,
}

impl Saving {
    /// The files of a tick.
    pub fn files_at(&self, tick: u64) -> impl Iterator<Item = &Path> {
        self.files.iter().filter(move |(at, _)| *at == tick).map(|(_, file)| file.as_path())
    }

    /// Writes one of the files; it gets its final name when it is complete.
    ///
    /// # Errors
    /// The file cannot be written or renamed.
    pub fn write(&self, file: &Path, checkpoint: &[u8]) -> Result<(), TraceError> {
        let mut partial = file.as_os_str().to_owned();
        partial.push(PARTIAL);
        let bytes = self.identity.file_around(checkpoint).map_err(std::io::Error::other);
        let written = bytes.and_then(|bytes| fs::write(&partial, bytes)).and_then(|()| fs::rename(&partial, file));
        written.map_err(TraceError::io("save", file))
    }
}
