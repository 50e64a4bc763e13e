//! Compares two traces: the first tick, instance and port that differ, and by how much.

use crate::table::Table;
use std::fmt::Write;

/// The differences of two traces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// Columns of the first that the second lacks.
    pub only_in_first: Vec<String>,
    /// Columns of the second that the first lacks.
    pub only_in_second: Vec<String>,
    /// Rows of the first and of the second.
    pub rows: (usize, usize),
    /// The first row in which a common column differs.
    pub first: Option<Cell>,
    /// Columns that differ anywhere, in the first trace's order.
    pub columns: Vec<ColumnDifference>,
}

/// Two values that should be equal.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The row, from 0, which is the tick if every tick was recorded.
    pub row: usize,
    /// The `time` cell of the row.
    pub time: String,
    /// The column.
    pub name: String,
    /// The value in the first and in the second.
    pub values: (String, String),
}

/// How much a column differs.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnDifference {
    /// The column.
    pub name: String,
    /// In how many rows.
    pub rows: usize,
    /// The largest distance; NaN if a value is no number.
    pub largest: f64,
}

impl Difference {
    /// Compares by columns of equal name; cells are equal when their text is.
    #[must_use]
    pub fn between(first: &Table, second: &Table) -> Self {
        let missing = |a: &Table, b: &Table| a.names.iter().filter(|name| !b.names.contains(name)).cloned().collect();
        let place = |name: &String| second.names.iter().position(|other| other == name);
        let common: Vec<_> = first.names.iter().enumerate().filter_map(|(i, name)| Some((i, place(name)?))).collect();
        let mut difference = Self {
            only_in_first: missing(first, second),
            only_in_second: missing(second, first),
            rows: (first.rows.len(), second.rows.len()),
            ..Self::default()
        };
        for &(mine, other) in &common {
            difference.compare_column(first, second, mine, other);
        }
        difference
    }

    fn compare_column(&mut self, first: &Table, second: &Table, mine: usize, other: usize) {
        let pairs = first.rows.iter().zip(&second.rows).map(|(a, b)| (&a[mine], &b[other])).enumerate();
        let different: Vec<_> = pairs.filter(|(_, (a, b))| a != b).collect();
        let Some(&(row, (a, b))) = different.first() else { return };
        let name = first.names[mine].clone();
        if self.first.as_ref().is_none_or(|cell| row < cell.row) {
            let time = first.names.iter().position(|name| name == "time").map(|time| first.rows[row][time].clone());
            let time = time.unwrap_or_default();
            self.first = Some(Cell { row, time, name: name.clone(), values: (a.clone(), b.clone()) });
        }
        let largest = different.iter().map(|(_, (a, b))| distance(a, b)).fold(0.0, nan_or_larger);
        self.columns.push(ColumnDifference { name, rows: different.len(), largest });
    }

    /// Whether the traces are equal.
    #[must_use]
    pub fn is_none(&self) -> bool {
        let columns = self.only_in_first.is_empty() && self.only_in_second.is_empty();
        columns && self.rows.0 == self.rows.1 && self.first.is_none()
    }

    /// The report as text; `names` are the names of the two traces.
    #[must_use]
    pub fn report(&self, names: (&str, &str)) -> String {
        if self.is_none() {
            return format!("identical: {} rows, every cell\n", self.rows.0);
        }
        let mut text = String::new();
        // Writing into a String cannot fail.
        if let Some(cell) = &self.first {
            let (a, b) = &cell.values;
            let apart = by_how_much(a, b);
            let _ = writeln!(
                text,
                "first difference at {} s (row {}) in {}: {a} and {b}{apart}",
                cell.time, cell.row, cell.name
            );
        }
        for column in self.columns.iter().take(10) {
            let _ = writeln!(text, "  {}: {} rows, at most {} apart", column.name, column.rows, shown(column.largest));
        }
        if self.columns.len() > 10 {
            let _ = writeln!(text, "  and {} more columns", self.columns.len() - 10);
        }
        for (list, name) in [(&self.only_in_first, names.0), (&self.only_in_second, names.1)] {
            if !list.is_empty() {
                let _ = writeln!(text, "only in {name}: {}", list.join(", "));
            }
        }
        if self.rows.0 != self.rows.1 {
            let _ = writeln!(text, "{} has {} rows, {} has {}", names.0, self.rows.0, names.1, self.rows.1);
        }
        text
    }
}

fn distance(a: &str, b: &str) -> f64 {
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs(),
        _ => f64::NAN,
    }
}

fn nan_or_larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

fn shown(distance: f64) -> String {
    format!("{distance:.3e}")
}

fn by_how_much(a: &str, b: &str) -> String {
    let apart = distance(a, b);
    if apart.is_nan() { String::new() } else { format!(", {} apart", shown(apart)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(header: &str, rows: &[&str]) -> Table {
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        Table { names: cells(header), rows: rows.iter().map(|row| cells(row)).collect(), partial: false }
    }

    #[test]
    fn equal_traces_have_no_difference() {
        let a = table("time,q.x", &["0,1", "0.1,2"]);
        let difference = Difference::between(&a, &a);
        assert!(difference.is_none());
        assert_eq!(difference.report(("a", "b")), "identical: 2 rows, every cell\n");
    }

    #[test]
    fn the_earliest_row_counts_then_the_order_of_columns() {
        let a = table("time,q.x,q.y,q.z", &["0,1,1,1", "0.1,2,2,2", "0.2,3,3,3"]);
        let b = table("time,q.x,q.y,q.z", &["0,1,1,1", "0.1,2,2.5,7", "0.2,4,3,3"]);
        let difference = Difference::between(&a, &b);
        assert_eq!(
            difference.report(("a", "b")),
            "first difference at 0.1 s (row 1) in q.y: 2 and 2.5, 5.000e-1 apart\n  \
             q.x: 1 rows, at most 1.000e0 apart\n  q.y: 1 rows, at most 5.000e-1 apart\n  \
             q.z: 1 rows, at most 5.000e0 apart\n"
        );
    }

    #[test]
    fn missing_columns_and_rows_are_reported() {
        let a = table("time,q.x", &["0,1", "0.1,2"]);
        let b = table("time,q.y", &["0,1"]);
        let report = Difference::between(&a, &b).report(("a", "b"));
        assert_eq!(report, "only in a: q.x\nonly in b: q.y\na has 2 rows, b has 1\n");
    }
}
