//! Finds the units that a script names, and builds those of the user's own workspace that are stale.
//!
//! A name that ends in `.fmu` or `.FMU` is a path beside the script. Any other name is looked up in the folders of
//! `--units` and of `LOCKSTEP_UNITS` (of a workspace there, among its packed units), then among the unit crates of cargo
//! workspaces that `--units` names, then among the packed units of the workspace that the script is in, then among the unit crates of the workspace that the user's current
//! folder is in. Nothing else is ever built, so that a script from elsewhere cannot make this program build anything.

use dsl::loader::Problem as UnitProblem;
use fmi2::printable;
use pack::{UnitCrate, Workspace};
use results::report::invocation::program;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Where units are looked for.
#[derive(Debug)]
pub struct Catalogue {
    /// Those of the command line, then those of the environment.
    folders: Vec<PathBuf>,
    /// The first folder of the environment that is none.
    missing: Option<PathBuf>,
    /// The cargo workspaces that the command line names.
    named_workspaces: Vec<Workspace>,
    workspace: Option<Workspace>,
    build: bool,
    /// A file that the command line names, and the name by which it is looked up.
    named: Option<(String, PathBuf)>,
}

/// A unit that can be run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its name in scripts.
    pub name: String,
    /// Where it comes from.
    pub origin: Origin,
}

/// Where a unit comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A packed file.
    Archive(PathBuf),
    /// A crate of the workspace.
    Crate(UnitCrate),
}

impl Entry {
    /// The name of the packed file.
    fn file_name(&self) -> Option<String> {
        let Origin::Archive(path) = &self.origin else { return None };
        path.file_name().map(|name| name.to_string_lossy().into_owned())
    }
}

/// The environment variable with folders of units.
const UNIT_FOLDERS: &str = "LOCKSTEP_UNITS";

/// Whether a name is that of a packed unit: it ends in `.fmu`, in letters of any case.
#[must_use]
pub fn is_archive(name: &Path) -> bool {
    name.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("fmu"))
}

impl Catalogue {
    /// Looks at the workspace around `current`; `build` is false for `--no-build`.
    ///
    /// # Errors
    /// If one of the folders or a `Cargo.toml` of that workspace cannot be read.
    pub fn new(folders: Vec<PathBuf>, current: &Path, build: bool) -> Result<Self, pack::PackError> {
        for folder in &folders {
            let unreadable = |source| pack::PackError::File { path: folder.clone(), doing: "read", source };
            std::fs::read_dir(folder).map_err(unreadable)?;
        }
        let named_workspaces =
            folders.iter().filter_map(|folder| workspace_at(folder).transpose()).collect::<Result<_, _>>()?;
        let workspace = Workspace::around(current)?;
        Ok(Self { folders, missing: None, named_workspaces, workspace, build, named: None })
    }

    /// The same with the folders that `LOCKSTEP_UNITS` names behind these; of a workspace the packed units.
    ///
    /// # Errors
    /// If one of the folders or a `Cargo.toml` of that workspace cannot be read; a folder of the environment that is none
    /// is an error of each name that is looked up.
    pub fn with_environment(folders: Vec<PathBuf>, current: &Path, build: bool) -> Result<Self, pack::PackError> {
        let mut catalogue = Self::new(folders, current, build)?;
        let named = std::env::var_os(UNIT_FOLDERS).unwrap_or_default();
        let named = std::env::split_paths(&named).filter(|folder| !folder.as_os_str().is_empty());
        let (folders, missing): (Vec<_>, Vec<_>) = named.partition(|folder| folder.is_dir());
        for folder in folders {
            let packed =
                workspace_at(&folder)?.and_then(|found| Some(found.units.first()?.archive().parent()?.to_path_buf()));
            catalogue.folders.push(folder);
            catalogue.folders.extend(packed.filter(|folder| folder.is_dir()));
        }
        catalogue.missing = missing.into_iter().next();
        Ok(catalogue)
    }

