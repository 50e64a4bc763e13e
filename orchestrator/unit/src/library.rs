//! A unit's shared library, loaded once for all of its instances.

mod conflicts;
mod functions;
mod states;

pub use conflicts::Conflict;
pub use functions::{DoStep, Functions, Get, Set};
pub(super) use states::StateFunctions;

use super::board::Note;
use super::error::{Refusal, UnitError};
use super::handles::HandleTable;
use super::variable_names::VariableNames;
use crate::failure::Doing;
use crate::process_state::{Changes, is_copy, notice_copies, preserved};
use fmi2::c::Str;
use fmi2::calls::Call;
use fmi2::description::ModelDescription;
use fmi2::platform::FOLDERS;
use libloading::os::unix as loader;
use std::ffi::{CStr, CString};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, Once, PoisonError};

/// A loaded unit. It stays loaded until the process ends: a unit may leave threads and exit handlers behind, and they
/// would crash if their code were unmapped.
#[derive(Debug)]
pub struct Library {
    pub(super) functions: Functions,
    /// The functions that save and restore states, or the first one that the library lacks.
    pub(super) states: Result<StateFunctions, Call>,
    pub(super) guid: CString,
    /// `fmuResourceLocation`: `file:///…/resources`.
    pub(super) resources: CString,
    /// `canBeInstantiatedOnlyOncePerProcess`
    pub(super) only_once: bool,
    pub(super) names: Arc<VariableNames>,
    pub(super) handles: HandleTable,
    /// The number of live instances.
    pub(super) instances: AtomicUsize,
    /// Set by `fmi2Fatal`: no function may be called any more.
    pub(super) fatal: AtomicBool,
    /// What its loading changed in the process, until that is reported.
    changes: Mutex<Changes>,
    conflicts: Vec<Conflict>,
}

impl Library {
    /// Loads the library of an unpacked unit and checks its version. Meanwhile the note names `instance`, the first
    /// instance of this unit, so that a crash in a constructor of the library is attributed to it.
    ///
    /// # Errors
    /// The unit cannot be used on this system.
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
        load_libm_globally();
        notice_copies();
        conflicts::note_program();
        let now = note.at(0, 0.0);
        let open = || {
            // RTLD_NOW: a missing symbol is an error here, not a crash at its first use in the middle of a run.
            // RTLD_LOCAL: all units export the same symbols, and none may bind to those of another.
            // SAFETY: the library's constructors are foreign code, which no check of ours makes sound. `lockstep run`
            // therefore runs units in a process that another one watches.
            unsafe { loader::Library::open(Some(&path), loader::RTLD_NOW | loader::RTLD_LOCAL) }
        };
        let (opened, changes) = now.call(instance, Doing::Load, || preserved(open));
        if is_copy() {
            note.end_copy(now.tick, instance, Doing::Load);
        }
        drop(now);
        let opened = opened.map_err(|error| refusal(&path, &error))?;
        let functions = Functions::of(&opened, &path)?;
        let states = StateFunctions::of(&opened);
        // Never closed: see the comment of `Library`.
        let conflicts = conflicts::conflicts_of(opened.into_raw(), &folder);
        check_version(&functions, &path, note, instance)?;
        Ok(Self {
            functions,
            states,
            guid: c_string(&description.guid),
            resources: c_string(&file_uri(&folder.join("resources"))),
            only_once: description
                .co_simulation
                .as_ref()
                .is_some_and(|unit| unit.can_be_instantiated_only_once_per_process),
            names: Arc::new(VariableNames::of(description)),
            handles: HandleTable(description.variables.iter().map(|variable| variable.value_reference).collect()),
            instances: AtomicUsize::new(0),
            fatal: AtomicBool::new(false),
            changes: Mutex::new(changes),
            conflicts,
        })
    }

    /// The functions, for benchmarks that measure the cost of the bare calls.
    #[must_use]
    pub fn functions(&self) -> &Functions {
        &self.functions
    }

    /// Passes on what its loading changed in the process, once.
    pub(super) fn report_changes(&self, report: impl FnOnce(Doing, Changes)) {
        let changes = std::mem::take(&mut *self.changes.lock().unwrap_or_else(PoisonError::into_inner));
        report(Doing::Load, changes);
    }

    /// The libraries that it does not get as it would in a process of its own.
    #[must_use]
    pub fn conflicts(&self) -> &[Conflict] {
        &self.conflicts
    }

    /// Whether an instance returned `fmi2Fatal`. The standard forbids any call after that, of other instances too.
    #[must_use]
    pub fn is_dead(&self) -> bool {
        // Pairs with the release store where the status is checked, possibly on another thread.
        self.fatal.load(Ordering::Acquire)
    }
}

