//! A script with everything that it names: its text, its units' descriptions, and what it means.
//!
//! `check` and `run` read scripts through here, so that both find the same errors.

use crate::find::catalogue::Catalogue;
use dsl::diagnostic::{Diagnostic, Severity, render};
use dsl::loader::{Loader, Problem, Table};
use dsl::parse::{parse, parse_assignment};
use dsl::resolve::{Request, resolve};
use dsl::scenario::Scenario;
use dsl::source::{Source, Sources};
use dsl::syntax::{Binding, File};
use fmi2::description::check::check;
use fmi2::description::{Finding, ModelDescription};
use fmi2::printable;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use unit::archive::read_loadable;
use unit::error::UnitError;

/// A script that was read, with its diagnostics.
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
    /// Errors and warnings.
    pub diagnostics: Vec<Diagnostic>,
    /// What it means, unless something is wrong.
    pub scenario: Option<Scenario>,
    /// Its units, each once, in order of first use, which is that of [`Scenario::units`]; those that were found.
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
    /// Reads and resolves a script with these assignments of the command line. `isolated`: each instance will have a process
    /// of its own.
    ///
    /// # Errors
    /// If the file cannot be read; errors in its content are among the diagnostics.
    pub fn read(path: &Path, settings: &[String], catalogue: &Catalogue, isolated: bool) -> io::Result<Self> {
        let text = String::from_utf8(std::fs::read(path)?)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, format!("it is not UTF-8: {error}")))?;
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        let name = printable::path(path);
        Ok(Self::of_text(name, folder, text, settings, catalogue, isolated))
    }

    /// A script without a text of its own, whose tree is made of texts of the command line; `text` says all that it means.
    /// Paths are relative to the current folder.
    #[must_use]
    pub fn of_tree(
        name: String,
        text: String,
        sources: Sources,
        tree: Result<File, Vec<Diagnostic>>,
        catalogue: &Catalogue,
    ) -> Self {
        let (file, diagnostics) = tree.map_or_else(|wrong| (None, wrong), |file| (Some(file), Vec::new()));
        let (scenario, units) = (None, Vec::new());
        let mut script = Self { name, folder: PathBuf::from("."), text, sources, diagnostics, scenario, units };
        if let Some(file) = file {
            script.resolve(&file, &[], catalogue, false);
        }
        script
    }

    /// The same for a text of which paths are relative to `folder`.
    #[must_use]
    pub fn of_text(
        name: String,
        folder: PathBuf,
        text: String,
        settings: &[String],
        catalogue: &Catalogue,
        isolated: bool,
    ) -> Self {
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
            script.resolve(&parsed.file, &settings, catalogue, isolated);
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

    fn resolve(&mut self, file: &File, settings: &[Binding], catalogue: &Catalogue, isolated: bool) {
        let files = Files { name: &self.name, folder: &self.folder, catalogue, units: Mutex::default() };
        let resolved = resolve(&Request { sources: &self.sources, file, loader: &files, settings, isolated });
        self.units = files.units.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.diagnostics = resolved.diagnostics;
        self.scenario = resolved.scenario;
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

/// Files beside the script, and the units of the catalogue.
struct Files<'a> {
    /// The script as the user named it.
    name: &'a str,
    /// The script's folder.
    folder: &'a Path,
    catalogue: &'a Catalogue,
    /// The units that were found, in order of first use.
    units: Mutex<Vec<ScriptUnit>>,
}

impl Files<'_> {
    /// The folder that paths of a text are relative to; assignments of the command line use the script's.
    fn folder_of<'f>(&'f self, from: &'f Source) -> &'f Path {
        let folder = Path::new(&from.name).parent().filter(|folder| from.name != self.name && *folder != Path::new(""));
        folder.unwrap_or(self.folder)
    }

    fn read(&self, from: &Source, path: &str) -> Result<(PathBuf, String), Problem> {
        let file = self.folder_of(from).join(path);
        match std::fs::read_to_string(&file) {
            Ok(text) => Ok((file, text)),
            Err(error) => Err(Problem { message: format!("`{path}` cannot be read: {error}"), help: None }),
        }
    }
}

