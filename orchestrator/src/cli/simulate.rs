//! `lockstep simulate`: one unit alone, as FMPy and fmusim users know it.

pub(super) mod alone;
mod column_name;
pub(super) mod experiment;
mod input_file;
mod record;
mod start_values;

use super::exit_code;
use crate::find::preparation::{self, Refusal};
use crate::host::execution::{ReadyRun, RunOutcome};
use crate::run::prepared_run::PreparedRun;
use crate::run::run_options::RunOptions;
use alone::Alone;
use fmi2::printable;
use record::Recorded;
use results::TraceError;
use results::recorder::Formats;
use results::report;
use results::report::console::Style;
use results::report::invocation::program;
use results::report::table::{heading_line, next_lines};
use results::run_folder::TRACE_CSV;
use results::run_record::{HashedFile, sha256};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Simulates one unit alone.
///
/// Start, stop and step are those of the unit's DefaultExperiment, or one second in steps of a thousandth. Outputs, inputs
/// and what --input drives are recorded under their own names. Ends with 0 if the unit came to the end, 2 if the command
/// line is wrong, 3 if the run broke, 130 if it was interrupted.
#[derive(Debug, clap::Args)]
pub struct Simulate {
    /// An .fmu file, or a unit as scripts name it
    unit: OsString,
    /// When to begin, for example 20s; a bare number is in seconds
    #[arg(long, value_name = "TIME", value_parser = experiment::start)]
    start: Option<f64>,
    /// When to end, for example 10s; a bare number is in seconds
    #[arg(long, value_name = "TIME", value_parser = experiment::time)]
    stop: Option<f64>,
    /// The communication step, for example 10ms; a bare number is in seconds
    #[arg(long, value_name = "TIME", value_parser = experiment::time)]
    step: Option<f64>,
    /// Sets a parameter or start value, for example 'mass = 1.6 kg'; a bare number is in the variable's own unit
    #[arg(long, value_name = "NAME = VALUE")]
    set: Vec<String>,
    /// Inputs over time, CSV or Parquet: the first column is `time` in seconds, or `time [ms]`; the others are named as
    /// inputs or tunable parameters, with a unit of measure if you like, `speed [km/h]`. Reals are interpolated, everything
    /// else is held; so are the ends
    #[arg(long, value_name = "FILE")]
    input: Option<PathBuf>,
    /// What is recorded: names of variables, of any causality, or patterns such as 'wheel.*'; all; or none
    #[arg(long, value_name = "NAME,…|all|none")]
    record: Vec<String>,
    /// The formats of the trace, for example csv [default: csv,parquet]
    #[arg(long, value_name = "csv,parquet", value_parser = super::formats)]
    format: Option<Formats>,
    /// Where the results go; a folder of an earlier run is replaced [default: runs/UNIT-alone]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Copies the recorded rows to this file too
    #[arg(long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// A folder of units, looked up before those of LOCKSTEP_UNITS and the workspace
    #[arg(long, value_name = "DIR")]
    units: Vec<PathBuf>,
    /// Never build a unit
    #[arg(long)]
    no_build: bool,
    /// How long a call of the unit may take before the run is given up; 0 waits for ever
    #[arg(long, value_name = "TIME", default_value = "10s", value_parser = humantime::parse_duration)]
    step_timeout: Duration,
}

