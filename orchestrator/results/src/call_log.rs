//! `fmi-calls.NAME.log`: every call of one instance, as its process logs it.

use super::TraceError;
use super::run_folder::{PartialFile, RunFolder, call_log_name};
use std::io::{BufWriter, Write};

/// The file of one instance.
#[derive(Debug)]
pub struct CallLog {
    file: BufWriter<PartialFile>,
    /// Whether a call has begun and not yet returned.
    open: bool,
}

impl CallLog {
    /// Begins the file of an instance.
    ///
    /// # Errors
    /// The file cannot be created; the error names it.
    pub fn begin(folder: &RunFolder, instance: &str) -> Result<Self, TraceError> {
        Ok(Self { file: BufWriter::new(folder.begin(&call_log_name(instance))?), open: false })
    }

    /// Adds a piece of the log.
    ///
    /// # Errors
    /// The file cannot be written; the error names it.
    pub fn add(&mut self, piece: &[u8]) -> Result<(), TraceError> {
        self.open = piece.last() != Some(&b'\n');
        let written = self.file.write_all(piece);
        self.file.get_ref().named(written)
    }

    /// Writes all buffered data.
    ///
    /// # Errors
    /// The file cannot be written; the error names it.
    pub fn save(&mut self) -> Result<(), TraceError> {
        let written = self.file.flush();
        self.file.get_ref().named(written)
    }

    /// Ends the file and gives it its final name.
    ///
    /// # Errors
    /// The file cannot be written or renamed; the error names it.
    pub fn finish(mut self) -> Result<(), TraceError> {
        if self.open {
            self.add(b"\n")?;
        }
        self.save()?;
        self.file.get_ref().finish()
    }
}
