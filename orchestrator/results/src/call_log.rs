//! `fmi-calls.NAME.log`: every call of one instance, as its process logs it.

use super::TraceError;
use super::run_folder::{PartialFile, RunFolder, call_log_name};
use super::run_record::RunState;
use super::sink::{Event, Sink};
use std::io::{BufWriter, Write};

/// The file of one instance.
#[derive(Debug)]
pub struct CallLog {
    instance: usize,
    file: BufWriter<PartialFile>,
    /// Whether a call has begun and not yet returned.
    open: bool,
}

impl CallLog {
    /// Begins the file of an instance.
    ///
    /// # Errors
    /// The file cannot be created; the error names it.
    pub fn begin(folder: &RunFolder, instance: usize, name: &str) -> Result<Self, TraceError> {
        Ok(Self { instance, file: BufWriter::new(folder.begin(&call_log_name(name))?), open: false })
    }

    fn add(&mut self, piece: &[u8]) -> Result<(), TraceError> {
        self.open = piece.last() != Some(&b'\n');
        let written = self.file.write_all(piece);
        self.file.get_ref().named(written)
    }
}

impl Sink for CallLog {
    fn event(&mut self, event: Event<'_>) -> Result<(), TraceError> {
        match event {
            Event::Calls { instance, piece } if instance == self.instance => self.add(piece),
            Event::Calls { .. } | Event::Window(_) => Ok(()),
        }
    }

    fn save(&mut self) -> Result<(), TraceError> {
        let written = self.file.flush();
        self.file.get_ref().named(written)
    }

    fn finish(mut self: Box<Self>, _end: RunState) -> Result<(), TraceError> {
        if self.open {
            self.add(b"\n")?;
        }
        self.save()?;
        self.file.get_ref().finish()
    }
}
