//! The program `lockstep`: arguments in, exit code out.
#![forbid(unsafe_code)]

use clap::Parser;
use orchestrator::cli::Cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(Cli::parse().run())
}
