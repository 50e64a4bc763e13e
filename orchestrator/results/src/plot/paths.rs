//! Paths in space: a view to scale of all position groups, with a grid on the ground and what stands there.

use super::choice::Choice;
use super::font::width as text_width;
use super::labels::{Labels, Legend, Sample};
use super::mesh::{MIDDLE_SHADE, Surface};
use super::overlay::{self, CIRCLE};
use super::places::{Place, circles, places};
use super::raster::Cells;
use super::run::Run;
use super::scale::label_in_steps;
use super::svg::{Anchor, FAINT_INK, GRID, INK, Picture, Stroke};
use super::view::{self, Point, View};
use super::{PlotError, Selection};

/// The most height of the view in pixels.
const HEIGHT: f64 = 400.0;
/// And where nothing moves.
const RESTING: f64 = 200.0;
const SIDE: f64 = 76.0;
const BELOW: f64 = 44.0;
const ABOVE: f64 = 30.0;

/// A position group of one run over time, in metres.
struct Path {
    points_m: Vec<(f64, Point)>,
    stroke: Stroke,
    is_other: bool,
}

/// A point on a path with a letter beside it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    pub at_s: f64,
    pub letter: String,
}

/// All that is drawn in space.
#[derive(Default)]
pub(super) struct Space {
    paths: Vec<Path>,
    circles: Vec<Place>,
    points: Vec<Place>,
    cells: Vec<Cells>,
    surfaces: Vec<Surface>,
    marks: Vec<Mark>,
    legend: Legend,
}

impl Space {
    pub(super) fn new(runs: &[Run], selection: &Selection, choice: &Choice) -> Result<Self, PlotError> {
        let mut space = Self::default();
        let Some(first) = runs.first() else { return Err(PlotError::Empty) };
        for (index, name) in choice.paths.iter().enumerate() {
            let main = Stroke::of_curve(index, if index == 0 { 2.2 } else { 1.6 });
            for (number, run) in runs.iter().enumerate() {
                let stroke = if number == 0 { main } else { main.of_other(number) };
                let points_m = run.path(name).unwrap_or_default();
                space.paths.push(Path { points_m, stroke, is_other: number > 0 });
            }
            space.legend.add(Sample::Line(main), name.as_str());
        }
        for group in &selection.circles {
            space.circles.extend(circles(first, group)?);
            space.legend.add(Sample::Field(CIRCLE, 0.5), group.as_str());
        }
        for group in &selection.points {
            space.points.extend(places(first, group)?);
            space.legend.add(Sample::None, format!("× {group}"));
        }
        for raster in &selection.rasters {
            space.cells.push(Cells::read(first, raster)?);
            space.legend.add(Sample::Field(INK, 0.45), raster.group.as_str());
        }
        for mesh in &selection.meshes {
            let surface = Surface::read(first, mesh)?;
            space.legend.add(Sample::Field(MIDDLE_SHADE, 1.0), surface.name.as_str());
            space.surfaces.push(surface);
        }
        if let Some(name) = &selection.mark {
            space.marks = marks(first, name)?;
            space.legend.add(Sample::None, format!("letters: {name} changes"));
        }
        Ok(space)
    }

    pub(super) fn is_empty(&self) -> bool {
        let bare = self.circles.is_empty() && self.points.is_empty() && self.cells.is_empty();
        self.paths.is_empty() && bare && self.surfaces.is_empty()
    }

    /// All points that the view must have room for.
    fn room(&self) -> Vec<Point> {
        let mut points: Vec<Point> =
            self.paths.iter().flat_map(|path| path.points_m.iter().map(|(_, at)| *at)).collect();
        points.extend(self.circles.iter().chain(&self.points).flat_map(overlay::room));
        points.extend(self.surfaces.iter().flat_map(|surface| surface.points.iter().copied()));
        let ground = points.iter().map(|point| point[2]).fold(f64::INFINITY, f64::min);
        let ground = if ground.is_finite() { ground } else { 0.0 };
        points.extend(self.cells.iter().flat_map(|cells| cells.room(ground)));
        points
    }

