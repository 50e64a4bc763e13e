//! `lockstep run`: one run of a script.

mod exit_code;
mod preparation;

use crate::message::Reason;
use crate::report::console::{Console, Style};
use crate::report::table::{Ending, Heading, next_lines, replay_command};
use crate::report::{self, status};
use crate::supervise::{Ended, Orders, SuperviseError, supervise};
use crate::trace::csv::TraceFile;
use crate::trace::run_folder::{RunFolder, SIGNALS_JSON, TRACE_CSV, VERDICT_JSON};
use crate::trace::run_record::{Broken, RunState};
use crate::trace::verdict::{Verdict, reason_text};
use crate::trace::{TraceError, signals};
use crate::wiring::seconds;
use preparation::Preparation;
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
    /// Where the results go; a folder of an earlier run is replaced [default: runs/SCRIPT]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Where units are looked for before the workspace
    #[arg(long, value_name = "DIR")]
    units: Vec<PathBuf>,
    /// Never build a unit
    #[arg(long)]
    no_build: bool,
    /// Record nothing, whatever the script says
    #[arg(long, value_name = "none")]
    record: Option<Record>,
    /// End as soon as a claim is lost
    #[arg(long)]
    fail_fast: bool,
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
        let preparation = match self.prepare() {
            Ok(preparation) => preparation,
            Err(refusal) => {
                status(refusal.0.trim_end());
                return exit_code::USAGE;
            }
        };
        match self.go(preparation) {
            Ok(code) => code,
            Err(error) => {
                let help = if let SuperviseError::Trace(error) = &error { error.help() } else { None };
                report::error(&error, help);
                exit_code::BROKEN
            }
        }
    }

    /// Runs what is ready to run, and tells how it went.
    fn go(&self, ready: Preparation) -> Result<u8, SuperviseError> {
        let Preparation { plan, mut record, mut folder, home: _home, script } = ready;
        let trace = begin_trace(&folder, &plan).map_err(SuperviseError::Trace);
        let program = std::env::current_exe();
        let mut console = Console::stderr(Style::fitting(self.progress.is_some()));
        let step_timeout = (!self.step_timeout.is_zero()).then_some(self.step_timeout);
        let ended = trace.and_then(|trace| {
            let program = program.map_err(|error| SuperviseError::Start { doing: "find this program", error })?;
            supervise(&Orders { plan: &plan, program, step_timeout }, trace, &mut console)
        });
        let ended = ended.inspect_err(|error| {
            record.state = RunState::Broken;
            record.broken = Some(Broken { instance: None, call: None, time_s: None, message: error.to_string() });
            // The error itself says more than one about the record.
            let _ = folder.note(&record);
        })?;
        let file_name = self.script.file_name().unwrap_or_default().to_string_lossy();
        let end = end_text(&ended, &plan.scenario);
        let verdict = Verdict::new(&plan.scenario, &file_name, ended.last_tick, end, &ended.findings);
        folder.write(VERDICT_JSON, &verdict.json()).map_err(SuperviseError::Trace)?;
        record.end(run_state(&ended), verdict.time_s, ended.wall);
        record.broken = ended.failure.as_ref().map(Broken::from);
        folder.note(&record).map_err(SuperviseError::Trace)?;
        if let Some(failure) = &ended.failure {
            report::error(failure, failure.help().as_deref());
        }
        let stop_s = seconds(plan.scenario.stop_tick, plan.scenario.step_ns);
        self.tell(&script, stop_s, &ended, &verdict, &folder);
        Ok(exit_code::of(ended.interrupted, ended.failure.is_some(), verdict.count()))
    }

    fn tell(&self, script: &str, stop_s: f64, ended: &Ended, verdict: &Verdict, folder: &RunFolder) {
        if self.json {
            report::result(&verdict.json());
            return;
        }
        let ending = match run_state(ended) {
            RunState::Interrupted => Ending::Interrupted,
            RunState::Broken => Ending::Broken,
            RunState::Finished | RunState::Running => Ending::Finished,
        };
        let heading = Heading { script, ending, stop_s, wall_s: ended.wall.as_secs_f64() };
        let units: Vec<_> = self.units.iter().map(|folder| folder.display().to_string()).collect();
        let replay = replay_command(script, &verdict.parameters, &units);
        let text = report::table::report(&heading, verdict, &replay);
        report::result(&(text + &next_lines(folder.path(), self.record.is_none())));
    }
}

/// The file of rows, and what its columns are; nothing with `--record none`.
fn begin_trace(folder: &RunFolder, plan: &crate::plan::Plan) -> Result<Option<TraceFile>, TraceError> {
    if !plan.record {
        return Ok(None);
    }
    let description_of = |instance: usize| &plan.units[plan.unit_of[instance]].description;
    folder.write(SIGNALS_JSON, &signals::json(&plan.scenario, description_of))?;
    let columns = signals::csv_columns(&plan.scenario, description_of);
    let file = folder.begin(TRACE_CSV)?;
    TraceFile::begin(file, plan.scenario.step_ns, &columns).map(Some)
}

fn run_state(ended: &Ended) -> RunState {
    match (ended.interrupted, &ended.failure) {
        (true, _) => RunState::Interrupted,
        (false, Some(_)) => RunState::Broken,
        (false, None) => RunState::Finished,
    }
}

fn end_text(ended: &Ended, scenario: &dsl::scenario::Scenario) -> String {
    match (&ended.failure, &ended.finish) {
        (Some(failure), _) => format!("broken: {failure}"),
        (None, Some(finish)) => reason_text(&finish.reason, scenario),
        (None, None) => reason_text(&Reason::Interrupted, scenario),
    }
}
