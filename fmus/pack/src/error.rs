//! Why a unit could not be packed.

use fmi2::printable;
use std::fmt;
use std::path::PathBuf;

/// Why a unit could not be packed.
#[derive(Debug)]
pub enum PackError {
    /// A file could not be read or written.
    File {
        /// The file.
        path: PathBuf,
        /// The operation, `read` or `write`.
        doing: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
    /// A `Cargo.toml` is not that of a unit crate.
    NoUnit {
        /// The manifest.
        manifest: PathBuf,
        /// What is missing.
        reason: String,
    },
    /// cargo could not be started.
    NoCargo(std::io::Error),
    /// cargo ended with an error, which it has reported on standard error.
    Build {
        /// The unit.
        unit: String,
    },
    /// cargo left no library where it is expected.
    NoLibrary {
        /// The unit.
        unit: String,
    },
    /// The library did not return its description.
    Describe {
        /// The unit.
        unit: String,
        /// Why.
        reason: String,
    },
    /// The library cannot be examined.
    Library {
        /// The unit.
        unit: String,
        /// Why.
        reason: String,
    },
    /// A new unit cannot be written.
    NewUnit {
        /// Why.
        message: String,
        /// What the user can do about it, if anything.
        help: Option<String>,
    },
    /// The description breaks rules of the standard.
    Rules {
        /// The unit.
        unit: String,
        /// The findings, one a line.
        findings: String,
    },
    /// The archive could not be written.
    Archive {
        /// The unit.
        unit: String,
        /// Why.
        reason: String,
    },
}

impl fmt::Display for PackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, doing, source } => write!(f, "cannot {doing} {}: {source}", printable::path(path)),
            Self::NoUnit { manifest, reason } => {
                write!(f, "{} is not a unit crate: {reason}", printable::path(manifest))
            }
            Self::NoCargo(source) => write!(f, "cannot start cargo, which builds units: {source}"),
            Self::Build { unit } => write!(f, "unit `{unit}` does not build; cargo says why above"),
            Self::NoLibrary { unit } => {
                write!(f, "unit `{unit}` built no library: its Cargo.toml needs `[lib] crate-type = [\"cdylib\"]`")
            }
            Self::Describe { unit, reason } => write!(f, "the library of unit `{unit}` gives no description: {reason}"),
            Self::Library { unit, reason } => write!(f, "the library of unit `{unit}` cannot be examined: {reason}"),
            Self::NewUnit { message, .. } => f.write_str(message),
            Self::Rules { unit, findings } => {
                write!(f, "the description of unit `{unit}` breaks rules of FMI 2.0.5:\n{findings}")
            }
            Self::Archive { unit, reason } => write!(f, "unit `{unit}` cannot be packed: {reason}"),
        }
    }
}

impl PackError {
    /// What the user can do about it, if anything.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::NoCargo(_) => Some(
                "https://rustup.rs installs Rust, to which cargo belongs; packed units need none: name a folder of .fmu \
                 files, --units DIR"
                    .to_owned(),
            ),
            Self::NewUnit { help, .. } => help.clone(),
            _ => None,
        }
    }
}

impl std::error::Error for PackError {}
