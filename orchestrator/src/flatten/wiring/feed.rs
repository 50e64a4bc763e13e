//! What connections bring to the inputs of a group: plain copies as runs of neighbours, and computed values.

use super::slot_table::SlotTable;
use crate::flatten::expression::{Moment, Program};
use crate::flatten::values::{Slot, Values};
use dsl::scenario::{Connection, Drive};
use fmi2::description::BaseType;

/// All connections of one kind into one group.
#[derive(Debug, Default)]
pub struct Feed {
    reals: Vec<CopyRange>,
    /// Many groups are fed with Reals only.
    others: Option<Box<Others>>,
}

/// What is no plain copy of Reals.
#[derive(Debug, Default)]
struct Others {
    integers: Vec<CopyRange>,
    booleans: Vec<CopyRange>,
    texts: Vec<CopyRange>,
    computed: Vec<Computed>,
}

/// Neighbours that are copied to neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CopyRange {
    /// The first source.
    pub from: usize,
    /// The first target.
    pub to: usize,
    /// How many.
    pub length: usize,
}

/// One value that is not a plain copy, or that has to wait for its window.
#[derive(Debug)]
pub struct Computed {
    to: usize,
    value: ComputedValue,
}

#[derive(Debug)]
enum ComputedValue {
    Real(Program),
    Integer(Program),
    Boolean(Program),
    ConstantInteger(i32),
    ConstantText(String),
    Text(usize),
}

impl Feed {
    /// Compiles connections, which come in the order of their targets.
    pub(super) fn new(connections: &[&Connection], places: &SlotTable) -> Self {
        let mut feed = Self::default();
        for connection in connections {
            let to = places.pick_input(connection.target).slot;
            match &connection.source {
                Drive::Copy(port) => feed.copy(places.read(*port), to),
                drive => feed.others().computed.push(Computed::new(drive, to, places)),
            }
        }
        feed
    }

    fn copy(&mut self, from: Slot, to: Slot) {
        assert_eq!(from.base, to.base, "a copy was resolved between different types");
        let runs = match to.base {
            BaseType::Real => &mut self.reals,
            BaseType::Integer => &mut self.others().integers,
            BaseType::Boolean => &mut self.others().booleans,
            BaseType::String => &mut self.others().texts,
        };
        match runs.last_mut().filter(|run| (run.from + run.length, run.to + run.length) == (from.index, to.index)) {
            Some(run) => run.length += 1,
            None => runs.push(CopyRange { from: from.index, to: to.index, length: 1 }),
        }
    }

    fn others(&mut self) -> &mut Others {
        self.others.get_or_insert_default()
    }

    /// Whether it brings nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.reals.is_empty() && self.others.is_none()
    }

    /// Brings everything to the inputs.
    #[inline]
    pub fn bring(&mut self, moment: &Moment<'_>, inputs: &mut Values) {
        copy(&self.reals, &moment.outputs.reals, &mut inputs.reals);
        if let Some(others) = &mut self.others {
            others.bring(moment, inputs);
        }
    }
}

impl Others {
    fn bring(&mut self, moment: &Moment<'_>, inputs: &mut Values) {
        let outputs = moment.outputs;
        copy(&self.integers, &outputs.integers, &mut inputs.integers);
        copy(&self.booleans, &outputs.booleans, &mut inputs.booleans);
        for run in &self.texts {
            inputs.texts[run.to..run.to + run.length].clone_from_slice(&outputs.texts[run.from..run.from + run.length]);
        }
        for computed in &mut self.computed {
            computed.bring(moment, inputs);
        }
    }
}

#[inline]
fn copy<T: Copy>(runs: &[CopyRange], from: &[T], to: &mut [T]) {
    for run in runs {
        // Single values are the most frequent; a call to copy one costs more than the value.
        if run.length == 1 {
            to[run.to] = from[run.from];
        } else {
            to[run.to..run.to + run.length].copy_from_slice(&from[run.from..run.from + run.length]);
        }
    }
}

impl Computed {
    pub(super) fn new(drive: &Drive, to: Slot, places: &SlotTable) -> Self {
        let mut place = |port| places.read(port);
        let value = match (drive, to.base) {
            (Drive::Copy(port), BaseType::Real) => ComputedValue::Real(Program::compile_signal(*port, &mut place)),
            (Drive::Copy(port), BaseType::Integer) => {
                ComputedValue::Integer(Program::compile_signal(*port, &mut place))
            }
            (Drive::Copy(port), BaseType::Boolean) => {
                ComputedValue::Boolean(Program::compile_signal(*port, &mut place))
            }
            (Drive::Copy(port), BaseType::String) => ComputedValue::Text(places.read(*port).index),
            (Drive::Real(expression), BaseType::Real) => {
                ComputedValue::Real(Program::compile_real(expression, &mut place))
            }
            (Drive::Boolean(condition), BaseType::Boolean) => {
                ComputedValue::Boolean(Program::compile_condition(condition, &mut place))
            }
            (Drive::Integer(value), BaseType::Integer) => ComputedValue::ConstantInteger(*value),
            (Drive::String(text), BaseType::String) => ComputedValue::ConstantText(text.clone()),
            (Drive::Curve(curve), BaseType::Real) => ComputedValue::Real(Program::curve(curve)),
            (Drive::Curve(curve), BaseType::Integer) => ComputedValue::Integer(Program::curve(curve)),
            (Drive::Curve(curve), BaseType::Boolean) => ComputedValue::Boolean(Program::curve(curve)),
            (drive, base) => unreachable!("{drive:?} was resolved for a variable of type {base:?}"),
        };
        Self { to: to.index, value }
    }

    /// Brings the value to its input.
    pub fn bring(&mut self, moment: &Moment<'_>, inputs: &mut Values) {
        let to = self.to;
        match &mut self.value {
            ComputedValue::Real(program) => inputs.reals[to] = program.real(moment),
            #[expect(clippy::cast_possible_truncation, reason = "it was an i32 before it was on the stack")]
            ComputedValue::Integer(program) => inputs.integers[to] = program.real(moment) as i32,
            ComputedValue::Boolean(program) => inputs.booleans[to] = i32::from(program.holds(moment)),
            ComputedValue::ConstantInteger(value) => inputs.integers[to] = *value,
            ComputedValue::ConstantText(text) => inputs.texts[to].clone_from(text),
            ComputedValue::Text(from) => inputs.texts[to].clone_from(&moment.outputs.texts[*from]),
        }
    }
}
