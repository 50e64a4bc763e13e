//! A script with everything that it names: its text, its units' descriptions, and what it means.
//!
//! `check` and `run` read scripts through here, so that both find the same errors.

use crate::find::catalogue::Catalogue;
use dsl::diagnostic::{Diagnostic, Severity, render};
use dsl::loader::{Loader, Problem, Table, TableColumn};
use dsl::parse::{parse, parse_assignment};
use dsl::parts::Parts;
use dsl::resolve::{AskedCase, Request, resolve};
use dsl::scenario::{Scenario, Value};
use dsl::source::{FileRef, Source, Sources, Span};
use dsl::syntax::{Binding, File};
use fmi2::description::check::check;
use fmi2::description::{Finding, ModelDescription};
use fmi2::printable;
use results::run_record::{HashedFile, sha256};
use results::table::{CellType, TableError, TableFile};
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
    /// Its parts, as texts of `sources`.
    pub parts: Vec<u32>,
    /// The files of its curves, each once.
    pub tables: Vec<HashedFile>,
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

/// What the command line says about a script.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScriptOptions<'a> {
    /// Assignments to parameters, each as one text.
    pub settings: &'a [String],
    /// The case of the sweep that gives parameters their values.
    pub case: Option<u64>,
    /// Whether each instance will have a process of its own.
    pub isolated: bool,
}

