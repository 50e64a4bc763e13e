//! `TypeDefinitions`: types that variables share.

use serde::{Deserialize, Serialize};

use super::Position;

/// `SimpleType`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimpleType {
    /// Position of the element.
    pub position: Position,
    /// `name`.
    pub name: String,
    /// `description`.
    pub description: Option<String>,
    /// The one child element.
    pub kind: TypeKind,
}

/// The child element of a `SimpleType`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TypeKind {
    /// `Real`
    Real(RealAttributes),
    /// `Integer`
    Integer {
        /// `min`
        min: Option<i32>,
        /// `max`
        max: Option<i32>,
    },
    /// `Boolean`
    Boolean,
    /// `String`
    String,
    /// `Enumeration`
    Enumeration {
        /// `quantity`
        quantity: Option<String>,
        /// `Item`s, in the file's order.
        items: Vec<Item>,
    },
}

/// `Item` of an enumeration type.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Item {
    /// Position of the element.
    pub position: Position,
    /// `name`
    pub name: String,
    /// `value`, unique in its type.
    pub value: i32,
    /// `description`
    pub description: Option<String>,
}

/// The attributes that a Real type and a Real variable share.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RealAttributes {
    /// `quantity`
    pub quantity: Option<String>,
    /// `unit`
    pub unit: Option<String>,
    /// `displayUnit`
    pub display_unit: Option<String>,
    /// `relativeQuantity`: whether values are differences, to which the offset of a unit does not apply.
    pub relative_quantity: Option<bool>,
    /// `min`
    pub min: Option<f64>,
    /// `max`
    pub max: Option<f64>,
    /// `nominal`
    pub nominal: Option<f64>,
    /// `unbounded`
    pub unbounded: bool,
}
