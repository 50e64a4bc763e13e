//! `lockstep new scenario`: a script that loads units and connects what fits.

use crate::find::catalogue::{Catalogue, is_archive};
use crate::find::preparation::{self, Refusal};
use crate::find::script::{Script, ScriptOptions};
use dsl::format::format;
use dsl::skeleton::{Loaded, Skeleton, name_of};
use fmi2::printable;
use results::report;
use std::ffi::OsString;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A script for units.
#[derive(Debug, clap::Args)]
pub(super) struct Scenario {
    /// Units as scripts name them, and .fmu files; one that is named twice is loaded twice
    #[arg(value_name = "UNIT", required = true)]
    units: Vec<OsString>,
    /// The script to write, which must not exist [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// A folder of units, looked up before those of LOCKSTEP_UNITS and the workspace
    #[arg(long = "units", value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Never build a unit
    #[arg(long)]
    no_build: bool,
}

impl Scenario {
    /// Runs the command and returns its exit code.
    pub fn run(&self) -> u8 {
        let mut catalogue = match preparation::catalogue(&self.folders, !self.no_build) {
            Ok(catalogue) => catalogue,
            Err(refusal) => return refused(&refusal),
        };
        let text = self.loaded(&mut catalogue).map(|loaded| checked(&loaded, self.folder(), &catalogue));
        let written = text.and_then(|text| match &self.out {
            None => {
                report::result(&text);
                Ok(())
            }
            Some(out) => {
                let written = fs::File::create_new(out).and_then(|mut file| file.write_all(text.as_bytes()));
                let problem = |error| Refusal::new(&format!("cannot write {}: {error}", printable::path(out)), None);
                written.map_err(problem).map(|()| report::result(&format!("{}\n", printable::path(out))))
            }
        });
        written.map_or_else(|refusal| refused(&refusal), |()| 0)
    }

    /// The folder that paths in the script are relative to.
    fn folder(&self) -> &Path {
        let folder = self.out.as_deref().and_then(Path::parent);
        folder.filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
    }

    fn loaded(&self, catalogue: &mut Catalogue) -> Result<Vec<Loaded>, Refusal> {
        let mut loaded: Vec<Loaded> = Vec::new();
        for given in &self.units {
            let unit = catalogue.name_of(given);
            let problem = |problem: dsl::loader::Problem| Refusal::new(&problem.message, problem.help.as_deref());
            let archive = catalogue.find(&unit, Path::new(".")).map_err(problem)?;
            let (description, _) =
                unit::archive::read_description(&archive).map_err(|error| Refusal::new(&error.of_unit(&unit), None))?;
            let path = Path::new(&unit);
            let stem = if is_archive(path) { path.file_stem() } else { path.file_name() };
            let name = name_of(&stem.unwrap_or_default().to_string_lossy(), &loaded);
            loaded.push(Loaded { name, unit: self.written(&unit)?, description });
        }
        Ok(loaded)
    }

    /// A unit as the script names it: a path is relative to the script, or absolute where that is in another folder.
    fn written(&self, unit: &str) -> Result<String, Refusal> {
        if !is_archive(Path::new(unit)) || self.folder() == Path::new(".") {
            return Ok(unit.to_owned());
        }
        let path = Path::new(unit).canonicalize().ok().and_then(|path| path.to_str().map(str::to_owned));
        path.ok_or_else(|| Refusal::new(&format!("a script cannot name {unit}"), Some("rename the file")))
    }
}

fn refused(refusal: &Refusal) -> u8 {
    report::status(refusal.0.trim_end());
    2
}

/// The script in the style of the language. A connection that the units do not allow becomes a comment.
fn checked(units: &[Loaded], folder: &Path, catalogue: &Catalogue) -> String {
    let mut skeleton = Skeleton::of(units);
    loop {
        let (text, lines) = skeleton.text();
        let script = Script::of_text("script".to_owned(), folder.to_owned(), text, ScriptOptions::default(), catalogue);
        let errors = script.diagnostics.iter().filter(|diagnostic| diagnostic.is_error());
        let places = errors.flat_map(|error| &error.labels);
        let wrong: Vec<_> = places.map(|label| script.sources.line_and_column(label.span).0).collect();
        // The last connection of a circle gives way.
        match lines.iter().rfind(|(line, _)| wrong.contains(line)) {
            Some(&(_, connection)) => skeleton.refuse(connection),
            None => return format(&script.sources, 0).unwrap_or(script.text),
        }
    }
}
