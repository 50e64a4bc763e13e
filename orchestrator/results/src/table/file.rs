//! A file with a table: its names first, then its rows.

use super::TableError;
use super::cell::CellType;
use super::parquet::ParquetTable;
use super::sheet::{Sheet, Wrong};
use crate::run_folder::{PARTIAL, RUN_JSON, TRACE_CSV, TRACE_PARQUET};
use fmi2::printable;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// The name of a column as its file has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Heading {
    /// All of it.
    pub text: String,
    /// The byte at which it begins in a text.
    at: usize,
}

impl Heading {
    /// Name and unit of measure of `speed [m/s]`. What is in brackets may also be an index, or the name has brackets: a
    /// reader that knows the whole as a name does not ask.
    #[must_use]
    pub fn with_unit(&self) -> Option<(&str, &str)> {
        let (name, unit) = self.text.strip_suffix(']')?.rsplit_once(" [")?;
        let is_index = unit.chars().all(|letter| letter.is_ascii_digit() || ",: *".contains(letter)) && unit != "1";
        (!is_index && !name.trim().is_empty()).then(|| (name.trim(), unit.trim()))
    }
}

/// A file whose names are read, and whose rows are not.
pub struct TableFile {
    path: PathBuf,
    is_partial: bool,
    headings: Vec<Heading>,
    time_unit: String,
    /// The columns in which `true` or `false` was read.
    booleans: BTreeSet<usize>,
    content: Content,
}

enum Content {
    Text(Sheet),
    Parquet(ParquetTable),
}

/// For each column its values, row by row.
type Columns = Vec<Vec<Option<f64>>>;

impl TableFile {
    /// Opens the trace of a run's folder, or a file.
    ///
    /// # Errors
    /// There is no table, it cannot be read, its first column is not the time, or two columns have one name.
    pub fn open(run: &Path) -> Result<Self, TableError> {
        let path = trace_file(run)?;
        let bytes = fs::read(&path).map_err(|error| TableError::unreadable(&path, error))?;
        Self::of_bytes(&path, bytes)
    }

    /// A file with this content.
    ///
    /// # Errors
    /// As [`TableFile::open`].
    pub fn of_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, TableError> {
        let is_partial = path.extension() == Some(PARTIAL.trim_start_matches('.').as_ref());
        let (content, headings) = if bytes.starts_with(b"PAR1") {
            let file = File::open(path).map_err(|error| TableError::unreadable(path, error))?;
            let (table, names) = ParquetTable::open(file).map_err(|reason| TableError::unreadable(path, reason))?;
            (Content::Parquet(table), names.into_iter().map(|text| Heading { text, at: 0 }).collect())
        } else {
            text_content(path, bytes, is_partial)?
        };
        let mut file = Self {
            path: path.to_owned(),
            is_partial,
            headings,
            time_unit: "s".to_owned(),
            booleans: BTreeSet::new(),
            content,
        };
        file.check_headings()?;
        Ok(file)
    }

    fn check_headings(&mut self) -> Result<(), TableError> {
        let first = self.headings.first().cloned().unwrap_or(Heading { text: String::new(), at: 0 });
        let (name, unit) = first.with_unit().unwrap_or((&first.text, "s"));
        if !name.eq_ignore_ascii_case("time") {
            return Err(self.without_time(name));
        }
        if seconds(0.0, unit).is_none() {
            let help = "write `time [s]`, or ms, us, ns, min, h";
            return Err(self.wrong_heading(0, format!("`{unit}` is not a unit of time")).help(Some(help.to_owned())));
        }
        self.time_unit = unit.to_owned();
        let mut seen = BTreeSet::from(["time"]);
        for (index, heading) in self.headings.iter().enumerate().skip(1) {
            if heading.text.is_empty() {
                return Err(self.wrong_heading(index, format!("column {} has no name", index + 1)));
            }
            if !seen.insert(&heading.text) {
                return Err(self.wrong_heading(index, format!("`{}` has a column already", heading.text)));
            }
        }
        Ok(())
    }

    /// The error for a first column of this name.
    fn without_time(&self, name: &str) -> TableError {
        let message = match name {
            "" => "the first column has no name, and must be `time`".to_owned(),
            name => format!("the first column is `{name}`, and must be `time`"),
        };
        let in_comment = matches!(&self.content, Content::Text(sheet) if sheet.has_names_in_a_comment());
        let help = if in_comment {
            "a line that begins with # is a comment: write the names of the columns without it"
        } else {
            "name the column of the time `time`, or with a unit of time, for example `time [ms]`"
        };
        self.wrong_heading(0, message).help(Some(help.to_owned()))
    }

