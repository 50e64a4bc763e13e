//! Runs the `lockstep` program as a user does, and locates it and the repository.

use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The options of a run with all instances in one process, and with each in its own process.
pub const PLACEMENTS: [&[&str]; 2] = [&[], &["--isolate"]];

/// The repository's folder.
#[must_use]
pub fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().map(Path::to_path_buf).unwrap_or_default()
}

/// The `lockstep` binary beside the running test.
///
/// # Panics
/// If it is not built; `cargo test --workspace` and `cargo build` build it.
#[must_use]
pub fn lockstep() -> PathBuf {
    let test = std::env::current_exe().unwrap_or_default();
    let binary = test.ancestors().nth(2).map(|folder| folder.join(format!("lockstep{}", std::env::consts::EXE_SUFFIX)));
    let found = binary.filter(|path| path.is_file());
    assert!(found.is_some(), "lockstep is not built: cargo build --release");
    found.unwrap_or_default()
}

/// Where tests let cargo build units outside of the repository, in the place of the user's own cache.
#[must_use]
pub fn unit_builds() -> PathBuf {
    lockstep().parent().and_then(Path::parent).map(|target| target.join("tests-cache")).unwrap_or_default()
}

/// The names in a folder, sorted.
///
/// # Panics
/// If the folder cannot be read.
#[must_use]
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder);
    assert!(entries.is_ok(), "{}: {entries:?}", folder.display());
    let mut names: Vec<_> =
        entries.into_iter().flatten().flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Exit code and output of a program.
#[derive(Debug)]
pub struct Said {
    /// Its exit code; `None` if a signal ended it.
    pub code: Option<i32>,
    /// Its standard output.
    pub out: String,
    /// Its standard error.
    pub err: String,
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8_lossy(&output.stdout).into_owned(),
            err: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// A `lockstep` command in a folder, ready for arguments.
#[must_use]
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(lockstep());
    // As where it is installed: hints show how the program was started.
    command.arg0("lockstep");
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command
}

/// Runs `lockstep` in a folder to its end.
///
/// # Panics
/// If it cannot be started.
#[must_use]
pub fn run(folder: &Path, arguments: &[&str]) -> Said {
    let output = command(folder, arguments).output();
    assert!(output.is_ok(), "cannot start lockstep: {output:?}");
    output.map(Said::from).unwrap_or_else(|_| unreachable!("asserted above"))
}
