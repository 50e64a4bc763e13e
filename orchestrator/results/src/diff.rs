//! Compares two traces by time: the first tick, instance and port that differ, by how much, and what only one of them has.

mod pairs;

use crate::shortest_decimal;
use crate::table::{Column, Table};
pub use pairs::OnlyRows;
use pairs::Pairs;
use std::fmt::Write;

/// How far apart two values of a column may be to count as equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Not at all: the same bits.
    Exact,
    /// This much, in the unit of measure of the column.
    Absolute(f64),
    /// This part of the larger magnitude.
    Relative(f64),
}

/// The differences of two traces.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// Columns of the one that the other lacks.
    pub only_columns: [Vec<String>; 2],
    /// Rows of the one at whose times the other has none.
    pub only_rows: [Option<OnlyRows>; 2],
    /// Columns that have another unit of measure in the other trace, with both; their values are not compared.
    pub units: Vec<(String, [String; 2])>,
    /// How many rows are compared, with the times of the first and the last.
    pub common: Option<(usize, [f64; 2])>,
    /// The first row in which a common column differs.
    pub first: Option<Cell>,
    /// Columns that differ anywhere, in the first trace's order.
    pub columns: Vec<ColumnDifference>,
    /// Where values that count as equal are furthest apart, if any are apart.
    pub within: Option<Apart>,
}

/// Two values that should be equal.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The row of the one and of the other, from 0.
    pub rows: [usize; 2],
    /// The time of the row.
    pub time_s: f64,
    /// The column.
    pub name: String,
    /// Its unit of measure.
    pub unit: Option<String>,
    /// The value in the one and in the other; `None` for an empty cell.
    pub values: [Option<f64>; 2],
}

/// How much a column differs.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnDifference {
    /// In how many rows.
    pub rows: usize,
    /// The column, with the largest distance; NaN if a value is no number.
    pub largest: Apart,
}

/// A distance between values of a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Apart {
    /// The column.
    pub name: String,
    /// Its unit of measure.
    pub unit: Option<String>,
    /// The distance in it.
    pub distance: f64,
}

impl Difference {
    /// Compares columns of equal name in rows of equal time; `limit` says how far apart values of a column may be.
    #[must_use]
    pub fn between(tables: [&Table; 2], limit: impl Fn(&Column) -> Limit) -> Self {
        let [first, second] = tables;
        let missing = |a: &Table, b: &Table| -> Vec<String> {
            a.names().filter(|name| b.column(name).is_none()).map(str::to_owned).collect()
        };
        let pairs = Pairs::of(&first.time_s(), &second.time_s());
        let mut difference = Self {
            only_columns: [missing(first, second), missing(second, first)],
            only_rows: pairs.only.clone(),
            common: pairs.common(),
            ..Self::default()
        };
        for mine in first.columns.iter().skip(1) {
            let Some(other) = second.column(&mine.name) else { continue };
            match (&mine.unit, &other.unit) {
                (Some(a), Some(b)) if a != b => {
                    difference.units.push((mine.name.clone(), [a.clone(), b.clone()]));
                }
                _ => difference.compare_column(&pairs, mine, other, limit(mine)),
            }
        }
        difference
    }

    fn compare_column(&mut self, pairs: &Pairs, mine: &Column, other: &Column, limit: Limit) {
        let limit = if mine.is_discrete { Limit::Exact } else { limit };
        let unit = mine.unit.as_ref().or(other.unit.as_ref()).filter(|unit| *unit != "1").cloned();
        let apart = |distance| Apart { name: mine.name.clone(), unit: unit.clone(), distance };
        let (mut rows, mut largest, mut within) = (0, 0.0, 0.0);
        for &(time_s, [a, b]) in &pairs.both {
            let values = [mine.values[a], other.values[b]];
            let distance = distance(values);
            if is_equal(values, limit) {
                within = if distance.is_nan() { within } else { distance.max(within) };
                continue;
            }
            rows += 1;
            largest = nan_or_larger(largest, distance);
            if rows == 1 && self.first.as_ref().is_none_or(|cell| a < cell.rows[0]) {
                let (name, unit) = (mine.name.clone(), unit.clone());
                self.first = Some(Cell { rows: [a, b], time_s, name, unit, values });
            }
        }
        if rows > 0 {
            self.columns.push(ColumnDifference { rows, largest: apart(largest) });
        }
        if within > self.within.as_ref().map_or(0.0, |within| within.distance) {
            self.within = Some(apart(within));
        }
    }

