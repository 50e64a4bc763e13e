//! `lockstep new`: a crate for one's own unit, a script for units.

mod scenario;

use fmi2::printable;
use results::report;
use results::report::invocation::program;
use std::path::{Path, PathBuf};

/// Writes something new to start from.
#[derive(Debug, clap::Args)]
pub struct New {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    /// Writes a crate for a unit of one's own, with a test and a script that runs it
    Unit(Unit),
    /// Writes a script that loads units and connects what fits by name, members and unit of measure
    Scenario(scenario::Scenario),
}

/// A crate for a unit. An empty folder becomes a workspace, which further units join.
#[derive(Debug, clap::Args)]
struct Unit {
    /// The unit's name, which becomes the folder's, for example my_tank
    name: String,
    /// The folder of the crate `fmu` [default: the one this program was built beside]
    #[arg(long, value_name = "PATH")]
    fmu: Option<PathBuf>,
}

impl New {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        match &self.what {
            What::Unit(unit) => unit.run(),
            What::Scenario(scenario) => scenario.run(),
        }
    }
}

impl Unit {
    fn run(&self) -> u8 {
        let beside_this = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fmus/fmu");
        let fmu = self.fmu.clone().unwrap_or(beside_this);
        let refused = |error: &pack::PackError| {
            report::error(error, error.help().as_deref());
            2
        };
        let current = match std::env::current_dir() {
            Ok(current) => current,
            Err(error) => {
                report::error(&format!("no current folder: {error}"), None);
                return 2;
            }
        };
        let new = match pack::new_unit(&self.name, &fmu, &current) {
            Ok(new) => new,
            Err(error) => return refused(&error),
        };
        report::result(&self.next(new.unit.workspace == new.unit.folder));
        if let Some(note) = new.note {
            report::status(&note);
        }
        0
    }

    /// What was written, and the next commands; a crate that is its own workspace is entered first.
    fn next(&self, alone: bool) -> String {
        let name = &self.name;
        let (unit, script) = (format!("{name}/src/lib.rs"), format!("{name}/{name}.scn"));
        let width = unit.len().max(script.len());
        let written = format!("{unit:<width$}  the unit, with a test\n{script:<width$}  a script that runs it\n\n");
        let program = program();
        if !alone {
            return format!("{written}cargo test\n{program} run {script}\n{program} pack {name}\n");
        }
        let own_path = || std::env::current_exe().map(printable::shell_word);
        // Another form than the bare name does not work in the unit's folder.
        let program = if program == "lockstep" { program.to_owned() } else { own_path().unwrap_or_default() };
        format!("{written}cd {name}\ncargo test\n{program} run {name}.scn\n{program} pack .\n")
    }
}