    /// Draws the view below `top`; returns the height that it needs.
    pub(super) fn draw(&self, picture: &mut Picture, selection: &Selection, top: f64, width: f64) -> f64 {
        let wide = width - 2.0 * 16.0;
        self.legend.draw(picture, (16.0, top), wide);
        let upper = top + self.legend.height(wide) + ABOVE;
        let room = self.room();
        let height = if view::rests(&room) { RESTING } else { HEIGHT.min(0.6 * width) };
        let view = View::fit(&room, selection.view, [SIDE, upper, width - 2.0 * SIDE, height]);
        let mut labels = Labels::default();
        floor(picture, &view);
        self.surfaces.iter().for_each(|surface| surface.draw(picture, &view));
        self.cells.iter().for_each(|cells| cells.draw(picture, &view));
        self.letters(picture, &view, &mut labels, false);
        numbers(picture, &view, &mut labels);
        let main = self.paths.first();
        if let Some(path) = main.filter(|_| !view.above && self.surfaces.is_empty()) {
            curtain(picture, &view, path);
        }
        overlay::circles(picture, &view, &self.circles);
        overlay::points(picture, &view, &self.points);
        for path in self.paths.iter().filter(|path| path.is_other) {
            picture.curve(&thinned(&view, path), path.stroke);
        }
        for path in self.paths.iter().filter(|path| !path.is_other).rev() {
            picture.curve(&thinned(&view, path), path.stroke);
            ends(picture, &view, path);
        }
        self.letters(picture, &view, &mut labels, true);
        view.bounds()[3] + BELOW - top
    }

    /// Letters at the marks of the first path. Their places are taken before those of numbers, and they are drawn last.
    fn letters(&self, picture: &mut Picture, view: &View, labels: &mut Labels, drawn: bool) {
        let Some(path) = self.paths.first() else { return };
        let mut scratch = Picture::default();
        let mut again = Labels::default();
        let labels = if drawn { &mut again } else { labels };
        for mark in &self.marks {
            let index = path.points_m.partition_point(|(time_s, _)| *time_s <= mark.at_s + 1e-9).max(1) - 1;
            let Some((_, point)) = path.points_m.get(index) else { continue };
            let (x, y) = view.page(*point);
            let at = |dx: f64, dy: f64, anchor: Anchor| ((x + dx, y + dy), anchor);
            let places = [
                at(-7.0, -7.0, Anchor::End),
                at(7.0, -7.0, Anchor::Start),
                at(-7.0, 16.0, Anchor::End),
                at(7.0, 16.0, Anchor::Start),
                at(0.0, -12.0, Anchor::Middle),
                at(0.0, 22.0, Anchor::Middle),
            ];
            let into = if drawn { &mut *picture } else { &mut scratch };
            into.dot((x, y), 4.0, path.stroke.colour);
            labels.write(into, &places, (13.0, INK), &mark.letter);
        }
    }
}

/// A ring where a path begins and a dot where it ends.
fn ends(picture: &mut Picture, view: &View, path: &Path) {
    if let Some((first, last)) = path.points_m.first().zip(path.points_m.last()) {
        picture.ring(view.page(first.1), 3.0, path.stroke.colour);
        picture.dot(view.page(last.1), 4.0, path.stroke.colour);
    }
}

/// Grid lines on the ground.
fn floor(picture: &mut Picture, view: &View) {
    let ([x0, y0, z0], [x1, y1, _]) = (view.low, view.high);
    for x in view.ticks(0) {
        picture.line(view.page([x, y0, z0]), view.page([x, y1, z0]), Stroke::new(GRID, 1.0));
    }
    for y in view.ticks(1) {
        picture.line(view.page([x0, y, z0]), view.page([x1, y, z0]), Stroke::new(GRID, 1.0));
    }
}

