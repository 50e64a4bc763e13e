//! Brings the units on board: libraries are loaded, instances made, their values set, initialization begun.

use super::told::message;
use crate::failure::{Cause, Doing, Failure};
use crate::message::{CallPiece, Message};
use crate::plan::{Plan, PlannedUnit};
use crate::unit::board::{Board, Now};
use crate::unit::call_log::CallLog;
use crate::unit::instance::{Instance, Setting};
use crate::unit::library::Library;
use crate::unit::logger::LogSink;
use crate::worker::Seating;
use dsl::scenario::{Preset, Value};
use std::path::Path;
use std::sync::Arc;

/// Bytes of a call that are told at once.
const LONGEST_PIECE: usize = Board::LONGEST_MESSAGE / 16;

/// Brings all instances of a plan into initialization mode, in the script's order. Whoever is aboard when one fails stays
/// there, so that the caller can tell the failure before a unit is freed.
///
/// # Errors
/// The first instance that could not be brought so far.
pub fn instances(plan: &Plan, board: &Arc<Board>, aboard: &mut Vec<Seating>) -> Result<(), Failure> {
    let sink: LogSink = {
        let board = Arc::clone(board);
        Arc::new(move |said| message(&board, &Message::Log(said)))
    };
    let note = board.note(0);
    let start = || note.at(0, 0.0);
    let mut libraries: Vec<Option<Arc<Library>>> = vec![None; plan.units.len()];
    for (index, planned) in plan.scenario.instances.iter().enumerate() {
        let unit = &plan.units[plan.unit_of[index]];
        let library = match &libraries[plan.unit_of[index]] {
            Some(library) => Arc::clone(library),
            None => load(unit, &planned.name, index, board)?,
        };
        libraries[plan.unit_of[index]] = Some(Arc::clone(&library));
        let (note, sink) = (note.clone(), Arc::clone(&sink));
        let calls = plan.log_calls.contains(&index).then(|| call_log(plan, board, index));
        let setting = Setting { name: &planned.name, index, note, sink, logging_on: calls.is_some(), calls };
        let instance = Instance::instantiate(&library, setting)?;
        let Seating { instance, .. } = aboard.push_mut(Seating { index, instance });
        for preset in &planned.presets {
            set(instance, &start(), preset, unit, &plan.folder)?;
        }
        instance.setup_experiment(&start())?;
    }
    aboard.iter_mut().try_for_each(|seating| seating.instance.enter_initialization_mode(&start()))
}

/// Tells the calls of an instance in pieces that the board takes.
fn call_log(plan: &Plan, board: &Arc<Board>, instance: usize) -> CallLog {
    let board = Arc::clone(board);
    let sink = move |text: &str| {
        for bytes in text.as_bytes().chunks(LONGEST_PIECE) {
            message(&board, &Message::Calls(CallPiece { instance, bytes: bytes.to_vec() }));
        }
    };
    CallLog { sink: Arc::new(sink), step_ns: plan.scenario.step_ns }
}

fn load(unit: &PlannedUnit, name: &str, index: usize, board: &Board) -> Result<Arc<Library>, Failure> {
    let library = Library::load(&unit.folder, &unit.description, &board.note(0), index);
    library.map(Arc::new).map_err(|error| Failure {
        instance: Some(name.to_owned()),
        doing: Doing::Load,
        time_s: None,
        cause: Cause::Other(error.to_string()),
    })
}

fn set(
    instance: &mut Instance,
    start: &Now<'_>,
    preset: &Preset,
    unit: &PlannedUnit,
    folder: &Path,
) -> Result<(), Failure> {
    let reference = &[unit.description.variables[preset.variable].value_reference];
    match &preset.value {
        Value::Real(value) => instance.set_real(start, reference, &[*value]),
        Value::Integer(value) => instance.set_integer(start, reference, &[*value]),
        Value::Boolean(value) => instance.set_boolean(start, reference, &[i32::from(*value)]),
        Value::String(text) => instance.set_string(start, reference, std::slice::from_ref(text)),
        Value::File(path) => {
            let path = folder.join(path).to_string_lossy().into_owned();
            instance.set_string(start, reference, &[path])
        }
    }
}
