//! `fmi-calls.NAME.log`: every call of one instance, as its process tells it.

use super::TraceError;
use super::run_folder::{PartialFile, RunFolder, call_log_name};
use std::io::{BufWriter, Write};

/// The file of one instance.
#[derive(Debug)]
pub struct CallLog {
    file: BufWriter<PartialFile>,
    /// Whether a call has begun and not yet come back.
    open: bool,
}

impl CallLog {
    /// Begins the file of an instance.
    ///
    /// # Errors
    /// If the system refuses to create it; the error names the file.
    pub fn begin(folder: &RunFolder, instance: &str) -> Result<Self, TraceError> {
        Ok(Self { file: BufWriter::new(folder.begin(&call_log_name(instance))?), open: false })
    }

    /// Adds what the process told.
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn add(&mut self, piece: &[u8]) -> Result<(), TraceError> {
        self.open = piece.last() != Some(&b'\n');
        let written = self.file.write_all(piece);
        self.file.get_ref().named(written)
    }

    /// Writes what is there.
    ///
    /// # Errors
    /// If the system refuses to write; the error names the file.
    pub fn save(&mut self) -> Result<(), TraceError> {
        let written = self.file.flush();
        self.file.get_ref().named(written)
    }

    /// Ends the file and gives it its final name.
    ///
    /// # Errors
    /// If the system refuses to write or to rename; the error names the file.
    pub fn finish(mut self) -> Result<(), TraceError> {
        if self.open {
            self.add(b"\n")?;
        }
        self.save()?;
        self.file.get_ref().finish()
    }
}