    /// The name by which a unit of the command line is looked up. A path that a script cannot name gets another.
    pub fn name_of(&mut self, unit: &OsStr) -> String {
        match unit.to_str() {
            Some(name) if printable::line(name) == name && !name.contains(['"', '\\']) => name.to_owned(),
            _ => {
                let name = printable::line(&unit.to_string_lossy()).replace(['"', '\\'], "\u{fffd}");
                self.named = Some((name.clone(), PathBuf::from(unit)));
                name
            }
        }
    }

    /// All units that bare names can mean in every script, sorted by name; a folder of units comes before the workspace.
    #[must_use]
    pub fn entries(&self) -> Vec<Entry> {
        let packed = self.folders.iter().flat_map(|folder| archives_in(folder));
        let workspaces = self.named_workspaces.iter().chain(&self.workspace);
        let crates = workspaces.flat_map(|workspace| &workspace.units);
        let crates = crates.map(|unit| Entry { name: unit.name.clone(), origin: Origin::Crate(unit.clone()) });
        let mut entries: Vec<_> = packed.chain(crates).collect();
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        entries.dedup_by(|later, first| later.name == first.name);
        entries
    }

    /// The archive that a script in `folder` means by `name`, built first if it is stale.
    ///
    /// # Errors
    /// Says why there is none, with the nearest names.
    pub fn find(&self, name: &str, folder: &Path) -> Result<PathBuf, UnitProblem> {
        if is_archive(Path::new(name)) {
            let named = self.named.as_ref().filter(|(given, _)| given == name);
            let path = folder.join(named.map_or(Path::new(name), |(_, path)| path));
            return if path.is_file() { Ok(path) } else { Err(no_file(name, &path)) };
        }
        if let Some(folder) = &self.missing {
            let message = format!("{UNIT_FOLDERS} names {}, which is no folder", printable::path(folder));
            let help = Some("it is a list of folders with `:` between them".to_owned());
            return Err(UnitProblem { message, help });
        }
        let found = self.entries().into_iter().find(|entry| entry.name == name).map(|entry| entry.origin);
        if let Some(Origin::Archive(path)) = found {
            return Ok(path);
        }
        let is_named = |unit: &UnitCrate| self.named_workspaces.iter().any(|named| named.units.contains(unit));
        if let Some(Origin::Crate(unit)) =
            found.as_ref().filter(|found| matches!(found, Origin::Crate(unit) if is_named(unit)))
        {
            return self.built(unit);
        }
        let of_script = self.workspace_of_script(folder)?;
        let of_script = of_script.iter().flat_map(|workspace| &workspace.units).find(|unit| unit.name == name);
        match (of_script.map(UnitCrate::archive).filter(|archive| archive.is_file()), found) {
            (Some(archive), _) => Ok(archive),
            (None, Some(Origin::Crate(unit))) => self.built(&unit),
            (None, _) => Err(of_script.map_or_else(|| self.unknown(name), not_packed)),
        }
    }

    /// The workspace that a script's folder is in, if that is another than the user's.
    fn workspace_of_script(&self, folder: &Path) -> Result<Option<Workspace>, UnitProblem> {
        let own = self.workspace.as_ref().and_then(|own| own.folder.canonicalize().ok());
        let Ok(folder) = folder.canonicalize() else { return Ok(None) };
        if own.is_some_and(|own| folder.starts_with(own)) {
            return Ok(None);
        }
        Workspace::around(&folder).map_err(|error| UnitProblem { message: error.to_string(), help: None })
    }

    fn built(&self, unit: &UnitCrate) -> Result<PathBuf, UnitProblem> {
        let archive = unit.archive();
        if !pack::is_stale(unit, &archive) {
            return Ok(archive);
        }
        if !self.build {
            let message = format!("unit `{}` is not built, or older than its sources", unit.name);
            let help = format!("leave out --no-build, or run: {} pack {}", program(), unit.name);
            return Err(UnitProblem { message, help: Some(help) });
        }
        results::report::status(&format!("building unit `{}`", unit.name));
        pack::pack(unit, &unit::describe::describe_library, &archive, &results::report::status)
            .map_err(|error| UnitProblem { message: error.to_string(), help: error.help() })?;
        Ok(archive)
    }

