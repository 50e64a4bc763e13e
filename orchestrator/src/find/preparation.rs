//! Everything that happens before the first unit is instantiated; whatever is wrong here ends with exit code 2.

mod checkpoints;

use crate::find::catalogue::Catalogue;
use crate::find::script::{Script, given_file};
use crate::run::home::Home;
use crate::run::interruption::Completion;
use crate::run::prepared_run::PreparedRun;
use crate::run::run_options::RunOptions;
use crate::run::run_spec::{RunSpec, SaveSpec, UnitSpec};
use checkpoints::{Candidate, Checkpoints};
use dsl::loader::Problem;
use dsl::nearest::nearest;
use dsl::scenario::{Scenario, Value};
use fmi2::description::{Finding, Severity};
use fmi2::printable;
use results::checkpoint::Saving;
use results::report::console::has_colour;
use results::report::{diagnostics, error_text, status};
use results::run_folder::RunFolder;
use results::run_record::{Case, HashedFile, Host, Parameter, RunRecord, RunState, now, sha256};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use unit::archive::{Unpacked, unpack};
use unit::process;

/// What helps where the folder of temporary files cannot be used.
pub const OTHER_TMPDIR: &str = "set TMPDIR to another folder";
/// How many findings about one unit a run prints.
const FINDINGS_SHOWN: usize = 3;

/// Why a run cannot begin, as the user reads it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal(pub String);

impl Refusal {
    /// An error with what the user can do about it.
    #[must_use]
    pub fn new(message: &impl std::fmt::Display, help: Option<&str>) -> Self {
        Self(error_text(message, help))
    }
}

/// Looks for units in these folders, in those of `LOCKSTEP_UNITS`, and in the workspace around the user's current folder.
///
/// # Errors
/// If one of the folders or a `Cargo.toml` of that workspace cannot be read.
pub fn catalogue(folders: &[PathBuf], build: bool) -> Result<Catalogue, Refusal> {
    let current = std::env::current_dir()
        .map_err(|error| Refusal::new(&format!("cannot find the current folder: {error}"), None))?;
    let catalogue = Catalogue::with_environment(folders.to_vec(), &current, build);
    catalogue.map_err(|error| Refusal::new(&error, None))
}

/// The refusal of a script whose warnings count as errors.
#[must_use]
pub fn refused_warnings(script: &Script) -> Refusal {
    let rendered = script.rendered(has_colour(&std::io::stderr()));
    if script.has_errors() {
        return Refusal(rendered);
    }
    let warnings = script.diagnostics.len();
    let counted = if warnings == 1 { "its warning".to_owned() } else { format!("its {warnings} warnings") };
    let message = format!("{} does not run with --strict because of {counted}", script.name);
    Refusal(rendered + &error_text(&message, None))
}

/// The units of a script, unpacked into the private folder of the run; they serve all cases of the script.
#[derive(Debug)]
pub struct UnpackedUnits {
    /// Removed when this and all runs that were prepared with it are dropped.
    home: Arc<Home>,
    units: Vec<UnitSpec>,
}

/// Unpacks the units of a script and hashes them, once for all of its cases. Warnings are printed.
///
/// # Errors
/// Whatever is wrong with the script or its units.
pub fn unpack_units(script: &Script) -> Result<UnpackedUnits, Refusal> {
    let rendered = script.rendered(has_colour(&std::io::stderr()));
    if script.scenario.is_none() {
        return Err(Refusal(rendered));
    }
    if !rendered.is_empty() {
        diagnostics(rendered.trim_end());
    }
    let home = private_folder()?;
    Ok(UnpackedUnits { units: unpack_all(script, home.path())?, home: Arc::new(home) })
}

/// The private folder of a run.
fn private_folder() -> Result<Home, Refusal> {
    let home = Home::make()
        .map_err(|error| Refusal::new(&format!("cannot make a folder for the units: {error}"), Some(OTHER_TMPDIR)))?;
    let root = home.path().parent().unwrap_or(home.path());
    if process::forbids_libraries(home.path()) {
        let message =
            format!("no library can be loaded from {}: its file system is mounted noexec", printable::path(root));
        return Err(Refusal::new(&message, Some(OTHER_TMPDIR)));
    }
    if home.is_replaceable() {
        status(&format!(
            "warning: other users can replace the units of this run: all may rename folders in {}\n\
             help: {OTHER_TMPDIR}, or run chmod +t on it",
            printable::path(root)
        ));
    }
    Ok(home)
}

