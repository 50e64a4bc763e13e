//! Circles and points on the ground or in space, each from a group of ports.

use super::places::Place;
use super::svg::{FAINT_INK, INK, Picture, Stroke};
use super::view::{Point, View};

/// The corners of a drawn circle.
const CORNERS: usize = 48;
/// The colour of circles.
pub(super) const CIRCLE: &str = "#8c959f";

/// A circle about a point at its height.
fn round(place: Point, radius_m: f64) -> [Point; CORNERS] {
    std::array::from_fn(|corner| {
        let angle = std::f64::consts::TAU * corner as f64 / CORNERS as f64;
        [place[0] + radius_m * libm::cos(angle), place[1] + radius_m * libm::sin(angle), place[2]]
    })
}

/// The points that a picture must have room for.
pub(super) fn room(place: &Place) -> Vec<Point> {
    let radius = place.radius_m.unwrap_or(0.0);
    let half = place.height_m.unwrap_or(0.0) / 2.0;
    let corner = |sign: f64| [place.at[0] + sign * radius, place.at[1] + sign * radius, place.at[2] + sign * half];
    vec![corner(-1.0), corner(1.0), place.first]
}

/// Draws circles, the far ones first; what has a height is a cylinder. A circle that has moved has a line from where it was.
pub(super) fn circles(picture: &mut Picture, view: &View, places: &[Place]) {
    let mut order: Vec<_> = places.iter().collect();
    order.sort_by(|a, b| view.nearness(a.at).total_cmp(&view.nearness(b.at)));
    for place in order {
        let radius = place.radius_m.unwrap_or(0.0);
        let half = place.height_m.unwrap_or(0.0).max(0.0) / 2.0;
        let level = |z: f64| -> Vec<(f64, f64)> {
            round([place.at[0], place.at[1], z], radius).iter().map(|corner| view.page(*corner)).collect()
        };
        let (base, top) = (level((place.at[2] - half).max(view.low[2])), level(place.at[2] + half));
        let outline = Stroke::new(INK, 1.0);
        if moved(place) {
            let from = round(place.first, radius).map(|corner| view.page(corner));
            closed(picture, &from, Stroke::new(FAINT_INK, 0.8).dashed());
            picture.line(view.page(place.first), view.page(place.at), Stroke::new(FAINT_INK, 1.0).dashed());
        }
        if half > 0.0 && !view.above {
            picture.polygon(&hull(&base, &top), CIRCLE, 0.35);
            closed(picture, &base, outline.faint(0.5));
            for corner in [side(&base, true), side(&base, false)] {
                picture.line(base[corner], top[corner], outline);
            }
        }
        picture.polygon(&top, CIRCLE, 0.35);
        closed(picture, &top, outline);
    }
}

fn moved(place: &Place) -> bool {
    (0..3).any(|axis| (place.at[axis] - place.first[axis]).abs() > 1e-6)
}

fn closed(picture: &mut Picture, corners: &[(f64, f64)], stroke: Stroke) {
    let around: Vec<_> = corners.iter().chain(corners.first()).copied().collect();
    picture.curve(&around, stroke);
}

/// The corner that is farthest to the left or right.
fn side(corners: &[(f64, f64)], left: bool) -> usize {
    let by_x = |a: &usize, b: &usize| corners[*a].0.total_cmp(&corners[*b].0);
    let all = 0..corners.len();
    if left { all.min_by(by_x) } else { all.max_by(by_x) }.unwrap_or(0)
}

/// The outline of a cylinder without its top: the near half of the base, and the near half of the top.
fn hull(base: &[(f64, f64)], top: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let (left, right) = (side(base, true), side(base, false));
    let half = |corners: &[(f64, f64)]| {
        let way = |step: usize| -> Vec<(f64, f64)> {
            let indices = std::iter::successors(Some(left), |at| (*at != right).then(|| (at + step) % corners.len()));
            indices.map(|at| corners[at]).collect()
        };
        let (one, other) = (way(1), way(corners.len() - 1));
        let lowest = |way: &[(f64, f64)]| way.iter().map(|corner| corner.1).fold(f64::NEG_INFINITY, f64::max);
        if lowest(&one) >= lowest(&other) { one } else { other }
    };
    half(base).into_iter().chain(half(top).into_iter().rev()).collect()
}

/// Draws points as crosses.
pub(super) fn points(picture: &mut Picture, view: &View, places: &[Place]) {
    for place in places {
        let (x, y) = view.page(place.at);
        let size = if places.len() > 200 { 1.5 } else { 3.5 };
        picture.line((x - size, y - size), (x + size, y + size), Stroke::new(INK, 1.3));
        picture.line((x - size, y + size), (x + size, y - size), Stroke::new(INK, 1.3));
    }
}
