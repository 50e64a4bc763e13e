//! Tables over time, as `plot`, `diff` and `simulate --input` read them: the trace of a run, or a file of another tool.
//!
//! The first column is `time`, in seconds unless it says `time [ms]`. A file is comma-separated text as spreadsheets write
//! it, or Parquet.

mod cell;
mod file;
mod parquet;
mod sheet;

use crate::run_folder::SIGNALS_JSON;
use fmi2::printable;
use serde::Deserialize;
use sheet::{Sheet, Wrong};
use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::path::Path;

pub use cell::CellType;
pub use file::{Heading, TableFile, seconds};

/// A table in memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The columns; the first is the time in seconds, and has a value in each row.
    pub columns: Vec<Column>,
    /// Whether the run that wrote it did not come to its end.
    pub partial: bool,
}

/// One column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// The name.
    pub name: String,
    /// The unit of measure.
    pub unit: Option<String>,
    /// Whether its values are known to be Integers, Booleans or items.
    pub is_discrete: bool,
    /// What `signals.json` says of its type; empty if that is not known.
    pub kind: String,
    /// The names of an enumeration's values.
    pub items: BTreeMap<i32, String>,
    /// A value for each row; `None` where the cell is empty.
    pub values: Vec<Option<f64>>,
}

/// What `signals.json` says of one column.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
pub struct ColumnNote {
    /// The name in the trace's header.
    pub name: String,
    /// The unit of measure.
    pub unit: Option<String>,
    /// `Real`, `Integer`, `Boolean`, `Enumeration` or `String`.
    #[serde(rename = "type")]
    pub kind: String,
    /// The names of an enumeration's values.
    #[serde(default)]
    pub items: BTreeMap<i32, String>,
}

/// Why a table cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableError {
    /// What is wrong, with the file, and with line and column if it is a text.
    message: String,
    /// What the user can do about it.
    pub help: Option<String>,
}

impl TableError {
    fn new(message: String) -> Self {
        Self { message, help: None }
    }

    fn unreadable(path: &Path, reason: impl fmt::Display) -> Self {
        Self::new(format!("cannot read {}: {reason}", printable::path(path)))
    }

    fn placed(path: &Path, sheet: &Sheet, wrong: Wrong) -> Self {
        let (line, column) = sheet.place(wrong.at);
        Self { message: format!("{}:{line}:{column}: {}", printable::path(path), wrong.message), help: wrong.help }
    }

    /// Adds what the user can do about it.
    #[must_use]
    pub fn help(self, help: Option<String>) -> Self {
        Self { help, ..self }
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for TableError {}

impl Table {
    /// Reads the trace of a run's folder, or a file, with the units of measure and types that `signals.json` in its folder
    /// says of its columns.
    ///
    /// # Errors
    /// There is no table, it cannot be read, a row does not fit the names, a cell is not a number, or time decreases. A last
    /// line without a line break in a partial trace, which a run that broke may leave, is not an error: it is dropped.
    pub fn read(run: &Path) -> Result<Self, TableError> {
        let mut file = TableFile::open(run)?;
        let notes = notes(run);
        let mut columns = vec![Column { name: "time".to_owned(), unit: Some("s".to_owned()), ..Column::default() }];
        let mut types = Vec::new();
        for heading in &file.headings()[1..] {
            let note = notes.iter().find(|note| note.name == heading.text);
            types.push(note.map_or(CellType::Any, ColumnNote::cell_type));
            columns.push(column(heading, note));
        }
        let partial = file.is_partial();
        let values = file.read(&types, true)?;
        for (column, values) in columns.iter_mut().zip(values) {
            column.values = values;
        }
        Ok(Self { columns, partial })
    }

    /// The names of the columns, the time first.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.name.as_str())
    }

    /// The column of this name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// The times of the rows in seconds.
    #[must_use]
    pub fn time_s(&self) -> Vec<f64> {
        self.columns.first().map_or_else(Vec::new, Column::numbers)
    }
}

fn column(heading: &Heading, note: Option<&ColumnNote>) -> Column {
    let (name, unit) = match (note, heading.with_unit()) {
        (None, Some((name, unit))) => (name.to_owned(), Some(unit.to_owned())),
        _ => (heading.text.clone(), note.and_then(|note| note.unit.clone())),
    };
    let is_discrete = note.is_some_and(|note| note.kind != "Real");
    let (kind, items) = note.map(|note| (note.kind.clone(), note.items.clone())).unwrap_or_default();
    Column { name: printable::line(&name), unit, is_discrete, kind, items, values: Vec::new() }
}

impl Column {
    /// The values, NaN where a cell is empty.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        self.values.iter().map(|value| value.unwrap_or(f64::NAN)).collect()
    }
}

impl ColumnNote {
    fn cell_type(&self) -> CellType {
        match self.kind.as_str() {
            "Real" => CellType::Real,
            "Integer" => CellType::Integer,
            "Boolean" => CellType::Boolean,
            "Enumeration" => CellType::Enumeration(self.items.clone()),
            _ => CellType::Any,
        }
    }
}

/// What `signals.json` of a run's folder, or beside a trace file, says of the columns; empty if there is none.
fn notes(run: &Path) -> Vec<ColumnNote> {
    let folder = if run.is_dir() { run } else { run.parent().unwrap_or(Path::new("")) };
    let text = fs::read_to_string(folder.join(SIGNALS_JSON));
    text.ok().and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
}

#[cfg(test)]
mod tests;
