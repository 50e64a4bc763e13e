//! What people read: words of units, the progress of a run, the table of claims at its end.
//!
//! Results go to standard output, everything else to standard error. Nothing else in this library prints.

pub mod console;
pub mod number;
pub mod progress;
pub mod table;

use std::io::{self, Write};

/// Prints one line on standard error: what is being done now.
pub fn status(text: &str) {
    // Nobody listening is no reason to end a run.
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Prints results on standard output; whoever reads them may stop early.
pub fn result(text: &str) {
    let mut out = io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
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
