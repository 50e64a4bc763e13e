//! The results of a run: its folder, files and formats, reports, plots and comparisons.
//!
//! The parent process of a run writes all files; the step loop only passes rows to it. Nothing here calls a unit or
//! steps a run, and the types that are written are plain data of this crate. `trace.csv`, `trace.parquet`,
//! `signals.json` and `verdict.json` have the same bytes wherever and whenever the run is repeated; only `run.json`
//! contains what differs between hosts.

#![forbid(unsafe_code)]

mod arrow_schema;
pub mod call_log;
pub mod checkpoint;
pub mod comparison;
pub mod csv;
pub mod diff;
pub mod events;
pub mod graph;
pub mod parquet;
pub mod plot;
pub mod recorder;
pub mod report;
pub mod run_folder;
pub mod run_record;
pub mod signals;
pub mod sink;
pub mod table;
pub mod verdict;

use fmi2::printable;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Why a run's folder could not be used or written.
#[derive(Debug)]
pub enum TraceError {
    /// Another run is writing into the folder.
    Locked(PathBuf),
    /// The folder contains files that are not those of a run.
    Foreign(PathBuf),
    /// The operating system returned an error.
    Io {
        /// What was being done: `create`, `write`.
        doing: &'static str,
        /// To which file or folder.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
}

impl TraceError {
    /// Adds to a system error what was being done, and to which file or folder.
    pub fn io(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |error| Self::Io { doing, path: path.to_owned(), error }
    }

    /// What the user can do about it, if anything.
    #[must_use]
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::Locked(_) => Some("wait for it, or give this run a folder of its own with --out DIR"),
            Self::Foreign(_) => Some("only a folder of an earlier run is replaced; choose another with --out DIR"),
            Self::Io { doing: "create", .. } => Some("choose another folder with --out DIR"),
            Self::Io { .. } => None,
        }
    }
}

impl fmt::Display for TraceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Locked(path) => write!(f, "another run is writing into {}", printable::path(path)),
            Self::Foreign(path) => write!(f, "{} is not empty and holds no run.json of ours", printable::path(path)),
            Self::Io { doing, path, error } => write!(f, "cannot {doing} {}: {error}", printable::path(path)),
        }
    }
}

impl std::error::Error for TraceError {}

/// `1 claim`, `2 claims`.
#[must_use]
pub fn counted(count: usize, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}

/// The shortest decimal that reads back to the same number, without `.0`.
#[must_use]
pub fn shortest_decimal(value: f64) -> String {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value);
    text.strip_suffix(".0").unwrap_or(text).to_owned()
}

/// A value as the JSON text of a run's file: indented, with a line break at the end.
#[must_use]
pub fn json_text(value: &impl serde::Serialize) -> String {
    match serde_json::to_string_pretty(value) {
        Ok(text) => text + "\n",
        Err(error) => unreachable!("plain data with string keys always has a JSON text: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_is_the_shortest_that_reads_back_to_the_same_bits() {
        let numbers = [0.1, -0.0, 1.0, 5e-324, 1e16, 1e-7, 123_456_789_012_345.0, f64::MAX, 1.0 / 3.0];
        let texts = numbers.map(shortest_decimal);
        for (number, text) in numbers.iter().zip(&texts) {
            assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(number.to_bits()), "{text}");
        }
        assert_eq!(texts[..5], ["0.1", "-0", "1", "5e-324", "1e+16"].map(String::from));
        assert_eq!(shortest_decimal(f64::NAN), "NaN");
        assert_eq!(shortest_decimal(f64::NEG_INFINITY), "-inf");
    }
}