impl Script {
    /// Reads and resolves a script.
    ///
    /// # Errors
    /// If the file cannot be read; errors in its content are among the diagnostics.
    pub fn read(path: &Path, options: ScriptOptions<'_>, catalogue: &Catalogue) -> io::Result<Self> {
        let text = String::from_utf8(std::fs::read(path)?)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, format!("it is not UTF-8: {error}")))?;
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        let name = printable::path(path);
        Ok(Self::of_text(name, folder, text, options, catalogue))
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
        let folder = PathBuf::from(".");
        let (parts, tables, units) = (Vec::new(), Vec::new(), Vec::new());
        let mut script = Self { name, folder, text, sources, diagnostics, scenario: None, parts, tables, units };
        if let Some(file) = file {
            script.resolve(&file, (&[], None), catalogue, false);
        }
        script
    }

    /// The same for a text of which paths are relative to `folder`.
    #[must_use]
    pub fn of_text(
        name: String,
        folder: PathBuf,
        text: String,
        options: ScriptOptions<'_>,
        catalogue: &Catalogue,
    ) -> Self {
        let mut script = Self {
            name: name.clone(),
            folder,
            text: text.clone(),
            sources: Sources::default(),
            diagnostics: Vec::new(),
            scenario: None,
            parts: Vec::new(),
            tables: Vec::new(),
            units: Vec::new(),
        };
        let file_text = script.sources.add(name, text);
        let parsed = parse(&script.sources, file_text);
        script.diagnostics = parsed.diagnostics;
        let settings = script.assignments(options.settings);
        let case = options.case.map(|number| script.case(number));
        if script.diagnostics.is_empty() {
            script.resolve(&parsed.file, (&settings, case), catalogue, options.isolated);
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

    /// A case whose number has a place for diagnostics.
    fn case(&mut self, number: u64) -> AskedCase {
        let written = number.to_string();
        let end = u32::try_from(written.len()).unwrap_or_default();
        let text = self.sources.add("--case", written);
        AskedCase { number, place: Span { text, start: 0, end } }
    }

    fn resolve(
        &mut self,
        file: &File,
        (settings, case): (&[Binding], Option<AskedCase>),
        catalogue: &Catalogue,
        isolated: bool,
    ) {
        let files = Files {
            name: &self.name,
            folder: &self.folder,
            catalogue,
            units: Mutex::default(),
            tables: Mutex::default(),
        };
        let parts = Parts::load(&mut self.sources, file, &files);
        if !parts.diagnostics.is_empty() {
            self.diagnostics = parts.diagnostics;
            return;
        }
        let request = Request { sources: &self.sources, file, parts: &parts, loader: &files, settings, case, isolated };
        let resolved = resolve(&request);
        self.units = files.units.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.tables = files.tables.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.diagnostics = resolved.diagnostics;
        self.scenario = resolved.scenario;
        self.parts = parts.iter().map(|part| part.text).collect();
        self.files_beside_script();
    }

    /// Names the files that parts name by paths that are relative to the script's folder.
    fn files_beside_script(&mut self) {
        let presets = self.scenario.iter_mut().flat_map(|scenario| &mut scenario.instances);
        for preset in presets.flat_map(|instance| &mut instance.presets) {
            if let Value::File(file) = &mut preset.value
                && self.parts.contains(&file.from)
                && let Some(folder) = Path::new(self.sources.name(file.from)).parent()
            {
                let folder = folder.strip_prefix(&self.folder).unwrap_or(folder);
                *file = FileRef { from: 0, path: folder.join(&file.path).display().to_string() };
            }
        }
    }

    /// The name of a part, relative to the script's folder, and its text.
    pub fn part(&self, part: u32) -> (String, &str) {
        let name = Path::new(self.sources.name(part));
        (name.strip_prefix(&self.folder).unwrap_or(name).display().to_string(), self.sources.text(part))
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
    /// The files of the tables that were read.
    tables: Mutex<Vec<HashedFile>>,
}

impl Files<'_> {
    /// The folder that paths of a text are relative to; assignments of the command line use the script's.
    fn folder_of<'f>(&'f self, from: &'f Source) -> &'f Path {
        let folder = Path::new(&from.name).parent().filter(|folder| from.name != self.name && *folder != Path::new(""));
        folder.unwrap_or(self.folder)
    }

    /// Notes a table with the hash of what was read.
    fn note_table(&self, file: &Path, bytes: &[u8]) {
        let home = self.folder.canonicalize().unwrap_or_else(|_| self.folder.to_owned());
        let name = file.strip_prefix(&home).unwrap_or(file).display().to_string();
        let mut tables = self.tables.lock().unwrap_or_else(PoisonError::into_inner);
        if tables.iter().all(|known| known.name != name) {
            tables.push(HashedFile { name, sha256: sha256(bytes) });
        }
    }

    fn read(&self, from: &Source, path: &str) -> Result<(PathBuf, String), Problem> {
        let folder = self.folder_of(from);
        let file = if folder == Path::new(".") { PathBuf::from(path) } else { folder.join(path) };
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
        let file = given_file(self.folder_of(from), path)?;
        let problem = |error: TableError| Problem { message: error.to_string(), help: error.help };
        let bytes = std::fs::read(&file).map_err(|error| unreadable(path, &error))?;
        self.note_table(&file, &bytes);
        let mut table = TableFile::of_bytes(&self.folder_of(from).join(path), bytes).map_err(problem)?;
        let headings = table.headings().iter().skip(1);
        let names = headings.map(|heading| match heading.with_unit() {
            Some((name, unit)) => (name.to_owned(), Some(unit.to_owned())),
            None => (heading.text.clone(), None),
        });
        let names: Vec<(String, Option<String>)> = names.collect();
        let columns = table.read(&vec![CellType::Any; names.len()], false).map_err(problem)?;
        let mut numbers = columns.into_iter().map(|column| column.into_iter().flatten().collect::<Vec<f64>>());
        let time_s = numbers.next().unwrap_or_default();
        if time_s.is_empty() {
            return Err(problem(table.wrong_heading(0, "the file has names, but no rows".to_owned())));
        }
        let columns = (1..).zip(names).zip(numbers);
        let column =
            |((index, (name, unit)), values)| TableColumn { name, unit, values, held: table.is_discrete(index) };
        Ok(Table { time_s, columns: columns.map(column).collect() })
    }
}

fn unreadable(path: &str, error: &io::Error) -> Problem {
    let help = Some("the path is relative to the script's folder".to_owned());
    Problem { message: format!("file {path:?} cannot be read: {error}"), help }
}

/// The file that `file("…")` names: it can be read and is in the folder of the script.
///
/// # Errors
/// Why a unit cannot be given the file.
pub fn given_file(folder: &Path, name: &str) -> Result<PathBuf, Problem> {
    let unreadable = |error: io::Error| unreadable(name, &error);
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
    let files = Files {
        name: &name,
        folder: folder.path(),
        catalogue: &catalogue,
        units: Mutex::default(),
        tables: Mutex::default(),
    };
    let script = Source::new(name.as_str(), "");
    let part = files.text(&script, "parts/uav.scn").expect("the part is there");
    assert_eq!(part.text, "param slot = 1 m\n");
    let table = files.table(&part, "in.csv").expect("the table is there");
    let column =
        TableColumn { name: "u, \"up\"".to_owned(), unit: Some("m/s".to_owned()), values: vec![1.5], held: false };
    assert_eq!(table, Table { time_s: vec![0.0], columns: vec![column] });
    let missing = files.text(&part, "uav.csv").expect_err("no such file");
    assert!(missing.message.starts_with("`uav.csv` cannot be read"), "{}", missing.message);
}
