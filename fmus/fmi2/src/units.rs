//! Units of measure as exponents of the SI base units, factor and offset.

use serde::{Deserialize, Serialize};

/// Exponents of the eight base units of FMI, in the order kg m s A K mol cd rad.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Dimension(pub [i8; 8]);

/// `BaseUnit`: `si = factor * value + offset`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
        Self { dimension: Dimension::default(), factor: 1.0, offset: 0.0 }
    }
}
