//! Paths in space: an oblique view of all position groups, with a grid on the ground and a curtain below the first.

use super::scale::{extent, label, ticks};
use super::svg::{Anchor, CURVES, FAINT_INK, GRID, INK, Picture, Stroke};

/// The view's height in pixels.
pub(super) const HEIGHT: f64 = 520.0;

/// A position group over time, in metres.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Path {
    pub name: String,
    pub points_m: Vec<[f64; 3]>,
}

/// A point on a path with a text beside it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    pub index: usize,
    pub text: String,
}

/// An oblique parallel view: x to the lower right, y to the upper right, z up.
#[derive(Clone, Copy, Debug)]
struct View {
    low: [f64; 3],
    high: [f64; 3],
    /// How much taller than true heights are drawn.
    height_factor: f64,
    scale: f64,
    origin: (f64, f64),
}

/// Directions of the world's axes on the page for a scale of one: seen from azimuth 240°, 30° above the ground.
const X_ON_PAGE: (f64, f64) = (0.866, 0.25);
const Y_ON_PAGE: (f64, f64) = (0.5, -0.433);
const Z_ON_PAGE: f64 = -0.866;

impl View {
    /// Fits all points into a box on the page.
    fn fit(paths: &[Path], left: f64, top: f64, width: f64, height: f64) -> Self {
        let axis =
            |axis: usize| extent(paths.iter().flat_map(|path| path.points_m.iter().map(move |point| point[axis])));
        let ends = [axis(0), axis(1), axis(2)];
        let (low_z, high_z) = (ends[2].0.min(0.0), ends[2].1);
        let across = (ends[0].1 - ends[0].0).max(ends[1].1 - ends[1].0);
        let wanted = (0.25 * across / (high_z - low_z)).clamp(1.0, 10.0);
        let height_factor = if wanted < 1.5 { 1.0 } else { wanted.round() };
        let low = [ends[0].0, ends[1].0, low_z];
        let high = [ends[0].1, ends[1].1, high_z];
        let mut view = Self { low, high, height_factor, scale: 1.0, origin: (0.0, 0.0) };
        let corners = view.corners().map(|corner| view.page(corner));
        let (min_x, max_x) = extent(corners.iter().map(|corner| corner.0));
        let (min_y, max_y) = extent(corners.iter().map(|corner| corner.1));
        view.scale = (width / (max_x - min_x)).min(height / (max_y - min_y));
        let slack = (width - view.scale * (max_x - min_x), height - view.scale * (max_y - min_y));
        view.origin = (left + slack.0 / 2.0 - view.scale * min_x, top + slack.1 / 2.0 - view.scale * min_y);
        view
    }

    fn corners(&self) -> [[f64; 3]; 8] {
        let end = |high: bool, axis: usize| if high { self.high[axis] } else { self.low[axis] };
        std::array::from_fn(|bits| [end(bits & 1 > 0, 0), end(bits & 2 > 0, 1), end(bits & 4 > 0, 2)])
    }

    fn page(&self, [x, y, z]: [f64; 3]) -> (f64, f64) {
        let (x, y, z) = (x - self.low[0], y - self.low[1], (z - self.low[2]) * self.height_factor);
        let page = (X_ON_PAGE.0 * x + Y_ON_PAGE.0 * y, X_ON_PAGE.1 * x + Y_ON_PAGE.1 * y + Z_ON_PAGE * z);
        (self.origin.0 + self.scale * page.0, self.origin.1 + self.scale * page.1)
    }
}

/// Draws all paths; the first is drawn solid as the main one, the others are dashed.
pub(super) fn draw(picture: &mut Picture, paths: &[Path], marks: &[Mark], top: f64, width: f64) {
    let view = View::fit(paths, 70.0, top + 50.0, width - 140.0, HEIGHT - 110.0);
    floor(picture, &view);
    let strokes: Vec<_> =
        CURVES.iter().cycle().take(paths.len()).enumerate().map(|(i, colour)| stroke(i, colour)).collect();
    for (path, stroke) in paths.iter().zip(&strokes).skip(1) {
        picture.curve(&thinned(&view, &path.points_m), *stroke);
    }
    if let (Some(first), Some(stroke)) = (paths.first(), strokes.first()) {
        curtain(picture, &view, first, stroke.colour);
        picture.curve(&thinned(&view, &first.points_m), *stroke);
        for mark in marks {
            let until = &first.points_m[..first.points_m.len().min(mark.index + 1)];
            let Some(&point) = until.iter().rfind(|point| is_sample(point)) else { continue };
            let (x, y) = view.page(point);
            picture.dot((x, y), 4.0, stroke.colour);
            picture.text((x - 7.0, y - 7.0), Anchor::End, 13.0, INK, &mark.text);
        }
    }
    let legend: Vec<_> = paths.iter().zip(strokes).map(|(path, stroke)| (path.name.clone(), stroke)).collect();
    picture.legend((40.0, top + 24.0), &legend);
    if view.height_factor > 1.0 {
        let note = format!("heights drawn {} times", label(view.height_factor));
        picture.text((width - 24.0, top + 24.0), Anchor::End, 11.0, FAINT_INK, &note);
    }
}

