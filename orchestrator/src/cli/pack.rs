//! `lockstep pack`: unit crates become `.fmu` files for this and any other tool.

use fmi2::printable;
use pack::{UnitCrate, Workspace};
use results::report;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Builds unit crates and packs them as .fmu files.
#[derive(Debug, clap::Args)]
pub struct Pack {
    /// Units of this workspace by name, or folders of unit crates
    #[arg(value_name = "UNIT-OR-PATH", required_unless_present = "all")]
    units: Vec<OsString>,
    /// All units of this workspace
    #[arg(long, conflicts_with = "units")]
    all: bool,
    /// Where the files go [default: target/fmus]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Pack {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        let units = match self.chosen() {
            Ok(units) => units,
            Err((message, help)) => {
                report::error(&message, help.as_deref());
                return 2;
            }
        };
        for (index, unit) in units.iter().enumerate() {
            report::status(&format!("packing {} ({} of {})", unit.name, index + 1, units.len()));
            let archive = match &self.out {
                Some(folder) => folder.join(format!("{}.fmu", unit.name)),
                None => unit.archive(),
            };
            match pack::pack(unit, &unit::describe::describe_library, &archive, &report::status) {
                Ok(()) => report::result(&format!("{}\n", printable::path(archive))),
                Err(error) => {
                    report::error(&error, error.help().as_deref());
                    return 2;
                }
            }
        }
        0
    }

    fn chosen(&self) -> Result<Vec<UnitCrate>, (String, Option<String>)> {
        let current = std::env::current_dir().map_err(|error| (format!("no current folder: {error}"), None))?;
        let workspace = Workspace::around(&current).map_err(|error| (error.to_string(), None))?;
        let units = workspace.map(|workspace| workspace.units).unwrap_or_default();
        if self.all {
            let help = "run it in a cargo workspace with packages that have [package.metadata.fmu]".to_owned();
            return if units.is_empty() { Err(("here are no units".to_owned(), Some(help))) } else { Ok(units) };
        }
        self.units.iter().map(|name| one(name, &units, &current)).collect()
    }
}

fn one(name: &OsStr, units: &[UnitCrate], current: &Path) -> Result<UnitCrate, (String, Option<String>)> {
    if let Some(unit) = units.iter().find(|unit| *unit.name == *name) {
        return Ok(unit.clone());
    }
    let folder = current.join(name);
    if folder.is_dir() {
        return UnitCrate::at(&folder.canonicalize().unwrap_or(folder)).map_err(|error| (error.to_string(), None));
    }
    let near = dsl::nearest::nearest(&name.to_string_lossy(), units.iter().map(|unit| unit.name.as_str()));
    let help = near.map(|near| format!("did you mean `{near}`?"));
    Err((format!("`{}` is neither a unit of this workspace nor a folder", printable::path(name)), help))
}
