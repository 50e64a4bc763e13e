//! `lockstep worker`: holds the instances of a run that another process directs.

use crate::bus::{Address, serve};
use results::report;
use std::path::PathBuf;

/// Holds an instance for a run; started by `lockstep run --isolate`, not by people.
#[derive(Debug, clap::Args)]
pub struct Worker {
    /// Serves one run, then ends
    #[arg(long, required = true)]
    once: bool,
    /// The private folder of the run
    #[arg(long, value_name = "DIR")]
    home: PathBuf,
    /// Its number among the workers of the run
    #[arg(value_name = "NUMBER")]
    number: usize,
}

impl Worker {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(self) -> u8 {
        match serve(&Address { home: self.home, number: self.number }) {
            Ok(()) => 0,
            Err(reason) => {
                report::error(&reason, None);
                1
            }
        }
    }
}
