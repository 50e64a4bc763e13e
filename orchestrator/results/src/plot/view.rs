//! Points of the world on the page: a parallel view to scale, the same for all three axes.

use super::ViewFrom;
use super::scale::{ends, ticks};

/// The least extent in metres: what hardly moves is a point, not a line that fills the picture.
const LEAST_M: f64 = 1.0;
/// An oblique view is at least this wide for its height, so that there is room for the numbers on the ground.
const LEAST_WIDE: f64 = 0.35;
/// Where heights differ by less than this part of the width, a view from above shows more.
const FLAT: f64 = 0.04;

/// A point of the world in metres.
pub(super) type Point = [f64; 3];

/// Whether all points lie within the least extent.
pub(super) fn rests(points: &[Point]) -> bool {
    (0..3).all(|axis| {
        let ends = ends(points.iter().map(|point| point[axis]));
        ends.is_none_or(|(low, high)| high - low <= LEAST_M)
    })
}

/// A parallel view: directions of the world's axes on the page, for a scale of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// The box that is shown; its ends across are at ticks.
    pub low: Point,
    pub high: Point,
    /// The distance of ticks across and upwards.
    pub step: (f64, f64),
    pub above: bool,
    scale: f64,
    origin: (f64, f64),
}

/// Seen from azimuth 240°, 30° above the ground.
const OBLIQUE: [(f64, f64); 3] = [(0.866, 0.25), (0.5, -0.433), (0.0, -0.866)];
const ABOVE: [(f64, f64); 3] = [(1.0, 0.0), (0.0, -1.0), (0.0, 0.0)];

impl View {
    /// A view of all points in a box of the page, whose height may be less than there is: left, top, width, height.
    pub(super) fn fit(points: &[Point], from: ViewFrom, [left, top, width, height]: [f64; 4]) -> Self {
        let axis = |axis: usize| ends(points.iter().map(|point| point[axis])).unwrap_or((0.0, 0.0));
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let across = (x.1 - x.0).max(y.1 - y.0).max(LEAST_M);
        let above = match from {
            ViewFrom::Fitting => z.1 - z.0 < FLAT * across && across > LEAST_M,
            ViewFrom::Above => true,
            ViewFrom::Oblique => false,
        };
        // The ground is shown where it is near.
        let z = if z.0 > 0.0 && z.0 < 2.0 * across.max(z.1 - z.0) { (0.0, z.1) } else { z };
        let tall = if above { 0.0 } else { z.1 - z.0 };
        let least = LEAST_M.max(LEAST_WIDE * tall).max(0.1 * across);
        let (_, step) = ticks(0.0, across.max(least), if above { 7.0 } else { 5.0 });
        let wide = |(low, high): (f64, f64)| {
            let room = ((least - (high - low)) / 2.0).max(0.0);
            [((low - room) / step + 1e-9).floor() * step, ((high + room) / step - 1e-9).ceil() * step]
        };
        let ([x0, x1], [y0, y1]) = (wide(x), wide(y));
        let z1 = z.1.max(z.0 + if rests(points) { LEAST_M / 2.0 } else { 0.1 * across });
        let step_up = ticks(z.0, z1, (6.0 * (z1 - z.0) / across).clamp(2.0, 6.0)).1;
        let (low, high) = ([x0, y0, z.0], [x1, y1, z1]);
        let mut view = Self { low, high, step: (step, step_up), above, scale: 1.0, origin: (0.0, 0.0) };
        let [min_x, max_x, min_y, max_y] = view.bounds();
        view.scale = (width / (max_x - min_x)).min(height / (max_y - min_y));
        let slack = width - view.scale * (max_x - min_x);
        view.origin = (left + slack / 2.0 - view.scale * min_x, top - view.scale * min_y);
        view
    }

    /// Left, right, top and bottom of the box on the page.
    pub(super) fn bounds(&self) -> [f64; 4] {
        let corners = self.corners().map(|corner| self.page(corner));
        let across = ends(corners.iter().map(|corner| corner.0)).unwrap_or((0.0, 1.0));
        let up = ends(corners.iter().map(|corner| corner.1)).unwrap_or((0.0, 1.0));
        [across.0, across.1, up.0, up.1]
    }

