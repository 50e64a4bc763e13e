//! `lockstep run`: one run of a script.

#[cfg(feature = "bus")]
mod live;

use super::exit_code;
use crate::find::preparation::{self, Refusal, default_folder};
use crate::find::script::{Script, ScriptOptions};
use crate::host::execution::{ReadyRun, RunOutcome};
use crate::run::run_options::RunOptions;
use fmi2::printable;
use results::checkpoint;
use results::recorder::Formats;
use results::report;
use results::report::console::Style;
use results::report::invocation::program;
use results::report::table::{Heading, next_lines, replay_command};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

/// Runs a script and judges its claims.
///
/// Ends with 0 if all claims hold, 1 if one failed, 2 if the script or the command line is wrong, 3 if the run broke,
/// 4 if no claim could be judged, 130 if it was interrupted.
#[derive(Debug, clap::Args)]
pub struct Run {
    /// The script
    #[arg(value_name = "SCRIPT.scn")]
    script: PathBuf,
    /// Sets a parameter of the script, for example 'gust = 6 m/s'
    #[arg(long, value_name = "NAME = VALUE")]
    set: Vec<String>,
    /// The case of the script's `sweep`, from 0, whose values the parameters get [default: their own values]
    #[arg(long, value_name = "K")]
    case: Option<u64>,
    /// Where the results go; a folder of an earlier run is replaced [default: runs/SCRIPT]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// A folder of units, looked up before those of LOCKSTEP_UNITS and the workspace
    #[arg(long, value_name = "DIR")]
    units: Vec<PathBuf>,
    /// Never build a unit
    #[arg(long)]
    no_build: bool,
    /// Warnings about the script count as errors, so that the run does not begin, and untested claims as failed
    #[arg(long)]
    strict: bool,
    /// Record nothing, whatever the script says
    #[arg(long, value_name = "none")]
    record: Option<Record>,
    /// The formats of the trace, for example csv [default: csv,parquet]
    #[arg(long, value_name = "csv,parquet", value_parser = super::formats, conflicts_with = "record")]
    format: Option<Formats>,
    /// Give each instance a process of its own: the results are the same
    #[cfg(feature = "bus")]
    #[arg(long)]
    isolate: bool,
    /// End as soon as a claim is lost
    #[arg(long)]
    fail_fast: bool,
    /// Simulated seconds for each second of the wall clock, to watch it: 1 is real time [default: as fast as it goes]
    #[arg(long, value_name = "FACTOR", value_parser = pace)]
    pace: Option<f64>,
    /// Saves the run as it is at a simulated time, for example 40s; may be given several times
    #[arg(long, num_args = 2, value_names = ["TIME", "FILE"])]
    save_at: Vec<OsString>,
    /// Continues where --save-at saved a run of the same script, parameters and units
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    #[cfg(feature = "bus")]
    #[command(flatten)]
    live: live::Live,
    /// Logs every call of an instance with arguments and status to fmi-calls.NAME.log, and asks its unit to tell all that
    /// it can (loggingOn); may be given several times
    #[arg(long, value_name = "NAME")]
    log_fmi_calls: Vec<String>,
    /// Print verdict.json instead of the table
    #[arg(long)]
    json: bool,
    /// Tell progress as JSON lines on standard error
    #[arg(long, value_name = "json")]
    progress: Option<ProgressForm>,
    /// How long a call of a unit may take before the run is given up; 0 waits for ever
    #[arg(long, value_name = "TIME", default_value = "10s", value_parser = humantime::parse_duration)]
    step_timeout: Duration,
}

/// What `--record` can say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Record {
    /// No rows.
    None,
}

/// What `--progress` can say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ProgressForm {
    /// A JSON object on each line.
    Json,
}

