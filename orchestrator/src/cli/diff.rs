//! `lockstep diff`: whether two runs are the same, and where they part.

use fmi2::printable;
use fmi2::units::parse;
use results::diff::{Difference, Limit};
use results::report;
use results::shortest_decimal;
use results::table::{Column, Table};
use std::path::PathBuf;

/// Compares two runs: the first tick, instance and port that differ, and by how much.
///
/// Rows are compared at equal times. A run that begins later, as one that continues with --from, is the same if it is equal
/// from there on. Exit code 0: the same; 1: different; 2: one of them cannot be read.
#[derive(Debug, clap::Args)]
pub struct Diff {
    /// The folder of a run, or a table over time: CSV or Parquet
    a: PathBuf,
    /// Another one
    b: PathBuf,
    /// How far apart Reals may be: 1mm for all columns that are lengths, 1e-6 or 1% of each value; may be given several times,
    /// then that with a unit of measure counts where it fits
    #[arg(long, value_parser = tolerance)]
    tolerance: Vec<Tolerance>,
}

/// A distance that does not count.
#[derive(Clone, Debug, PartialEq)]
struct Tolerance {
    value: f64,
    /// The unit of measure; `None` for a part of each value.
    unit: Option<String>,
}

impl Diff {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        let tables = match (Table::read(&self.a), Table::read(&self.b)) {
            (Ok(a), Ok(b)) => [a, b],
            (Err(error), _) | (_, Err(error)) => {
                report::error(&error, error.help.as_deref());
                return 2;
            }
        };
        let names = [&self.a, &self.b].map(printable::path);
        for (table, name) in tables.iter().zip(&names).filter(|(table, _)| table.partial) {
            let rows = table.time_s().len();
            report::status(&format!("note: {name} did not come to its end: {rows} rows are compared"));
        }
        if let Some(useless) = self.tolerance.iter().find(|tolerance| !tolerance.fits_any(&tables)) {
            let message = format!("--tolerance {}: no column is in such a unit of measure", useless.shown());
            let help = "a number without a unit, such as 1e-6, is a part of each value, for all columns";
            report::error(&message, Some(help));
            return 2;
        }
        let [a, b] = &tables;
        let difference = Difference::between([a, b], |column| self.limit(column));
        let tolerances: Vec<_> = self.tolerance.iter().map(Tolerance::shown).collect();
        report::result(&difference.report([&names[0], &names[1]], &tolerances.join(" or ")));
        u8::from(!difference.is_none())
    }

    fn limit(&self, column: &Column) -> Limit {
        let absolute = self.tolerance.iter().find_map(|tolerance| tolerance.in_unit_of(column)).map(Limit::Absolute);
        let relative = self.tolerance.iter().find(|tolerance| tolerance.unit.is_none());
        absolute.or(relative.map(|tolerance| Limit::Relative(tolerance.value))).unwrap_or(Limit::Exact)
    }
}

impl Tolerance {
    /// Its value in the unit of measure of a column; `None` if it is none for this column.
    fn in_unit_of(&self, column: &Column) -> Option<f64> {
        let (unit, of_column) = (self.unit.as_deref()?, column.unit.as_deref()?);
        if unit == of_column {
            return Some(self.value);
        }
        let (from, to) = (parse(unit).ok()?, parse(of_column).ok()?);
        // A distance has no offset.
        Some(from.conversion_to(&to)?.factor * self.value)
    }

    fn fits_any(&self, tables: &[Table]) -> bool {
        let mut columns = tables.iter().flat_map(|table| table.columns.iter().skip(1));
        self.unit.is_none() || columns.any(|column| self.in_unit_of(column).is_some())
    }

    fn shown(&self) -> String {
        match &self.unit {
            Some(unit) => format!("{} {unit}", shortest_decimal(self.value)),
            None => format!("{} of each value", shortest_decimal(self.value)),
        }
    }
}

/// A tolerance of the command line: `1mm`, `0.5 deg`, `1e-6`, `1%`.
fn tolerance(text: &str) -> Result<Tolerance, String> {
    let expected = || "expected a distance such as 1mm, or a part of each value such as 1e-6".to_owned();
    let (value, unit) = super::number_and_unit(text).ok_or_else(expected)?;
    if !value.is_finite() || value < 0.0 {
        return Err(expected());
    }
    let unit = unit.trim_matches('\'');
    Ok(match unit {
        "" => Tolerance { value, unit: None },
        "%" => Tolerance { value: value / 100.0, unit: None },
        unit => Tolerance { value, unit: Some(unit.to_owned()) },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_is_a_distance_with_a_unit_or_a_part_of_each_value() {
        let read = |text| tolerance(text).map(|Tolerance { value, unit }| (value, unit.unwrap_or_default()));
        for (text, value, unit) in
            [("1mm", 1.0, "mm"), ("0.5 deg", 0.5, "deg"), ("1e-6", 1e-6, ""), ("1%", 0.01, ""), ("2 'N.m'", 2.0, "N.m")]
        {
            assert_eq!(read(text), Ok((value, unit.to_owned())), "{text}");
        }
        for text in ["", "mm", "-1mm", "nan", "inf m"] {
            assert!(read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_tolerance_counts_in_the_unit_of_measure_of_a_column() {
        let column = |unit: &str| Column { unit: Some(unit.to_owned()), ..Column::default() };
        let diff = |texts: &[&str]| Diff {
            a: PathBuf::new(),
            b: PathBuf::new(),
            tolerance: texts.iter().map(|text| tolerance(text).unwrap()).collect(),
        };
        assert_eq!(diff(&["1mm"]).limit(&column("m")), Limit::Absolute(0.001));
        assert_eq!(diff(&["1mm"]).limit(&column("rad")), Limit::Exact);
        assert_eq!(diff(&["1degC"]).limit(&column("K")), Limit::Absolute(1.0));
        assert_eq!(diff(&["3 furlong"]).limit(&column("furlong")), Limit::Absolute(3.0));
        let both = diff(&["1e-6", "1mm"]);
        assert_eq!(
            (both.limit(&column("m")), both.limit(&column("rad"))),
            (Limit::Absolute(0.001), Limit::Relative(1e-6))
        );
        assert_eq!(both.limit(&Column::default()), Limit::Relative(1e-6));
    }
}
