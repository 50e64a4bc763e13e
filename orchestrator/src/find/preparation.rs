//! Everything that happens before the first unit is instantiated; whatever is wrong here ends with exit code 2.

mod checkpoints;

pub use checkpoints::CheckpointOptions;

use crate::find::catalogue::Catalogue;
use crate::find::script::Script;
use crate::run::prepared_run::PreparedRun;
use crate::run::run_spec::{HOME_PREFIX, RunSpec, SaveSpec, UnitSpec};
use checkpoints::{Candidate, Checkpoints};
use dsl::nearest::nearest;
use dsl::scenario::{Scenario, Value};
use fmi2::description::{Finding, Severity};
use results::checkpoint::Saving;
use results::report::{error_text, status};
use results::run_folder::RunFolder;
use results::run_record::{HashedFile, Host, Parameter, RunRecord, RunState, now, sha256};
use std::collections::BTreeSet;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use unit::archive::{Unpacked, unpack};

/// How many findings about one unit a run mentions.
const FINDINGS_TOLD: usize = 3;

/// What a run is asked for besides its script.
#[derive(Clone, Debug)]
pub struct PrepareOptions {
    /// Where the results go.
    pub out: PathBuf,
    /// End as soon as a claim is lost.
    pub fail_fast: bool,
    /// Record rows.
    pub record: bool,
    /// Simulated seconds for each second of the wall clock, if it is not to run as fast as it can.
    pub pace: Option<f64>,
    /// What to save, and where to continue from.
    pub checkpoints: CheckpointOptions,
    /// The names of the instances whose calls are logged.
    pub log_calls: Vec<String>,
    /// What the run reads besides what the script names.
    pub files: Vec<HashedFile>,
}

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

/// Looks for units in these folders and in the workspace around the user's current folder.
///
/// # Errors
/// If a `Cargo.toml` of that workspace cannot be read.
pub fn catalogue(folders: &[PathBuf], build: bool) -> Result<Catalogue, Refusal> {
    let current = std::env::current_dir()
        .map_err(|error| Refusal::new(&format!("cannot find the current folder: {error}"), None))?;
    Catalogue::new(folders.to_vec(), &current, build).map_err(|error| Refusal::new(&error, None))
}

/// Unpacks the units of a script and claims the folder of the results. Warnings are told.
///
/// # Errors
/// Whatever is wrong with the script, its units or the folder.
pub fn prepare(mut script: Script, wanted: PrepareOptions) -> Result<PreparedRun, Refusal> {
    let rendered = script.rendered(std::io::stderr().is_terminal());
    let Some(scenario) = script.scenario.take() else { return Err(Refusal(rendered)) };
    if !rendered.is_empty() {
        status(rendered.trim_end());
    }
    let log_calls = instances_named(&wanted.log_calls, &scenario)?;
    let files = files_of(&scenario, &script.folder)?.into_iter().chain(wanted.files).collect();
    let home = TempDir::with_prefix(HOME_PREFIX)
        .map_err(|error| Refusal::new(&format!("cannot make a folder for the units: {error}"), None))?;
    let (units, hashes) = unpack_all(&script, home.path())?;
    let mut record = record(&script, &scenario, hashes, files);
    let candidate = Candidate { scenario: &scenario, units: &units, record: &record };
    let Checkpoints { saving, from } = candidate.checkpoints(&wanted.checkpoints)?;
    let (from, continued) = from.unzip();
    record.from = continued;
    let folder = RunFolder::claim(&wanted.out, &record).map_err(|error| Refusal::new(&error, error.help()))?;
    let spec = RunSpec {
        scenario,
        folder: script.folder.canonicalize().unwrap_or_else(|_| script.folder.clone()),
        board: home.path().join("board"),
        fail_fast: wanted.fail_fast,
        record: wanted.record,
        live: false,
        pace: wanted.pace,
        saves: saves(&saving, home.path()),
        from,
        log_calls,
        units,
    };
    Ok(PreparedRun { spec, saving, record, folder, home, script: script.name })
}

/// A private file for each tick at which something is saved.
fn saves(saving: &Saving, home: &Path) -> Vec<SaveSpec> {
    let ticks: BTreeSet<_> = saving.files.iter().map(|(tick, _)| *tick).collect();
    ticks.into_iter().map(|tick| SaveSpec { tick, file: home.join(format!("checkpoint{tick}")) }).collect()
}