impl Run {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        exit_code::reached(self.prepare(), Style::fitting(self.progress.is_some()), self.strict, |outcome| {
            self.print(outcome);
            Ok(())
        })
    }

    fn prepare(&self) -> Result<ReadyRun, Refusal> {
        let catalogue = preparation::catalogue(&self.units, !self.no_build)?;
        let options = ScriptOptions { settings: &self.set, case: self.case, isolated: self.is_isolated() };
        let script = Script::read(&self.script, options, &catalogue)
            .map_err(|error| Refusal::new(&format!("cannot read {}: {error}", printable::path(&self.script)), None))?;
        if self.strict && !script.diagnostics.is_empty() {
            return Err(preparation::refused_warnings(&script));
        }
        #[cfg(feature = "bus")]
        let listening = self.live.listen()?;
        let options = self.options()?;
        let units = preparation::unpack_units(&script)?;
        let run = preparation::prepare(script, &units, options)?;
        #[cfg(feature = "bus")]
        return self.live.show(listening, run);
        #[cfg(not(feature = "bus"))]
        Ok(run.into())
    }

    fn options(&self) -> Result<RunOptions, Refusal> {
        Ok(RunOptions {
            out: self.out.clone().unwrap_or_else(|| default_folder(&self.script)),
            fail_fast: self.fail_fast,
            record: self.record.is_none(),
            formats: self.format.unwrap_or_default(),
            #[cfg(feature = "bus")]
            live: self.live.is_on(),
            pace: self.pace,
            save_at: self.saves()?,
            from: self.from.clone(),
            log_calls: self.log_fmi_calls.clone(),
            step_timeout: Some(self.step_timeout).filter(|limit| !limit.is_zero()),
            isolate: self.is_isolated(),
            ..RunOptions::default()
        })
    }

    #[cfg(feature = "bus")]
    fn is_isolated(&self) -> bool {
        self.isolate
    }

    #[cfg(not(feature = "bus"))]
    fn is_isolated(&self) -> bool {
        false
    }

    /// The pairs of `--save-at`.
    fn saves(&self) -> Result<Vec<(Duration, PathBuf)>, Refusal> {
        let (pairs, _) = self.save_at.as_chunks();
        let save = |[time, file]: &[OsString; 2]| {
            let time = time.to_string_lossy();
            let refused =
                |error| Refusal::new(&format!("--save-at {time}: {error}"), Some("write a time, for example 40s"));
            Ok((humantime::parse_duration(&time).map_err(refused)?, PathBuf::from(file)))
        };
        let saves: Vec<(Duration, PathBuf)> = pairs.iter().map(save).collect::<Result<_, _>>()?;
        let mut seen = BTreeSet::new();
        for (_, path) in &saves {
            if !seen.insert(path) {
                let message = format!("--save-at names {} twice", printable::path(path));
                return Err(Refusal::new(&message, Some("give each time a file of its own")));
            }
            if checkpoint::is_another_file(path) {
                let message = format!("--save-at {}: this is no checkpoint, and would be lost", printable::path(path));
                return Err(Refusal::new(&message, Some("name a new file, or an earlier checkpoint to replace")));
            }
        }
        Ok(saves)
    }

    fn print(&self, outcome: &RunOutcome) {
        let verdict = &outcome.verdict;
        if self.json {
            report::result(&verdict.json());
            return;
        }
        let replay = replay_command(program(), &self.script, verdict.case, &verdict.parameters, &self.units);
        let text = report::table::report(&Heading { strict: self.strict, ..outcome.heading() }, verdict, &replay);
        report::result(&(text + &next_lines(program(), outcome.folder.path(), self.record.is_none())));
    }
}

fn pace(text: &str) -> Result<f64, String> {
    let pace = text.parse().ok().filter(|pace: &f64| *pace > 0.0 && pace.is_finite());
    pace.ok_or_else(|| "a number above zero, for example 1 for real time".to_owned())
}

#[test]
fn a_pace_is_a_number_above_zero() {
    assert_eq!(pace("0.5"), Ok(0.5));
    for none in ["0", "-1", "inf", "NaN", "fast"] {
        assert!(pace(none).is_err(), "{none}");
    }
}
