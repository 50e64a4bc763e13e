//! The columns of a run by name: single columns, groups, paths.

use super::run::Run;
use crate::table::Column;

/// What kind of values a column has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Real,
    Integer,
    Boolean,
    Enumeration,
}

/// What is farther away is no place on any map.
const FARTHEST_M: f64 = 1e15;

/// The samples of one curve: times in seconds and values, in order, without gaps.
pub(super) type Samples = Vec<(f64, f64)>;

impl Run {
    pub(super) fn kind(&self, name: &str) -> Kind {
        match self.table.column(name) {
            Some(column) if column.kind == "Boolean" => Kind::Boolean,
            Some(column) if column.kind == "Enumeration" && !column.items.is_empty() => Kind::Enumeration,
            Some(column) if column.is_discrete => Kind::Integer,
            _ => Kind::Real,
        }
    }

    /// The unit of measure; empty for plain numbers.
    pub(super) fn unit(&self, name: &str) -> &str {
        let column = self.table.column(name);
        column.and_then(|column| column.unit.as_deref()).filter(|unit| *unit != "1").unwrap_or_default()
    }

    /// The samples of a column, where it has any.
    pub(super) fn samples(&self, name: &str) -> Samples {
        let Some(column) = self.table.column(name) else { return Vec::new() };
        let samples = self.table.time_s().into_iter().zip(&column.values);
        samples.filter_map(|(time_s, value)| Some((time_s, (*value)?))).filter(|(_, value)| !value.is_nan()).collect()
    }

    /// The columns that a name selects: the column itself, or all columns of a group or array.
    pub(super) fn members(&self, name: &str) -> Vec<&str> {
        let below =
            |other: &str| other.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
        self.table.names().skip(1).filter(|other| below(other)).collect()
    }

    /// The last value of a column.
    pub(super) fn last(&self, name: &str) -> Option<f64> {
        last(self.table.column(name)?)
    }

    /// The first value of a column.
    pub(super) fn first(&self, name: &str) -> Option<f64> {
        self.table.column(name)?.values.iter().flatten().copied().find(|value| value.is_finite())
    }

    /// Whether a column has two values that differ.
    pub(super) fn changes(&self, name: &str) -> bool {
        let Some(column) = self.table.column(name) else { return false };
        let mut values = column.values.iter().flatten();
        let first = values.next();
        values.any(|value| Some(value) != first)
    }

    /// The points of a group of x, y and z in metres, also of x and y alone; rows without a sample are left out.
    pub(super) fn path(&self, group: &str) -> Option<Vec<(f64, [f64; 3])>> {
        let axis = |axis: &str| {
            let name = format!("{group}.{axis}");
            self.table.column(&name).filter(|_| self.unit(&name) == "m")
        };
        let (x, y, z) = (axis("x")?, axis("y")?, axis("z"));
        if z.is_none() && self.table.column(&format!("{group}.z")).is_some() {
            return None;
        }
        let rows = self.table.time_s().into_iter().enumerate().filter_map(|(row, time_s)| {
            let at = |column: &Column| column.values.get(row).copied().flatten().filter(is_place);
            Some((time_s, [at(x)?, at(y)?, z.map_or(Some(0.0), at)?]))
        });
        Some(rows.collect())
    }
}

/// Whether a coordinate in metres is on any map.
pub(super) fn is_place(coordinate: &f64) -> bool {
    coordinate.abs() <= FARTHEST_M
}

fn last(column: &Column) -> Option<f64> {
    column.values.iter().rev().flatten().copied().find(|value| value.is_finite())
}

/// Everything before the last dot or index: columns of one group share a panel.
pub(super) fn group_of(name: &str) -> &str {
    let end = name.rfind(['.', '[']).unwrap_or(name.len());
    &name[..end]
}

/// The name without what stands in brackets: the same signal of several vehicles shares a panel.
pub(super) fn without_indices(name: &str) -> String {
    let mut inside = false;
    let keep = |letter: &char| {
        let kept = !inside && *letter != '[';
        inside = *letter == '[' || inside && *letter != ']';
        kept
    };
    name.chars().filter(keep).collect()
}

/// Angles are drawn in degrees.
pub(super) fn display_unit(unit: &str) -> (&str, f64) {
    let degrees = 180.0 / std::f64::consts::PI;
    match unit {
        "rad" => ("deg", degrees),
        "rad/s" => ("deg/s", degrees),
        other => (other, 1.0),
    }
}
