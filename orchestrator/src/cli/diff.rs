//! `lockstep diff`: whether two runs are the same, and where they part.

use results::diff::Difference;
use results::report;
use results::table::Table;
use std::path::PathBuf;

/// Compares two runs: the first tick, instance and port that differ, and by how much.
///
/// Exit code 0: the same; 1: different; 2: one of them cannot be read.
#[derive(Debug, clap::Args)]
pub struct Diff {
    /// The folder of a run, or a trace.csv
    a: PathBuf,
    /// Another one
    b: PathBuf,
}

impl Diff {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        let (a, b) = match (Table::read(&self.a), Table::read(&self.b)) {
            (Ok(a), Ok(b)) => (a, b),
            (Err(error), _) | (_, Err(error)) => {
                report::error(&error, None);
                return 2;
            }
        };
        let difference = Difference::between(&a, &b);
        report::result(&difference.report((&self.a.display().to_string(), &self.b.display().to_string())));
        u8::from(!difference.is_none())
    }
}
