//! The parameters of a script, and the case of its sweep that gives them values.

use serde::{Deserialize, Serialize};

/// A parameter of the script with its value in this run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Parameter {
    /// The name.
    pub name: String,
    /// The value as it can be typed after `--set name = `.
    pub value: String,
    /// Whether the command line set it.
    pub set: bool,
}

/// The cases of a script, and the one that this is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sweep {
    /// How many cases there are.
    pub cases: u64,
    /// The case that gave the swept parameters their values; `None` if they have their own.
    pub case: Option<Case>,
}

/// A case of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Case {
    /// Its number, from 0.
    pub number: u64,
    /// The seed that `--set seed = …` gave to the draws, where `seed` is an axis itself.
    pub draw_seed: Option<i64>,
}
