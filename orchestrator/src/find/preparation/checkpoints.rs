//! What a run saves and where it continues from: checked before it begins.

use super::Refusal;
use crate::run::run_options::RunOptions;
use crate::run::run_spec::UnitSpec;
use crate::run::step_loop::Checkpoint;
use dsl::scenario::Scenario;
use fmi2::printable;
use results::checkpoint::{Identity, Saving};
use results::run_record::{Continued, HashedFile, RunRecord, sha256};
use std::path::{Path, PathBuf};
use std::time::Duration;
use unit::time::seconds;

/// A run that is ready to be prepared, as far as checkpoints have to do with it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate<'a> {
    pub scenario: &'a Scenario,
    pub units: &'a [UnitSpec],
    pub record: &'a RunRecord,
}

/// The checkpoints of a run: those to write, and the one that it continues from.
#[derive(Debug, Default)]
pub(super) struct Checkpoints {
    pub saving: Saving,
    pub from: Option<(Checkpoint, Continued)>,
}

impl Candidate<'_> {
    /// Finds the ticks and files to save at, and reads the checkpoint to continue from.
    ///
    /// # Errors
    /// Units that cannot be saved, times at which nothing can be saved, a file that cannot be continued from.
    pub fn checkpoints(&self, options: &RunOptions) -> Result<Checkpoints, Refusal> {
        if options.save_at.is_empty() && options.from.is_none() {
            return Ok(Checkpoints::default());
        }
        self.refuse_units_without_states()?;
        let identity = Identity::of(self.record, self.scenario.step_ns);
        let from = options.from.as_deref().map(|file| self.read(file, &identity)).transpose()?;
        let first_tick = from.as_ref().map_or(0, |(checkpoint, _)| checkpoint.tick + 1);
        let files = options.save_at.iter().map(|(time, file)| self.save(*time, file, first_tick));
        Ok(Checkpoints { saving: Saving { identity, files: files.collect::<Result<_, _>>()? }, from })
    }

    fn refuse_units_without_states(&self) -> Result<(), Refusal> {
        let lacks = |unit: &UnitSpec| {
            let offers = unit.description.co_simulation.as_ref();
            let lacking = [
                ("canGetAndSetFMUstate", offers.is_some_and(|offers| offers.can_get_and_set_fmu_state)),
                ("canSerializeFMUstate", offers.is_some_and(|offers| offers.can_serialize_fmu_state)),
            ];
            let lacking: Vec<_> = lacking.iter().filter(|(_, offered)| !offered).map(|(name, _)| *name).collect();
            (!lacking.is_empty()).then(|| format!("\nunit `{}` lacks {}", unit.name, lacking.join(" and ")))
        };
        let lacking: String = self.units.iter().filter_map(lacks).collect();
        if lacking.is_empty() {
            return Ok(());
        }
        let message = format!("this run can neither be saved nor continued{lacking}");
        Err(Refusal::new(&message, Some("have these units exported with both, or leave out --save-at and --from")))
    }

    fn read(&self, file: &Path, identity: &Identity) -> Result<(Checkpoint, Continued), Refusal> {
        let name = printable::path(file);
        let cannot = |why: &dyn std::fmt::Display, help: Option<&str>| {
            Refusal::new(&format!("cannot continue from {name}: {why}"), help)
        };
        let bytes = std::fs::read(file).map_err(|error| cannot(&error, None))?;
        let instances = self.scenario.instances.iter();
        let descriptions: Vec<_> = instances.map(|instance| &self.units[instance.unit].description).collect();
        let checkpoint = identity.checkpoint_in(&bytes);
        let checkpoint = checkpoint.and_then(|bytes| Checkpoint::read(bytes, self.scenario, &descriptions));
        let checkpoint = checkpoint.map_err(|error| cannot(&error, Some(&error.help())))?;
        let time_s = seconds(checkpoint.tick, self.scenario.step_ns);
        let continued = Continued { checkpoint: HashedFile { name, sha256: sha256(&bytes) }, time_s };
        Ok((checkpoint, continued))
    }

    /// The tick of a time to save at, which must be one of this run's with a tick behind it.
    fn save(&self, time: Duration, file: &Path, first_tick: u64) -> Result<(u64, PathBuf), Refusal> {
        let Scenario { step_ns, stop_tick, .. } = *self.scenario;
        let at = |tick| format!("{} s", seconds(tick, step_ns));
        let time_ns = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        let option = format!("--save-at {} s", time.as_secs_f64());
        let tick = time_ns / step_ns;
        if tick >= stop_tick {
            let message = format!("{option}: nothing is left to run then, the run stops at {}", at(stop_tick));
            return Err(Refusal::new(&message, Some(&format!("the last time to save at is {}", at(stop_tick - 1)))));
        }
        if !time_ns.is_multiple_of(step_ns) {
            let message = format!("{option} does not fall on the {} grid", at(1));
            let neighbours = (tick..=tick + 1).filter(|&tick| tick < stop_tick).map(at).collect::<Vec<_>>();
            return Err(Refusal::new(&message, Some(&neighbours.join(" or "))));
        }
        if tick < first_tick {
            let message = format!("{option}: this run has its first row at {}", at(first_tick));
            return Err(Refusal::new(&message, Some("save later, or from a run that begins earlier")));
        }
        let folder = file.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        if !folder.is_dir() || file.is_dir() {
            let message = format!("cannot save {}: it is a folder, or lies in none", printable::path(file));
            return Err(Refusal::new(&message, Some("name a file in a folder that is there")));
        }
        Ok((tick, file.to_owned()))
    }
}
