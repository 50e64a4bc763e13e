//! What is looked at after a call besides its status: whether it changed its process, and whether it returned twice.

use super::Instance;
use crate::board::Now;
use crate::failure::Doing;
use crate::logger::{LogMessage, LogSink};
use crate::process_state::{Changes, compares_each_call, is_copy, restored_floating_point};
use fmi2::calls::Call;
use std::fmt::Display;

/// Reports what a unit does wrong although its calls succeed, each kind once.
pub(super) struct Warnings {
    index: usize,
    sink: LogSink,
    /// Whether a call has returned `fmi2Warning`.
    status: bool,
    /// The changes of its process that were reported.
    changes: Changes,
    /// A change that was found after a step and is not reported yet.
    unnamed: Option<Unnamed>,
}

/// A change by a step or by a call that set values for it; the next call that changes something names it.
#[derive(Debug)]
struct Unnamed {
    tick: u64,
    counts_at: u64,
    changes: Changes,
}

impl std::fmt::Debug for Warnings {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { status, changes, unnamed, .. } = self;
        f.debug_struct("Warnings").field("status", status).field("changes", changes).field("unnamed", unnamed).finish()
    }
}

impl Warnings {
    pub fn new(index: usize, sink: LogSink) -> Self {
        Self { index, sink, status: false, changes: Changes::NONE, unnamed: None }
    }

    /// Logs a warning.
    pub fn warn(&self, when: (u64, u64), text: String) {
        (self.sink)(LogMessage::warning(self.index, when, text));
    }

    /// A call returned a warning: the reason is in the unit's own log messages, if any.
    pub fn status(&mut self, now: &Now<'_>, call: Call) {
        if !std::mem::replace(&mut self.status, true) {
            let text = format!("{} returned fmi2Warning (reported once; the run goes on)", call.name());
            self.warn((now.tick, now.counts_at), text);
        }
    }

    /// Something changed the process and was restored. All of floating-point control counts as one kind.
    pub fn changed(&mut self, now: &Now<'_>, by: impl Display, changes: Changes) {
        self.changed_at((now.tick, now.counts_at), by, changes);
    }

    fn changed_at(&mut self, when: (u64, u64), by: impl Display, changes: Changes) {
        let mut changes = changes.without(self.changes);
        if self.reported_floating_point() {
            changes = changes.without(Changes::FLOATING_POINT);
        }
        if changes != Changes::NONE {
            self.changes |= changes;
            self.warn(when, format!("{by} changed {changes} of its process: restored (reported once)"));
        }
    }

    /// Reports a change of floating-point control: the earlier one that has no name yet, or this one.
    fn floating_point(&mut self, now: &Now<'_>, doing: Doing, changes: Changes) {
        let unnamed = Unnamed { tick: now.tick, counts_at: now.counts_at, changes };
        let Unnamed { tick, counts_at, changes } = self.unnamed.take().unwrap_or(unnamed);
        self.changed_at((tick, counts_at), doing, changes);
    }

    /// Whether a change of floating-point control was reported.
    pub fn reported_floating_point(&self) -> bool {
        self.changes.meets(Changes::FLOATING_POINT)
    }

    /// Reports an earlier change that no later call has repeated.
    pub fn unrepeated(&mut self) {
        if let Some(Unnamed { tick, counts_at, changes }) = self.unnamed.take() {
            self.changed_at((tick, counts_at), "fmi2DoStep or the setting of values before it", changes);
        }
    }
}

impl Instance {
    /// Ends a copy of the process in which a call returned too, and compares floating-point control after a step or, if every
    /// call is compared, after any call. Where only steps are compared, a call that set values for the step may be the one that
    /// changed it; from then on every call is compared, so that the next change is that of a known call.
    pub(super) fn look_after(&mut self, now: &Now<'_>, call: Call) {
        let doing = Doing::Call(call);
        if is_copy() {
            self.rest.note.end_copy(now.tick, self.index, doing);
        }
        let compares_each_call = compares_each_call();
        if !compares_each_call && call != Call::DoStep {
            return;
        }
        let (warnings, changes) = (&mut self.rest.warnings, restored_floating_point());
        match (changes != Changes::NONE, compares_each_call) {
            (true, true) => warnings.floating_point(now, doing, changes),
            (true, false) => {
                warnings.unnamed = Some(Unnamed { tick: now.tick, counts_at: now.counts_at, changes });
            }
            (false, _) if call == Call::DoStep => warnings.unrepeated(),
            (false, _) => {}
        }
    }

    /// Whether a change of floating-point control by this instance was reported.
    #[must_use]
    pub fn reported_floating_point(&self) -> bool {
        self.rest.warnings.reported_floating_point()
    }

    /// Reports a change of floating-point control while outputs of this instance and of later ones were read.
    pub fn changed_by_reading(&mut self, now: &Now<'_>, changes: Changes) {
        self.rest.warnings.changed(now, "the reading of outputs, of this or a later instance,", changes);
    }
}
