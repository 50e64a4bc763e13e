//! Output for people: log messages of units, the progress of a run, the table of claims at its end.
//!
//! Results go to standard output, everything else to standard error. Nothing else in this library prints.

pub mod console;
pub mod invocation;
pub mod number;
pub mod progress;
pub mod table;

use fmi2::printable;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Prints status lines on standard error, without what would command the user's terminal.
pub fn status(text: &str) {
    diagnostics(&printable::lines(text));
}

/// Prints rendered diagnostics, which may have colours, on standard error.
pub fn diagnostics(text: &str) {
    // A closed standard error must not end a run.
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Whether results did not reach standard output.
static LOST: AtomicBool = AtomicBool::new(false);

/// Prints results on standard output, without what would command the user's terminal.
pub fn result(text: &str) {
    rendered_result(&printable::lines(text));
}

/// Prints results with rendered diagnostics, which may have colours, on standard output. A closed pipe is no error, because a reader such as `head` may stop early; any
/// other failure is reported and recorded for the exit code.
pub fn rendered_result(text: &str) {
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

/// The text of an error with its help; later lines of either are marked.
#[must_use]
pub fn error_text(message: &impl std::fmt::Display, help: Option<&str>) -> String {
    let message = printable::block(&message.to_string());
    match help {
        Some(help) => format!("error: {message}\nhelp: {}", printable::block(help)),
        None => format!("error: {message}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_comes_before_its_help() {
        assert_eq!(error_text(&"it broke", Some("mend it")), "error: it broke\nhelp: mend it");
        assert_eq!(error_text(&"it broke", None), "error: it broke");
        assert_eq!(
            error_text(&"cannot read a\nerror: \x1b[2Jb", None),
            "error: cannot read a\n  | error: \u{fffd}[2Jb"
        );
    }
}
