//! Plots of a run: paths in space and signals over time, as one SVG.

mod paths;
mod scale;
mod series;
pub(crate) mod svg;

use crate::table::Table;
use paths::{Mark, Path};
use series::{Curve, Panel};
use std::fmt;
use svg::Picture;

const WIDTH: f64 = 960.0;
/// Without a choice of signals a picture has at most this many panels.
const DEFAULT_PANELS: usize = 4;

/// What to draw.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Names of columns or groups; a position group becomes a path, anything else a panel, several names with commas
    /// between them one panel for each unit. Empty: all paths and the first few groups.
    pub signals: Vec<String>,
    /// An Integer or Boolean column at whose changes the first path is marked with letters.
    pub mark: Option<String>,
}

/// Why a trace cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlotError {
    /// No column or group has this name.
    Unknown(String),
    /// The trace has no rows or no columns.
    Empty,
}

impl fmt::Display for PlotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => write!(f, "no column or group `{name}` was recorded"),
            Self::Empty => f.write_str("nothing was recorded"),
        }
    }
}

impl std::error::Error for PlotError {}

/// Draws a trace.
///
/// # Errors
/// A name of the selection was not recorded, or the trace is empty.
pub fn draw(title: &str, table: &Table, selection: &Selection) -> Result<String, PlotError> {
    let trace = Trace { table };
    let time_s = table.time_s();
    if time_s.is_empty() || table.columns.len() < 2 {
        return Err(PlotError::Empty);
    }
    let (paths, panels) =
        if selection.signals.is_empty() { trace.default_choice() } else { trace.chosen(&selection.signals)? };
    let marks = selection.mark.as_deref().map(|name| trace.marks(name)).transpose()?.unwrap_or_default();
    let mut picture = Picture::default();
    let mut top = 8.0;
    if !paths.is_empty() {
        paths::draw(&mut picture, &paths, &marks, top, WIDTH);
        top += paths::HEIGHT;
    }
    for panel in &panels {
        series::draw(&mut picture, panel, &time_s, top, WIDTH);
        top += series::HEIGHT;
    }
    Ok(picture.finish(title, WIDTH, top + 8.0))
}

struct Trace<'a> {
    table: &'a Table,
}

impl Trace<'_> {
    fn unit(&self, name: &str) -> &str {
        let column = self.table.column(name);
        column.and_then(|column| column.unit.as_deref()).filter(|unit| *unit != "1").unwrap_or_default()
    }

    fn column(&self, name: &str) -> Option<Vec<f64>> {
        Some(self.table.column(name)?.numbers())
    }

    /// The columns that a name selects: the column itself, or all columns of a group or array.
    fn members(&self, name: &str) -> Vec<&str> {
        let below =
            |other: &str| other.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']));
        self.table.names().filter(|other| below(other)).collect()
    }

    /// A group of x, y, z in metres.
    fn path(&self, group: &str) -> Option<Path> {
        let [x, y, z] = ["x", "y", "z"].map(|axis| format!("{group}.{axis}"));
        let in_metres = [&x, &y, &z].iter().all(|name| self.unit(name) == "m");
        let (x, y, z) = (self.column(&x)?, self.column(&y)?, self.column(&z)?);
        let points_m = x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect();
        in_metres.then(|| Path { name: group.to_owned(), points_m })
    }

    fn panel(&self, names: &[&str]) -> Panel {
        let unit = names.first().map(|name| self.unit(name)).unwrap_or_default();
        let (shown_unit, factor) = display_unit(unit);
        let curve = |name: &&str| Curve {
            name: (*name).to_owned(),
            values: self.column(name).unwrap_or_default().into_iter().map(|value| value * factor).collect(),
        };
        Panel { unit: shown_unit.to_owned(), curves: names.iter().map(curve).collect() }
    }

    fn chosen(&self, signals: &[String]) -> Result<(Vec<Path>, Vec<Panel>), PlotError> {
        let (mut paths, mut panels) = (Vec::new(), Vec::new());
        for names in signals {
            let mut curves = Vec::new();
            for name in names.split(',') {
                match (self.path(name), self.members(name)) {
                    (Some(path), _) => paths.push(path),
                    (None, members) if members.is_empty() => return Err(PlotError::Unknown(name.to_owned())),
                    (None, members) => curves.extend(members),
                }
            }
            panels.extend(curves.chunk_by(|a, b| self.unit(a) == self.unit(b)).map(|same| self.panel(same)));
        }
        Ok((paths, panels))
    }

    /// All position groups; then the first groups of columns that are no positions, angles of attitude first.
    fn default_choice(&self) -> (Vec<Path>, Vec<Panel>) {
        let groups = self.table.names().filter_map(|name| name.strip_suffix(".x")).filter(|g| g.ends_with("position"));
        let mut paths: Vec<_> = groups.filter_map(|group| self.path(group)).collect();
        // Actual positions come before setpoints.
        paths.sort_by_key(|path| path.name.contains("setpoint"));
        let mut panels: Vec<Vec<&str>> = Vec::new();
        for name in self.table.names().skip(1) {
            let in_path =
                paths.iter().any(|path| name.strip_prefix(&path.name).is_some_and(|rest| rest.starts_with('.')));
            let same =
                |group: &&mut Vec<&str>| group_of(group[0]) == group_of(name) && self.unit(group[0]) == self.unit(name);
            if in_path {
                continue;
            }
            match panels.iter_mut().find(same) {
                Some(group) => group.push(name),
                None => panels.push(vec![name]),
            }
        }
        let panels = panels.iter().take(DEFAULT_PANELS).map(|names| self.panel(names)).collect();
        (paths, panels)
    }

    /// The first row, the rows at which a column changes, and the last row, lettered from A.
    fn marks(&self, name: &str) -> Result<Vec<Mark>, PlotError> {
        let values = self.column(name).ok_or_else(|| PlotError::Unknown(name.to_owned()))?;
        let mut indices = vec![0];
        indices.extend((1..values.len()).filter(|&index| values[index].to_bits() != values[index - 1].to_bits()));
        indices.push(values.len() - 1);
        let letters = ('A'..='Z').map(String::from);
        Ok(indices.into_iter().zip(letters).map(|(index, text)| Mark { index, text }).collect())
    }
}

/// Everything before the last dot or index: columns of one group share a panel.
fn group_of(name: &str) -> &str {
    let end = name.rfind(['.', '[']).unwrap_or(name.len());
    &name[..end]
}

/// Angles are drawn in degrees.
fn display_unit(unit: &str) -> (&str, f64) {
    let degrees = 180.0 / std::f64::consts::PI;
    match unit {
        "rad" => ("deg", degrees),
        other => (other, 1.0),
    }
}

#[cfg(test)]
mod tests;
