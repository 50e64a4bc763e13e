//! Carries out a prepared run: supervises it and writes its files.

use crate::host::supervise::{BeginLive, RunEnd, StartWorkers, SuperviseError, start_error, supervise};
use crate::run::message::Reason;
use crate::run::prepared_run::PreparedRun;
use crate::run::run_spec::RunSpec;
use dsl::scenario::Scenario;
use flatten::claims;
use flatten::columns;
use results::recorder::Recorder;
use results::report;
use results::report::console::{Console, Style};
use results::report::table::Heading;
use results::run_folder::{RunFolder, VERDICT_JSON};
use results::run_record::{Broken, RunRecord, RunState};
use results::verdict::{JudgedClaim, VerdictFile};
use results::{TraceError, signals};
use unit::process::Descendants;
use unit::time::seconds;

/// A run that is prepared, with what shows it while it goes on.
pub struct ReadyRun {
    /// The run.
    pub run: PreparedRun,
    /// Begins what takes its rows and its end besides the files.
    pub live: Option<BeginLive>,
}

impl From<PreparedRun> for ReadyRun {
    fn from(run: PreparedRun) -> Self {
        Self { run, live: None }
    }
}

/// A run that is over.
#[derive(Debug)]
pub struct RunOutcome {
    /// How it ended.
    pub ended: RunEnd,
    /// How its claims came out.
    pub verdict: VerdictFile,
    /// Where its files are.
    pub folder: RunFolder,
    /// The script as the user named it.
    pub script: String,
    /// The simulated seconds at which it began.
    pub from_s: f64,
    /// The simulated seconds that the script asks for.
    pub stop_s: f64,
}

impl RunOutcome {
    /// The first line of the report.
    #[must_use]
    pub fn heading(&self) -> Heading<'_> {
        let (state, wall_s) = (self.ended.state(), self.ended.wall.as_secs_f64());
        Heading { script: &self.script, state, from_s: self.from_s, stop_s: self.stop_s, wall_s, strict: false }
    }
}

/// Runs to the end. A failure is printed and written to `run.json`, whatever else could not be written.
///
/// # Errors
/// The run could not be supervised, or its files not be written.
pub fn carry_out(
    ready: ReadyRun,
    style: Style,
    start_workers: Option<StartWorkers>,
) -> Result<RunOutcome, SuperviseError> {
    let ReadyRun { run, live } = ready;
    let PreparedRun { spec, saving, mut record, mut folder, home: _home, completion: _completion, script } = run;
    let program = std::env::current_exe().map_err(start_error("find this program"));
    let adopted = Descendants::adopt().map_err(start_error("adopt the processes of units"));
    let ended = program.and_then(|program| {
        // Dropped when what steps has ended, and while signals are still counted.
        let _descendants = adopted?;
        let recorder = begin_files(&folder, &spec).map_err(SuperviseError::Trace)?;
        supervise(&spec, &saving, &program, start_workers, recorder, live, &mut Console::stderr(style))
    });
    let ended = ended.inspect_err(|error| note_break(&mut folder, &mut record, error))?;
    if let Some(failure) = &ended.failure {
        report::error(failure, failure.help().as_deref());
    }
    let file_name = script.rsplit('/').next().unwrap_or(&script);
    let end = end_text(&ended, &spec.scenario);
    let verdict = verdict(&spec.scenario, &record, file_name, end, &ended);
    record.end(ended.state(), verdict.time_s, ended.wall);
    record.broken = ended.failure.as_ref().map(Broken::from);
    leave(&mut folder, &mut record, &verdict).map_err(SuperviseError::Trace)?;
    let stop_s = seconds(spec.scenario.stop_tick, spec.scenario.step_ns);
    Ok(RunOutcome { ended, verdict, folder, script, from_s: spec.from_s(), stop_s })
}

/// Writes what broke a run without results to `run.json`. Prints it too where the error that the caller prints is another.
fn note_break(folder: &mut RunFolder, record: &mut RunRecord, error: &SuperviseError) {
    record.broken = Some(match error {
        SuperviseError::Broken { failure, .. } => {
            report::error(failure, failure.help().as_deref());
            Broken::from(&**failure)
        }
        SuperviseError::Start { .. } | SuperviseError::Trace(_) => Broken::outside_of_calls(error),
    });
    record.state = RunState::Broken;
    // The caller reports the error itself, which matters more than a record that cannot be written.
    let _ = folder.note(record);
}