/// The instances of these names, each once.
fn instances_named(names: &[String], scenario: &Scenario) -> Result<Vec<usize>, Refusal> {
    let mut found = names
        .iter()
        .map(|name| {
            let known = || scenario.instances.iter().map(|instance| instance.name.as_str());
            known().position(|instance| instance == name).ok_or_else(|| {
                let help = match nearest(name, known()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("its instances are: {}", known().collect::<Vec<_>>().join(", ")),
                };
                Refusal::new(&format!("--log-fmi-calls {name}: the script has no such instance"), Some(&help))
            })
        })
        .collect::<Result<Vec<_>, _>>()?;
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

/// Where the results of a script go unless the user says so: `runs/` and its name without its ending.
#[must_use]
pub fn default_folder(script: &Path) -> PathBuf {
    Path::new("runs").join(script.file_stem().unwrap_or(script.as_os_str()))
}

/// Unpacks each unit into a folder of its own; what the standard has against it is told and tolerated.
fn unpack_all(script: &Script, home: &Path) -> Result<(Vec<UnitSpec>, Vec<HashedFile>), Refusal> {
    let mut units = Vec::new();
    let mut hashes = Vec::new();
    for (index, unit) in script.units.iter().enumerate() {
        let unpacked =
            unpack(&unit.archive, &home.join(format!("unit{index}"))).map_err(|error| Refusal::new(&error, None))?;
        for line in finding_lines(&unit.name, &unit.archive, &unit.findings) {
            status(&line);
        }
        let Unpacked { folder, description, sha256, .. } = unpacked;
        hashes.push(HashedFile { name: unit.name.clone(), sha256: sha256.clone() });
        units.push(UnitSpec { name: unit.name.clone(), folder, description, sha256 });
    }
    Ok((units, hashes))
}

fn finding_lines(name: &str, archive: &Path, findings: &[Finding]) -> Vec<String> {
    let broken: Vec<_> = findings.iter().filter(|finding| finding.severity == Severity::Error).collect();
    let told = broken.iter().take(FINDINGS_TOLD);
    let mut lines: Vec<_> = told.map(|finding| format!("warning: unit `{name}`: {finding}")).collect();
    if let Some(more) = broken.len().checked_sub(FINDINGS_TOLD).filter(|&more| more > 0) {
        lines.push(format!("warning: unit `{name}`: and {more} more: lockstep check {}", archive.display()));
    }
    lines
}

/// What `file("…")` names, hashed; each must lie in the script's folder.
fn files_of(scenario: &Scenario, folder: &Path) -> Result<Vec<HashedFile>, Refusal> {
    let presets = scenario.instances.iter().flat_map(|instance| &instance.presets);
    let names = presets.filter_map(|preset| if let Value::File(name) = &preset.value { Some(name) } else { None });
    let mut files: Vec<HashedFile> = Vec::new();
    for name in names {
        if files.iter().any(|file| file.name == *name) {
            continue;
        }
        let refused = |error: std::io::Error| Refusal::new(&format!("cannot read file(\"{name}\"): {error}"), None);
        let home = folder.canonicalize().map_err(refused)?;
        let path = folder.join(name).canonicalize().map_err(refused)?;
        if !path.starts_with(&home) {
            let message = format!("file(\"{name}\") lies outside of the script's folder {}", folder.display());
            return Err(Refusal::new(&message, Some("put it beside the script")));
        }
        let bytes = std::fs::read(&path).map_err(refused)?;
        files.push(HashedFile { name: name.clone(), sha256: sha256(&bytes) });
    }
    Ok(files)
}

/// The parameters of a scenario as results show them.
fn parameters(scenario: &Scenario) -> Vec<Parameter> {
    let parameters = scenario.parameters.iter().cloned();
    parameters.map(|dsl::scenario::Parameter { name, value, set }| Parameter { name, value, set }).collect()
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

    fn with_file(name: &str) -> Scenario {
        let mut scenario = scenario();
        scenario.instances[0].presets.push(Preset { variable: 0, value: Value::File(name.to_owned()) });
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
        for (name, words) in [("../secret", "outside"), ("link", "outside"), ("none.csv", "cannot read")] {
            let refusal = files_of(&with_file(name), &inner).map(drop).unwrap_err();
            assert!(refusal.0.contains(words), "{}", refusal.0);
        }
    }

    #[test]
    fn the_folder_of_a_run_is_named_after_its_script() {
        assert_eq!(default_folder(Path::new("scenarios/first_flight.scn")), Path::new("runs/first_flight"));
    }
}
