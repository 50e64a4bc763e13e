//! Carries out a run that is prepared: looks after it and leaves its files.

use crate::message::Reason;
use crate::plan::Plan;
use crate::preparation::Preparation;
use crate::report;
use crate::report::console::{Console, Style};
use crate::report::table::{Ending, Heading};
use crate::supervise::{Ended, Orders, SuperviseError, supervise};
use crate::trace::csv::TraceFile;
use crate::trace::run_folder::{RunFolder, SIGNALS_JSON, TRACE_CSV, VERDICT_JSON};
use crate::trace::run_record::{Broken, RunState};
use crate::trace::verdict::{Verdict, reason_text};
use crate::trace::{TraceError, signals};
use crate::wiring::seconds;
use std::time::Duration;

/// How a run is looked after.
#[derive(Clone, Copy, Debug)]
pub struct Manner {
    /// How progress is told.
    pub style: Style,
    /// How long a call of a unit may take; zero waits for ever.
    pub step_timeout: Duration,
}

/// A run that is over.
#[derive(Debug)]
pub struct Outcome {
    /// How it ended.
    pub ended: Ended,
    /// How its claims came out.
    pub verdict: Verdict,
    /// Where its files are.
    pub folder: RunFolder,
    /// The script as the user named it.
    pub script: String,
    /// The simulated seconds that the script asks for.
    pub stop_s: f64,
}

impl Outcome {
    /// The first line of the report.
    #[must_use]
    pub fn heading(&self) -> Heading<'_> {
        let ending = match run_state(&self.ended) {
            RunState::Interrupted => Ending::Interrupted,
            RunState::Broken => Ending::Broken,
            RunState::Finished | RunState::Running => Ending::Finished,
        };
        Heading { script: &self.script, ending, stop_s: self.stop_s, wall_s: self.ended.wall.as_secs_f64() }
    }
}

/// Runs to the end. What broke, if something did, is told.
///
/// # Errors
/// If the run could not be looked after, or its files not be written.
pub fn carry_out(ready: Preparation, manner: Manner) -> Result<Outcome, SuperviseError> {
    let Preparation { plan, mut record, mut folder, home: _home, script } = ready;
    let trace = begin_trace(&folder, &plan).map_err(SuperviseError::Trace);
    let program = std::env::current_exe();
    let mut console = Console::stderr(manner.style);
    let step_timeout = (!manner.step_timeout.is_zero()).then_some(manner.step_timeout);
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
    let file_name = script.rsplit('/').next().unwrap_or(&script);
    let end = end_text(&ended, &plan.scenario);
    let verdict = Verdict::new(&plan.scenario, file_name, ended.last_tick, end, &ended.findings);
    folder.write(VERDICT_JSON, &verdict.json()).map_err(SuperviseError::Trace)?;
    record.end(run_state(&ended), verdict.time_s, ended.wall);
    record.broken = ended.failure.as_ref().map(Broken::from);
    folder.note(&record).map_err(SuperviseError::Trace)?;
    if let Some(failure) = &ended.failure {
        report::error(failure, failure.help().as_deref());
    }
    let stop_s = seconds(plan.scenario.stop_tick, plan.scenario.step_ns);
    Ok(Outcome { ended, verdict, folder, script, stop_s })
}

/// The file of rows, and what its columns are; nothing with `--record none`.
fn begin_trace(folder: &RunFolder, plan: &Plan) -> Result<Option<TraceFile>, TraceError> {
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
