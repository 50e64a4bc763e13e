//! Instantiates units: loads libraries, makes instances, sets their values and begins initialization.

use crate::run::message::{CallPiece, Message, MessageSink};
use crate::run::run_spec::UnitSpec;
use crate::run::start_values::StartValues;
use crate::run::worker::Instantiated;
use dsl::scenario::Preset;
use fmi2::printable;
use std::path::Path;
use std::sync::Arc;
use unit::board::{Note, Now};
use unit::call_log::CallLog;
use unit::call_log::LONGEST_PIECE;
use unit::failure::{Cause, Doing, Failure};
use unit::instance::{Instance, Setting};
use unit::library::{Conflict, Library};
use unit::logger::LogMessage;
use unit::time::seconds;

/// An instance that is to be made.
#[derive(Clone, Copy, Debug)]
pub struct NewInstance<'a> {
    /// The index in the scenario.
    pub index: usize,
    /// The name in the script.
    pub name: &'a str,
    /// The index of its unit.
    pub unit: usize,
    /// What is set before initialization.
    pub presets: &'a [Preset],
    /// Whether its calls are logged.
    pub log_calls: bool,
}

/// What making instances needs besides the instances.
pub struct Instantiator<'a> {
    /// The units.
    pub units: &'a [UnitSpec],
    /// The folder that `file("…")` is relative to.
    pub folder: &'a Path,
    /// The note of the thread that makes the calls.
    pub note: Note,
    /// The tick at which the run begins.
    pub start_tick: u64,
    /// The communication step in nanoseconds.
    pub step_ns: u64,
    /// Receives log messages and logged calls of units.
    pub sink: MessageSink,
}

impl Instantiator<'_> {
    /// Makes instances, in their order, up to the point where initialization can begin. If one fails, those before it stay
    /// in `made`, so that the caller can report the failure before a unit is freed, which may crash.
    ///
    /// # Errors
    /// The first instance that could not be made.
    pub fn make<'p>(
        &self,
        instances: impl IntoIterator<Item = NewInstance<'p>>,
        made: &mut Vec<Instantiated>,
    ) -> Result<(), Failure> {
        let mut libraries: Vec<Option<Arc<Library>>> = vec![None; self.units.len()];
        for NewInstance { index, name, unit, presets, log_calls } in instances {
            let library = match &libraries[unit] {
                Some(library) => Arc::clone(library),
                None => self.load(&self.units[unit], name, index)?,
            };
            libraries[unit] = Some(Arc::clone(&library));
            let sink = Arc::clone(&self.sink);
            let sink = Arc::new(move |message| sink(Message::Log(message)));
            let calls = log_calls.then(|| self.call_log(index));
            let setting = Setting { name, index, note: self.note.clone(), sink, logging_on: log_calls, calls };
            let instance = Instance::instantiate(&library, setting)?;
            let start_values = StartValues::new(presets, &self.units[unit].description, self.folder);
            let made = made.push_mut(Instantiated { index, instance, start_values });
            set_up(made, &self.note, self.start_tick, self.step_ns)?;
        }
        Ok(())
    }

    /// Sends the logged calls of an instance in pieces that fit into the ring of a board.
    fn call_log(&self, instance: usize) -> CallLog {
        let sink = Arc::clone(&self.sink);
        let send = move |text: &str| {
            for bytes in text.as_bytes().chunks(LONGEST_PIECE) {
                sink(Message::Calls(CallPiece { instance, bytes: bytes.to_vec() }));
            }
        };
        CallLog { sink: Arc::new(send), step_ns: self.step_ns }
    }

    fn load(&self, unit: &UnitSpec, name: &str, index: usize) -> Result<Arc<Library>, Failure> {
        let library = Library::load(&unit.folder, &unit.description, &self.note, index);
        let library = library.map_err(|error| Failure {
            instance: Some(name.to_owned()),
            doing: Doing::Load,
            time_s: None,
            cause: Cause::Other(error.to_string()),
        })?;
        for conflict in library.conflicts() {
            let warning = LogMessage::warning(index, (0, 0), self.conflict_text(conflict));
            (self.sink)(Message::Log(warning));
        }
        Ok(Arc::new(library))
    }

    fn conflict_text(&self, conflict: &Conflict) -> String {
        let named = |path: &Path| {
            let within = |unit: &UnitSpec| {
                let folder = unit.folder.canonicalize().ok()?;
                Some(format!("{} of unit `{}`", printable::path(path.strip_prefix(folder).ok()?), unit.name))
            };
            self.units.iter().find_map(within).unwrap_or_else(|| printable::path(path))
        };
        let Conflict { needed, used, own } = conflict;
        let own = own.as_ref().map_or_else(|| "that of the system".to_owned(), |own| named(own));
        format!(
            "it uses {} instead of {own}: a process has one library named {needed}; with --isolate each unit has its own",
            named(used)
        )
    }
}

/// Sets the presets of an instance that was instantiated or reset, and the start of its experiment.
///
/// # Errors
/// The unit refuses.
pub fn set_up(made: &mut Instantiated, note: &Note, start_tick: u64, step_ns: u64) -> Result<(), Failure> {
    made.start_values.set_presets(&mut made.instance, || at_start(note, start_tick, step_ns))?;
    made.instance.setup_experiment(&at_start(note, start_tick, step_ns))
}

/// Begins initialization of all instances, in their order, and sets their start values.
///
/// # Errors
/// The first instance that refused.
pub fn enter_initialization(
    made: &mut [Instantiated],
    note: &Note,
    start_tick: u64,
    step_ns: u64,
) -> Result<(), Failure> {
    made.iter_mut().try_for_each(|Instantiated { instance, start_values, .. }| {
        instance.enter_initialization_mode(&at_start(note, start_tick, step_ns))?;
        start_values.initialize(instance, &at_start(note, start_tick, step_ns))
    })
}

/// Begins calls of initialization.
pub(crate) fn at_start(note: &Note, start_tick: u64, step_ns: u64) -> Now<'_> {
    note.at(start_tick, seconds(start_tick, step_ns))
}
