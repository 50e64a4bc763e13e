//! Plots of runs: paths in space and signals over time, as one SVG or PNG.
//!
//! A picture has a title, a view of the paths, and panels over one time axis. Nothing in it is about one unit: what is
//! drawn is chosen by names, types and units of measure of columns.

mod bands;
mod choice;
mod claimed;
mod font;
mod labels;
mod layout;
mod mesh;
mod overlay;
mod panel;
mod paths;
mod places;
mod png;
mod raster;
mod run;
mod scale;
pub(crate) mod svg;
mod trace;
mod view;

pub use run::Run;

use choice::Choice;
use fmi2::printable;
use std::fmt;
use std::path::PathBuf;
use svg::Picture;

/// The width of a picture in pixels where none is asked for.
pub const WIDTH: f64 = 960.0;
/// A narrower picture has no room for axes.
pub const LEAST_WIDTH: f64 = 320.0;

/// And a wider one is no picture for a screen.
pub const MOST_WIDTH: f64 = 20_000.0;

/// What to draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Names of columns, groups or claims; a position group becomes a path, anything else a panel, several names with
    /// commas between them one panel for each unit. Empty: all paths, what the claims are about, and the first few groups.
    pub signals: Vec<String>,
    /// An Integer, Boolean or Enumeration column at whose changes the first path is marked with letters.
    pub mark: Option<String>,
    /// Discrete columns that are drawn as coloured bands over all panels.
    pub modes: Vec<String>,
    /// Groups of circles: positions with a radius.
    pub circles: Vec<String>,
    /// Groups of points: positions.
    pub points: Vec<String>,
    /// Cells over the ground.
    pub rasters: Vec<Raster>,
    /// A surface of triangles: a file, or a group of points and triangles.
    pub meshes: Vec<Mesh>,
    /// The first second that is drawn.
    pub from_s: Option<f64>,
    /// The last second that is drawn.
    pub to_s: Option<f64>,
    /// From where the paths are seen.
    pub view: ViewFrom,
    /// The width in pixels; `None` is [`WIDTH`].
    pub width: Option<f64>,
}

/// From where paths are seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ViewFrom {
    /// From above where all is in one plane, else oblique.
    #[default]
    Fitting,
    /// From above: x to the right, y upwards.
    Above,
    /// From the side and above: x to the lower right, y to the upper right, z upwards.
    Oblique,
}

/// Cells over the ground, and what its ports do not tell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Raster {
    /// An array: Booleans, reals, or Integers of 32 cells each, the least bit first.
    pub group: String,
    /// The number of cells from left to right.
    pub columns: Option<usize>,
    /// The side of a cell in metres.
    pub cell_m: Option<f64>,
}

/// A surface of triangles.
#[derive(Clone, Debug, PartialEq)]
pub enum Mesh {
    /// The text of a Wavefront OBJ file in metres, and its name.
    Obj(PathBuf, String),
    /// A group with `point[…].{x,y,z}` and `triangle[…]`, three Integers each.
    Ports(String),
}

/// Why a run cannot be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum PlotError {
    /// No column, group or claim has this name.
    Unknown(String),
    /// What has this name is not what it should be drawn as.
    Unfit {
        /// The name.
        name: String,
        /// What was expected and found.
        reason: String,
    },
    /// The trace has no rows or no columns.
    Empty,
    /// No row lies between the times that were asked for.
    NoRows {
        /// The run.
        run: String,
        /// Its first and last second.
        has_s: (f64, f64),
    },
    /// The picture is narrower than its axes, or has too many pixels.
    Size,
}

impl fmt::Display for PlotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown(name) => write!(f, "no column or group `{}` was recorded", printable::line(name)),
            Self::Unfit { name, reason } => write!(f, "cannot draw `{}`: {reason}", printable::line(name)),
            Self::Empty => f.write_str("nothing was recorded"),
            Self::NoRows { run, has_s: (first, last) } => {
                write!(f, "no row of {run} lies between --from and --to; it has rows from {first} s to {last} s")
            }
            Self::Size => {
                write!(f, "a picture is {LEAST_WIDTH} to {MOST_WIDTH} pixels wide and has at most 200 million pixels")
            }
        }
    }
}

impl std::error::Error for PlotError {}

/// A picture that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    picture: Picture,
    title: String,
    width: f64,
    height: f64,
}

impl Drawing {
    /// As SVG: shapes and texts, the same bytes for the same runs.
    #[must_use]
    pub fn svg(&self) -> String {
        self.picture.finish(&self.title, self.width, self.height)
    }

    /// As PNG, `scale` pixels for each of the SVG's.
    ///
    /// # Errors
    /// The picture has too many pixels.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>, PlotError> {
        self.picture.png(self.width, self.height, scale).ok_or(PlotError::Size)
    }
}

/// Draws runs over each other; the first is the one whose claims and windows are shown.
///
/// # Errors
/// A name of the selection was not recorded, or is not what it should be drawn as, or there is nothing to draw.
pub fn draw(mut runs: Vec<Run>, selection: &Selection) -> Result<Drawing, PlotError> {
    let width = selection.width.unwrap_or(WIDTH);
    let is_possible = (LEAST_WIDTH..=MOST_WIDTH).contains(&width);
    if !is_possible {
        return Err(PlotError::Size);
    }
    for run in &mut runs {
        let time_s = run.table.time_s();
        let Some((&first, &last)) = time_s.first().zip(time_s.last()) else { return Err(PlotError::Empty) };
        if run.table.columns.len() < 2 {
            return Err(PlotError::Empty);
        }
        if !run.keep(selection.from_s, selection.to_s) {
            return Err(PlotError::NoRows { run: run.name.clone(), has_s: (first, last) });
        }
    }
    if runs.is_empty() {
        return Err(PlotError::Empty);
    }
    let choice = Choice::new(&runs, selection)?;
    let (picture, height) = layout::draw(&runs, selection, &choice, width)?;
    let title = runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>().join(", ");
    Ok(Drawing { picture, title, width, height })
}

#[cfg(test)]
mod tests;