    fn corners(&self) -> [Point; 8] {
        let end = |high: bool, axis: usize| if high { self.high[axis] } else { self.low[axis] };
        std::array::from_fn(|bits| [end(bits & 1 > 0, 0), end(bits & 2 > 0, 1), end(bits & 4 > 0, 2)])
    }

    /// The place of a point.
    pub(super) fn page(&self, point: Point) -> (f64, f64) {
        let directions = if self.above { ABOVE } else { OBLIQUE };
        let from_low = [0, 1, 2].map(|axis| self.scale * (point[axis] - self.low[axis]));
        let sum = |part: fn((f64, f64)) -> f64| (0..3).map(|axis| from_low[axis] * part(directions[axis])).sum::<f64>();
        (self.origin.0 + sum(|direction| direction.0), self.origin.1 + sum(|direction| direction.1))
    }

    /// How near a point is to the eye, to draw what is near over what is far.
    pub(super) fn nearness(&self, [x, y, z]: Point) -> f64 {
        if self.above { z } else { 0.866 * (0.5 * x - 0.866 * y) + 0.5 * z }
    }

    /// The point on the ground below.
    pub(super) fn ground(&self, [x, y, _]: Point) -> (f64, f64) {
        self.page([x, y, self.low[2]])
    }

    /// Round numbers of an axis inside the box.
    pub(super) fn ticks(&self, axis: usize) -> Vec<f64> {
        let step = if axis == 2 { self.step.1 } else { self.step.0 };
        let (first, last) = ((self.low[axis] / step - 1e-9).ceil(), (self.high[axis] / step + 1e-9).floor());
        (0..100).map(|index| first + f64::from(index)).take_while(|at| *at <= last).map(|at| at * step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: [f64; 4] = [70.0, 50.0, 820.0, 420.0];

    #[test]
    fn every_point_lies_inside_and_the_scale_is_the_same_for_all_axes() {
        let points = [[0.0, 0.0, 0.0], [30.0, 0.0, 10.0], [30.0, -70.0, 10.0], [0.0, -70.0, 0.0]];
        let view = View::fit(&points, ViewFrom::Fitting, PAGE);
        assert!(!view.above);
        for point in points {
            let (x, y) = view.page(point);
            assert!((70.0..=890.0).contains(&x) && (50.0..=470.0).contains(&y), "{x} {y}");
        }
        let length = |from: Point, to: Point| {
            let ((x0, y0), (x1, y1)) = (view.page(from), view.page(to));
            ((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0)).sqrt()
        };
        let up = length([0.0; 3], [0.0, 0.0, 10.0]) / 0.866;
        let along_x = length([0.0; 3], [10.0, 0.0, 0.0]) / 0.9014;
        assert!((up / along_x - 1.0).abs() < 1e-3, "{up} {along_x}");
    }

    #[test]
    fn a_hover_has_an_extent_on_the_ground() {
        let points = [[0.0, 0.0, 0.0], [0.001, 0.0, 10.0]];
        let view = View::fit(&points, ViewFrom::Fitting, PAGE);
        assert!(view.high[0] - view.low[0] >= 3.5 && view.high[1] - view.low[1] >= 3.5, "{view:?}");
        let resting = View::fit(&[[5.0, 5.0, 0.0]], ViewFrom::Fitting, PAGE);
        assert!(resting.high[0] - resting.low[0] >= 1.0);
        assert!(resting.page([5.0, 5.0, 0.0]).0.is_finite());
    }

    #[test]
    fn what_is_flat_is_seen_from_above() {
        let points = [[0.0, 0.0, -5.0], [100.0, 80.0, -5.5]];
        assert!(View::fit(&points, ViewFrom::Fitting, PAGE).above);
        assert!(!View::fit(&points, ViewFrom::Oblique, PAGE).above);
    }
}