    fn unknown(&self, name: &str) -> UnitProblem {
        let entries = self.entries();
        let names = entries.iter().map(|entry| entry.name.as_str());
        let help = match dsl::nearest::nearest(name, names) {
            Some(near) => format!("did you mean `{near}`? All units: {} describe", program()),
            None if entries.is_empty() => {
                "name a file, \"my_unit.fmu\", or a folder of them, --units DIR; here is no cargo workspace with units"
                    .to_owned()
            }
            None => format!("{} units are here: {} describe", entries.len(), program()),
        };
        UnitProblem { message: format!("there is no unit `{name}`"), help: Some(help) }
    }
}

/// The workspace or unit crate whose folder this is.
fn workspace_at(folder: &Path) -> Result<Option<Workspace>, pack::PackError> {
    if folder.join("Cargo.toml").is_file() { Workspace::around(folder) } else { Ok(None) }
}

/// That a unit of another workspace than the user's is not packed.
fn not_packed(unit: &UnitCrate) -> UnitProblem {
    let message = format!("unit `{}` of the workspace that this script is in is not packed", unit.name);
    let folder = printable::path(&unit.workspace);
    let help = format!("run `{} pack {}` in {folder}, or allow it to be built: --units {folder}", program(), unit.name);
    UnitProblem { message, help: Some(help) }
}

fn no_file(name: &str, path: &Path) -> UnitProblem {
    let near = archives_in(path.parent().unwrap_or(Path::new(".")));
    let names: Vec<_> = near.iter().filter_map(Entry::file_name).collect();
    let file_name = Path::new(name).file_name().map(|file| file.to_string_lossy().into_owned()).unwrap_or_default();
    let help = dsl::nearest::nearest(&file_name, names.iter().map(String::as_str)).map_or_else(
        || "paths are relative to the script".to_owned(),
        |near| format!("paths are relative to the script; did you mean `{near}`?"),
    );
    UnitProblem { message: format!("there is no file `{}`", printable::path(path)), help: Some(help) }
}

