//! Values flattened to one array for each base type, with indices into them.

use dsl::scenario::Value;
use fmi2::description::{Kind, Variable};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// One array for each base type. Booleans are held as units exchange them, 0 or 1.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Values {
    /// `fmi2Real`
    pub reals: Vec<f64>,
    /// `fmi2Integer` and enumerations
    pub integers: Vec<i32>,
    /// `fmi2Boolean`
    pub booleans: Vec<i32>,
    /// `fmi2String`
    pub texts: Vec<String>,
}

/// The type of a value of a run, whatever standard a unit follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum ValueType {
    /// A number in SI units.
    Real,
    /// A whole number, also that of an enumeration's item.
    Integer,
    /// True or false.
    Boolean,
    /// A text.
    Text,
}

impl ValueType {
    /// The type of a variable's values.
    #[must_use]
    pub fn of(variable: &Variable) -> Self {
        match variable.kind {
            Kind::Real(_) => Self::Real,
            Kind::Integer { .. } | Kind::Enumeration { .. } => Self::Integer,
            Kind::Boolean { .. } => Self::Boolean,
            Kind::String { .. } => Self::Text,
        }
    }
}

/// The index of one value in [`Values`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Slot {
    /// The type, which selects the array.
    pub base: ValueType,
    /// The index into it.
    pub index: usize,
}

/// A range of each array of [`Values`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ranges {
    /// Of [`Values::reals`].
    pub reals: Range<usize>,
    /// Of [`Values::integers`].
    pub integers: Range<usize>,
    /// Of [`Values::booleans`].
    pub booleans: Range<usize>,
    /// Of [`Values::texts`].
    pub texts: Range<usize>,
}

impl Values {
    /// Adds a slot that holds zero, false or the empty text.
    pub fn add(&mut self, base: ValueType) -> Slot {
        let index = match base {
            ValueType::Real => grow(&mut self.reals),
            ValueType::Integer => grow(&mut self.integers),
            ValueType::Boolean => grow(&mut self.booleans),
            ValueType::Text => grow(&mut self.texts),
        };
        Slot { base, index }
    }

    /// The end of each array as an empty range.
    #[must_use]
    pub fn end(&self) -> Ranges {
        let at = |length: usize| length..length;
        Ranges {
            reals: at(self.reals.len()),
            integers: at(self.integers.len()),
            booleans: at(self.booleans.len()),
            texts: at(self.texts.len()),
        }
    }

    /// Whether a slot of these values of one layout holds the same; Reals are compared bit by bit, but any two NaN are the
    /// same.
    #[must_use]
    pub fn is_same(&self, other: &Self, Slot { base, index }: Slot) -> bool {
        match base {
            ValueType::Real => {
                let (one, other) = (self.reals[index], other.reals[index]);
                one.to_bits() == other.to_bits() || one.is_nan() && other.is_nan()
            }
            ValueType::Integer => self.integers[index] == other.integers[index],
            ValueType::Boolean => self.booleans[index] == other.booleans[index],
            ValueType::Text => self.texts[index] == other.texts[index],
        }
    }

    /// Copies these ranges from values of the same layout; allocates only where a text is longer than its buffer.
    pub fn copy_ranges(&mut self, from: &Self, ranges: &Ranges) {
        self.reals[ranges.reals.clone()].copy_from_slice(&from.reals[ranges.reals.clone()]);
        self.integers[ranges.integers.clone()].copy_from_slice(&from.integers[ranges.integers.clone()]);
        self.booleans[ranges.booleans.clone()].copy_from_slice(&from.booleans[ranges.booleans.clone()]);
        self.texts[ranges.texts.clone()].clone_from_slice(&from.texts[ranges.texts.clone()]);
    }

    /// Copies one value of other values to a slot of the same type.
    ///
    /// # Panics
    /// If the slots are of different types.
    pub fn copy_slot(&mut self, to: Slot, from: &Self, at: Slot) {
        assert_eq!(to.base, at.base, "a value is copied to a slot of its type");
        match to.base {
            ValueType::Real => self.reals[to.index] = from.reals[at.index],
            ValueType::Integer => self.integers[to.index] = from.integers[at.index],
            ValueType::Boolean => self.booleans[to.index] = from.booleans[at.index],
            ValueType::Text => self.texts[to.index].clone_from(&from.texts[at.index]),
        }
    }

    /// Stores a value of the script.
    ///
    /// # Panics
    /// If the value is not of the slot's type; the resolver excludes that.
    pub fn store(&mut self, slot: Slot, value: &Value) {
        match (slot.base, value) {
            (ValueType::Real, Value::Real(value)) => self.reals[slot.index] = *value,
            (ValueType::Integer, Value::Integer(value)) => self.integers[slot.index] = *value,
            (ValueType::Boolean, Value::Boolean(value)) => self.booleans[slot.index] = i32::from(*value),
            (ValueType::Text, Value::String(value)) => self.texts[slot.index].clone_from(value),
            (ValueType::Text, Value::File(file)) => self.texts[slot.index].clone_from(&file.path),
            (base, value) => unreachable!("{value:?} was resolved for a variable of type {base:?}"),
        }
    }
}

impl Ranges {
    /// The ranges from the start of this to the end of the other.
    #[must_use]
    pub fn to(&self, end: &Self) -> Self {
        Self {
            reals: self.reals.start..end.reals.end,
            integers: self.integers.start..end.integers.end,
            booleans: self.booleans.start..end.booleans.end,
            texts: self.texts.start..end.texts.end,
        }
    }
}

/// The start value that a description declares, or else zero, false or the empty text.
#[must_use]
pub fn start_value(variable: &Variable) -> Value {
    match &variable.kind {
        Kind::Real(real) => Value::Real(real.start.unwrap_or_default()),
        Kind::Integer { start, .. } | Kind::Enumeration { start, .. } => Value::Integer(start.unwrap_or_default()),
        Kind::Boolean { start } => Value::Boolean(start.unwrap_or_default()),
        Kind::String { start } => Value::String(start.clone().unwrap_or_default()),
    }
}

fn grow<T: Default>(values: &mut Vec<T>) -> usize {
    values.push(T::default());
    values.len() - 1
}