impl Loader for Files<'_> {
    fn unit(&self, from: &Source, name: &str) -> Result<Arc<ModelDescription>, Problem> {
        let unit = find(name, self.folder_of(from), self.catalogue)?;
        let description = Arc::clone(&unit.description);
        self.units.lock().unwrap_or_else(PoisonError::into_inner).push(unit);
        Ok(description)
    }

    fn text(&self, from: &Source, path: &str) -> Result<Source, Problem> {
        let (file, text) = self.read(from, path)?;
        Ok(Source::new(file.display().to_string(), text))
    }

    fn file(&self, from: &Source, path: &str) -> Result<(), Problem> {
        given_file(self.folder_of(from), path).map(drop)
    }

    fn table(&self, from: &Source, path: &str) -> Result<Table, Problem> {
        let (_, text) = self.read(from, path)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let mut lines = text.lines().filter(|line| !line.trim().is_empty()).map(cells);
        Ok(Table { header: lines.next().unwrap_or_default(), rows: lines.collect() })
    }
}

/// The file that `file("…")` names: it can be read and is in the folder of the script.
///
/// # Errors
/// Why a unit cannot be given the file.
pub fn given_file(folder: &Path, name: &str) -> Result<PathBuf, Problem> {
    let unreadable = |error: io::Error| Problem {
        message: format!("file {name:?} cannot be read: {error}"),
        help: Some("the path is relative to the script's folder".to_owned()),
    };
    let home = folder.canonicalize().map_err(unreadable)?;
    let path = folder.join(name).canonicalize().map_err(unreadable)?;
    if !path.starts_with(&home) {
        let message = format!("file {name:?} is outside of the script's folder {}", printable::path(folder));
        return Err(Problem { message, help: Some("put it beside the script".to_owned()) });
    }
    if !path.is_file() {
        return Err(Problem { message: format!("{name:?} is not a file"), help: None });
    }
    std::fs::File::open(&path).map_err(unreadable)?;
    Ok(path)
}

/// The cells of a line between commas; a quoted cell may hold commas, and a doubled quote is one quote.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut is_quoted = false;
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match (letter, cells.last_mut()) {
            ('"', Some(cell)) if is_quoted && letters.next_if_eq(&'"').is_some() => cell.push('"'),
            ('"', _) => is_quoted = !is_quoted,
            (',', _) if !is_quoted => cells.push(String::new()),
            (letter, Some(cell)) => cell.push(letter),
            (_, None) => {}
        }
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

fn find(name: &str, folder: &Path, catalogue: &Catalogue) -> Result<ScriptUnit, Problem> {
    let archive = catalogue.find(name, folder)?;
    let problem = |error: UnitError| Problem { message: error.of_unit(name), help: None };
    let (description, mut findings) = read_loadable(&archive).map_err(problem)?;
    findings.extend(check(&description));
    Ok(ScriptUnit { name: name.to_owned(), archive, description: Arc::new(description), findings })
}

#[test]
fn parts_and_tables_are_beside_the_text_that_names_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let name = folder.path().join("a.scn").display().to_string();
    std::fs::create_dir(folder.path().join("parts")).expect("a folder inside");
    let write = |path: &str, text: &str| std::fs::write(folder.path().join(path), text).expect("a file");
    write("parts/uav.scn", "param slot = 1 m\n");
    write("parts/in.csv", "time,\"u, \"\"up\"\" [m/s]\"\n\n0, 1.5\n");
    let catalogue = Catalogue::new(Vec::new(), folder.path(), false).expect("no folder of units");
    let files = Files { name: &name, folder: folder.path(), catalogue: &catalogue, units: Mutex::default() };
    let script = Source::new(name.as_str(), "");
    let part = files.text(&script, "parts/uav.scn").expect("the part is there");
    assert_eq!(part.text, "param slot = 1 m\n");
    let table = files.table(&part, "in.csv").expect("the table is there");
    assert_eq!(table.header, ["time", "u, \"up\" [m/s]"]);
    assert_eq!(table.rows, [["0", "1.5"]]);
    let missing = files.text(&part, "uav.csv").expect_err("no such file");
    assert!(missing.message.starts_with("`uav.csv` cannot be read"), "{}", missing.message);
}