fn archives_in(folder: &Path) -> Vec<Entry> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let archives = files.filter(|path| path.is_file() && is_archive(path));
    let mut entries: Vec<_> = archives
        .filter_map(|path| Some(Entry { name: path.file_stem()?.to_str()?.to_owned(), origin: Origin::Archive(path) }))
        .collect();
    entries.sort_by(|a, b| a.name.cmp(&b.name));
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_relative_to_the_script() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("tank.fmu"), "").unwrap();
        let catalogue = Catalogue::new(Vec::new(), folder.path(), false).unwrap();
        assert_eq!(catalogue.find("tank.fmu", folder.path()).unwrap(), folder.path().join("tank.fmu"));
        let problem = catalogue.find("tamk.fmu", folder.path()).unwrap_err();
        assert_eq!(problem.help.as_deref(), Some("paths are relative to the script; did you mean `tank.fmu`?"));
        std::fs::write(folder.path().join("PUMP.FMU"), "").unwrap();
        assert_eq!(catalogue.find("PUMP.FMU", folder.path()).unwrap(), folder.path().join("PUMP.FMU"));
        let problem = catalogue.find("PUMP.fmu", folder.path()).unwrap_err();
        assert_eq!(problem.help.as_deref(), Some("paths are relative to the script; did you mean `PUMP.FMU`?"));
    }

    #[test]
    fn a_folder_of_units_comes_before_the_workspace() {
        let root = tempfile::tempdir().unwrap();
        std::fs::write(root.path().join("Cargo.toml"), "[package]\nname = \"tank\"\n[package.metadata.fmu]\n").unwrap();
        std::fs::create_dir(root.path().join("packed")).unwrap();
        let packed = root.path().join("packed/tank.fmu");
        std::fs::write(&packed, "").unwrap();
        let catalogue = Catalogue::new(vec![root.path().join("packed")], root.path(), false).unwrap();
        assert_eq!(catalogue.entries().len(), 1);
        assert_eq!(catalogue.find("tank", root.path()).unwrap(), packed);
    }

    #[test]
    fn a_packed_unit_of_the_scripts_own_workspace_is_found_and_never_built() {
        let root = tempfile::tempdir().unwrap();
        let write = |path: &str, text: &str| {
            let path = root.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        write("theirs/Cargo.toml", "[package]\nname = \"tank\"\n[package.metadata.fmu]\n");
        write("theirs/scenarios/a.scn", "");
        write("mine/Cargo.toml", "[package]\nname = \"tank\"\n[package.metadata.fmu]\n");
        let [theirs, mine] = ["theirs", "mine"].map(|folder| root.path().canonicalize().unwrap().join(folder));
        let from_elsewhere = Catalogue::new(Vec::new(), root.path(), true).unwrap();
        let problem = from_elsewhere.find("tank", &theirs.join("scenarios")).unwrap_err();
        assert_eq!(problem.message, "unit `tank` of the workspace that this script is in is not packed");
        let folder = theirs.display();
        let help = format!("run `{} pack tank` in {folder}, or allow it to be built: --units {folder}", program());
        assert_eq!(problem.help, Some(help));
        let archive = UnitCrate::archive(&Workspace::around(&theirs).unwrap().unwrap().units[0]);
        std::fs::create_dir_all(archive.parent().unwrap()).unwrap();
        std::fs::write(&archive, "").unwrap();
        for current in [root.path(), &mine] {
            let catalogue = Catalogue::new(Vec::new(), current, false).unwrap();
            assert_eq!(catalogue.find("tank", &theirs.join("scenarios")).unwrap(), archive);
        }
        let inside = Catalogue::new(Vec::new(), &theirs, false).unwrap();
        let stale = inside.find("tank", &theirs.join("scenarios"));
        assert!(stale.is_err(), "inside of the workspace a crate is built when it is stale: {stale:?}");
    }

    #[test]
    fn a_workspace_that_the_command_line_names_offers_its_crates() {
        let root = tempfile::tempdir().unwrap();
        let theirs = root.path().join("theirs");
        std::fs::create_dir(&theirs).unwrap();
        std::fs::write(theirs.join("Cargo.toml"), "[package]\nname = \"tank\"\n[package.metadata.fmu]\n").unwrap();
        let named = Catalogue::new(vec![theirs.clone()], root.path(), false).unwrap();
        let problem = named.find("tank", root.path()).unwrap_err();
        assert_eq!(problem.message, "unit `tank` is not built, or older than its sources");
        let plain = Catalogue::new(Vec::new(), root.path(), false).unwrap();
        assert_eq!(plain.find("tank", root.path()).unwrap_err().message, "there is no unit `tank`");
    }

    #[test]
    fn a_folder_of_units_that_is_not_there_is_an_error() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("nope");
        let error = Catalogue::new(vec![folder.clone()], root.path(), false).unwrap_err().to_string();
        assert!(error.starts_with(&format!("cannot read {}: ", folder.display())), "{error}");
    }

    #[test]
    fn no_build_says_what_to_run() {
        let root = tempfile::tempdir().unwrap();
        std::fs::write(root.path().join("Cargo.toml"), "[package]\nname = \"tank\"\n[package.metadata.fmu]\n").unwrap();
        let catalogue = Catalogue::new(Vec::new(), root.path(), false).unwrap();
        let problem = catalogue.find("tank", root.path()).unwrap_err();
        assert_eq!(problem.help, Some(format!("leave out --no-build, or run: {} pack tank", program())));
    }
}