/// Writes what there is to say about a run that is over; one whose verdict cannot be written is broken.
fn leave(folder: &mut RunFolder, record: &mut RunRecord, verdict: &VerdictFile) -> Result<(), TraceError> {
    let written = folder.write(VERDICT_JSON, &verdict.json());
    if let Err(error) = &written {
        record.state = RunState::Broken;
        record.broken.get_or_insert_with(|| Broken::outside_of_calls(error));
    }
    let noted = folder.note(record);
    written.and(noted)
}

/// The files that grow with the run: rows unless `--record none`, and calls that are to be logged.
fn begin_files(folder: &RunFolder, spec: &RunSpec) -> Result<Recorder, TraceError> {
    let mut recorder = Recorder::default();
    if spec.options.record {
        let columns = columns::of(&spec.scenario, |instance| &spec.unit(instance).description);
        let signals: Vec<_> = std::iter::once(signals::time()).chain(columns).collect();
        recorder.begin_rows(folder, spec.scenario.step_ns, &signals, spec.options.formats)?;
    }
    if !spec.scenario.events.is_empty() {
        recorder.begin_events(folder)?;
    }
    let instances = spec.scenario.instances.iter().enumerate();
    for (index, instance) in instances.filter(|(_, instance)| spec.options.logs_calls_of(&instance.name)) {
        recorder.begin_calls(folder, index, &instance.name)?;
    }
    Ok(recorder)
}

/// What the script claims, put together with how it came out.
fn verdict(scenario: &Scenario, record: &RunRecord, script: &str, end: String, ended: &RunEnd) -> VerdictFile {
    let claims = scenario.claims.iter().zip(&ended.standings);
    VerdictFile {
        scenario: scenario.title.clone(),
        script: script.to_owned(),
        parameters: record.parameters.clone(),
        case: record.case,
        time_s: seconds(ended.last_tick, scenario.step_ns),
        end,
        claims: claims
            .map(|(claim, standing)| {
                let judged = JudgedClaim::new(&claims::info(claim), standing, scenario.step_ns);
                judged.comparing(claims::comparisons(claim, scenario))
            })
            .collect(),
        events: ended.events.clone(),
    }
}

fn end_text(ended: &RunEnd, scenario: &Scenario) -> String {
    match (&ended.failure, &ended.finish) {
        (Some(failure), _) => format!("broken: {failure}"),
        (None, Some(finish)) => finish.reason.text(scenario),
        (None, None) => Reason::Interrupted.text(scenario),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::record;
    use std::path::Path;
    use std::time::Duration;
    use unit::failure::{Cause, Doing, Failure};

    fn failure() -> Failure {
        Failure { instance: Some("quad".to_owned()), doing: Doing::Load, time_s: Some(12.34), cause: Cause::Signal(11) }
    }

    fn refusal() -> TraceError {
        TraceError::io("write", Path::new("trace.csv.partial"))(std::io::ErrorKind::StorageFull.into())
    }

    fn noted(folder: &RunFolder) -> (String, String) {
        let text = std::fs::read_to_string(folder.path().join("run.json")).unwrap();
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        let text_of = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
        (text_of(&value["state"]), text_of(&value["broken"]["message"]))
    }

    #[test]
    fn a_verdict_that_cannot_be_written_breaks_the_run_but_hides_no_earlier_break() {
        for (state, earlier) in [(RunState::Finished, None), (RunState::Broken, Some(failure()))] {
            let home = tempfile::tempdir().unwrap();
            let mut record = record();
            let mut folder = RunFolder::claim(home.path(), &record).unwrap();
            std::fs::create_dir(home.path().join("verdict.json.partial")).unwrap();
            record.end(state, 1.0, Duration::from_secs(1));
            record.broken = earlier.as_ref().map(Broken::from);
            let verdict = VerdictFile {
                scenario: "A unit goes up".to_owned(),
                script: "a.scn".to_owned(),
                parameters: Vec::new(),
                case: None,
                time_s: 0.1,
                end: "the end".to_owned(),
                claims: Vec::new(),
                events: Vec::new(),
            };
            let error = leave(&mut folder, &mut record, &verdict).unwrap_err();
            let message = earlier.map_or(error.to_string(), |failure| failure.to_string());
            assert_eq!(noted(&folder), ("broken".to_owned(), message));
        }
    }

    #[test]
    fn a_trace_that_cannot_be_written_breaks_the_run_but_hides_no_earlier_break() {
        for earlier in [None, Some(failure())] {
            let home = tempfile::tempdir().unwrap();
            let mut record = record();
            let mut folder = RunFolder::claim(home.path(), &record).unwrap();
            note_break(&mut folder, &mut record, &SuperviseError::unwritten(earlier.clone(), refusal()));
            let message = earlier.map_or(refusal().to_string(), |failure| failure.to_string());
            assert_eq!(noted(&folder), ("broken".to_owned(), message));
        }
    }
}
