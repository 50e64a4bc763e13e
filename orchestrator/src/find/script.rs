//! A script with everything that it names: its text, its units' descriptions, and what it means.
//!
//! `check` and `run` read scripts through here, so that both find the same errors.

use crate::find::catalogue::Catalogue;
use dsl::diagnostic::{Diagnostic, Severity, render};
use dsl::parse::{parse, parse_assignment};
use dsl::resolve::{Request, UnitProblem, Units, resolve, units};
use dsl::scenario::Scenario;
use dsl::source::Sources;
use dsl::syntax::{Binding, File, Instance, StatementKind};
use fmi2::description::check::check;
use fmi2::description::{Finding, ModelDescription};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use unit::archive::read_loadable;
use unit::error::UnitError;

/// A script that was read, with whatever is wrong with it.
#[derive(Debug)]
pub struct Script {
    /// As the user named it.
    pub name: String,
    /// The folder that paths in it are relative to.
    pub folder: PathBuf,
    /// The script's text.
    pub text: String,
    /// The texts that diagnostics point into.
    pub sources: Sources,
    /// What is wrong or deserves a look.
    pub diagnostics: Vec<Diagnostic>,
    /// What it means, unless something is wrong.
    pub scenario: Option<Scenario>,
    /// Its units, each once, in order of first use; those that were found.
    pub units: Vec<ScriptUnit>,
}

/// A unit that a script names.
#[derive(Clone, Debug)]
pub struct ScriptUnit {
    /// As the script names it.
    pub name: String,
    /// Its file.
    pub archive: PathBuf,
    /// What its `modelDescription.xml` says.
    pub description: Arc<ModelDescription>,
    /// What is wrong with it by the rules of the standard.
    pub findings: Vec<Finding>,
}

impl Script {
    /// Reads a script and finds out what it means with these assignments of the command line.
    ///
    /// # Errors
    /// If the file cannot be read; whatever is wrong with its content is among the diagnostics.
    pub fn read(path: &Path, settings: &[String], catalogue: &Catalogue) -> io::Result<Self> {
        let text = String::from_utf8(std::fs::read(path)?)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, format!("it is not UTF-8: {error}")))?;
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        Ok(Self::of_text(path.display().to_string(), folder, text, settings, catalogue))
    }

    /// Finds out what a text means whose paths are relative to `folder`.
    #[must_use]
    pub fn of_text(name: String, folder: PathBuf, text: String, settings: &[String], catalogue: &Catalogue) -> Self {
        let mut script = Self {
            name: name.clone(),
            folder,
            text: text.clone(),
            sources: Sources::default(),
            diagnostics: Vec::new(),
            scenario: None,
            units: Vec::new(),
        };
        let file_text = script.sources.add(name, text);
        let parsed = parse(&script.sources, file_text);
        script.diagnostics = parsed.diagnostics;
        let settings = script.assignments(settings);
        if script.diagnostics.is_empty() {
            script.resolve(&parsed.file, &settings, catalogue);
        }
        script
    }

    fn assignments(&mut self, settings: &[String]) -> Vec<Binding> {
        let mut bindings = Vec::new();
        for setting in settings {
            let text = self.sources.add("--set", setting.as_str());
            match parse_assignment(&self.sources, text) {
                Ok(binding) => bindings.push(binding),
                Err(diagnostics) => self.diagnostics.extend(diagnostics),
            }
        }
        bindings
    }

    fn resolve(&mut self, file: &File, settings: &[Binding], catalogue: &Catalogue) {
        let mut known = Units::new();
        for word in units(file) {
            let found = find(&word.text, &self.folder, catalogue);
            let description = found.map(|unit| {
                let description = Arc::clone(&unit.description);
                self.units.push(unit);
                description
            });
            known.insert(word.text.clone(), description);
        }
        let resolved = resolve(&Request { sources: &self.sources, file, units: &known, settings });
        self.diagnostics = resolved.diagnostics;
        self.scenario = resolved.scenario;
        let needs = self.needs_of_units(file);
        if !needs.is_empty() {
            self.diagnostics.extend(needs);
            self.diagnostics.sort_by_key(|diagnostic| diagnostic.labels.first().map(|label| label.span));
            if self.has_errors() {
                self.scenario = None;
            }
        }
    }

    /// What the libraries of units ask of the process that loads them.
    fn needs_of_units(&self, file: &File) -> Vec<Diagnostic> {
        let mut needs = Vec::new();
        for unit in &self.units {
            let Some(library) = &unit.description.co_simulation else { continue };
            let mut instances = file.statements.iter().filter_map(|statement| match &statement.kind {
                StatementKind::Fmu(instance) if instance.unit.text == unit.name => Some(instance),
                _ => None,
            });
            let Some(first) = instances.next() else { continue };
            if library.needs_execution_tool {
                let message = format!("unit `{}` says that it needs another program to run", unit.name);
                let warning = Diagnostic::warning("W05", first.unit.span, message);
                needs.push(warning.help("make sure that the program it was exported from is installed"));
            }
            if library.can_be_instantiated_only_once_per_process {
                needs.extend(instances.map(|again| only_once(&unit.name, first, again)));
            }
        }
        needs
    }

    /// Whether something is wrong.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// The diagnostics as people read them; empty if there are none.
    #[must_use]
    pub fn rendered(&self, colour: bool) -> String {
        render(&self.sources, &self.diagnostics, colour)
    }
}

fn only_once(unit: &str, first: &Instance, again: &Instance) -> Diagnostic {
    let message = format!("unit `{unit}` can be instantiated only once per process, and a run is one process");
    Diagnostic::error("E26", again.unit.span, message).label(first.unit.span, "the first")
}

fn find(name: &str, folder: &Path, catalogue: &Catalogue) -> Result<ScriptUnit, UnitProblem> {
    let archive = catalogue.find(name, folder)?;
    let problem = |error: UnitError| UnitProblem { message: error.of_unit(name), help: None };
    let (description, mut findings) = read_loadable(&archive).map_err(problem)?;
    findings.extend(check(&description));
    Ok(ScriptUnit { name: name.to_owned(), archive, description: Arc::new(description), findings })
}
