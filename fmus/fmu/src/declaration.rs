//! The declaration of a port by the attributes of a field.
#![allow(unsafe_code, reason = "Ports is an unsafe trait: its references become offsets")]

/// Role of a port in its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Role {
    /// Set from outside, before and during a run.
    Input,
    /// Set from outside before a run, and also between steps if it is tunable.
    Parameter {
        /// Whether it may change between steps.
        tunable: bool,
    },
    /// A state with a start value that may be set; at its own instant it depends on no input.
    ExactOutput,
    /// An output that the unit computes.
    CalculatedOutput {
        /// The full name of the field that declares it.
        field: String,
        /// Its dependencies at a communication point.
        depends: Vec<String>,
        /// The dependencies of its initial value.
        depends_at_start: Vec<String>,
    },
    /// A state for observation only.
    ExactLocal,
    /// A computed variable for observation only.
    CalculatedLocal,
}

impl Role {
    /// Whether the description has a start value, so that it may be set before the run.
    #[must_use]
    pub fn has_start(&self) -> bool {
        !matches!(self, Self::CalculatedOutput { .. } | Self::CalculatedLocal)
    }
}

/// The attributes of one port; those of a group or array hold for each of its scalars.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// Its role in the unit.
    pub role: Role,
    /// The doc comment's first paragraph.
    pub description: &'static str,
    /// Unit of measure of a Real.
    pub unit: Option<&'static str>,
    /// Display unit of a Real.
    pub display: Option<&'static str>,
    /// Smallest value.
    pub min: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// Nominal value.
    pub nominal: Option<f64>,
}

/// `#[fmu(experiment(..))]`: the default experiment of the unit, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Start time.
    pub start: Option<f64>,
    /// Stop time.
    pub stop: Option<f64>,
    /// Preferred communication step.
    pub step: Option<f64>,
}

/// The declaration of a unit's struct, implemented by `#[derive(Fmu)]`.
///
/// # Safety
///
/// `visit` keeps the contract of [`Port`](crate::port::Port).
pub unsafe trait Ports: Sized {
    /// `modelName`; the crate's name by default.
    const NAME: Option<&'static str>;
    /// The struct's doc comment, first paragraph.
    const DESCRIPTION: &'static str;
    /// The default experiment.
    const EXPERIMENT: Experiment;

    /// The unit with every port at its start value.
    fn at_start() -> Self;

    /// Passes each scalar to the visitor, in the order of declaration.
    fn visit(&mut self, visitor: &mut crate::visitor::Visitor);
}