impl Simulate {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        exit_code::reached(self.prepare().map(ReadyRun::from), Style::fitting(false), false, |outcome| {
            self.print(outcome)
        })
    }

    fn prepare(&self) -> Result<PreparedRun, Refusal> {
        let mut catalogue = preparation::catalogue(&self.units, !self.no_build)?;
        let alone = Alone::find(&catalogue.name_of(&self.unit), &catalogue)?;
        let (curves, files) = match &self.input {
            Some(path) => {
                let (curves, file) = self.read_input(path, &alone)?;
                (curves, vec![file])
            }
            None => (Vec::new(), Vec::new()),
        };
        let asked = experiment::Asked { start_s: self.start, stop_s: self.stop, step_s: self.step };
        let experiment = experiment::Experiment::new(asked, &alone.description)?;
        experiment.notes.iter().for_each(|note| report::status(note));
        let driven: Vec<_> = curves.iter().map(|(variable, _)| *variable).collect();
        let Recorded { columns, note } = record::recorded(&self.record, &alone.description, &driven)?;
        if let Some(note) = note {
            report::status(&note);
        }
        self.check_trace(columns.is_some())?;
        let record = columns.is_some();
        let script = alone.script(&experiment, &self.set, curves, columns.unwrap_or_default(), &catalogue)?;
        // Not the folder of a script of the same name.
        let folder = || Path::new("runs").join(format!("{}-alone", alone.name()));
        let out = self.out.clone().unwrap_or_else(folder);
        if let Some(output) = self.output.as_ref().filter(|output| lies_in(output, &out)) {
            let message = format!("--output {} lies in the folder of the results", printable::path(output));
            return Err(Refusal::new(&message, Some("their rows are in its trace.csv anyway; name a file elsewhere")));
        }
        let step_timeout = Some(self.step_timeout).filter(|limit| !limit.is_zero());
        let options = RunOptions {
            out,
            record,
            formats: self.format.unwrap_or_default(),
            step_timeout,
            files,
            ..RunOptions::default()
        };
        let units = preparation::unpack_units(&script)?;
        preparation::prepare(script, &units, options)
    }

    /// Refuses options about a trace that there is not.
    fn check_trace(&self, is_recorded: bool) -> Result<(), Refusal> {
        let contradiction = match (&self.output, self.format) {
            (None, None) => None,
            (Some(_), _) if !is_recorded => Some("--output copies the trace, and --record none leaves none"),
            (_, Some(_)) if !is_recorded => Some("--format is about the trace, and --record none leaves none"),
            (Some(_), Some(formats)) if !formats.csv => Some("--output copies trace.csv, which --format leaves out"),
            _ => None,
        };
        contradiction.map_or(Ok(()), |message| Err(Refusal::new(&message, Some("leave one of them out"))))
    }

    fn read_input(&self, path: &Path, alone: &Alone) -> Result<(input_file::Curves, HashedFile), Refusal> {
        let name = printable::path(path);
        let bytes = std::fs::read(path).map_err(|error| Refusal::new(&format!("cannot read {name}: {error}"), None))?;
        let file = HashedFile { name, sha256: sha256(&bytes) };
        let curves = input_file::read(path, bytes, &alone.description);
        Ok((curves.map_err(|error| Refusal::new(&error, error.help.as_deref()))?, file))
    }

    fn print(&self, outcome: &RunOutcome) -> Result<(), TraceError> {
        if let Some(output) = &self.output {
            let copied = std::fs::copy(outcome.folder.path().join(TRACE_CSV), output);
            copied.map_err(TraceError::io("write", output))?;
        }
        let heading = heading_line(&outcome.heading(), &outcome.verdict);
        report::result(&(heading + &next_lines(program(), outcome.folder.path(), !record::is_none(&self.record))));
        Ok(())
    }
}

/// Whether a file would lie in a folder; either may not be there yet.
fn lies_in(file: &Path, folder: &Path) -> bool {
    let parent = file.parent().filter(|parent| *parent != Path::new("")).unwrap_or(Path::new("."));
    let place = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).ok();
    place(parent) == place(folder)
}

#[test]
fn a_file_lies_in_a_folder_however_both_are_spelt() {
    let home = tempfile::tempdir().unwrap();
    let folder = home.path().join("runs");
    assert!(lies_in(&folder.join("trace.csv"), &folder));
    std::fs::create_dir(&folder).unwrap();
    std::os::unix::fs::symlink(&folder, home.path().join("link")).unwrap();
    assert!(lies_in(&home.path().join("link/../link/trace.csv"), &home.path().join("runs/../runs")));
    assert!(!lies_in(&home.path().join("trace.csv"), &folder));
    assert!(lies_in(Path::new("trace.csv"), Path::new(".")));
}