/// Prepares one case of a script, whose units are unpacked: checks what it reads and continues from, and claims the folder
/// of its results.
///
/// # Errors
/// Whatever is wrong with the script, its files, the options or the folder.
pub fn prepare(mut script: Script, unpacked: &UnpackedUnits, options: RunOptions) -> Result<PreparedRun, Refusal> {
    let Some(scenario) = script.scenario.take() else {
        return Err(Refusal(script.rendered(has_colour(&std::io::stderr()))));
    };
    check_log_calls(&options.log_calls, &scenario)?;
    let parts = script.parts.iter().map(|&part| script.part(part));
    let parts = parts.map(|(name, text)| HashedFile { name, sha256: sha256(text.as_bytes()) });
    let files = files_of(&scenario, &script.folder)?.into_iter().chain(options.files.iter().cloned());
    let files = parts.chain(script.tables.iter().cloned()).chain(files).collect();
    let UnpackedUnits { home, units } = unpacked;
    let hash = |unit: &UnitSpec| HashedFile { name: unit.name.clone(), sha256: unit.sha256.clone() };
    let mut record = record(&script, &scenario, units.iter().map(hash).collect(), files);
    let candidate = Candidate { scenario: &scenario, units, record: &record };
    let Checkpoints { saving, from } = candidate.checkpoints(&options)?;
    let (from, continued) = from.unzip();
    record.from = continued;
    let completion = Completion::begin();
    let folder = RunFolder::claim(&options.out, &record).map_err(|error| Refusal::new(&error, error.help()))?;
    let spec = RunSpec {
        worker_of: options.isolate.then(|| (0..scenario.instances.len()).collect()),
        scenario,
        folder: folder_for_units(&script.folder, home.path())?,
        board: home.path().join("board"),
        options,
        saves: saves(&saving, home.path()),
        from,
        units: units.clone(),
    };
    Ok(PreparedRun { spec, saving, record, folder, home: Arc::clone(home), completion, script: script.name })
}

/// A specification for the tests of a script's units, which leave no results, with the private folder that it needs.
///
/// # Errors
/// Whatever is wrong with the script.
pub fn prepare_tests(
    mut script: Script,
    unpacked: UnpackedUnits,
    options: RunOptions,
) -> Result<(RunSpec, Arc<Home>), Refusal> {
    let Some(scenario) = script.scenario.take() else {
        return Err(Refusal(script.rendered(has_colour(&std::io::stderr()))));
    };
    let UnpackedUnits { home, units } = unpacked;
    let board = home.path().join("board");
    let spec = RunSpec {
        scenario,
        units,
        folder: script.folder,
        board,
        options,
        worker_of: None,
        saves: Vec::new(),
        from: None,
    };
    Ok((spec, home))
}

/// A private file for each tick at which something is saved.
fn saves(saving: &Saving, home: &Path) -> Vec<SaveSpec> {
    let ticks: BTreeSet<_> = saving.files.iter().map(|(tick, _)| *tick).collect();
    ticks.into_iter().map(|tick| SaveSpec { tick, file: home.join(format!("checkpoint{tick}")) }).collect()
}

/// Refuses a name that no instance has.
fn check_log_calls(names: &[String], scenario: &Scenario) -> Result<(), Refusal> {
    let known = || scenario.instances.iter().map(|instance| instance.name.as_str());
    let Some(name) = names.iter().find(|name| !known().any(|known| known == *name)) else { return Ok(()) };
    let help = match nearest(name, known()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("its instances are: {}", known().collect::<Vec<_>>().join(", ")),
    };
    Err(Refusal::new(&format!("--log-fmi-calls {name}: the script has no such instance"), Some(&help)))
}

/// Where the results of a script go unless the user says so: `runs/` and its name without its ending.
#[must_use]
pub fn default_folder(script: &Path) -> PathBuf {
    Path::new("runs").join(script.file_stem().unwrap_or(script.as_os_str()))
}

/// Unpacks each unit into a folder of its own. Violations of the standard are printed as warnings.
fn unpack_all(script: &Script, home: &Path) -> Result<Vec<UnitSpec>, Refusal> {
    let mut units = Vec::new();
    for (index, unit) in script.units.iter().enumerate() {
        let unpacked =
            unpack(&unit.archive, &home.join(format!("unit{index}"))).map_err(|error| Refusal::new(&error, None))?;
        for line in finding_lines(&unit.name, &unit.archive, &unit.findings) {
            status(&line);
        }
        let Unpacked { folder, description, sha256, .. } = unpacked;
        units.push(UnitSpec { name: unit.name.clone(), folder, description, sha256 });
    }
    Ok(units)
}

fn finding_lines(name: &str, archive: &Path, findings: &[Finding]) -> Vec<String> {
    let broken: Vec<_> = findings.iter().filter(|finding| finding.severity == Severity::Error).collect();
    let shown = broken.iter().take(FINDINGS_SHOWN);
    let mut lines: Vec<_> = shown.map(|finding| format!("warning: unit `{name}`: {finding}")).collect();
    if let Some(more) = broken.len().checked_sub(FINDINGS_SHOWN).filter(|&more| more > 0) {
        lines.push(format!(
            "warning: unit `{name}`: and {more} more: {} check {}",
            results::report::invocation::program(),
            printable::path(archive)
        ));
    }
    lines
}

