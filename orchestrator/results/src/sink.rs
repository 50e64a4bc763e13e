//! The trait of those that take what a run yields: each format of the results, and the live values.

use super::TraceError;
use super::events::WindowChange;
use super::run_record::RunState;
use std::fmt::Debug;

/// What happens during a run besides its rows.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// The next piece of the log of an instance's calls.
    Calls {
        /// The instance.
        instance: usize,
        /// Text that may end within a line.
        piece: &'a [u8],
    },
    /// A window of the script opened or closed.
    Window(&'a WindowChange),
}

/// Takes the rows and events of a run. After an error it is called no more: it is dropped, as every sink of a run whose
/// results cannot be written.
pub trait Sink: Debug {
    /// Takes the row of a tick: one slot for each signal but the time, the bits of a Real, else the number widened.
    ///
    /// # Errors
    /// The file of the sink cannot be written; the error names it.
    fn row(&mut self, _tick: u64, _slots: &[u64]) -> Result<(), TraceError> {
        Ok(())
    }

    /// Takes an event.
    ///
    /// # Errors
    /// The file of the sink cannot be written; the error names it.
    fn event(&mut self, _event: Event<'_>) -> Result<(), TraceError> {
        Ok(())
    }

    /// Writes all buffered data, if its file stays readable after a crash of this process.
    ///
    /// # Errors
    /// The file of the sink cannot be written; the error names it.
    fn save(&mut self) -> Result<(), TraceError> {
        Ok(())
    }

    /// The run has ended so: its file is complete and gets its final name.
    ///
    /// # Errors
    /// The file of the sink cannot be written or renamed; the error names it.
    fn finish(self: Box<Self>, end: RunState) -> Result<(), TraceError>;
}
