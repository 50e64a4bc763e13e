//! The logger callback: what a unit says, with its printf arguments in place, brought to a sink.
//!
//! A unit may call it at any time and from any thread, with NULL where a text belongs, a status that the standard does
//! not know, an environment that is not the one it was given, and a format that nobody should obey. All of that becomes
//! a message; nothing that happens here reaches the unit.

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

use fmi2::c::{ComponentEnvironment, RawStatus, Str};
use serde::{Deserialize, Serialize};
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// A log message of a unit, with its printf arguments in place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogMessage {
    /// Index of the instance; `None` before one exists.
    pub instance: Option<usize>,
    /// The tick of the call in which the unit logged it.
    pub tick: u64,
    /// The tick at which that call's result counts: the message is shown then, wherever the instance is.
    pub counts_at: u64,
    /// The status as the unit gave it.
    pub status: RawStatus,
    /// The category as the unit gave it.
    pub category: String,
    /// The text.
    pub text: String,
}

/// Where messages of units go; called by any thread.
pub type LogSink = Arc<dyn Fn(LogMessage) + Send + Sync>;

/// What is longer than this is cut.
const LONGEST_TEXT: usize = 64 << 10;
/// What stands where it was cut.
const CUT: &str = " … (cut here)";

/// Delivers one message. `text` gives the formatted bytes.
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
    // What is caught was told by the panic hook already, and a unit cannot do anything about it.
    let _ = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the caller says so.
        let (name, mut category) = unsafe { (lossy(name), lossy(category)) };
        let Some((environment, exact)) = Environment::find(environment, &name) else { return };
        let mut text = environment.names.expand(String::from_utf8_lossy(&text()).trim_end());
        cut(&mut text);
        cut(&mut category);
        let instance = exact.then_some(environment.instance);
        let (tick, counts_at) = (environment.note.tick(), environment.note.counts_at());
        (environment.sink)(LogMessage { instance, tick, counts_at, status, category, text });
    }));
}

/// # Safety
/// `text` is NULL or ends in a zero byte.
unsafe fn lossy(text: Str) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller says so.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

fn cut(text: &mut String) {
    if text.len() > LONGEST_TEXT {
        text.truncate(text.floor_char_boundary(LONGEST_TEXT));
        text.push_str(CUT);
    }
}

#[cfg(test)]
mod tests;
