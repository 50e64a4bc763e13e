//! `lockstep check`: everything that is wrong with scripts and units, before anything runs.

mod unit_file;
mod unit_run;

use super::exit_code;
use crate::find::catalogue::{Catalogue, is_archive};
use crate::find::preparation::{self, Refusal};
use crate::find::script::{Script, ScriptOptions};
use dsl::diagnostic::Severity;
use dsl::scenario::Scenario;
use flatten::listing;
use fmi2::description::ModelDescription;
use fmi2::printable;
use results::counted;
use results::report;
use results::report::console::has_colour;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Checks scripts and .fmu files, and runs nothing unless asked to.
///
/// A script is checked with the units that it names; an .fmu file by every rule of FMI 2.0.5, with line and column.
/// With --run each .fmu file is also tested by running it. Ends with 0 if nothing is wrong, 1 if such a test failed,
/// else with 2; 130 if it was interrupted.
#[derive(Debug, clap::Args)]
pub struct Check {
    /// Scripts and .fmu files
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Sets a parameter of the scripts, for example 'gust = 6 m/s'
    #[arg(long, value_name = "NAME = VALUE")]
    set: Vec<String>,
    /// Check the scripts with the parameters of this case of their `sweep`, from 0
    #[arg(long, value_name = "K")]
    case: Option<u64>,
    /// A folder of units, looked up before those of LOCKSTEP_UNITS and the workspace
    #[arg(long, value_name = "DIR")]
    units: Vec<PathBuf>,
    /// Never build a unit
    #[arg(long)]
    no_build: bool,
    /// Check scripts for a run with --isolate
    #[arg(long)]
    isolate: bool,
    /// Show what a script will do: periods, waves, connections, initialization
    #[arg(short, long)]
    verbose: bool,
    /// Warnings count as errors
    #[arg(long)]
    strict: bool,
    /// Draw the units of a script and their connections
    #[arg(long, value_name = "F.svg")]
    graph: Option<PathBuf>,
    #[command(flatten)]
    unit_run: unit_run::UnitRun,
}

/// What was found out about one file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Checked {
    /// Every finding as people read it.
    findings: String,
    errors: usize,
    warnings: usize,
    /// What there is, if nothing is wrong.
    facts: String,
    /// More about it, for `-v`.
    details: String,
}

impl Check {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        if let Some(refusal) = self.refused_graph() {
            report::status(refusal.0.trim_end());
            return exit_code::USAGE;
        }
        let mut all_well = true;
        let mut tests_passed = true;
        let mut catalogue = None;
        for file in &self.files {
            match self.one(file, &mut catalogue) {
                Ok(checked) => {
                    all_well &= checked.is_well(self.strict);
                    report::rendered_result(&checked.findings);
                    report::result(&self.text(file, &checked));
                }
                Err(refusal) => {
                    all_well = false;
                    report::status(refusal.0.trim_end());
                    continue;
                }
            }
            if self.unit_run.is_asked_for_with(file) {
                let tested = self.catalogue(&mut catalogue).and_then(|catalogue| self.unit_run.test(file, catalogue));
                match tested {
                    Ok(passed) => tests_passed &= passed,
                    Err(refusal) => {
                        all_well = false;
                        report::status(refusal.0.trim_end());
                    }
                }
            }
        }
        match (tests_passed, all_well) {
            (false, _) => exit_code::FAILED,
            (true, false) => exit_code::USAGE,
            (true, true) => 0,
        }
    }

    fn one(&self, file: &Path, catalogue: &mut Option<Catalogue>) -> Result<Checked, Refusal> {
        if is_archive(file) {
            return unit_file::check(file).map_err(|error| Refusal::new(&error, None));
        }
        let options = ScriptOptions { settings: &self.set, case: self.case, isolated: self.isolate };
        let script = Script::read(file, options, self.catalogue(catalogue)?)
            .map_err(|error| Refusal::new(&format!("cannot read {}: {error}", printable::path(file)), None))?;
        if let (Some(out), Some(scenario)) = (&self.graph, &script.scenario) {
            let picture = flatten::graph::of(scenario, &descriptions(&script, scenario)).draw();
            let problem = |error| Refusal::new(&format!("cannot write {}: {error}", printable::path(out)), None);
            std::fs::write(out, picture).map_err(problem)?;
        }
        Ok(of_script(&script, has_colour(&std::io::stdout())))
    }

    /// That a picture is asked for that cannot be drawn.
    fn refused_graph(&self) -> Option<Refusal> {
        let out = self.graph.as_ref()?;
        if out.extension() != Some(OsStr::new("svg")) {
            let message = format!("--graph {} is no name of a picture", printable::path(out));
            return Some(Refusal::new(&message, Some("pictures are SVG: let it end in .svg")));
        }
        let is_script = matches!(self.files.as_slice(), [file] if !is_archive(file));
        (!is_script).then(|| Refusal::new(&"--graph draws one script", Some("name one script and no other file")))
    }

    /// The catalogue, made when the first file needs it.
    fn catalogue<'a>(&self, made: &'a mut Option<Catalogue>) -> Result<&'a mut Catalogue, Refusal> {
        Ok(match made {
            Some(catalogue) => catalogue,
            None => made.insert(preparation::catalogue(&self.units, !self.no_build)?),
        })
    }

    fn text(&self, file: &Path, checked: &Checked) -> String {
        let details = if self.verbose { checked.details.as_str() } else { "" };
        format!("{}\n{details}", checked.summary(&printable::path(file), self.strict))
    }
}

