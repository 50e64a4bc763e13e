//! Standard error during a run: lines that stay, and on a terminal one progress line below them that is overwritten.

use super::progress::{Progress, Tenths};
use fmi2::printable;
use std::env;
use std::ffi::OsStr;
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// One line that is overwritten.
    Live,
    /// A line for each tenth.
    Tenths,
    /// A JSON line for each tenth.
    Json,
    /// Not at all.
    Never,
}

impl Style {
    /// The style for standard error, which depends on whether it is a terminal; `json` for `--progress json`.
    #[must_use]
    pub fn fitting(json: bool) -> Self {
        match (json, io::stderr().is_terminal() && has_commands(env::var_os("TERM").as_deref())) {
            (true, _) => Self::Json,
            (false, true) => Self::Live,
            (false, false) => Self::Tenths,
        }
    }
}

/// Whether what is written to a stream may be coloured: it is a terminal that has colours, and the user does not refuse them
/// (<https://no-color.org>).
#[must_use]
pub fn has_colour(stream: &impl IsTerminal) -> bool {
    let refused = env::var_os("NO_COLOR").is_some_and(|refused| !refused.is_empty());
    stream.is_terminal() && !refused && has_commands(env::var_os("TERM").as_deref())
}

/// Whether the terminal of this name knows commands at all.
fn has_commands(terminal: Option<&OsStr>) -> bool {
    terminal.is_some_and(|name| name != "dumb")
}

/// How often a line on a terminal changes.
const REFRESH: Duration = Duration::from_millis(100);
/// Seconds of a run after which people see its progress.
const PATIENCE_S: f64 = 1.0;

/// Writes lines and progress in turn.
#[derive(Debug)]
pub struct Console<W: Write> {
    out: W,
    style: Style,
    tenths: Tenths,
    shown: Option<Instant>,
}

impl Console<io::Stderr> {
    /// Standard error.
    #[must_use]
    pub fn stderr(style: Style) -> Self {
        Self::new(io::stderr(), style)
    }
}

impl<W: Write> Console<W> {
    /// A console on any writer.
    pub fn new(out: W, style: Style) -> Self {
        Self { out, style, tenths: Tenths::default(), shown: None }
    }

    /// The writer, with nothing left to write.
    pub fn into_inner(mut self) -> W {
        self.clear();
        self.out
    }

    /// Prints a line that stays, without what would command the user's terminal.
    pub fn say(&mut self, text: &str) {
        self.clear();
        // A closed standard error must not end a run.
        let _ = writeln!(self.out, "{}", printable::lines(text));
    }

    /// Shows the progress if a new line is due; `progress` is called only then.
    pub fn progress(&mut self, part: f64, progress: impl FnOnce() -> Progress) {
        match self.style {
            Style::Live => {
                if self.shown.is_none_or(|shown| shown.elapsed() >= REFRESH) {
                    let progress = progress();
                    if progress.wall_s < PATIENCE_S {
                        return;
                    }
                    // Carriage return, erase to the end, no wrapping while the line is written.
                    let _ = write!(self.out, "\r\x1b[K\x1b[?7l{}\x1b[?7h", progress.line());
                    let _ = self.out.flush();
                    self.shown = Some(Instant::now());
                }
            }
            Style::Tenths => {
                if let Some(percent) = self.tenths.due(part) {
                    let progress = progress();
                    if progress.wall_s >= PATIENCE_S {
                        let _ = writeln!(self.out, "{percent:3} %  {}", progress.line());
                    }
                }
            }
            Style::Never => {}
            Style::Json => {
                if self.tenths.due(part).is_some() {
                    let _ = writeln!(self.out, "{}", progress().json());
                }
            }
        }
    }

    /// Erases the progress line.
    pub fn clear(&mut self) {
        if self.shown.take().is_some() {
            let _ = write!(self.out, "\r\x1b[K");
            let _ = self.out.flush();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn output(style: Style) -> String {
        output_after(style, 1.0)
    }

    fn output_after(style: Style, wall_s: f64) -> String {
        let mut bytes = Vec::new();
        let mut console = Console::new(&mut bytes, style);
        for time_s in [0.0, 1.0, 2.0] {
            console.progress(time_s / 2.0, || Progress { time_s, stop_s: 2.0, from_s: 0.0, wall_s, claims: vec![] });
        }
        console.say("0.5 s  quad  warning  low battery");
        console.clear();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn a_line_that_stays_replaces_the_progress_line() {
        assert_eq!(
            output(Style::Live),
            "\r\x1b[K\x1b[?7l0.00 s of 2 s  0x\x1b[?7h\r\x1b[K0.5 s  quad  warning  low battery\n"
        );
    }

    #[test]
    fn without_a_terminal_there_is_a_line_for_each_tenth_reached() {
        assert_eq!(
            output(Style::Tenths),
            " 50 %  1.00 s of 2 s  1x  1 s left\n100 %  2.00 s of 2 s  2x\n0.5 s  quad  warning  low battery\n"
        );
    }

    #[test]
    fn a_run_of_less_than_a_second_shows_no_progress_to_people() {
        for style in [Style::Live, Style::Tenths] {
            assert_eq!(output_after(style, 0.9), "0.5 s  quad  warning  low battery\n");
        }
        assert!(output_after(Style::Json, 0.9).starts_with('{'));
    }

    #[test]
    fn the_json_style_prints_one_object_a_line() {
        let text = output(Style::Json);
        assert_eq!(text.lines().filter(|line| line.starts_with('{') && line.ends_with('}')).count(), 2);
    }
}
