//! Why a unit cannot be used: the errors of its archive and of its library.

use fmi2::description::Finding;
use fmi2::printable;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a unit cannot be used.
#[derive(Debug)]
pub enum UnitError {
    /// A file of the unit cannot be read or written.
    File {
        /// What was being done.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
    /// The archive is broken or unsafe.
    Archive {
        /// The archive.
        archive: PathBuf,
        /// The entry, if the problem is about one.
        entry: Option<String>,
        /// What is wrong.
        problem: String,
    },
    /// `modelDescription.xml` cannot be read.
    Description {
        /// The archive.
        archive: PathBuf,
        /// Why.
        finding: Finding,
    },
    /// The unit has no `CoSimulation` element.
    NoCoSimulation {
        /// Whether it has a `ModelExchange` element.
        model_exchange: bool,
    },
    /// There is no library for this platform.
    NoBinary {
        /// The file that is needed, relative to the unit's folder.
        wanted: String,
        /// The files below `binaries/` and `sources/`, relative to the unit's folder.
        present: Vec<String>,
    },
    /// The system's loader refuses the library.
    Loader {
        /// The library.
        library: PathBuf,
        /// Why.
        refusal: Refusal,
    },
    /// The library lacks a function of the standard.
    NoFunction {
        /// The library.
        library: PathBuf,
        /// The function.
        symbol: &'static str,
    },
    /// The library implements another version of the standard, or uses other C types.
    Version {
        /// The library.
        library: PathBuf,
        /// The function that was called.
        function: &'static str,
        /// What it should return.
        expected: &'static str,
        /// What it returned.
        found: String,
    },
}

/// Why the system's loader refuses a library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It needs a library that this system does not have.
    MissingLibrary(String),
    /// It needs a library that is in its own folder, where the system does not look for it.
    LibraryBeside(String),
    /// It needs a symbol that no loaded library has.
    MissingSymbol(String),
    /// Anything else, as the loader's message.
    Other(String),
}

impl Refusal {
    /// Classifies the message of `dlerror` about `library`.
    pub(super) fn of(library: &Path, message: &str) -> Self {
        let (subject, rest) = message.split_once(": ").unwrap_or(("", message));
        if rest.starts_with("cannot open shared object file") && Path::new(subject) != library {
            let is_beside = library.parent().is_some_and(|folder| folder.join(subject).is_file());
            if is_beside { Self::LibraryBeside(subject.to_owned()) } else { Self::MissingLibrary(subject.to_owned()) }
        } else if let Some(symbol) = rest.strip_prefix("undefined symbol: ") {
            Self::MissingSymbol(symbol.to_owned())
        } else {
            Self::Other(message.to_owned())
        }
    }
}

impl UnitError {
    /// The message, with the unit's name where the error itself does not contain it.
    #[must_use]
    pub fn of_unit(&self, unit: &str) -> String {
        match self {
            Self::NoCoSimulation { .. } | Self::NoBinary { .. } => format!("unit `{unit}`: {self}"),
            _ => self.to_string(),
        }
    }
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { doing, path, error } => write!(f, "{doing} {}: {error}", printable::path(path)),
            Self::Archive { archive, entry: None, problem } => write!(f, "{}: {problem}", printable::path(archive)),
            Self::Archive { archive, entry: Some(entry), problem } => {
                write!(f, "{}: entry `{}` {problem}", printable::path(archive), entry.escape_debug())
            }
            Self::Description { archive, finding } => {
                write!(f, "{}: modelDescription.xml:{finding}", printable::path(archive))
            }
            Self::NoCoSimulation { model_exchange: true } => {
                f.write_str("the unit has no CoSimulation element, only model exchange")
            }
            Self::NoCoSimulation { model_exchange: false } => {
                f.write_str("its description has neither a CoSimulation nor a ModelExchange element")
            }
            Self::NoBinary { wanted, present } => no_binary(f, wanted, present),
            Self::Loader { library, refusal } => {
                let library = printable::path(library);
                match refusal {
                    Refusal::MissingLibrary(name) => {
                        write!(f, "{library} needs the library `{name}`, which this system does not have")
                    }
                    Refusal::LibraryBeside(name) => {
                        write!(
                            f,
                            "{library} needs the library `{name}`, which is in the same folder, where the system "
                        )?;
                        write!(
                            f,
                            "does not look for it: the unit should be linked with `-Wl,-rpath,'$ORIGIN'`; until "
                        )?;
                        write!(f, "then copy `{name}` to a folder that LD_LIBRARY_PATH names")
                    }
                    Refusal::MissingSymbol(name) => {
                        write!(f, "{library} needs the symbol `{name}`, which no loaded library has")
                    }
                    Refusal::Other(message) => write!(f, "{library} cannot be loaded: {message}"),
                }
            }
            Self::NoFunction { library, symbol } => {
                write!(f, "{} lacks the function `{symbol}` of FMI 2.0", printable::path(library))
            }
            Self::Version { library, function, expected, found } => {
                write!(f, "{}: {function} should answer `{expected}`, but answers `{found}`", printable::path(library))
            }
        }
    }
}

fn no_binary(f: &mut fmt::Formatter<'_>, wanted: &str, present: &[String]) -> fmt::Result {
    let (binaries, others): (Vec<_>, Vec<_>) = present.iter().partition(|name| name.starts_with("binaries/"));
    match (binaries.as_slice(), others.is_empty()) {
        ([], false) => {
            f.write_str("the unit has sources only, which Lockstep does not compile: ")?;
            write!(f, "build `{wanted}` from them and add it to the archive")
        }
        ([], true) => {
            write!(
                f,
                "the unit has no library for this platform: `{wanted}` is not there, nor any other below `binaries/`"
            )
        }
        (binaries, _) => {
            let binaries: Vec<&str> = binaries.iter().map(|name| name.as_str()).collect();
            write!(f, "the unit has no library for this platform: `{wanted}` is not there, ")?;
            write!(f, "only `{}`", binaries.join("`, `"))
        }
    }
}

impl std::error::Error for UnitError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File { error, .. } => Some(error),
            _ => None,
        }
    }
}

#[test]
fn messages_of_the_loader_are_classified() {
    let library = Path::new("/units/a.so");
    let of = |message| Refusal::of(library, message);
    assert_eq!(
        of("libpython3.11.so.1.0: cannot open shared object file: No such file or directory"),
        Refusal::MissingLibrary("libpython3.11.so.1.0".into())
    );
    assert_eq!(of("/units/a.so: undefined symbol: PyErr_Print"), Refusal::MissingSymbol("PyErr_Print".into()));
    let folder = tempfile::tempdir().unwrap();
    let beside = folder.path().join("libdep.so");
    std::fs::write(&beside, "").unwrap();
    let refusal = Refusal::of(&folder.path().join("a.so"), "libdep.so: cannot open shared object file: No such file");
    assert_eq!(refusal, Refusal::LibraryBeside("libdep.so".into()));
    for other in ["/units/a.so: cannot open shared object file: Permission denied", "/units/a.so: invalid ELF header"] {
        assert_eq!(of(other), Refusal::Other(other.into()));
    }
}
