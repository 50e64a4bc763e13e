//! `lockstep check --run`: tests a unit by running it, a line for each test.

use crate::cli::exit_code;
use crate::cli::simulate::alone::Alone;
use crate::cli::simulate::experiment::{self, Asked, Experiment};
use crate::find::catalogue::{Catalogue, is_archive};
use crate::find::preparation::{self, Refusal};
use crate::host::unit_tests::{TestResult, Tested, test_unit};
use crate::run::run_options::RunOptions;
use fmi2::description::ModelDescription;
use fmi2::printable;
use results::{report, shortest_decimal};
use std::path::Path;
use std::time::Duration;

/// A DefaultExperiment of more steps is cut to so many, since each test takes it twice.
const MOST_STEPS: f64 = 10_000.0;
/// The width of a test's name.
const WIDTH: usize = 30;

/// How units are run.
#[derive(Debug, Default, clap::Args)]
pub(super) struct UnitRun {
    /// Test each .fmu file by running it: saving and restoring its state, in memory, as bytes and in a new process, reset,
    /// two instances in one process. Inputs get their start values; Reals vary by up to a twentieth
    #[arg(long)]
    run: bool,
    /// With --run: the communication step, for example 10ms [default: that of the unit's DefaultExperiment]
    #[arg(long, value_name = "TIME", value_parser = experiment::time, requires = "run")]
    step: Option<f64>,
    /// With --run: when to end, for example 10s [default: as the unit's DefaultExperiment, at most 10000 steps]
    #[arg(long, value_name = "TIME", value_parser = experiment::time, requires = "run")]
    stop: Option<f64>,
    /// With --run: how long a call of the unit may take before the test has failed; 0 waits for ever [default: 10s]
    #[arg(long, value_name = "TIME", value_parser = humantime::parse_duration, requires = "run")]
    step_timeout: Option<Duration>,
}

impl UnitRun {
    /// Whether this file is to be run.
    pub fn is_asked_for_with(&self, file: &Path) -> bool {
        self.run && is_archive(file)
    }

    /// Runs all tests of a unit and prints each result; says whether none failed.
    ///
    /// # Errors
    /// The unit cannot be run at all, or an option does not fit.
    pub fn test(&self, file: &Path, catalogue: &mut Catalogue) -> Result<bool, Refusal> {
        let alone = Alone::find(&catalogue.name_of(file.as_os_str()), catalogue)?;
        let experiment = self.experiment(&alone.description)?;
        experiment.notes.iter().for_each(|note| report::status(note));
        let mut script = alone.script(&experiment, &[], Vec::new(), Vec::new(), catalogue)?;
        // The check has printed them already.
        script.units.iter_mut().for_each(|unit| unit.findings.clear());
        if let Some(scenario) = &mut script.scenario {
            script.diagnostics.clear();
            let mut second = scenario.instances[0].clone();
            second.name += "_2";
            scenario.instances.push(second);
        }
        let units = preparation::unpack_units(&script)?;
        let step_timeout = Some(self.step_timeout.unwrap_or(Duration::from_secs(10))).filter(|limit| !limit.is_zero());
        let options = RunOptions { step_timeout, ..RunOptions::default() };
        // The private folder is removed at the end.
        let (spec, _home) = preparation::prepare_tests(script, units, options)?;
        let name = printable::path(file);
        let (step, stop) = (shortest_decimal(experiment.step_s), shortest_decimal(experiment.stop_s));
        report::result(&format!("{name}: run to {stop} s in steps of {step} s\n"));
        let mut failed = 0;
        let program = std::env::current_exe();
        let program = program.map_err(|error| Refusal::new(&format!("cannot find this program: {error}"), None))?;
        let tested = test_unit(&spec, &program, |tested| {
            failed += usize::from(matches!(tested.result, TestResult::Failed(_)));
            print(tested);
        });
        tested.map_err(|error| Refusal::new(&error, exit_code::help(&error)))?;
        let end = if failed == 0 { "no test failed".to_owned() } else { results::counted(failed, "test") + " failed" };
        report::result(&format!("{name}: {end}\n"));
        Ok(failed == 0)
    }

    fn experiment(&self, description: &ModelDescription) -> Result<Experiment, Refusal> {
        let asked = Asked { start_s: Some(0.0), stop_s: self.stop, step_s: self.step };
        let experiment = Experiment::new(asked, description)?;
        if self.stop.is_none() && experiment.stop_s > MOST_STEPS * experiment.step_s {
            return Experiment::new(Asked { stop_s: Some(MOST_STEPS * experiment.step_s), ..asked }, description);
        }
        Ok(experiment)
    }
}

fn print(Tested { name, result, log }: &Tested) {
    if !log.is_empty() {
        report::status(log.trim_end());
    }
    let text = match result {
        TestResult::Passed => "pass".to_owned(),
        TestResult::Failed(what) => format!("fail: {what}"),
        TestResult::NotSupported(why) => format!("not supported: {why}"),
        TestResult::NotRun(why) => format!("not run: {why}"),
    };
    report::result(&format!("  {name:WIDTH$}{text}\n"));
}
