//! `events.csv`: when each window of the script opened and closed.

use super::TraceError;
use super::csv::quoted;
use super::run_folder::PartialFile;
use super::run_record::RunState;
use super::shortest_decimal;
use super::sink::{Event, Sink};
use serde::Serialize;
use std::io::{BufWriter, Write};

/// A window that opened or closed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WindowChange {
    /// The tick.
    pub tick: u64,
    /// Simulated seconds.
    pub time_s: f64,
    /// What happened.
    pub change: Changed,
    /// The name of the file and the line of the statement: `quad.scn:34`.
    pub statement: String,
    /// The time or condition as written.
    pub condition: String,
    /// The word before it: `at`, `when` or `while`. In `verdict.json` only, as the next.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub trigger: &'static str,
    /// What is in force in the window, each once: `set`, or the kind of a fault.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub does: Vec<&'static str>,
}

/// What happened to a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Changed {
    /// What it does is in force.
    Opened,
    /// What it did is undone.
    Closed,
}

impl Changed {
    fn text(self) -> &'static str {
        match self {
            Self::Opened => "opened",
            Self::Closed => "closed",
        }
    }
}

/// The file of a run.
#[derive(Debug)]
pub struct EventsFile(BufWriter<PartialFile>);

impl EventsFile {
    /// Begins with the header line.
    ///
    /// # Errors
    /// The file cannot be written; the error names it.
    pub fn begin(file: PartialFile) -> Result<Self, TraceError> {
        let mut events = Self(BufWriter::new(file));
        events.line("tick,time,change,statement,condition")?;
        Ok(events)
    }

    fn line(&mut self, line: &str) -> Result<(), TraceError> {
        let written = writeln!(self.0, "{line}");
        self.0.get_ref().named(written)
    }
}

impl Sink for EventsFile {
    fn event(&mut self, event: Event<'_>) -> Result<(), TraceError> {
        let Event::Window(WindowChange { tick, time_s, change, statement, condition, .. }) = event else {
            return Ok(());
        };
        let (time, change) = (shortest_decimal(*time_s), change.text());
        self.line(&format!("{tick},{time},{change},{},{}", quoted(statement), quoted(condition)))
    }

    fn save(&mut self) -> Result<(), TraceError> {
        let written = self.0.flush();
        self.0.get_ref().named(written)
    }

    fn finish(mut self: Box<Self>, _end: RunState) -> Result<(), TraceError> {
        self.save()?;
        self.0.get_ref().finish()
    }
}

#[cfg(test)]
mod tests {
    use super::super::run_folder::{EVENTS_CSV, RunFolder};
    use super::super::run_record::tests::record;
    use super::*;

    #[test]
    fn each_change_is_a_line() {
        let home = tempfile::tempdir().unwrap();
        let folder = RunFolder::claim(home.path(), &record()).unwrap();
        let mut file = Box::new(EventsFile::begin(folder.begin(EVENTS_CSV).unwrap()).unwrap());
        for (tick, change, condition) in
            [(0, Changed::Opened, "true"), (25, Changed::Closed, "true"), (30, Changed::Opened, "max(a.x, 3 m) > 2 m")]
        {
            let (statement, condition) = ("quad.scn:7".to_owned(), condition.to_owned());
            let time_s = tick as f64 * 0.01;
            let change =
                WindowChange { tick, time_s, change, statement, condition, trigger: "while", does: vec!["set"] };
            file.event(Event::Window(&change)).unwrap();
        }
        file.finish(RunState::Finished).unwrap();
        let text = std::fs::read_to_string(home.path().join(EVENTS_CSV)).unwrap();
        assert_eq!(
            text,
            "tick,time,change,statement,condition\n0,0,opened,quad.scn:7,true\n25,0.25,closed,quad.scn:7,true\n\
             30,0.3,opened,quad.scn:7,\"max(a.x, 3 m) > 2 m\"\n"
        );
    }
}
