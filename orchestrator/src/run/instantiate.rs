//! Instantiates units: loads libraries, makes instances, sets their values and begins initialization.

use crate::run::message::{CallPiece, Message, MessageSink};
use crate::run::run_spec::UnitSpec;
use crate::run::worker::Instantiated;
use dsl::scenario::{Preset, Value};
use std::path::Path;
use std::sync::Arc;
use unit::board::{Note, Now};
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
        let start = || self.note.at(0, 0.0);
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
            let Instantiated { instance, .. } = made.push_mut(Instantiated { index, instance });
            for preset in presets {
                self.set(instance, &start(), preset, &self.units[unit])?;
            }
            instance.setup_experiment(&start())?;
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

    fn set(&self, instance: &mut Instance, start: &Now<'_>, preset: &Preset, unit: &UnitSpec) -> Result<(), Failure> {
        let handles = instance.handles([preset.variable]);
        let handle = &handles.unwrap_or_else(|| unreachable!("a preset of `{}` is of one of its variables", unit.name));
        match &preset.value {
            Value::Real(value) => instance.set_real(start, handle, &[*value]),
            Value::Integer(value) => instance.set_integer(start, handle, &[*value]),
            Value::Boolean(value) => instance.set_boolean(start, handle, &[i32::from(*value)]),
            Value::String(text) => instance.set_string(start, handle, std::slice::from_ref(text)),
            Value::File(file) => {
                let path = self.folder.join(&file.path).to_string_lossy().into_owned();
                instance.set_string(start, handle, &[path])
            }
        }
    }
}

/// Begins initialization of all instances, in their order.
///
/// # Errors
/// The first instance that refused.
pub fn enter_initialization(made: &mut [Instantiated], note: &Note) -> Result<(), Failure> {
    made.iter_mut().try_for_each(|made| made.instance.enter_initialization_mode(&note.at(0, 0.0)))
}
