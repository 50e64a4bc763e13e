//! Output for people: log messages of units, the progress of a run, the table of claims at its end.
//!
//! Results go to standard output, everything else to standard error. Nothing else in this library prints.

pub mod console;
pub mod number;
pub mod progress;
pub mod table;

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Prints one status line on standard error.
pub fn status(text: &str) {
    // A closed standard error must not end a run.
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Whether results did not reach standard output.
static LOST: AtomicBool = AtomicBool::new(false);

/// Prints results on standard output. A closed pipe is no error, because a reader such as `head` may stop early; any
/// other failure is reported and recorded for the exit code.
pub fn result(text: &str) {
    let mut out = io::stdout().lock();
    let Err(write_error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) else { return };
    if write_error.kind() != io::ErrorKind::BrokenPipe {
        LOST.store(true, Ordering::Relaxed);
        error(&format!("cannot write to standard output: {write_error}"), None);
    }
}

/// Whether a write of results to standard output failed, other than by a closed pipe.
#[must_use]
pub fn results_were_lost() -> bool {
    LOST.load(Ordering::Relaxed)
}

/// Prints an error with its help on standard error.
pub fn error(message: &impl std::fmt::Display, help: Option<&str>) {
    status(&error_text(message, help));
}

/// The text of an error with its help.
#[must_use]
pub fn error_text(message: &impl std::fmt::Display, help: Option<&str>) -> String {
    help.map_or_else(|| format!("error: {message}"), |help| format!("error: {message}\nhelp: {help}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_comes_before_its_help() {
        assert_eq!(error_text(&"it broke", Some("mend it")), "error: it broke\nhelp: mend it");
        assert_eq!(error_text(&"it broke", None), "error: it broke");
    }
}
