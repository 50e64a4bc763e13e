//! Units of measure as exponents of the SI base units, factor and offset.
//!
//! A unit is represented like a `BaseUnit` element of a model description; [`parse`] reads the unit expressions of
//! scripts and unit crates (`m/s^2`, `N.m`, `deg`) with one built-in table.

mod parse;
mod table;

use std::fmt;

pub use parse::{Cause, UnknownUnit, parse};

/// Exponents of the eight base units of FMI, in the order kg m s A K mol cd rad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "description", derive(serde::Serialize, serde::Deserialize))]
pub struct Dimension(pub [i8; 8]);

impl Dimension {
    /// The dimension of a plain number.
    pub const NONE: Self = Self([0; 8]);
    /// The names of the base units, in the order of the exponents.
    pub const BASE_NAMES: [&'static str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];

    /// The dimension of a product, or `None` if an exponent leaves the range of `i8`.
    #[must_use]
    pub fn checked_mul(self, other: Self) -> Option<Self> {
        self.each(|index, exponent| exponent.checked_add(other.0[index]))
    }

    /// The dimension of a quotient, or `None` if an exponent leaves the range of `i8`.
    #[must_use]
    pub fn checked_div(self, other: Self) -> Option<Self> {
        self.each(|index, exponent| exponent.checked_sub(other.0[index]))
    }

    /// The dimension of a power, or `None` if an exponent leaves the range of `i8`.
    #[must_use]
    pub fn checked_pow(self, power: i8) -> Option<Self> {
        self.each(|_, exponent| exponent.checked_mul(power))
    }

    /// The dimension of a square root, or `None` if an exponent is odd.
    #[must_use]
    pub fn checked_sqrt(self) -> Option<Self> {
        self.each(|_, exponent| (exponent % 2 == 0).then_some(exponent / 2))
    }

    /// The dimension with the exponent of rad set to 0: inside expressions an angle is treated as a plain number.
    #[must_use]
    pub fn without_angle(mut self) -> Self {
        self.0[7] = 0;
        self
    }

    fn each(self, change: impl Fn(usize, i8) -> Option<i8>) -> Option<Self> {
        let mut exponents = self.0;
        for (index, exponent) in exponents.iter_mut().enumerate() {
            *exponent = change(index, *exponent)?;
        }
        Some(Self(exponents))
    }
}

/// `kg m^2/s^2`, `kg/(m s^2)`, `1/s`, and `1` for a plain number.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = || Self::BASE_NAMES.iter().zip(self.0);
        let written = |name: &str, exponent: u8| match exponent {
            1 => name.to_owned(),
            _ => format!("{name}^{exponent}"),
        };
        let above: Vec<_> = named().filter(|&(_, e)| e > 0).map(|(name, e)| written(name, e.unsigned_abs())).collect();
        let below: Vec<_> = named().filter(|&(_, e)| e < 0).map(|(name, e)| written(name, e.unsigned_abs())).collect();
        f.write_str(if above.is_empty() { "1".to_owned() } else { above.join(" ") }.as_str())?;
        match below.as_slice() {
            [] => Ok(()),
            [one] => write!(f, "/{one}"),
            several => write!(f, "/({})", several.join(" ")),
        }
    }
}

/// `BaseUnit`: `si = factor * value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "description", derive(serde::Serialize, serde::Deserialize))]
pub struct BaseUnit {
    /// Exponents of the base units.
    pub dimension: Dimension,
    /// Factor to SI.
    pub factor: f64,
    /// Offset to SI, added after the factor.
    pub offset: f64,
}

impl Default for BaseUnit {
    fn default() -> Self {
        Self { dimension: Dimension::NONE, factor: 1.0, offset: 0.0 }
    }
}

impl BaseUnit {
    /// The SI value of a value in this unit: of parts of the SI unit the number nearest to it, so that 700 ms is 0.7 s.
    #[must_use]
    pub fn to_si(&self, value: f64) -> f64 {
        self.parts().map_or_else(|| self.scale().apply(value), |parts| value / parts)
    }

    /// The value in this unit for an SI value.
    #[must_use]
    pub fn from_si(&self, si: f64) -> f64 {
        match self.parts() {
            Some(parts) => si * parts,
            None if self.factor == 1.0 && self.offset == 0.0 => si,
            None => (si - self.offset) / self.factor,
        }
    }

    /// How many of this unit are one SI unit, if that is a whole number above 1: 1000 of `ms`.
    #[must_use]
    pub fn parts(&self) -> Option<f64> {
        let parts = (1.0 / self.factor).round();
        (self.offset == 0.0 && parts > 1.0 && 1.0 / parts == self.factor).then_some(parts)
    }

    /// The conversion of values in this unit to values in the other one; `None` if the dimensions differ.
    #[must_use]
    pub fn conversion_to(&self, other: &Self) -> Option<Conversion> {
        let (factor, offset) = (self.factor / other.factor, (self.offset - other.offset) / other.factor);
        (self.dimension == other.dimension).then_some(Conversion { factor, offset })
    }

    fn scale(&self) -> Conversion {
        Conversion { factor: self.factor, offset: self.offset }
    }
}

/// `new = factor * old + offset`, between two units of one dimension or from a unit to its display unit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "description", derive(serde::Serialize, serde::Deserialize))]
pub struct Conversion {
    /// Factor.
    pub factor: f64,
    /// Offset, added after the factor.
    pub offset: f64,
}

impl Conversion {
    /// The identity.
    pub const IDENTITY: Self = Self { factor: 1.0, offset: 0.0 };

    /// The converted value; [`Conversion::IDENTITY`] keeps the bits.
    #[must_use]
    pub fn apply(&self, value: f64) -> f64 {
        if *self == Self::IDENTITY { value } else { self.factor * value + self.offset }
    }
}

#[cfg(test)]
mod tests;
