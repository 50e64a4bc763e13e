//! `lockstep new`: a crate for one's own unit, a script for units.

mod scenario;

use fmi2::printable;
use results::report;
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
        let current = std::env::current_dir().map_err(|error| (format!("no current folder: {error}"), None));
        let new = match current.and_then(|current| pack::new_unit(&self.name, &fmu, &current)) {
            Ok(new) => new,
            Err((message, help)) => {
                report::error(&message, help.as_deref());
                return 2;
            }
        };
        let name = &self.name;
        let [unit, script] = pack::first_files(name).map(printable::path);
        let width = unit.len().max(script.len());
        let program = report::invocation::program();
        report::result(&format!(
            "{unit:<width$}  the unit, with a test\n{script:<width$}  a script that runs it\n\n\
             cd {name}\ncargo test\n{program} run {name}.scn\n{program} pack .\n"
        ));
        if let Some(note) = new.note {
            report::status(&note);
        }
        0
    }
}
