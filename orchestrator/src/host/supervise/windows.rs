//! Windows that opened and closed, as results show them.

use super::Supervision;
use flatten::event_words;
use flatten::wiring::Change;
use results::TraceError;
use results::events::{Changed, WindowChange};
use results::sink::Event;
use std::io::Write;
use unit::time::seconds;

impl<W: Write> Supervision<'_, W> {
    /// Records that a window opened or closed.
    pub(super) fn window(&mut self, change: Change) -> Result<(), TraceError> {
        let scenario = &self.spec.scenario;
        let Some(event) = scenario.events.get(change.event) else { return Ok(()) };
        let change = WindowChange {
            tick: change.tick,
            time_s: seconds(change.tick, scenario.step_ns),
            change: if change.opened { Changed::Opened } else { Changed::Closed },
            statement: event.statement.clone(),
            condition: event.condition.clone(),
            trigger: event_words::trigger(event),
            does: event_words::does(event),
        };
        let recorded = self.recorder.event(Event::Window(&change));
        self.events.push(change);
        recorded
    }
}
