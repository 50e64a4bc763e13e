//! The checkpoint files that a run leaves, and those that it does not.

use super::Supervision;
use fmi2::printable;
use results::{TraceError, shortest_decimal};
use std::fs;
use std::io::{self, Write};
use unit::time::seconds;

impl<W: Write> Supervision<'_, W> {
    /// Writes the checkpoints of a tick; those that are stored a second time have the rows that followed.
    pub(super) fn store(&mut self, tick: u64) -> Result<(), TraceError> {
        let Some(save) = self.spec.saves.iter().find(|save| save.tick == tick) else { return Ok(()) };
        let again = self.kept.contains(&tick);
        // The stepping process may replace the file at any time.
        let taken = save.file.with_extension("taken");
        match fs::rename(&save.file, &taken) {
            // What was taken for the first time had the rows already.
            Err(error) if again && error.kind() == io::ErrorKind::NotFound => return Ok(()),
            moved => moved.map_err(TraceError::io("rename", &save.file))?,
        }
        let checkpoint = fs::read(&taken).map_err(TraceError::io("read", &taken))?;
        for file in self.saving.files_at(tick) {
            self.saving.write(file, &checkpoint)?;
            if !again {
                let time = shortest_decimal(seconds(tick, self.spec.scenario.step_ns));
                self.console.say(&format!("saved {} at {time} s", printable::path(file)));
            }
        }
        if !again {
            self.kept.push(tick);
        }
        fs::remove_file(&taken).map_err(TraceError::io("remove", &taken))
    }

    /// Prints which checkpoints were not written.
    pub(super) fn report_unsaved(&mut self, last_tick: u64) {
        let time = |tick| shortest_decimal(seconds(tick, self.spec.scenario.step_ns));
        for (tick, file) in self.saving.files.iter().filter(|(tick, _)| !self.kept.contains(tick)) {
            let ended = if self.failure.is_some() { "broke" } else { "ended" };
            let why = if last_tick > *tick {
                format!("a step that was under way at {} s failed", time(*tick))
            } else {
                format!("the run {ended} at {} s and was to be saved at {} s", time(last_tick), time(*tick))
            };
            self.console.say(&format!("warning: {} was not saved: {why}", printable::path(file)));
        }
    }
}
