//! Builds the unit of `tests/foreign/` with the system's C compiler, with or without a planted fault, and packs it.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;
use zip::write::SimpleFileOptions;

/// The replacement in the description of a unit that declares that it saves its state.
pub const CLAIMS_STATES: (&str, &str) = (
    "canHandleVariableCommunicationStepSize=\"true\"",
    "canHandleVariableCommunicationStepSize=\"true\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"",
);

/// How the unit is built and packed.
#[derive(Debug)]
pub struct Foreign<'a> {
    /// Names and values for the compiler's `-D`; see `tests/foreign/unit.c`.
    pub defines: &'a [&'a str],
    /// The folder below `binaries/`.
    pub platform: &'a str,
    /// Texts of the description and their replacements.
    pub description: &'a [(&'a str, &'a str)],
}

impl Default for Foreign<'_> {
    fn default() -> Self {
        let platform = if cfg!(target_arch = "x86_64") { "linux64" } else { "aarch64-linux" };
        Self { defines: &[], platform, description: &[] }
    }
}

#[allow(clippy::unwrap_used, reason = "a test that cannot build its unit has failed")]
impl Foreign<'_> {
    /// Writes `foreign.fmu` into a temporary folder, which is removed when the returned `TempDir` is dropped.
    ///
    /// # Panics
    /// If the compiler is missing or fails, or the description lacks a text to replace.
    #[must_use]
    pub fn build(&self) -> (TempDir, PathBuf) {
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("foreign");
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("foreign.so");
        let compiled = Command::new("cc")
            .args(["-std=c11", "-D_DEFAULT_SOURCE", "-O1", "-fPIC", "-shared", "-fvisibility=hidden"])
            .args(self.defines.iter().map(|define| format!("-D{define}")))
            .arg("-o")
            .arg(&library)
            .arg(sources.join("unit.c"))
            .output()
            .unwrap();
        assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
        let mut description = fs::read_to_string(sources.join("modelDescription.xml")).unwrap();
        for (from, to) in self.description {
            assert!(description.contains(from), "{from}");
            description = description.replace(from, to);
        }
        let fmu = folder.path().join("foreign.fmu");
        let mut archive = zip::ZipWriter::new(fs::File::create(&fmu).unwrap());
        let options = SimpleFileOptions::default();
        archive.start_file("modelDescription.xml", options).unwrap();
        archive.write_all(description.as_bytes()).unwrap();
        archive.start_file(format!("binaries/{}/foreign.so", self.platform), options).unwrap();
        archive.write_all(&fs::read(&library).unwrap()).unwrap();
        archive.finish().unwrap();
        (folder, fmu)
    }
}