/// The text as C has it, up to its first zero character: neither XML nor a path can contain one.
fn c_string(text: &str) -> CString {
    let end = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..end]).unwrap_or_default()
}

/// The library for this platform, from the files below `binaries/` and `sources/`.
///
/// # Errors
/// The unit does not support co-simulation, or has no such library.
pub(super) fn library_among(present: Vec<String>, description: &ModelDescription) -> Result<String, UnitError> {
    let model_exchange = description.model_exchange.is_some();
    let co_simulation = description.co_simulation.as_ref().ok_or(UnitError::NoCoSimulation { model_exchange })?;
    let file = format!("{}{}", co_simulation.model_identifier, std::env::consts::DLL_SUFFIX);
    let mut candidates = FOLDERS.iter().map(|platform| format!("binaries/{platform}/{file}"));
    candidates
        .find(|wanted| present.contains(wanted))
        .ok_or_else(|| UnitError::NoBinary { wanted: format!("binaries/{}/{file}", FOLDERS[0]), present })
}

/// The files below `binaries/`, such as `binaries/linux64/other.so`, sorted; of an empty folder, and of `sources/`, its own
/// path.
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
    if folder.join("sources").is_dir() {
        present.push("sources/".to_owned());
    }
    present
}

/// Loads `libm` with its symbols visible to all libraries: many units use `sin` or `fmin` without linking to `libm`,
/// because the program that their vendor tested them with had loaded it.
fn load_libm_globally() {
    static LOADED: Once = Once::new();
    LOADED.call_once(|| {
        // SAFETY: `libm` is part of the C library and has no constructors with side effects.
        let libm = unsafe { loader::Library::open(Some("libm.so.6"), loader::RTLD_NOW | loader::RTLD_GLOBAL) };
        // If it has another name here, loading the unit reports the missing symbol.
        libm.map(std::mem::forget).ok();
    });
}

fn refusal(path: &Path, error: &libloading::Error) -> UnitError {
    let message = match error {
        libloading::Error::DlOpen { source } => source.to_string(),
        other => other.to_string(),
    };
    UnitError::Loader { library: path.to_path_buf(), refusal: Refusal::of(path, &message) }
}

fn check_version(functions: &Functions, path: &Path, note: &Note, instance: usize) -> Result<(), UnitError> {
    for (call, function, expected) in [
        (Call::GetVersion, functions.get_version, "2.0"),
        (Call::GetTypesPlatform, functions.get_types_platform, "default"),
    ] {
        let now = note.at(0, 0.0);
        // SAFETY: the standard allows this call at any time; the function returns a constant of the library.
        let found = now.call(instance, Doing::Call(call), || unsafe { read_text(function()) });
        drop(now);
        if found != expected {
            let (library, function) = (path.to_path_buf(), call.name());
            return Err(UnitError::Version { library, function, expected, found });
        }
    }
    Ok(())
}

/// A copy of a string that a unit returned.
///
/// # Safety
/// `text` is NULL or ends in a zero byte.
unsafe fn read_text(text: Str) -> String {
    if text.is_null() {
        return "NULL".to_owned();
    }
    // SAFETY: guaranteed by the caller.
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
fn a_resource_uri_has_three_slashes_and_escapes_special_characters() {
    assert_eq!(file_uri(Path::new("/tmp/my units/50%/ü.d")), "file:///tmp/my%20units/50%25/%C3%BC.d");
}