fn stroke(index: usize, colour: &'static str) -> Stroke {
    if index == 0 { Stroke::new(colour, 2.2) } else { Stroke::new(colour, 1.4).dashed() }
}

/// Grid lines and numbers on the ground, and the height axis at its left corner.
fn floor(picture: &mut Picture, view: &View) {
    let ([x0, y0, z0], [x1, y1, z1]) = (view.low, view.high);
    for x in ticks(x0, x1, 6.0) {
        picture.line(view.page([x, y0, z0]), view.page([x, y1, z0]), Stroke::new(GRID, 1.0));
        let (px, py) = view.page([x, y0, z0]);
        picture.text((px - 4.0, py + 16.0), Anchor::Middle, 11.0, FAINT_INK, &label(x));
    }
    for y in ticks(y0, y1, 6.0) {
        picture.line(view.page([x0, y, z0]), view.page([x1, y, z0]), Stroke::new(GRID, 1.0));
        let (px, py) = view.page([x1, y, z0]);
        picture.text((px + 8.0, py + 12.0), Anchor::Start, 11.0, FAINT_INK, &label(y));
    }
    for z in ticks(z0, z1, 3.0) {
        let (px, py) = view.page([x0, y0, z]);
        picture.line((px - 4.0, py), (px, py), Stroke::new(FAINT_INK, 1.0));
        picture.text((px - 8.0, py + 4.0), Anchor::End, 11.0, FAINT_INK, &label(z));
    }
    picture.line(view.page([x0, y0, z0]), view.page([x0, y0, z1]), Stroke::new(FAINT_INK, 1.0));
    let (mid_x, mid_y) = view.page([(x0 + x1) / 2.0, y0, z0]);
    picture.text((mid_x - 24.0, mid_y + 34.0), Anchor::Middle, 12.0, INK, "x, m");
    let (mid_x, mid_y) = view.page([x1, (y0 + y1) / 2.0, z0]);
    picture.text((mid_x + 42.0, mid_y + 22.0), Anchor::Start, 12.0, INK, "y, m");
    let (top_x, top_y) = view.page([x0, y0, z1]);
    picture.text((top_x, top_y - 10.0), Anchor::Middle, 12.0, INK, "z, m");
}

/// A faint surface from the path down to the ground, which shows the position above the ground.
fn curtain(picture: &mut Picture, view: &View, path: &Path, colour: &'static str) {
    let ground = |point: &[f64; 3]| view.page([point[0], point[1], view.low[2]]);
    let samples: Vec<_> = path.points_m.iter().filter(|point| is_sample(point)).collect();
    let steps: Vec<_> = samples.iter().step_by((samples.len() / 300).max(1)).copied().collect();
    for pair in steps.windows(2) {
        let wall = [view.page(*pair[0]), view.page(*pair[1]), ground(pair[1]), ground(pair[0])];
        if wall.iter().all(|(x, y)| x.is_finite() && y.is_finite()) {
            picture.polygon(&wall, colour, 0.07);
        }
    }
    let shadow: Vec<_> = steps.iter().map(|point| ground(point)).collect();
    picture.curve(&shadow, Stroke::new(colour, 1.0).faint(0.35));
}

/// Points that are at least half a pixel apart; rows without a sample are left out.
fn thinned(view: &View, points_m: &[[f64; 3]]) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for point in points_m.iter().filter(|point| is_sample(point)).map(|&point| view.page(point)) {
        if kept.last().is_none_or(|last| (last.0 - point.0).abs() + (last.1 - point.1).abs() > 0.5) {
            kept.push(point);
        }
    }
    kept
}

fn is_sample(point: &[f64; 3]) -> bool {
    point.iter().all(|coordinate| coordinate.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_of_a_path_lies_inside_the_view() {
        let points_m = vec![[0.0, 0.0, 0.0], [30.0, 0.0, 10.0], [30.0, -70.0, 10.0], [0.0, -70.0, 0.0]];
        let paths = [Path { name: "p".into(), points_m }];
        let view = View::fit(&paths, 10.0, 20.0, 300.0, 200.0);
        for point in &paths[0].points_m {
            let (x, y) = view.page(*point);
            assert!((10.0..=310.0).contains(&x) && (20.0..=220.0).contains(&y), "{x} {y}");
        }
    }

    #[test]
    fn rows_without_a_sample_interrupt_no_path() {
        let (sample, none) = (|x: f64| [x, x, x], [f64::NAN; 3]);
        let paths =
            [Path { name: "p".into(), points_m: vec![sample(0.0), none, sample(5.0), none, sample(10.0), none] }];
        let view = View::fit(&paths, 0.0, 0.0, 300.0, 200.0);
        assert_eq!(thinned(&view, &paths[0].points_m), [0.0, 5.0, 10.0].map(|x| view.page(sample(x))));
    }

    #[test]
    fn up_is_up_on_the_page() {
        let paths = [Path { name: "p".into(), points_m: vec![[0.0; 3], [10.0, 10.0, 10.0]] }];
        let view = View::fit(&paths, 0.0, 0.0, 100.0, 100.0);
        assert!(view.page([5.0, 5.0, 9.0]).1 < view.page([5.0, 5.0, 1.0]).1);
    }
}