    /// The names of the columns, the time first.
    #[must_use]
    pub fn headings(&self) -> &[Heading] {
        &self.headings
    }

    /// Whether it is the trace of a run that did not come to its end.
    #[must_use]
    pub fn is_partial(&self) -> bool {
        self.is_partial
    }

    /// An error about the name of a column.
    #[must_use]
    pub fn wrong_heading(&self, index: usize, message: String) -> TableError {
        let at = self.headings.get(index).map_or(0, |heading| heading.at);
        self.wrong(Wrong::new(at, message))
    }

    fn wrong(&self, wrong: Wrong) -> TableError {
        match &self.content {
            Content::Text(sheet) => TableError::placed(&self.path, sheet, wrong),
            Content::Parquet(_) => {
                TableError::new(format!("{}: {}", printable::path(&self.path), wrong.message)).help(wrong.help)
            }
        }
    }

    /// Reads the rows: the time in seconds, then for each other column its values by its type. With `gaps` cells may be
    /// empty or not finite, as those of a trace.
    ///
    /// # Errors
    /// A row does not fit the names, a cell does not fit its column's type, or time decreases.
    pub fn read(&mut self, types: &[CellType], gaps: bool) -> Result<Columns, TableError> {
        let mut rows =
            Rows { headings: &self.headings, types, gaps, time_unit: &self.time_unit, booleans: BTreeSet::new() };
        let read = match &mut self.content {
            Content::Text(sheet) => rows.of_text(sheet),
            Content::Parquet(table) => rows.of_parquet(table),
        };
        self.booleans = std::mem::take(&mut rows.booleans);
        read.map_err(|wrong| self.wrong(wrong))
    }

    /// Whether a column that was read has words for truth, or a type of the file that is not Real.
    #[must_use]
    pub fn is_discrete(&self, index: usize) -> bool {
        match &self.content {
            Content::Text(_) => self.booleans.contains(&index),
            Content::Parquet(table) => table.is_discrete(index),
        }
    }
}

/// The text of a file, and the names in its first row.
fn text_content(path: &Path, bytes: Vec<u8>, is_partial: bool) -> Result<(Content, Vec<Heading>), TableError> {
    let mut sheet =
        Sheet::decode(bytes).map_err(|wrong| TableError::unreadable(path, wrong.message).help(wrong.help))?;
    if is_partial {
        sheet.drop_incomplete_line();
    }
    let row = sheet.row().map(|row| {
        let cells = row.unwrap_or_default().into_iter();
        cells.map(|cell| Heading { text: cell.text.into_owned(), at: cell.at }).collect::<Vec<_>>()
    });
    let mut headings = row.map_err(|wrong| TableError::placed(path, &sheet, wrong))?;
    // Spreadsheets end lines with separators of columns that are empty.
    headings.truncate(headings.iter().rposition(|heading| !heading.text.is_empty()).map_or(0, |last| last + 1));
    if headings.is_empty() {
        return Err(TableError::placed(path, &sheet, Wrong::new(0, "the file is empty")));
    }
    Ok((Content::Text(sheet), headings))
}

/// How rows are read.
struct Rows<'a> {
    headings: &'a [Heading],
    types: &'a [CellType],
    gaps: bool,
    time_unit: &'a str,
    /// The columns in which `true` or `false` was read.
    booleans: BTreeSet<usize>,
}

