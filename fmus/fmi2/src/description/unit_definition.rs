//! `UnitDefinitions`: the units of measure that a description defines.

use serde::{Deserialize, Serialize};

use super::Position;

/// `Unit` with its `BaseUnit` and `DisplayUnit`s.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UnitDefinition {
    /// Position of the element.
    pub position: Position,
    /// `name`.
    pub name: String,
    /// `BaseUnit`; if absent, only the name is known.
    pub base: Option<crate::units::BaseUnit>,
    /// `DisplayUnit`s.
    pub display_units: Vec<DisplayUnit>,
}

/// `DisplayUnit`: `display = factor * value + offset`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DisplayUnit {
    /// Position of the element.
    pub position: Position,
    /// `name`.
    pub name: String,
    /// `factor`, 1 by default.
    pub factor: f64,
    /// `offset`, 0 by default.
    pub offset: f64,
}

impl Default for DisplayUnit {
    fn default() -> Self {
        Self { position: Position::default(), name: String::new(), factor: 1.0, offset: 0.0 }
    }
}