/// What `file("…")` names, hashed; each must lie in the script's folder.
fn files_of(scenario: &Scenario, folder: &Path) -> Result<Vec<HashedFile>, Refusal> {
    let presets = scenario.instances.iter().flat_map(|instance| &instance.presets);
    // All of them are named by the script or the command line, whose paths are relative to the script's folder.
    let names = presets.filter_map(|preset| match &preset.value {
        Value::File(file) => Some(&file.path),
        _ => None,
    });
    let mut files: Vec<HashedFile> = Vec::new();
    for name in names {
        if files.iter().any(|file| file.name == *name) {
            continue;
        }
        let refused = |problem: Problem| Refusal::new(&problem.message, problem.help.as_deref());
        let path = given_file(folder, name).map_err(refused)?;
        let unreadable = |error| Refusal::new(&format!("cannot read {}: {error}", printable::path(&path)), None);
        let bytes = std::fs::read(&path).map_err(unreadable)?;
        files.push(HashedFile { name: name.clone(), sha256: sha256(&bytes) });
    }
    Ok(files)
}

/// The script's folder under a name that units can be given, whose texts are UTF-8: a link in the private folder if its own
/// is not.
fn folder_for_units(folder: &Path, home: &Path) -> Result<PathBuf, Refusal> {
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    if folder.to_str().is_some() {
        return Ok(folder);
    }
    let link = home.join("script");
    match std::os::unix::fs::symlink(&folder, &link) {
        Err(error) if error.kind() != std::io::ErrorKind::AlreadyExists => {
            Err(Refusal::new(&format!("cannot make {}: {error}", printable::path(&link)), None))
        }
        _ => Ok(link),
    }
}

/// The parameters of a scenario as results show them.
fn parameters(scenario: &Scenario) -> Vec<Parameter> {
    let parameters = scenario.parameters.iter().cloned();
    parameters.map(|dsl::scenario::Parameter { name, value, set }| Parameter { name, value, set }).collect()
}

fn case(dsl::scenario::Case { number, draw_seed }: dsl::scenario::Case) -> Case {
    Case { number, draw_seed }
}

fn record(script: &Script, scenario: &Scenario, units: Vec<HashedFile>, files: Vec<HashedFile>) -> RunRecord {
    RunRecord {
        lockstep: env!("CARGO_PKG_VERSION"),
        state: RunState::Running,
        scenario: scenario.title.clone(),
        script: HashedFile { name: script.name.clone(), sha256: sha256(script.text.as_bytes()) },
        units,
        files,
        from: None,
        parameters: parameters(scenario),
        case: scenario.sweep.and_then(|sweep| sweep.case).map(case),
        host: Host::this(),
        started: now(),
        wall_s: 0.0,
        simulated_s: None,
        broken: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::scenario;
    use dsl::scenario::Preset;
    use dsl::source::FileRef;

    fn with_file(name: &str) -> Scenario {
        let mut scenario = scenario();
        scenario.instances[0]
            .presets
            .push(Preset { variable: 0, value: Value::File(FileRef { from: 0, path: name.to_owned() }) });
        scenario
    }

    #[test]
    fn a_file_beside_the_script_is_hashed_once() {
        let home = tempfile::tempdir().unwrap();
        std::fs::write(home.path().join("yard.csv"), "").unwrap();
        let mut scenario = with_file("yard.csv");
        let again = scenario.instances[0].presets[0].clone();
        scenario.instances[0].presets.push(again);
        let files = files_of(&scenario, home.path()).unwrap_or_else(|refusal| panic!("{}", refusal.0));
        assert_eq!(files, [HashedFile { name: "yard.csv".to_owned(), sha256: sha256(b"") }]);
    }

    #[test]
    fn a_file_outside_of_the_scripts_folder_or_missing_is_refused() {
        let home = tempfile::tempdir().unwrap();
        let inner = home.path().join("scenarios");
        std::fs::create_dir(&inner).unwrap();
        std::fs::write(home.path().join("secret"), "").unwrap();
        std::os::unix::fs::symlink("../secret", inner.join("link")).unwrap();
        for (name, text) in
            [("../secret", "outside"), ("link", "outside"), ("none.csv", "cannot be read"), (".", "is not a file")]
        {
            let refusal = files_of(&with_file(name), &inner).map(drop).unwrap_err();
            assert!(refusal.0.contains(text), "{}", refusal.0);
        }
    }

    #[test]
    fn the_folder_of_a_run_is_named_after_its_script() {
        assert_eq!(default_folder(Path::new("scenarios/first_flight.scn")), Path::new("runs/first_flight"));
    }
}
