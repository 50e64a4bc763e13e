//! The attributes causality, variability and initial: role, time of change and source of the first value of a variable.

use serde::{Deserialize, Serialize};

/// `causality`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Causality {
    /// `parameter`
    Parameter,
    /// `calculatedParameter`
    CalculatedParameter,
    /// `input`
    Input,
    /// `output`
    Output,
    /// `local`, the schema's default
    #[default]
    Local,
    /// `independent`
    Independent,
}

impl Causality {
    /// All causalities.
    pub const ALL: [Self; 6] =
        [Self::Parameter, Self::CalculatedParameter, Self::Input, Self::Output, Self::Local, Self::Independent];

    /// The schema's spelling.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Parameter => "parameter",
            Self::CalculatedParameter => "calculatedParameter",
            Self::Input => "input",
            Self::Output => "output",
            Self::Local => "local",
            Self::Independent => "independent",
        }
    }
}

/// `variability`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Variability {
    /// `constant`
    Constant,
    /// `fixed`
    Fixed,
    /// `tunable`
    Tunable,
    /// `discrete`
    Discrete,
    /// `continuous`, the schema's default
    #[default]
    Continuous,
}

impl Variability {
    /// All variabilities.
    pub const ALL: [Self; 5] = [Self::Constant, Self::Fixed, Self::Tunable, Self::Discrete, Self::Continuous];

    /// The schema's spelling.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Fixed => "fixed",
            Self::Tunable => "tunable",
            Self::Discrete => "discrete",
            Self::Continuous => "continuous",
        }
    }
}

/// `initial`
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Initial {
    /// `exact`
    Exact,
    /// `approx`
    Approx,
    /// `calculated`
    Calculated,
}

impl Initial {
    /// All values of `initial`.
    pub const ALL: [Self; 3] = [Self::Exact, Self::Approx, Self::Calculated];

    /// The schema's spelling.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Approx => "approx",
            Self::Calculated => "calculated",
        }
    }
}

/// The default of `initial` in the table of section 2.2.7; `None` for inputs, the independent variable and pairs that
/// the table forbids.
#[must_use]
pub fn default_initial(causality: Causality, variability: Variability) -> Option<Initial> {
    use {Causality as C, Variability as V};
    match (causality, variability) {
        (C::Parameter, V::Fixed | V::Tunable) | (C::Output | C::Local, V::Constant) => Some(Initial::Exact),
        (C::CalculatedParameter, V::Fixed | V::Tunable)
        | (C::Output, V::Discrete | V::Continuous)
        | (C::Local, V::Fixed | V::Tunable | V::Discrete | V::Continuous) => Some(Initial::Calculated),
        _ => None,
    }
}
