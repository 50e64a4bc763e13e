//! Cells over the ground from an array of ports: Booleans, reals, or Integers of 32 cells each.

use super::places::few;
use super::run::Run;
use super::svg::{INK, Picture};
use super::trace::{Kind, group_of};
use super::view::{Point, View};
use super::{PlotError, Raster};

/// More cells are finer than any picture.
const MOST_CELLS: usize = 4_000_000;
/// Shades of reals.
const SHADES: f64 = 6.0;

/// Cells by rows from the origin, each from 0, which is not drawn, to 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cells {
    origin: [f64; 2],
    cell_m: f64,
    columns: usize,
    values: Vec<f64>,
}

impl Cells {
    /// The cells at the last row of the table. `columns`, `cell` and `origin.{x,y}` are ports beside the array where the
    /// selection does not say them.
    pub(super) fn read(run: &Run, raster: &Raster) -> Result<Self, PlotError> {
        let name = &raster.group;
        let members = run.members(name);
        let Some(first) = members.first() else { return Err(PlotError::Unknown(name.clone())) };
        let unfit = |reason: String| PlotError::Unfit { name: name.clone(), reason };
        let values = match run.kind(first) {
            Kind::Integer => members.iter().flat_map(|word| bits(run.last(word).unwrap_or(0.0))).collect(),
            _ => levels(&members.iter().map(|cell| run.last(cell).unwrap_or(0.0)).collect::<Vec<_>>()),
        };
        let beside = |port: &str, unit: &str| {
            let names = [format!("{}.{port}", group_of(name)), format!("{name}.{port}")];
            names.iter().filter(|name| run.unit(name) == unit).find_map(|name| run.last(name))
        };
        let columns = raster.columns.or_else(|| beside("columns", "").map(|columns| columns.max(0.0) as usize));
        let Some(columns) = columns.filter(|columns| *columns > 0) else {
            let has = few(&run.members(group_of(name)));
            return Err(unfit(format!("no port `columns` is beside it, so say --raster-columns; beside it are {has}")));
        };
        let cell_m = raster.cell_m.or_else(|| beside("cell", "m"));
        let Some(cell_m) = cell_m.filter(|cell| *cell > 0.0 && cell.is_finite()) else {
            return Err(unfit(
                "no port `cell` in metres is beside it, so say --raster-cell, for example 0.5".to_owned(),
            ));
        };
        if values.len() > MOST_CELLS {
            return Err(unfit(format!("it has {} cells, more than {MOST_CELLS}", values.len())));
        }
        let origin = ["origin.x", "origin.y"].map(|port| beside(port, "m").unwrap_or(0.0));
        Ok(Self { origin, cell_m, columns, values })
    }

    /// The corners of all cells.
    pub(super) fn room(&self, level: f64) -> [Point; 2] {
        let rows = self.values.len() / self.columns;
        let [x, y] = self.origin;
        let far = |count: usize| count as f64 * self.cell_m;
        [[x, y, level], [x + far(self.columns), y + far(rows), level]]
    }

    /// Draws the cells on the ground; neighbours in a row are one shape.
    pub(super) fn draw(&self, picture: &mut Picture, view: &View) {
        let whole = self.values.len() / self.columns * self.columns;
        for (row, values) in self.values[..whole].chunks(self.columns).enumerate() {
            let mut column = 0;
            for same in values.chunk_by(|a, b| a == b) {
                let [left, right, near, far] =
                    [column, column + same.len(), row, row + 1].map(|at| at as f64 * self.cell_m);
                column += same.len();
                if same[0] > 0.0 {
                    let corner = |x: f64, y: f64| view.ground([self.origin[0] + x, self.origin[1] + y, 0.0]);
                    let corners = [corner(left, near), corner(right, near), corner(right, far), corner(left, far)];
                    picture.polygon(&corners, INK, 0.45 * same[0]);
                }
            }
        }
    }
}

/// The cells of a word, the least bit first.
fn bits(word: f64) -> impl Iterator<Item = f64> {
    let word = word as i64 as u32;
    (0..32).map(move |bit| f64::from(word >> bit & 1))
}

/// Reals in a few shades between their least and largest.
fn levels(values: &[f64]) -> Vec<f64> {
    let Some((low, high)) = super::scale::ends(values.iter().copied()) else { return vec![0.0; values.len()] };
    let low = low.min(0.0);
    let level = |value: &f64| ((value - low) / (high - low) * SHADES).round() / SHADES;
    if high > low { values.iter().map(level).collect() } else { vec![0.0; values.len()] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_has_32_cells_also_where_its_sign_bit_is_set() {
        let cells: Vec<_> = bits(f64::from(i32::MIN) + 5.0).collect();
        assert_eq!((cells.len(), cells[0], cells[1], cells[2], cells[31]), (32, 1.0, 0.0, 1.0, 1.0));
    }

    #[test]
    fn reals_are_shaded_from_zero_to_their_largest() {
        assert_eq!(levels(&[0.0, 3.0, 6.0]), [0.0, 0.5, 1.0]);
        assert_eq!(levels(&[0.0, 0.0]), [0.0, 0.0]);
    }
}
