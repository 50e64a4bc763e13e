//! What the attributes of a field say about a port.
#![allow(unsafe_code, reason = "Ports is an unsafe trait: its references become offsets")]

/// What a port is to its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Role {
    /// Given from outside, before and during a run.
    Input,
    /// Given from outside before a run, or between steps too if it is tunable.
    Parameter {
        /// Whether it may change between steps.
        tunable: bool,
    },
    /// A state that starts at a value which may be set, and depends on nothing at its own instant.
    ExactOutput,
    /// An output that the unit computes.
    CalculatedOutput {
        /// What it depends on at the instant of a communication point.
        depends: Vec<String>,
        /// What its value at the start depends on.
        depends_at_start: Vec<String>,
    },
    /// A state of interest to nobody but an observer.
    ExactLocal,
    /// Computed, of interest to nobody but an observer.
    CalculatedLocal,
}

impl Role {
    /// Whether a start value stands in the description, so that it may be set before the run.
    #[must_use]
    pub fn has_start(&self) -> bool {
        !matches!(self, Self::CalculatedOutput { .. } | Self::CalculatedLocal)
    }
}

/// The attributes of one port; those of a group or array hold for each of its scalars.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// What it is to the unit.
    pub role: Role,
    /// The doc comment's first paragraph.
    pub description: &'static str,
    /// Unit of measure of a Real.
    pub unit: Option<&'static str>,
    /// Unit that people prefer to read.
    pub display: Option<&'static str>,
    /// Smallest value.
    pub min: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// Usual size.
    pub nominal: Option<f64>,
}

/// `#[fmu(experiment(..))]`: what a simulation of the unit alone would use, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Start time.
    pub start: Option<f64>,
    /// Stop time.
    pub stop: Option<f64>,
    /// Preferred communication step.
    pub step: Option<f64>,
}

/// What `#[derive(Fmu)]` says about a unit's struct.
///
/// # Safety
///
/// `visit` keeps the promises of [`Port`](crate::port::Port).
pub unsafe trait Ports: Sized {
    /// `modelName`; the crate's name if none is given.
    const NAME: Option<&'static str>;
    /// The struct's doc comment, first paragraph.
    const DESCRIPTION: &'static str;
    /// The default experiment.
    const EXPERIMENT: Experiment;

    /// The unit with every port at its start value.
    fn at_start() -> Self;

    /// Shows each scalar to the visitor, in the order of declaration.
    fn visit(&mut self, visitor: &mut crate::visitor::Visitor);
}
