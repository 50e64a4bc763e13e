//! Where the values of a row of the trace come from: for each column the slot of its value.

use super::slot_table::SlotTable;
use crate::expression::{Moment, Program, Stack};
use crate::values::{Slot, ValueType, Values};
use dsl::scenario::{Column, ColumnSource};
use unit::board::RowWriter;

/// The columns, separated into those of outputs, those of inputs and those that are computed.
#[derive(Debug, Default)]
pub struct RowLayout {
    outputs: Columns,
    inputs: Columns,
    /// Programs of `let`s with the index of the column.
    reals: Vec<(Program, usize)>,
    conditions: Vec<(Program, usize)>,
}

#[derive(Debug, Default)]
struct Columns {
    /// Index of the value and index of the column.
    reals: Vec<(usize, usize)>,
    integers: Vec<(usize, usize)>,
    booleans: Vec<(usize, usize)>,
}

impl RowLayout {
    pub(super) fn new(columns: &[Column], table: &SlotTable) -> Self {
        let mut layout = Self::default();
        let read = &mut |port| table.read(port);
        for (column, recorded) in columns.iter().enumerate() {
            match &recorded.source {
                ColumnSource::Port(port) => match table.input(*port) {
                    Some(slot) => layout.inputs.add(slot, column),
                    None => layout.outputs.add(table.read(*port), column),
                },
                ColumnSource::Real { value, .. } => layout.reals.push((Program::compile_real(value, read), column)),
                ColumnSource::Condition(condition) => {
                    layout.conditions.push((Program::compile_condition(condition, read), column));
                }
            }
        }
        layout
    }

    /// Sets each column of a row once: the bits of Reals, Integers widened with their sign, Booleans 0 or 1.
    pub fn fill(&self, moment: &Moment<'_>, inputs: &Values, stack: &mut Stack, row: &RowWriter<'_>) {
        self.outputs.fill(moment.outputs, row);
        self.inputs.fill(inputs, row);
        for (program, column) in &self.reals {
            row.set(*column, program.real(moment, stack).to_bits());
        }
        for (program, column) in &self.conditions {
            row.set(*column, u64::from(program.holds(moment, stack)));
        }
    }
}

impl Columns {
    fn add(&mut self, slot: Slot, column: usize) {
        let columns = match slot.base {
            ValueType::Real => &mut self.reals,
            ValueType::Integer => &mut self.integers,
            ValueType::Boolean => &mut self.booleans,
            ValueType::Text => unreachable!("the resolver admits no column of strings"),
        };
        columns.push((slot.index, column));
    }

    fn fill(&self, values: &Values, row: &RowWriter<'_>) {
        for &(index, column) in &self.reals {
            row.set(column, values.reals[index].to_bits());
        }
        for &(index, column) in &self.integers {
            row.set(column, i64::from(values.integers[index]).cast_unsigned());
        }
        for &(index, column) in &self.booleans {
            row.set(column, u64::from(values.booleans[index] != 0));
        }
    }
}