impl Rows<'_> {
    fn of_text(&mut self, sheet: &mut Sheet) -> Result<Columns, Wrong> {
        let mut columns = vec![Vec::new(); self.headings.len()];
        let mut last_s = f64::NEG_INFINITY;
        let separator = sheet.separator();
        while let Some(mut row) = sheet.row()? {
            while row.len() > columns.len() && row.last().is_some_and(|cell| cell.text.is_empty()) {
                row.pop();
            }
            if row.len() != columns.len() {
                let place = row.get(columns.len()).or(row.last()).map_or(0, |cell| cell.at);
                let message = format!("expected {} values as in the header, found {}", columns.len(), row.len());
                let wrong = Wrong::new(place, message);
                let commas = separator == ',' && row.len() > columns.len();
                return Err(if commas {
                    wrong.help("numbers are written with a point, not with a comma")
                } else {
                    wrong
                });
            }
            let time_s = self.time(&row[0].text, last_s).map_err(|message| Wrong::new(row[0].at, message))?;
            last_s = time_s;
            columns[0].push(Some(time_s));
            for (index, cell) in row.iter().enumerate().skip(1) {
                let value = self.value(index, &cell.text).map_err(|message| Wrong::new(cell.at, message))?;
                if value.is_some() && cell.text.trim().parse::<f64>().is_err() {
                    self.booleans.insert(index);
                }
                columns[index].push(value);
            }
        }
        Ok(columns)
    }

    fn of_parquet(&self, table: &ParquetTable) -> Result<Columns, Wrong> {
        let mut columns = Vec::new();
        for (index, heading) in self.headings.iter().enumerate() {
            let column = table.column(index);
            let values = column.map_err(|reason| Wrong::new(0, format!("column `{}`: {reason}", heading.text)))?;
            columns.push(values);
        }
        let mut last_s = f64::NEG_INFINITY;
        for row in 0..columns[0].len() {
            let in_row = |message| Wrong::new(0, format!("row {}: {message}", row + 1));
            let text = |value: Option<f64>| value.map(crate::shortest_decimal).unwrap_or_default();
            last_s = self.time(&text(columns[0][row]), last_s).map_err(in_row)?;
            columns[0][row] = Some(last_s);
            for (index, column) in columns.iter().enumerate().skip(1) {
                // A trace has what its columns take; only what drives a unit is checked.
                if !self.gaps {
                    self.value(index, &text(column[row])).map_err(in_row)?;
                }
            }
        }
        Ok(columns)
    }

    fn time(&self, text: &str, last_s: f64) -> Result<f64, String> {
        let number = CellType::Real.of_text(text, "time")?;
        let time_s = seconds(number, self.time_unit).filter(|time_s| time_s.is_finite());
        let time_s = time_s.ok_or_else(|| format!("`{text}` is not a time"))?;
        if time_s < last_s {
            let last = crate::shortest_decimal(last_s);
            return Err(format!("time {} comes after {last}; it must not fall", crate::shortest_decimal(time_s)));
        }
        Ok(time_s)
    }

    fn value(&self, index: usize, text: &str) -> Result<Option<f64>, String> {
        if self.gaps && text.is_empty() {
            return Ok(None);
        }
        let name = &self.headings[index].text;
        let value = self.types[index - 1].of_text(text, name)?;
        if self.gaps || value.is_finite() { Ok(Some(value)) } else { Err(format!("`{text}` is not a finite number")) }
    }
}

/// The seconds of a time in a unit, `s`, `ms`, `us`, `ns`, `min` or `h`; `None` if it is another unit.
#[must_use]
pub fn seconds(time: f64, unit: &str) -> Option<f64> {
    // Divided, not multiplied: 1 ms is the number nearest to 0.001.
    match unit {
        "s" => Some(time),
        "ms" => Some(time / 1e3),
        "us" | "\u{b5}s" | "\u{3bc}s" => Some(time / 1e6),
        "ns" => Some(time / 1e9),
        "min" => Some(time * 60.0),
        "h" => Some(time * 3600.0),
        _ => None,
    }
}

/// The trace of a run's folder, or the file itself; without a complete trace the `.partial` one is used.
fn trace_file(run: &Path) -> Result<PathBuf, TableError> {
    let inside = [TRACE_CSV.to_owned(), TRACE_PARQUET.to_owned(), format!("{TRACE_CSV}{PARTIAL}")];
    let found = if run.is_dir() {
        inside.iter().map(|name| run.join(name)).find(|path| path.is_file())
    } else {
        run.exists().then(|| run.to_owned())
    };
    found.ok_or_else(|| without_trace(run))
}

fn without_trace(run: &Path) -> TableError {
    let name = printable::path(run);
    if run.join(format!("{TRACE_PARQUET}{PARTIAL}")).is_file() {
        let help = "without --format such a run keeps its rows in trace.csv too";
        return TableError::new(format!(
            "the run of {name} did not come to its end, and its trace.parquet is incomplete"
        ))
        .help(Some(help.to_owned()));
    }
    if run.join(RUN_JSON).is_file() {
        return TableError::new(format!("the run of {name} recorded nothing"));
    }
    TableError::new(format!("{name} is neither a run's folder nor a trace.csv"))
}
