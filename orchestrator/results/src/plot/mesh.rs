//! A surface of triangles, from a Wavefront OBJ file or from ports.

use super::places::{few, places};
use super::run::Run;
use super::svg::{Picture, Stroke};
use super::view::{Point, View};
use super::{Mesh, PlotError};
use fmi2::printable;

/// More triangles make a picture that no program opens quickly.
const MOST_TRIANGLES: usize = 20_000;
/// From the side in the shadow to that in the light.
const SHADES: [&str; 6] = ["#b9b2a3", "#c5beb0", "#d0cabd", "#dad5ca", "#e4e0d7", "#edeae4"];

/// The colour that stands for a surface in a legend.
pub(super) const MIDDLE_SHADE: &str = SHADES[1];

/// Corners, and three of them for each triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Surface {
    pub name: String,
    pub points: Vec<Point>,
    triangles: Vec<[usize; 3]>,
}

impl Surface {
    pub(super) fn read(run: &Run, mesh: &Mesh) -> Result<Self, PlotError> {
        let (surface, name) = match mesh {
            Mesh::Obj(path, text) => {
                let name = printable::path(path).to_string();
                let surface = obj(text).map_err(|reason| PlotError::Unfit { name: name.clone(), reason })?;
                (surface, name)
            }
            Mesh::Ports(group) => (ports(run, group)?, group.clone()),
        };
        let reason = match surface.triangles.len() {
            0 => "it has no triangles".to_owned(),
            1..=MOST_TRIANGLES => return Ok(Self { name, ..surface }),
            more => format!("it has {more} triangles, more than {MOST_TRIANGLES}; make it coarser"),
        };
        Err(PlotError::Unfit { name, reason })
    }

    /// Draws the triangles, the far ones first, the brighter the more they face the light, which comes from the left.
    pub(super) fn draw(&self, picture: &mut Picture, view: &View) {
        let corners = |triangle: &[usize; 3]| triangle.map(|corner| self.points[corner]);
        let middle = |triangle: &[usize; 3]| {
            let [a, b, c] = corners(triangle);
            [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0)
        };
        let mut order: Vec<_> = self.triangles.iter().collect();
        order.sort_by(|a, b| view.nearness(middle(a)).total_cmp(&view.nearness(middle(b))));
        for triangle in order {
            let corners = corners(triangle);
            let page = corners.map(|corner| view.page(corner));
            let shade = SHADES[(light(corners) * (SHADES.len() as f64 - 0.01)) as usize % SHADES.len()];
            picture.polygon(&page, shade, 1.0);
            // Without a border the gaps between triangles would shine through.
            picture.curve(&[page[0], page[1], page[2], page[0]], Stroke::new(shade, 0.6));
        }
    }
}

/// How much a triangle faces the light: from 0 to 1.
fn light([a, b, c]: [Point; 3]) -> f64 {
    let (u, v) = ([0, 1, 2].map(|axis| b[axis] - a[axis]), [0, 1, 2].map(|axis| c[axis] - a[axis]));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|part| part * part).sum::<f64>().sqrt();
    let up = if normal[2] < 0.0 { -1.0 } else { 1.0 };
    let towards = up * (-0.5 * normal[0] + 0.3 * normal[1] + 0.8 * normal[2]) / length;
    // Heights of a terrain are small: the shades are spread over gentle slopes.
    if towards.is_finite() { (0.5 + 1.5 * (towards - 0.8)).clamp(0.0, 1.0) } else { 0.5 }
}

/// `point[…].{x,y,z}` and `triangle[…]`, three Integers from 1 for each.
fn ports(run: &Run, group: &str) -> Result<Surface, PlotError> {
    let members = run.members(group);
    if members.is_empty() {
        return Err(PlotError::Unknown(group.to_owned()));
    }
    let unfit = |reason: String| PlotError::Unfit { name: group.to_owned(), reason };
    let points: Vec<_> = places(run, &format!("{group}.point"))
        .map_err(|_| unfit(format!("it has no point[…].{{x,y,z}} in metres; it has {}", few(&members))))?
        .into_iter()
        .map(|place| place.at)
        .collect();
    let corners: Vec<_> = run.members(&format!("{group}.triangle")).iter().filter_map(|name| run.last(name)).collect();
    let mut triangles = Vec::new();
    // Places that are not used have corner 0.
    for three in corners.chunks_exact(3).filter(|three| three.iter().all(|corner| *corner >= 1.0)) {
        let corner = |value: f64| {
            let index = value as usize;
            if index <= points.len() {
                Ok(index - 1)
            } else {
                Err(unfit(format!("a triangle has the corner {value}, there are {} points", points.len())))
            }
        };
        triangles.push([corner(three[0])?, corner(three[1])?, corner(three[2])?]);
    }
    Ok(Surface { points, triangles, ..Surface::default() })
}

/// Corners and faces of an OBJ file; faces with more corners become several triangles, everything else is left out.
fn obj(text: &str) -> Result<Surface, String> {
    let mut surface = Surface::default();
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let wrong = |what: &str| format!("line {} has no {what}: {}", index + 1, printable::line(line));
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> =
                    words.filter_map(|word| word.parse().ok()).filter(|number: &f64| number.is_finite()).collect();
                let [x, y, z, ..] = numbers[..] else { return Err(wrong("three coordinates")) };
                surface.points.push([x, y, z]);
            }
            Some("f") => {
                let corner = |word: &str| {
                    let number: i64 = word.split('/').next()?.parse().ok()?;
                    let count = i64::try_from(surface.points.len()).ok()?;
                    let index = if number < 0 { count + number } else { number - 1 };
                    usize::try_from(index).ok().filter(|index| *index < surface.points.len())
                };
                let corners: Option<Vec<_>> = words.map(corner).collect();
                let corners = corners
                    .filter(|corners| corners.len() >= 3)
                    .ok_or_else(|| wrong("three corners that are there"))?;
                surface.triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Ok(surface)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_obj_file_is_read_into_triangles() {
        let surface = obj("# a square\nv 0 0 0\nv 1 0 0\nv 1 1 2\nv 0 1 0\nf 1/1 2/2 3//1 4\nf -1 -2 -3\n").unwrap();
        assert_eq!(surface.points.len(), 4);
        assert_eq!(surface.triangles, [[0, 1, 2], [0, 2, 3], [3, 2, 1]]);
        assert_eq!(obj("v 0 0\n").unwrap_err(), "line 1 has no three coordinates: v 0 0");
        assert_eq!(obj("v 0 0 0\nf 1 2 3\n").unwrap_err(), "line 2 has no three corners that are there: f 1 2 3");
    }
}
