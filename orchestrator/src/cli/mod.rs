//! The command line: one file for each subcommand; each runs and returns its exit code.

pub mod check;
pub mod describe;
pub mod diff;
mod exit_code;
pub mod fmt;
pub mod new;
pub mod pack;
pub mod plot;
pub mod run;
pub mod simulate;
#[cfg(feature = "bus")]
pub mod worker;

use crate::run::interruption;
use clap::{Parser, Subcommand};
use results::recorder::Formats;
use results::report;
use std::panic::catch_unwind;
use std::path::{Path, PathBuf};
use std::{env, io};
use unit::describe::library_description;
use unit::process;

/// The stack on which a script is read, and some memory besides.
const ADDRESS_SPACE: usize = 128 << 20;

/// The commands that the program starts itself to load units.
const HOLDS_UNITS: [&str; 3] = [crate::host::supervise::SUBCOMMAND, WORKER, unit::describe::SUBCOMMAND];
#[cfg(feature = "bus")]
const WORKER: &str = crate::bus::SUBCOMMAND;
#[cfg(not(feature = "bus"))]
const WORKER: &str = "worker";

/// Runs scenarios of FMI 2.0 co-simulation units in lockstep and judges what their scripts claim.
#[derive(Debug, Parser)]
#[command(name = "lockstep", version, propagate_version = true)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Run(run::Run),
    Check(check::Check),
    Simulate(simulate::Simulate),
    Describe(describe::Describe),
    Pack(pack::Pack),
    New(new::New),
    Fmt(fmt::Fmt),
    Plot(plot::Plot),
    Diff(diff::Diff),
    /// What a run starts to hold the units; not for people
    #[command(hide = true)]
    StepLoop,
    #[cfg(feature = "bus")]
    #[command(hide = true)]
    Worker(worker::Worker),
    /// What packing starts to ask a library for its description; not for people
    #[command(hide = true)]
    DescribeLibrary {
        /// The library
        path: PathBuf,
    },
}

impl Cli {
    /// Parses the arguments, runs the command and returns the exit code of the process. Signals are handled first of all.
    #[must_use]
    pub fn main() -> u8 {
        process::survive_file_size_limit();
        let holds_units = env::args_os().nth(1).is_some_and(|command| HOLDS_UNITS.iter().any(|name| command == *name));
        // A signal that ends a process with units is a fault that its parent reports.
        if !holds_units && let Err(error) = interruption::listen() {
            let help = (error.kind() == io::ErrorKind::WouldBlock).then_some(exit_code::MORE_PROCESSES);
            report::error(&format!("cannot listen for Ctrl-C: {error}"), help);
            return exit_code::USAGE;
        }
        if !holds_units && !process::has_address_space(ADDRESS_SPACE) {
            report::error(&"too little address space is left", Some("raise the limit (ulimit -v)"));
            return exit_code::USAGE;
        }
        // A panic is printed already. It is a defect, or zenoh's answer where the system gives it nothing.
        catch_unwind(|| Self::parse().run()).unwrap_or(exit_code::BROKEN)
    }

    /// Runs the command and returns the exit code of the process.
    #[must_use]
    pub fn run(self) -> u8 {
        let lost = match self.command {
            Command::Run(_) | Command::Simulate(_) => exit_code::BROKEN,
            _ => exit_code::USAGE,
        };
        let reached = match self.command {
            Command::Run(run) => run.run(),
            Command::Check(check) => check.run(),
            Command::Simulate(simulate) => simulate.run(),
            Command::Describe(describe) => describe.run(),
            Command::Pack(pack) => pack.run(),
            Command::New(new) => new.run(),
            Command::Fmt(fmt) => fmt.run(),
            Command::Plot(plot) => plot.run(),
            Command::Diff(diff) => diff.run(),
            Command::StepLoop => step_loop(),
            #[cfg(feature = "bus")]
            Command::Worker(worker) => worker.run(),
            Command::DescribeLibrary { path } => describe_library(&path),
        };
        // A signal that the terminal is gone leaves no standard output either.
        if report::results_were_lost() && reached != exit_code::INTERRUPTED { lost } else { reached }
    }
}

/// Steps the run whose specification comes on standard input. An error before it has a board is printed.
fn step_loop() -> u8 {
    match crate::host::child::run() {
        Ok(()) => 0,
        Err(error) => {
            report::error(&error, None);
            1
        }
    }
}

/// The formats that `--format` names: `csv,parquet`.
fn formats(text: &str) -> Result<Formats, String> {
    let mut formats = Formats { csv: false, parquet: false };
    for name in text.split(',') {
        match name.trim() {
            "csv" => formats.csv = true,
            "parquet" => formats.parquet = true,
            other => return Err(format!("`{other}` is no format of traces: csv, parquet or csv,parquet")),
        }
    }
    Ok(formats)
}

/// A number at the start of a text and what follows it, without blanks: `10s`, `7.5 ms`, `1e-6`.
fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let ends = text.char_indices().map(|(at, _)| at).chain([text.len()]).rev();
    ends.map(|at| text.split_at(at)).find_map(|(number, unit)| {
        let number = number.trim_end();
        let value = number.parse().ok().filter(|_| number.ends_with(|c: char| c.is_ascii_digit() || c == '.'))?;
        Some((value, unit.trim()))
    })
}

/// Prints what a library says of itself.
fn describe_library(path: &Path) -> u8 {
    match library_description(path) {
        Ok(description) => {
            report::result(&description);
            0
        }
        Err(reason) => {
            report::status(&reason);
            2
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_child_of_a_run_is_started_with_a_command_that_exists() {
        let started = Cli::try_parse_from(["lockstep", crate::host::supervise::SUBCOMMAND]).map(|cli| cli.command);
        assert!(matches!(started, Ok(Command::StepLoop)));
    }

    #[cfg(feature = "bus")]
    #[test]
    fn a_worker_is_started_with_a_command_that_exists() {
        let started = ["lockstep", crate::bus::SUBCOMMAND, "--once", "--home", "/tmp/lockstep-x", "3"];
        let started = Cli::try_parse_from(started).map(|cli| cli.command);
        assert!(matches!(started, Ok(Command::Worker(_))));
    }

    #[test]
    fn a_library_is_asked_with_a_command_that_exists() {
        let asked = ["lockstep", unit::describe::SUBCOMMAND, "libtank.so"];
        let asked = Cli::try_parse_from(asked).map(|cli| cli.command);
        assert!(matches!(asked, Ok(Command::DescribeLibrary { .. })));
    }

    #[test]
    fn formats_are_chosen_by_name() {
        assert_eq!(formats("csv"), Ok(Formats { csv: true, parquet: false }));
        assert_eq!(formats("parquet, csv"), Ok(Formats::default()));
        assert!(formats("csv,mcap").unwrap_err().starts_with("`mcap` is no format"));
    }

    #[test]
    fn a_flag_that_this_version_does_not_have_is_refused() {
        let refused = Cli::try_parse_from(["lockstep", "run", "a.scn", "--profile"]).unwrap_err();
        assert_eq!(refused.exit_code(), 2);
        assert!(refused.to_string().contains("--profile"), "{refused}");
    }
}
