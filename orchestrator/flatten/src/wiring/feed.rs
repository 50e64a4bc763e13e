//! What connections bring to the inputs of a group: plain copies, merged into contiguous ranges, and computed values.

use super::slot_table::SlotTable;
use crate::expression::{Moment, Program, Stack};
use crate::values::{Slot, ValueType, Values};
use dsl::scenario::{Connection, Drive};

/// All connections of one kind into one group.
#[derive(Debug, Default)]
pub struct Feed {
    reals: Vec<CopyRange>,
    /// `None` for the many groups that connections drive with copies of Reals only.
    others: Option<Box<Others>>,
}

/// Everything but plain copies of Reals.
#[derive(Debug, Default)]
struct Others {
    integers: Vec<CopyRange>,
    booleans: Vec<CopyRange>,
    texts: Vec<CopyRange>,
    computed: Vec<Computed>,
}

/// Adjacent values that are copied to adjacent slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CopyRange {
    /// Index of the first source.
    pub from: usize,
    /// Index of the first target.
    pub to: usize,
    /// The number of values.
    pub length: usize,
}

/// One value that is not a plain copy, or that applies only while a window is open.
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
    /// Compiles connections, which are given in the order of their targets, so that neighbouring copies can be merged.
    pub(super) fn new(connections: &[&Connection], table: &SlotTable) -> Self {
        let mut feed = Self::default();
        for connection in connections {
            let to = table.input_slot(connection.target).slot;
            match &connection.source {
                Drive::Copy(port) => feed.copy(table.read(*port), to),
                drive => feed.others().computed.push(Computed::new(drive, to, table)),
            }
        }
        feed
    }

    fn copy(&mut self, from: Slot, to: Slot) {
        assert_eq!(from.base, to.base, "a copy was resolved between different types");
        let ranges = match to.base {
            ValueType::Real => &mut self.reals,
            ValueType::Integer => &mut self.others().integers,
            ValueType::Boolean => &mut self.others().booleans,
            ValueType::Text => &mut self.others().texts,
        };
        match ranges
            .last_mut()
            .filter(|range| (range.from + range.length, range.to + range.length) == (from.index, to.index))
        {
            Some(range) => range.length += 1,
            None => ranges.push(CopyRange { from: from.index, to: to.index, length: 1 }),
        }
    }

    fn others(&mut self) -> &mut Others {
        self.others.get_or_insert_default()
    }

    /// Whether there is no connection.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.reals.is_empty() && self.others.is_none()
    }

    /// The programs that compute values.
    pub(super) fn programs(&self) -> impl Iterator<Item = &Program> {
        let computed = self.others.iter().flat_map(|others| &others.computed);
        computed.filter_map(|computed| match &computed.value {
            ComputedValue::Real(program) | ComputedValue::Integer(program) | ComputedValue::Boolean(program) => {
                Some(program)
            }
            ComputedValue::ConstantInteger(_) | ComputedValue::ConstantText(_) | ComputedValue::Text(_) => None,
        })
    }

    /// Computes all values and stores them in the inputs.
    #[inline]
    pub fn bring(&self, moment: &Moment<'_>, stack: &mut Stack, inputs: &mut Values) {
        copy(&self.reals, &moment.outputs.reals, &mut inputs.reals);
        if let Some(others) = &self.others {
            others.bring(moment, stack, inputs);
        }
    }
}

impl Others {
    fn bring(&self, moment: &Moment<'_>, stack: &mut Stack, inputs: &mut Values) {
        let outputs = moment.outputs;
        copy(&self.integers, &outputs.integers, &mut inputs.integers);
        copy(&self.booleans, &outputs.booleans, &mut inputs.booleans);
        for range in &self.texts {
            inputs.texts[range.to..range.to + range.length]
                .clone_from_slice(&outputs.texts[range.from..range.from + range.length]);
        }
        for computed in &self.computed {
            computed.bring(moment, stack, inputs);
        }
    }
}

#[inline]
fn copy<T: Copy>(ranges: &[CopyRange], from: &[T], to: &mut [T]) {
    for range in ranges {
        // Most ranges hold a single value, for which a call of `copy_from_slice` costs more than the assignment.
        if range.length == 1 {
            to[range.to] = from[range.from];
        } else {
            to[range.to..range.to + range.length].copy_from_slice(&from[range.from..range.from + range.length]);
        }
    }
}

impl Computed {
    pub(super) fn new(drive: &Drive, to: Slot, table: &SlotTable) -> Self {
        let mut slot_of = |port| table.read(port);
        let value = match (drive, to.base) {
            (Drive::Copy(port), ValueType::Real) => ComputedValue::Real(Program::compile_signal(*port, &mut slot_of)),
            (Drive::Copy(port), ValueType::Integer) => {
                ComputedValue::Integer(Program::compile_signal(*port, &mut slot_of))
            }
            (Drive::Copy(port), ValueType::Boolean) => {
                ComputedValue::Boolean(Program::compile_signal(*port, &mut slot_of))
            }
            (Drive::Copy(port), ValueType::Text) => ComputedValue::Text(table.read(*port).index),
            (Drive::Real(expression), ValueType::Real) => {
                ComputedValue::Real(Program::compile_real(expression, &mut slot_of))
            }
            (Drive::Boolean(condition), ValueType::Boolean) => {
                ComputedValue::Boolean(Program::compile_condition(condition, &mut slot_of))
            }
            (Drive::Integer(value), ValueType::Integer) => ComputedValue::ConstantInteger(*value),
            (Drive::String(text), ValueType::Text) => ComputedValue::ConstantText(text.clone()),
            (Drive::Curve(curve), ValueType::Real) => ComputedValue::Real(Program::curve(curve)),
            (Drive::Curve(curve), ValueType::Integer) => ComputedValue::Integer(Program::curve(curve)),
            (Drive::Curve(curve), ValueType::Boolean) => ComputedValue::Boolean(Program::curve(curve)),
            (drive, base) => unreachable!("{drive:?} was resolved for a variable of type {base:?}"),
        };
        Self { to: to.index, value }
    }

    /// Computes the value and stores it in its input.
    pub fn bring(&self, moment: &Moment<'_>, stack: &mut Stack, inputs: &mut Values) {
        let to = self.to;
        match &self.value {
            ComputedValue::Real(program) => inputs.reals[to] = program.real(moment, stack),
            #[expect(clippy::cast_possible_truncation, reason = "it was an i32 before it was on the stack")]
            ComputedValue::Integer(program) => inputs.integers[to] = program.real(moment, stack) as i32,
            ComputedValue::Boolean(program) => inputs.booleans[to] = i32::from(program.holds(moment, stack)),
            ComputedValue::ConstantInteger(value) => inputs.integers[to] = *value,
            ComputedValue::ConstantText(text) => inputs.texts[to].clone_from(text),
            ComputedValue::Text(from) => inputs.texts[to].clone_from(&moment.outputs.texts[*from]),
        }
    }
}