/// Numbers at the ends of the grid lines, the height axis at the left corner, and the names of the axes.
fn numbers(picture: &mut Picture, view: &View, labels: &mut Labels) {
    let ([x0, y0, z0], [x1, y1, z1]) = (view.low, view.high);
    let faint = (11.0, FAINT_INK);
    let mut x_axis = Axis { picture, labels, view, style: faint };
    let (x_at, y_at) = if view.above {
        (((0.0, 16.0), Anchor::Middle), ((-8.0, 4.0), Anchor::End))
    } else {
        (((-4.0, 15.0), Anchor::End), ((8.0, 15.0), Anchor::Start))
    };
    let y_edge = if view.above { x0 } else { x1 };
    x_axis.numbers(0, x_at, |x| [x, y0, z0]);
    x_axis.numbers(1, y_at, |y| [y_edge, y, z0]);
    let ((x_x, x_y), (y_x, y_y)) = (view.page([(x0 + x1) / 2.0, y0, z0]), view.page([y_edge, (y0 + y1) / 2.0, z0]));
    if view.above {
        let corner = view.page([x0, y1, z0]);
        x_axis.title((x_x, x_y + 36.0), Anchor::Middle, "x [m]");
        x_axis.title((corner.0 - 8.0, corner.1 - 12.0), Anchor::End, "y [m]");
        return;
    }
    x_axis.numbers(2, ((-8.0, 4.0), Anchor::End), |z| [x0, y0, z]);
    x_axis.title((x_x - 26.0, x_y + 34.0), Anchor::End, "x [m]");
    let numbers = view.ticks(1).iter().map(|y| text_width(&label_in_steps(*y, view.step.0), 11.0)).fold(0.0, f64::max);
    x_axis.title((y_x + 20.0 + numbers, y_y + 24.0), Anchor::Start, "y [m]");
    let (top_x, top_y) = view.page([x0, y0, z1]);
    x_axis.title((top_x, top_y - 10.0), Anchor::Middle, "z [m]");
    let corner = view.page([x0, y0, z0]);
    x_axis.picture.line(corner, (top_x, top_y), Stroke::new(FAINT_INK, 1.0));
    for z in view.ticks(2) {
        let (x, y) = view.page([x0, y0, z]);
        x_axis.picture.line((x - 4.0, y), (x, y), Stroke::new(FAINT_INK, 1.0));
    }
}

struct Axis<'a> {
    picture: &'a mut Picture,
    labels: &'a mut Labels,
    view: &'a View,
    style: (f64, &'static str),
}

impl Axis<'_> {
    fn numbers(&mut self, axis: usize, ((dx, dy), anchor): ((f64, f64), Anchor), at: impl Fn(f64) -> Point) {
        let step = if axis == 2 { self.view.step.1 } else { self.view.step.0 };
        for tick in self.view.ticks(axis) {
            let (x, y) = self.view.page(at(tick));
            self.labels.write(self.picture, &[((x + dx, y + dy), anchor)], self.style, &label_in_steps(tick, step));
        }
    }

    fn title(&mut self, at: (f64, f64), anchor: Anchor, text: &str) {
        let lower = ((at.0, at.1 + 12.0), anchor);
        self.labels.write(self.picture, &[(at, anchor), lower], (12.0, INK), text);
    }
}

/// A faint surface from the path down to the ground, which shows the position above the ground.
fn curtain(picture: &mut Picture, view: &View, path: &Path) {
    let colour = path.stroke.colour;
    let steps: Vec<_> = path.points_m.iter().step_by((path.points_m.len() / 300).max(1)).map(|(_, at)| *at).collect();
    for pair in steps.windows(2) {
        let wall = [view.page(pair[0]), view.page(pair[1]), view.ground(pair[1]), view.ground(pair[0])];
        let is_thin = (wall[0].0 - wall[1].0).abs() < 0.05 && (wall[2].0 - wall[3].0).abs() < 0.05;
        if !is_thin {
            picture.polygon(&wall, colour, 0.07);
        }
    }
    let shadow: Vec<_> = steps.iter().map(|point| view.ground(*point)).collect();
    picture.curve(&shadow, Stroke::new(colour, 1.0).faint(0.35));
}

/// Points that are at least half a pixel apart, and the last one.
fn thinned(view: &View, path: &Path) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for point in path.points_m.iter().map(|(_, point)| view.page(*point)) {
        if kept.last().is_none_or(|last| (last.0 - point.0).abs() + (last.1 - point.1).abs() > 0.5) {
            kept.push(point);
        }
    }
    kept
}

/// The first row, the rows at which a column changes, and the last row, lettered from A.
pub(super) fn marks(run: &Run, name: &str) -> Result<Vec<Mark>, PlotError> {
    if run.table.column(name).is_none() {
        return Err(PlotError::Unknown(name.to_owned()));
    }
    let samples = run.samples(name);
    let Some((first, last)) = samples.first().zip(samples.last()) else { return Ok(Vec::new()) };
    let changes = samples.windows(2).filter(|pair| pair[0].1.to_bits() != pair[1].1.to_bits()).map(|pair| pair[1].0);
    let times = [first.0].into_iter().chain(changes).chain([last.0]);
    let letters = ('A'..='Z').map(String::from);
    Ok(times.zip(letters).map(|(at_s, letter)| Mark { at_s, letter }).collect())
}