impl Checked {
    fn is_well(&self, strict: bool) -> bool {
        self.errors == 0 && !(strict && self.warnings > 0)
    }

    /// One line: `flight.scn: ok  4 units, 27 connections, 3 claims`.
    fn summary(&self, name: &str, strict: bool) -> String {
        let counts = [(self.errors, "error"), (self.warnings, "warning")];
        let counts = counts.into_iter().filter(|&(count, _)| count > 0).map(|(count, what)| counted(count, what));
        let counts = counts.collect::<Vec<_>>().join(", ");
        match (self.is_well(strict), counts.is_empty()) {
            (true, true) => format!("{name}: ok  {}", self.facts),
            (true, false) => format!("{name}: ok  {}  ({counts})", self.facts),
            (false, _) => format!("{name}: {counts}"),
        }
    }
}

fn of_script(script: &Script, colour: bool) -> Checked {
    let count = |severity| script.diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count();
    let checked = Checked {
        findings: script.rendered(colour),
        errors: count(Severity::Error),
        warnings: count(Severity::Warning),
        ..Checked::default()
    };
    let Some(scenario) = &script.scenario else { return checked };
    Checked { facts: facts(scenario), details: listing::text(scenario, &descriptions(script, scenario)), ..checked }
}

fn facts(scenario: &Scenario) -> String {
    let cases = scenario.sweep.map_or(0, |sweep| usize::try_from(sweep.cases).unwrap_or(usize::MAX));
    let counts = [
        counted(scenario.instances.len(), "unit"),
        counted(scenario.connections.len(), "connection"),
        counted(scenario.claims.len(), "claim"),
        counted(cases, "case"),
    ];
    counts[..if cases == 0 { 3 } else { 4 }].join(", ")
}

/// For each instance what its unit says of itself.
fn descriptions<'a>(script: &'a Script, scenario: &Scenario) -> Vec<&'a ModelDescription> {
    scenario.instances.iter().map(|instance| script.units[instance.unit].description.as_ref()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_tells_what_there_is_or_what_is_wrong() {
        let with = |errors, warnings| Checked { errors, warnings, facts: "3 units".to_owned(), ..Checked::default() };
        assert_eq!(with(0, 0).summary("a.scn", true), "a.scn: ok  3 units");
        assert_eq!(with(0, 1).summary("a.scn", false), "a.scn: ok  3 units  (1 warning)");
        assert_eq!(with(0, 2).summary("a.scn", true), "a.scn: 2 warnings");
        assert_eq!(with(1, 2).summary("a.scn", false), "a.scn: 1 error, 2 warnings");
    }

    #[test]
    fn a_file_that_is_not_there_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["none.scn", "none.fmu"] {
            let file = folder.path().join(name);
            let check = Check {
                files: vec![file.clone()],
                set: Vec::new(),
                case: None,
                units: Vec::new(),
                no_build: true,
                isolate: false,
                verbose: false,
                strict: false,
                graph: None,
                unit_run: unit_run::UnitRun::default(),
            };
            let Refusal(message) = check.one(&file, &mut None).unwrap_err();
            assert!(message.contains(name) && message.contains("No such file"), "{message}");
        }
    }
}
