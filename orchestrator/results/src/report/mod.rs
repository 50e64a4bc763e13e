//! What people read: words of units, the progress of a run, the table of claims at its end.
//!
//! Results go to standard output, everything else to standard error. Nothing else in this library prints.

pub mod console;
pub mod number;
pub mod progress;
pub mod table;

use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Prints one line on standard error: what is being done now.
pub fn status(text: &str) {
    // Nobody listening is no reason to end a run.
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Whether results did not reach standard output.
static LOST: AtomicBool = AtomicBool::new(false);

/// Prints results on standard output. Whoever reads them may stop early; any other failure is told, and remembered for
/// the exit code.
pub fn result(text: &str) {
    let mut out = io::stdout().lock();
    let Err(refused) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) else { return };
    if refused.kind() != io::ErrorKind::BrokenPipe {
        LOST.store(true, Ordering::Relaxed);
        error(&format!("cannot write to standard output: {refused}"), None);
    }
}

/// Whether results did not reach standard output, though somebody was listening.
#[must_use]
pub fn results_were_lost() -> bool {
    LOST.load(Ordering::Relaxed)
}

/// Prints an error with its help on standard error.
pub fn error(message: &impl std::fmt::Display, help: Option<&str>) {
    status(&error_text(message, help));
}

/// An error with its help as people see it.
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
