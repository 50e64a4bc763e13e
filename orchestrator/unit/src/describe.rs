//! Gets the `modelDescription.xml` of a newly built library, in a process of its own.
//!
//! The export layer (`fmus/fmu`) exports `lockstep_fmu_description` beside the functions of the standard. To call it,
//! the library must be loaded, which runs foreign code: so the packager starts this program again and reads its output.

use libloading::os::unix::Library;
use std::path::Path;
use std::process::{Command, Stdio};

/// The hidden subcommand that [`describe_library`] runs.
pub const SUBCOMMAND: &str = "describe-library";

/// The function by which the export layer returns the description; it stores the length in its argument.
type Description = unsafe extern "C" fn(*mut usize) -> *const u8;

/// The description of a library, read in a process of its own.
///
/// # Errors
/// The message of that process, or how it ended.
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
    let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    Err(if message.is_empty() { format!("its process ended with {}", output.status) } else { message })
}

/// The description of a library, read in this process; the library stays loaded.
///
/// # Errors
/// The library cannot be loaded, or was not built with the export layer.
pub fn library_description(path: &Path) -> Result<String, String> {
    // SAFETY: loading runs the library's constructors, which are foreign code. This process does nothing else, so a
    // crash harms nothing.
    let library = unsafe { Library::new(path) }.map_err(|error| format!("it cannot be loaded: {error}"))?;
    // SAFETY: the export layer exports a function of this type under this name.
    let description = unsafe { library.get::<Description>(b"lockstep_fmu_description\0") }
        .map_err(|_| "it has no `lockstep_fmu_description`: does the crate say fmu::export!?".to_owned())?;
    let mut length = 0;
    // SAFETY: the pointer is valid during the call, as the export layer requires.
    let text = unsafe { description(&raw mut length) };
    if text.is_null() {
        return Err("it gives no description".to_owned());
    }
    // SAFETY: the export layer returns `length` bytes that live as long as the library, which is never closed (see
    // below).
    let bytes = unsafe { std::slice::from_raw_parts(text, length) };
    let text = String::from_utf8(bytes.to_vec()).map_err(|_| "its description is not UTF-8".to_owned());
    std::mem::forget(library);
    text
}
