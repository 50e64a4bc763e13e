//! What a script names outside its own text: units, other texts and tables, loaded through a trait.
//!
//! The crate opens no file. The command line reads from disk, tests from memory, an editor from its buffers.

use std::sync::Arc;

use fmi2::description::ModelDescription;

use crate::source::Source;

/// Loads what a script names. `from` is the text that names it: paths are relative to its folder. While a script is resolved,
/// equal calls return equal results, and the resolver makes each call for a unit, text or table once.
pub trait Loader: Sync {
    /// The description of a unit by the text of an `fmu` line: a path that ends in `.fmu`, or a name.
    ///
    /// # Errors
    /// Why the unit cannot be used.
    fn unit(&self, from: &Source, name: &str) -> Result<Arc<ModelDescription>, Problem>;

    /// The text of a part, which `use x = "part.scn"` names.
    ///
    /// # Errors
    /// Why the text cannot be read.
    fn text(&self, from: &Source, path: &str) -> Result<Source, Problem>;

    /// Whether a unit can be given a file, which `file("yard.csv")` names; the resolver asks at each place that names one.
    ///
    /// # Errors
    /// Why the file cannot be given to a unit.
    fn file(&self, from: &Source, path: &str) -> Result<(), Problem>;

    /// A table of values over time, which `curve("in.csv", "u")` names.
    ///
    /// # Errors
    /// Why the table cannot be read.
    fn table(&self, from: &Source, path: &str) -> Result<Table, Problem>;
}

/// Why something cannot be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// What is wrong, in one line without a full stop.
    pub message: String,
    /// How to fix it.
    pub help: Option<String>,
}

/// A table of numbers over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Seconds, row by row; they never fall, and there is at least one.
    pub time_s: Vec<f64>,
    /// The columns behind the time, in the file's order.
    pub columns: Vec<TableColumn>,
}

/// A column of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableColumn {
    /// The name, without a unit of measure.
    pub name: String,
    /// The unit of measure behind the name: `m/s` of `u [m/s]`.
    pub unit: Option<String>,
    /// The values, row by row; `true` is 1.
    pub values: Vec<f64>,
    /// Whether they are Booleans or Integers, which are held until the next row.
    pub held: bool,
}
