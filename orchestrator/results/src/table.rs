//! A recorded trace, read back for `plot` and `diff`.

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
    /// The operating system returned an error.
    Io(PathBuf, std::io::Error),
    /// A line does not fit the header.
    Ragged {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
    },
    /// The first column is not the time.
    Timeless(PathBuf),
    /// A cell is neither empty nor a number.
    NoNumber {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The cell.
        cell: String,
    },
    /// A time is not a finite number, or is before that of the row above.
    NoTime {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The cell.
        cell: String,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTrace(path) => write!(f, "{} is neither a run's folder nor a trace.csv", path.display()),
            Self::Io(path, error) => write!(f, "cannot read {}: {error}", path.display()),
            Self::Ragged { path, line } => write!(f, "{}:{line}: not as many cells as the header", path.display()),
            Self::Timeless(path) => write!(f, "{}:1: the first column is not `time`", path.display()),
            Self::NoNumber { path, line, cell } => write!(f, "{}:{line}: `{cell}` is no number", path.display()),
            Self::NoTime { path, line, cell } => {
                write!(f, "{}:{line}: `{cell}` is no time, or before that of the row above", path.display())
            }
        }
    }
}

impl std::error::Error for TableError {}

/// The trace of a run's folder, or the file itself; without a complete trace the `.partial` one is used.
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
    /// There is no trace, it cannot be read, a row does not fit the header, a cell is not a number, or time decreases.
    /// A last line without a line break, which a run that broke may leave, is not an error: it is dropped.
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
        if names.first().is_none_or(|name| name != "time") {
            return Err(TableError::Timeless(path));
        }
        let partial = path.extension().is_some_and(|extension| extension == "partial");
        let table = Self { names, rows, partial };
        table.check_numbers(&path)?;
        Ok(table)
    }

    fn check_numbers(&self, path: &Path) -> Result<(), TableError> {
        let mut last_s = f64::NEG_INFINITY;
        for (row, line) in self.rows.iter().zip(2..) {
            let place = |cell: &String| (path.to_owned(), line, cell.clone());
            if let Some(cell) = row.iter().find(|cell| !cell.is_empty() && cell.parse::<f64>().is_err()) {
                let (path, line, cell) = place(cell);
                return Err(TableError::NoNumber { path, line, cell });
            }
            match row[0].parse::<f64>() {
                Ok(time_s) if time_s.is_finite() && time_s >= last_s => last_s = time_s,
                _ => {
                    let (path, line, cell) = place(&row[0]);
                    return Err(TableError::NoTime { path, line, cell });
                }
            }
        }
        Ok(())
    }

    /// A column as numbers; an empty cell is NaN.
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
    fn a_partial_trace_is_used_and_its_incomplete_last_line_is_dropped() {
        let folder = folder_with("trace.csv.partial", "time,a\n0,1\n0.1");
        let table = Table::read(folder.path()).unwrap();
        assert_eq!((table.rows.len(), table.partial), (1, true));
    }

    proptest::proptest! {
        #[test]
        fn any_text_is_read_as_a_table_or_an_error(text in "(time)?[,\"\r\n0-9.a-z \\PC]{0,80}\n?") {
            let folder = folder_with("trace.csv", &text);
            if let Ok(table) = Table::read(folder.path()) {
                for column in 0..table.names.len() {
                    proptest::prop_assert_eq!(table.numbers(column).len(), table.rows.len());
                }
            }
            proptest::prop_assert_eq!(notes(folder.path()), []);
        }
    }

    #[test]
    fn a_row_that_does_not_fit_is_named_by_its_line() {
        let folder = folder_with("trace.csv", "time,a\n0,1\n0.1\n");
        let error = Table::read(folder.path()).unwrap_err().to_string();
        assert!(error.ends_with("trace.csv:3: not as many cells as the header"), "{error}");
    }

    #[test]
    fn a_file_that_is_not_a_trace_is_an_error_with_the_line() {
        for (text, words) in [
            ("", "trace.csv:1: the first column is not `time`"),
            ("a,time\n0,1\n", "trace.csv:1: the first column is not `time`"),
            ("time,a\n0,1\n0.1,x\n", "trace.csv:3: `x` is no number"),
            ("time,a\n1,1\n0,1\n", "trace.csv:3: `0` is no time, or before that of the row above"),
            ("time,a\n,1\n", "trace.csv:2: `` is no time, or before that of the row above"),
            ("time,a\ninf,1\n", "trace.csv:2: `inf` is no time, or before that of the row above"),
        ] {
            let folder = folder_with("trace.csv", text);
            let error = Table::read(folder.path()).unwrap_err().to_string();
            assert!(error.ends_with(words), "{error}");
        }
    }

    #[test]
    fn columns_are_described_by_the_signals_file_in_the_same_folder() {
        let folder =
            folder_with("signals.json", r#"[{"name": "a.b", "unit": "m", "type": "Real", "causality": "output"}]"#);
        let note = ColumnNote { name: "a.b".to_owned(), unit: Some("m".to_owned()), kind: "Real".to_owned() };
        let expected = [note];
        assert_eq!(notes(&folder.path().join("trace.csv")), expected);
        assert_eq!(notes(folder.path()), expected);
        assert_eq!(notes(Path::new("/no/such/run")), []);
    }
}
