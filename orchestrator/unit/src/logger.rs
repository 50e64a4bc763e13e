//! The logger callback: passes a unit's log messages, with their printf arguments inserted, to a sink.
//!
//! A unit may call it at any time and from any thread: with NULL instead of a string, with a status that the standard
//! does not define, with an environment other than the one it was given, and with a format that would write to memory.
//! Each such call becomes a message, and no error or panic of ours reaches the unit.

mod environment;
mod format;
#[cfg(all(target_arch = "x86_64", not(windows)))]
#[path = "logger/trampoline_x86_64.rs"]
mod trampoline;
#[cfg(not(all(target_arch = "x86_64", not(windows))))]
#[path = "logger/trampoline_other.rs"]
mod trampoline;

pub(super) use environment::{Environment, Registration};
pub(super) use trampoline::LOGGER;

use fmi2::c::{ComponentEnvironment, RawStatus, Status, Str};
use serde::{Deserialize, Serialize};
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// A log message of a unit, with its printf arguments inserted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogMessage {
    /// Index of the instance; `None` if it could not be identified.
    pub instance: Option<usize>,
    /// The tick of the call in which the unit logged it.
    pub tick: u64,
    /// The tick at which that call's result takes effect. Messages are shown in the order of this tick, which is the
    /// same in one process and in many.
    pub counts_at: u64,
    /// The status as the unit gave it.
    pub status: RawStatus,
    /// The category as the unit gave it.
    pub category: String,
    /// The text.
    pub text: String,
}

impl LogMessage {
    /// A warning of Lockstep's own about an instance.
    #[must_use]
    pub fn warning(instance: usize, (tick, counts_at): (u64, u64), text: String) -> Self {
        let (status, category) = (Status::Warning as RawStatus, "logStatusWarning".to_owned());
        Self { instance: Some(instance), tick, counts_at, status, category, text }.shortened()
    }

    /// The status as it is shown to users.
    #[must_use]
    pub fn status_name(&self) -> String {
        let name = match Status::from_raw(self.status) {
            Some(Status::Ok) => "info",
            Some(Status::Warning) => "warning",
            Some(Status::Discard) => "discard",
            Some(Status::Error) => "error",
            Some(Status::Fatal) => "fatal",
            Some(Status::Pending) => "pending",
            None => return format!("status {}", self.status),
        };
        name.to_owned()
    }

    /// This message with the ends of text and category cut off where they are too long for the board, with a note.
    fn shortened(mut self) -> Self {
        cut(&mut self.text, LONGEST_TEXT);
        cut(&mut self.category, LONGEST_TEXT);
        self
    }
}

/// Receives log messages of units; any thread may call it.
pub type LogSink = Arc<dyn Fn(LogMessage) + Send + Sync>;

/// The largest number of bytes of a text or a category; the rest is cut off.
const LONGEST_TEXT: usize = 64 << 10;
/// The mark at the end of a text that was cut.
const CUT: &str = " … (cut here)";

/// Passes one message to the sink of its instance. `text` returns the formatted bytes.
///
/// # Safety
/// `name` and `category` are NULL or end in a zero byte.
unsafe fn deliver(
    environment: ComponentEnvironment,
    name: Str,
    status: RawStatus,
    category: Str,
    text: impl FnOnce() -> Vec<u8>,
) {
    // A panic must not unwind through the unit's frames, which is undefined in C. The panic hook has reported it
    // already.
    let _ = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: guaranteed by the caller.
        let (name, category) = unsafe { (lossy(name), lossy(category)) };
        let Some((environment, exact)) = Environment::find(environment, &name) else { return };
        let text = environment.names.expand(String::from_utf8_lossy(&text()).trim_end(), LONGEST_TEXT);
        let instance = exact.then_some(environment.instance);
        let (tick, counts_at) = (environment.note.tick(), environment.note.counts_at());
        (environment.sink)(LogMessage { instance, tick, counts_at, status, category, text }.shortened());
    }));
}

/// # Safety
/// `text` is NULL or ends in a zero byte.
unsafe fn lossy(text: Str) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: guaranteed by the caller.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

fn cut(text: &mut String, bytes: usize) {
    if text.len() > bytes {
        text.truncate(text.floor_char_boundary(bytes));
        text.push_str(CUT);
    }
}

#[cfg(test)]
mod tests;