    /// Whether the traces are equal where they overlap. One of them may begin later, as that of a run that continues.
    #[must_use]
    pub fn is_none(&self) -> bool {
        let begins_later = match &self.only_rows {
            [None, None] => true,
            [Some(only), None] | [None, Some(only)] => only.before_the_other && self.common.is_some(),
            [Some(_), Some(_)] => false,
        };
        let columns = self.only_columns.iter().all(Vec::is_empty) && self.units.is_empty();
        columns && begins_later && self.first.is_none()
    }

    /// The report as text; `names` are the names of the two traces, `tolerance` is what the user allowed.
    #[must_use]
    pub fn report(&self, names: [&str; 2], tolerance: &str) -> String {
        let mut text = if self.is_none() { self.equal(tolerance) } else { self.cells() };
        // Writing into a String cannot fail.
        for (name, [a, b]) in &self.units {
            let _ = writeln!(text, "{name} is in {a} in {}, and in {b} in {}", names[0], names[1]);
        }
        for (columns, name) in self.only_columns.iter().zip(names) {
            if !columns.is_empty() {
                let _ = writeln!(text, "only in {name}: {}", columns.join(", "));
            }
        }
        for (only, name) in self.only_rows.iter().zip(names) {
            if let Some(only) = only {
                let _ = writeln!(text, "only in {name}: {only}");
            }
        }
        if self.common.is_none() && self.only_rows.iter().any(Option::is_some) {
            text.push_str("they have no time in common\n");
        }
        text
    }

    fn equal(&self, tolerance: &str) -> String {
        let (rows, [from_s, to_s]) = self.common.unwrap_or_default();
        let overlap = self.only_rows.iter().any(Option::is_some);
        let how = match (&self.within, overlap) {
            (None, false) => "identical".to_owned(),
            (None, true) => "equal where they overlap".to_owned(),
            (Some(_), false) => format!("equal within {tolerance}"),
            (Some(_), true) => format!("equal within {tolerance} where they overlap"),
        };
        let span = if overlap {
            format!(" from {} s to {} s", shortest_decimal(from_s), shortest_decimal(to_s))
        } else {
            String::new()
        };
        let rows = pairs::rows(rows);
        match &self.within {
            None => format!("{how}: {rows}{span}, every cell\n"),
            Some(apart) => format!("{how}: {rows}{span}, at most {} in {}\n", apart.shown(), apart.name),
        }
    }

    fn cells(&self) -> String {
        let mut text = String::new();
        // Writing into a String cannot fail.
        if let Some(cell) = &self.first {
            let rows = match cell.rows {
                [a, b] if a == b => format!("row {a}"),
                [a, b] => format!("rows {a} and {b}"),
            };
            let time = shortest_decimal(cell.time_s);
            let _ = writeln!(text, "first difference at {time} s ({rows}) in {}: {}", cell.name, cell.shown());
        }
        for ColumnDifference { rows, largest } in self.columns.iter().take(10) {
            let _ = writeln!(text, "  {}: {}, at most {}", largest.name, pairs::rows(*rows), largest.shown());
        }
        if self.columns.len() > 10 {
            let _ = writeln!(text, "  and {} more columns", self.columns.len() - 10);
        }
        text
    }
}

impl Cell {
    /// Both values, and how far they are apart.
    fn shown(&self) -> String {
        let unit = self.unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
        let value =
            |value: Option<f64>| value.map_or("an empty cell".to_owned(), |value| shortest_decimal(value) + &unit);
        let [a, b] = self.values;
        let both = format!("{} and {}", value(a), value(b));
        let distance = distance(self.values);
        if distance.is_nan() { both } else { format!("{both}, {distance:.3e}{unit} apart") }
    }
}

impl Apart {
    fn shown(&self) -> String {
        let unit = self.unit.as_ref().map(|unit| format!(" {unit}")).unwrap_or_default();
        if self.distance.is_nan() {
            "one is no number".to_owned()
        } else {
            format!("{:.3e}{unit} apart", self.distance)
        }
    }
}

fn is_equal(values: [Option<f64>; 2], limit: Limit) -> bool {
    let [Some(a), Some(b)] = values else { return values == [None, None] };
    let distance = (a - b).abs();
    let is_near = match limit {
        Limit::Exact => false,
        Limit::Absolute(limit) => distance <= limit,
        Limit::Relative(part) => distance <= part * a.abs().max(b.abs()),
    };
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()) || (is_near && distance.is_finite())
}

fn distance([a, b]: [Option<f64>; 2]) -> f64 {
    a.zip(b).map_or(f64::NAN, |(a, b)| (a - b).abs())
}

fn nan_or_larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

#[cfg(test)]
mod tests;
