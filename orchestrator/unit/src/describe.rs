//! Asks a freshly built library for its `modelDescription.xml`, in a process of its own.
//!
//! The export layer (`fmus/fmu`) puts `lockstep_fmu_description` beside the functions of the standard. To call it, the
//! library must be loaded, which runs foreign code: so the packager starts this program once more and reads what it says.

use libloading::os::unix::Library;
use std::path::Path;
use std::process::{Command, Stdio};

/// The hidden subcommand that [`describe_library`] starts.
pub const SUBCOMMAND: &str = "describe-library";

/// Where the export layer keeps the description.
type Description = unsafe extern "C" fn(*mut usize) -> *const u8;

/// The description that a library tells in a process of its own.
///
/// # Errors
/// Says how that process ended, or what it complained of.
pub fn describe_library(library: &Path) -> Result<String, String> {
    let program = std::env::current_exe().map_err(|error| format!("cannot find this program: {error}"))?;
    let output = Command::new(program)
        .arg(SUBCOMMAND)
        .arg(library)
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("cannot start a process for it: {error}"))?;
    if output.status.success() {
        return String::from_utf8(output.stdout).map_err(|_| "its description is not UTF-8".to_owned());
    }
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(if said.is_empty() { format!("its process ended with {}", output.status) } else { said })
}

/// The description that a library tells in this process; it stays loaded.
///
/// # Errors
/// If it cannot be loaded, or is no library of the export layer.
pub fn library_description(path: &Path) -> Result<String, String> {
    // SAFETY: loading runs the library's constructors, which is what this process is for.
    let library = unsafe { Library::new(path) }.map_err(|error| format!("it cannot be loaded: {error}"))?;
    // SAFETY: under this name the export layer exports a function of this type.
    let description = unsafe { library.get::<Description>(b"lockstep_fmu_description\0") }
        .map_err(|_| "it has no `lockstep_fmu_description`: does the crate say fmu::export!?".to_owned())?;
    let mut length = 0;
    // SAFETY: the pointer is valid for the call, as the export layer asks.
    let text = unsafe { description(&raw mut length) };
    if text.is_null() {
        return Err("it gives no description".to_owned());
    }
    // SAFETY: the export layer hands out `length` bytes that live as long as the library, which is leaked below.
    let bytes = unsafe { std::slice::from_raw_parts(text, length) };
    let text = String::from_utf8(bytes.to_vec()).map_err(|_| "its description is not UTF-8".to_owned());
    std::mem::forget(library);
    text
}
