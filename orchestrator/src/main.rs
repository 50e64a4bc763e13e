//! The program `lockstep`: parses the arguments, runs the command and returns its exit code.
#![forbid(unsafe_code)]

use orchestrator::cli::Cli;
use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(Cli::main())
}
