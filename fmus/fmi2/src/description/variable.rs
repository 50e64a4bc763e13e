//! `ScalarVariable`: one port in the terms of the standard.

use crate::calls::{Permission, State, settable};
use serde::{Deserialize, Serialize};

use super::{Causality, Initial, Named, Position, RealAttributes, Variability, default_initial};

/// `ScalarVariable`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Position of the element.
    pub position: Position,
    /// `name`
    pub name: String,
    /// `valueReference`: the handle in get and set calls, unique with the base type.
    pub value_reference: u32,
    /// `description`
    pub description: Option<String>,
    /// `causality`
    pub causality: Causality,
    /// `variability`
    pub variability: Variability,
    /// `initial` as written; [`Variable::initial_or_default`] adds the standard's defaults.
    pub initial: Option<Initial>,
    /// `canHandleMultipleSetPerTimeInstant`, which only an input of a unit with model exchange may have.
    pub can_handle_multiple_set_per_time_instant: Option<bool>,
    /// The tools in `Annotations`.
    pub annotations: Vec<Named>,
    /// `declaredType` of the child element.
    pub declared_type: Option<String>,
    /// The child element.
    pub kind: Kind,
}

/// The child element of a `ScalarVariable`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Kind {
    /// `Real`; `start` is in [`RealVariable`].
    Real(RealVariable),
    /// `Integer`
    Integer {
        /// `start`
        start: Option<i32>,
        /// `min`
        min: Option<i32>,
        /// `max`
        max: Option<i32>,
    },
    /// `Boolean`
    Boolean {
        /// `start`
        start: Option<bool>,
    },
    /// `String`
    String {
        /// `start`
        start: Option<String>,
    },
    /// `Enumeration`; `declaredType` is mandatory.
    Enumeration {
        /// `start`
        start: Option<i32>,
        /// `min`
        min: Option<i32>,
        /// `max`
        max: Option<i32>,
    },
}

/// `Real` of a `ScalarVariable`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RealVariable {
    /// `start`
    pub start: Option<f64>,
    /// `derivative`: 0-based index of the variable whose derivative this is (1-based in the file).
    pub derivative: Option<usize>,
    /// `reinit`, which only a state of a unit with model exchange may have.
    pub reinit: Option<bool>,
    /// Attributes that a type may declare too; the variable's own values take precedence.
    pub attributes: RealAttributes,
}

impl std::ops::Deref for RealVariable {
    type Target = RealAttributes;
    fn deref(&self) -> &RealAttributes {
        &self.attributes
    }
}

/// The base types that get and set calls distinguish; Enumeration is passed as Integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum BaseType {
    /// `fmi2Real`
    Real,
    /// `fmi2Integer`, also of enumerations
    Integer,
    /// `fmi2Boolean`
    Boolean,
    /// `fmi2String`
    String,
}

impl Variable {
    /// The base type of the variable's get and set calls.
    #[must_use]
    pub fn base_type(&self) -> BaseType {
        match self.kind {
            Kind::Real(_) => BaseType::Real,
            Kind::Integer { .. } | Kind::Enumeration { .. } => BaseType::Integer,
            Kind::Boolean { .. } => BaseType::Boolean,
            Kind::String { .. } => BaseType::String,
        }
    }

    /// Whether an importer may set the variable before initialization.
    #[must_use]
    pub fn has_settable_start(&self) -> bool {
        let initial = self.initial_or_default();
        settable(State::Instantiated, self.causality, self.variability, initial) == Permission::Always
    }

    /// Whether an importer may set the variable in initialization mode.
    #[must_use]
    pub fn is_settable_in_initialization(&self) -> bool {
        let initial = self.initial_or_default();
        settable(State::InitializationMode, self.causality, self.variability, initial) == Permission::Always
    }

    /// Whether there is a start value.
    #[must_use]
    pub fn has_start(&self) -> bool {
        match &self.kind {
            Kind::Real(real) => real.start.is_some(),
            Kind::Integer { start, .. } | Kind::Enumeration { start, .. } => start.is_some(),
            Kind::Boolean { start } => start.is_some(),
            Kind::String { start } => start.is_some(),
        }
    }

    /// `initial`, or if absent the standard's default for the causality and variability (table of 2.2.7).
    #[must_use]
    pub fn initial_or_default(&self) -> Option<Initial> {
        self.initial.or_else(|| default_initial(self.causality, self.variability))
    }
}
