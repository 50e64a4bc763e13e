//! A unit's dynamic library, loaded once for all of its instances.

mod functions;
mod process_state;
mod states;

pub use functions::{DoStep, Functions, Get, Set};
pub(super) use process_state::preserved;
pub(super) use states::StateFunctions;

use super::board::Note;
use super::error::{Refusal, UnitError};
use super::variable_names::VariableNames;
use crate::failure::Doing;
use fmi2::c::Str;
use fmi2::calls::Call;
use fmi2::description::ModelDescription;
use fmi2::platform::FOLDERS;
use libloading::os::unix as loader;
use std::ffi::{CStr, CString};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Once};

/// A loaded unit. It stays loaded until the process ends: units leave threads and exit handlers behind, which must not
/// find their code gone.
#[derive(Debug)]
pub struct Library {
    pub(super) functions: Functions,
    /// Those that save and restore states, or the first that the library lacks.
    pub(super) states: Result<StateFunctions, Call>,
    pub(super) guid: CString,
    /// `file:///…/resources`
    pub(super) resources: CString,
    pub(super) only_once: bool,
    pub(super) names: Arc<VariableNames>,
    /// How many instances there are.
    pub(super) instances: AtomicUsize,
    /// Set by `fmi2Fatal`: no function may be called any more.
    pub(super) fatal: AtomicBool,
}

impl Library {
    /// Loads the library of an unpacked unit and asks it for its version. Meanwhile the note says that `instance`, the
    /// first that needs it, is being loaded.
    ///
    /// # Errors
    /// Whatever keeps this system from using the unit.
    pub fn load(
        folder: &Path,
        description: &ModelDescription,
        note: &Note,
        instance: usize,
    ) -> Result<Self, UnitError> {
        let folder = fs::canonicalize(folder).map_err(|error| UnitError::File {
            doing: "looking for the unit's folder",
            path: folder.to_path_buf(),
            error,
        })?;
        let path = folder.join(library_among(present_libraries(&folder), description)?);
        offer_libm();
        let now = note.at(0, 0.0);
        now.enter(instance, Doing::Load);
        let opened = preserved(|| {
            // SAFETY: the library's constructors are foreign code; that it may do anything is why this process has a
            // parent that watches over it.
            unsafe { loader::Library::open(Some(&path), loader::RTLD_NOW | loader::RTLD_LOCAL) }
        });
        drop(now);
        let opened = opened.map_err(|error| refusal(&path, &error))?;
        let functions = Functions::of(&opened, &path)?;
        let states = StateFunctions::of(&opened);
        // Never closed, see the type's comment.
        std::mem::forget(opened);
        check_answers(&functions, &path, note, instance)?;
        Ok(Self {
            functions,
            states,
            guid: text(&description.guid),
            resources: text(&file_uri(&folder.join("resources"))),
            only_once: description
                .co_simulation
                .as_ref()
                .is_some_and(|unit| unit.can_be_instantiated_only_once_per_process),
            names: Arc::new(VariableNames::of(description)),
            instances: AtomicUsize::new(0),
            fatal: AtomicBool::new(false),
        })
    }

    /// The functions, for whoever measures what the calls alone cost.
    #[must_use]
    pub fn functions(&self) -> &Functions {
        &self.functions
    }

    /// Whether an instance returned `fmi2Fatal`, after which no function may be called any more.
    #[must_use]
    pub fn is_dead(&self) -> bool {
        self.fatal.load(Ordering::Acquire)
    }
}

/// XML cannot hold a zero character, and a path cannot either; if one came from elsewhere the text ends there.
fn text(text: &str) -> CString {
    let until = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..until]).unwrap_or_default()
}

/// The library for this platform among the files below `binaries/`.
///
/// # Errors
/// The unit is not made for co-simulation, or brings no such library.
pub(super) fn library_among(present: Vec<String>, description: &ModelDescription) -> Result<String, UnitError> {
    let co_simulation = description.co_simulation.as_ref().ok_or(UnitError::NoCoSimulation)?;
    let file = format!("{}{}", co_simulation.model_identifier, std::env::consts::DLL_SUFFIX);
    let mut candidates = FOLDERS.iter().map(|platform| format!("binaries/{platform}/{file}"));
    candidates
        .find(|wanted| present.contains(wanted))
        .ok_or_else(|| UnitError::NoBinary { wanted: format!("binaries/{}/{file}", FOLDERS[0]), present })
}

/// `linux64/other.so` and so on, sorted.
fn present_libraries(folder: &Path) -> Vec<String> {
    let names = |folder: &Path| -> Vec<String> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut names: Vec<_> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    let binaries = folder.join("binaries");
    let mut present = Vec::new();
    for platform in names(&binaries) {
        match names(&binaries.join(&platform)).as_slice() {
            [] => present.push(format!("binaries/{platform}/")),
            files => present.extend(files.iter().map(|file| format!("binaries/{platform}/{file}"))),
        }
    }
    present
}

/// Many units use `sin` or `fmin` without linking the library that has them.
fn offer_libm() {
    static OFFERED: Once = Once::new();
    OFFERED.call_once(|| {
        // SAFETY: the C library's own mathematics has no constructor that disturbs anything.
        let libm = unsafe { loader::Library::open(Some("libm.so.6"), loader::RTLD_NOW | loader::RTLD_GLOBAL) };
        // Where it has another name the unit says which symbol it misses.
        libm.map(std::mem::forget).ok();
    });
}

fn refusal(path: &Path, error: &libloading::Error) -> UnitError {
    let said = match error {
        libloading::Error::DlOpen { source } => source.to_string(),
        other => other.to_string(),
    };
    UnitError::Loader { library: path.to_path_buf(), refusal: Refusal::of(path, &said) }
}

fn check_answers(functions: &Functions, path: &Path, note: &Note, instance: usize) -> Result<(), UnitError> {
    for (call, function, expected) in [
        (Call::GetVersion, functions.get_version, "2.0"),
        (Call::GetTypesPlatform, functions.get_types_platform, "default"),
    ] {
        let now = note.at(0, 0.0);
        now.enter(instance, Doing::Call(call));
        // SAFETY: the function may be called at any time, and answers a constant of the library.
        let answer = unsafe { read_text(function()) };
        drop(now);
        if answer != expected {
            let (library, function) = (path.to_path_buf(), call.name());
            return Err(UnitError::Version { library, function, expected, found: answer });
        }
    }
    Ok(())
}

/// A copy of a text that a unit answered.
///
/// # Safety
/// `text` is NULL or ends in a zero byte.
unsafe fn read_text(text: Str) -> String {
    if text.is_null() {
        return "NULL".to_owned();
    }
    // SAFETY: the caller says so.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// The absolute path as a URI of RFC 3986.
fn file_uri(path: &Path) -> String {
    use std::os::unix::ffi::OsStrExt;
    let mut uri = String::from("file://");
    for &byte in path.as_os_str().as_bytes() {
        if byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

#[test]
fn a_resource_uri_has_three_slashes_and_no_foreign_characters() {
    assert_eq!(file_uri(Path::new("/tmp/my units/50%/ü.d")), "file:///tmp/my%20units/50%25/%C3%BC.d");
}
