//! Instantiates units: loads libraries, makes instances, sets their values and begins initialization.

use crate::run::message::{CallPiece, Message, MessageSink};
use crate::run::run_spec::UnitSpec;
use crate::run::start_values::StartValues;
use crate::run::worker::Instantiated;
use dsl::scenario::Preset;
use std::path::Path;
use std::sync::Arc;
use unit::board::Note;
use unit::call_log::CallLog;
use unit::call_log::LONGEST_PIECE;
use unit::failure::{Cause, Doing, Failure};
use unit::instance::{Instance, Setting};
use unit::library::Library;

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
            set_up(made.push_mut(Instantiated { index, instance, start_values }), &self.note)?;
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
        library.map(Arc::new).map_err(|error| Failure {
            instance: Some(name.to_owned()),
            doing: Doing::Load,
            time_s: None,
            cause: Cause::Other(error.to_string()),
        })
    }
}

/// Sets the presets of an instance that was instantiated or reset, and the start of its experiment.
///
/// # Errors
/// The unit refuses.
pub fn set_up(made: &mut Instantiated, note: &Note) -> Result<(), Failure> {
    made.start_values.set_presets(&mut made.instance, &note.at(0, 0.0))?;
    made.instance.setup_experiment(&note.at(0, 0.0))
}

/// Begins initialization of all instances, in their order, and sets their start values.
///
/// # Errors
/// The first instance that refused.
pub fn enter_initialization(made: &mut [Instantiated], note: &Note) -> Result<(), Failure> {
    made.iter_mut().try_for_each(|Instantiated { instance, start_values, .. }| {
        instance.enter_initialization_mode(&note.at(0, 0.0))?;
        start_values.initialize(instance, &note.at(0, 0.0))
    })
}
