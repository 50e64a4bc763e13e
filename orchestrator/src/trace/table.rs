//! A recorded trace, read back: what `plot` and `diff` look at.

use serde::Deserialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// A trace as text cells, in the file's order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// The header.
    pub names: Vec<String>,
    /// The rows; each has as many cells as the header has names.
    pub rows: Vec<Vec<String>>,
    /// Whether the run that wrote it did not come to its end.
    pub partial: bool,
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
}

/// Why a trace cannot be read.
#[derive(Debug)]
pub enum TableError {
    /// Neither a run's folder nor a trace.
    NoTrace(PathBuf),
    /// The system refused.
    Io(PathBuf, std::io::Error),
    /// A line does not fit the header.
    Ragged {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTrace(path) => write!(f, "{} is neither a run's folder nor a trace.csv", path.display()),
            Self::Io(path, error) => write!(f, "cannot read {}: {error}", path.display()),
            Self::Ragged { path, line } => write!(f, "{}:{line}: not as many cells as the header", path.display()),
        }
    }
}

impl std::error::Error for TableError {}

/// The trace of a run's folder, or the file itself; a `.partial` one stands in for a whole one.
fn trace_file(run: &Path) -> Result<PathBuf, TableError> {
    let whole = run.join(super::run_folder::TRACE_CSV);
    let partial = run.join(format!("{}.partial", super::run_folder::TRACE_CSV));
    [run.to_path_buf(), whole, partial]
        .into_iter()
        .find(|path| path.is_file())
        .ok_or_else(|| TableError::NoTrace(run.to_path_buf()))
}

impl Table {
    /// Reads the trace of a run's folder, or a trace file.
    ///
    /// # Errors
    /// If there is none, it cannot be read, or a row does not fit the header. A last line without its line break, which
    /// a run that broke may leave, is dropped.
    pub fn read(run: &Path) -> Result<Self, TableError> {
        let path = trace_file(run)?;
        let text = std::fs::read_to_string(&path).map_err(|error| TableError::Io(path.clone(), error))?;
        let whole_lines = text.rfind('\n').map_or("", |end| &text[..end]);
        let mut lines = whole_lines.split('\n').map(cells);
        let names = lines.next().unwrap_or_default();
        let rows: Vec<_> = lines.collect();
        if let Some(row) = rows.iter().position(|row| row.len() != names.len()) {
            return Err(TableError::Ragged { path, line: row + 2 });
        }
        let partial = path.extension().is_some_and(|extension| extension == "partial");
        Ok(Self { names, rows, partial })
    }

    /// A column as numbers; a cell that is none, or empty, is NaN.
    #[must_use]
    pub fn numbers(&self, column: usize) -> Vec<f64> {
        self.rows.iter().map(|row| row[column].parse().unwrap_or(f64::NAN)).collect()
    }
}

/// What `signals.json` of a run's folder, or beside a trace file, says of the columns; empty if there is none.
#[must_use]
pub fn notes(run: &Path) -> Vec<ColumnNote> {
    let folder = if run.is_dir() { run } else { run.parent().unwrap_or(Path::new("")) };
    let text = std::fs::read_to_string(folder.join(super::run_folder::SIGNALS_JSON));
    text.ok().and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
}

/// The cells of a line; quotes hold commas together, a doubled quote is one.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    let mut characters = line.strip_suffix('\r').unwrap_or(line).chars().peekable();
    while let Some(character) = characters.next() {
        let cell = cells.last_mut().unwrap_or_else(|| unreachable!("there is always a last cell"));
        match character {
            '"' if quoted && characters.peek() == Some(&'"') => {
                characters.next();
                cell.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            other => cell.push(other),
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(file: &str, text: &str) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(file), text).unwrap();
        folder
    }

    #[test]
    fn a_trace_is_read_with_its_quoted_names() {
        let folder = folder_with("trace.csv", "time,\"m[1,2]\",\"say \"\"x\"\"\"\n0,1,\n0.1,2,3\n");
        let table = Table::read(folder.path()).unwrap();
        assert_eq!(table.names, ["time", "m[1,2]", "say \"x\""]);
        assert_eq!(table.numbers(1), [1.0, 2.0]);
        assert!(table.numbers(2)[0].is_nan() && !table.partial);
    }

    #[test]
    fn a_partial_trace_stands_in_and_its_torn_last_line_is_dropped() {
        let folder = folder_with("trace.csv.partial", "time,a\n0,1\n0.1");
        let table = Table::read(folder.path()).unwrap();
        assert_eq!((table.rows.len(), table.partial), (1, true));
    }

    #[test]
    fn a_row_that_does_not_fit_is_named_by_its_line() {
        let folder = folder_with("trace.csv", "time,a\n0,1\n0.1\n");
        let error = Table::read(folder.path()).unwrap_err().to_string();
        assert!(error.ends_with("trace.csv:3: not as many cells as the header"), "{error}");
    }

    #[test]
    fn columns_are_explained_by_the_file_beside_them() {
        let folder =
            folder_with("signals.json", r#"[{"name": "a.b", "unit": "m", "type": "Real", "causality": "output"}]"#);
        let note = ColumnNote { name: "a.b".to_owned(), unit: Some("m".to_owned()), kind: "Real".to_owned() };
        let expected = [note];
        assert_eq!(notes(&folder.path().join("trace.csv")), expected);
        assert_eq!(notes(folder.path()), expected);
        assert_eq!(notes(Path::new("/no/such/run")), []);
    }
}
