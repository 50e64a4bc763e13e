//! `ModelStructure`: outputs, derivatives and initial unknowns with their dependencies.

use serde::{Deserialize, Serialize};

use super::Position;

/// `ModelStructure`; indices count from 0 into [`variables`](super::ModelDescription::variables).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelStructure {
    /// Position of the element.
    pub position: Position,
    /// `Outputs`
    pub outputs: Vec<Unknown>,
    /// `Derivatives`
    pub derivatives: Vec<Unknown>,
    /// `InitialUnknowns`
    pub initial_unknowns: Vec<Unknown>,
}

/// `Unknown`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Unknown {
    /// Position of the element.
    pub position: Position,
    /// Index of the variable; `usize::MAX` represents an index of 0 in the file, which the checker reports.
    pub index: usize,
    /// `dependencies`: `None` (absent) means on everything, an empty list on nothing.
    pub dependencies: Option<Vec<usize>>,
    /// `dependenciesKind`, as many as dependencies.
    pub dependencies_kind: Option<Vec<DependencyKind>>,
}

/// One entry of `dependenciesKind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DependencyKind {
    /// `dependent`
    Dependent,
    /// `constant`
    Constant,
    /// `fixed`
    Fixed,
    /// `tunable`
    Tunable,
    /// `discrete`
    Discrete,
}

impl DependencyKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Dependent, Self::Constant, Self::Fixed, Self::Tunable, Self::Discrete];

    /// The schema's spelling.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Dependent => "dependent",
            Self::Constant => "constant",
            Self::Fixed => "fixed",
            Self::Tunable => "tunable",
            Self::Discrete => "discrete",
        }
    }
}
