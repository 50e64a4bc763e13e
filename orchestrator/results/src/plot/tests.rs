//! Tests of what a picture shows, each with a run of its own.

mod overlays;
mod runs;
mod space;
mod time;

use super::labels::overlap;
use super::svg::{Element, INK, Stroke};
use super::*;

/// The picture of a run, which is also written where `LOCKSTEP_PICTURES` names a folder: to be looked at.
fn picture(name: &str, runs: &[Run], selection: &Selection) -> Drawing {
    let drawing = draw(runs.to_vec(), selection).unwrap();
    let again = draw(runs.to_vec(), selection).unwrap();
    assert_eq!(drawing.svg(), again.svg(), "the same run has the same picture");
    if let Some(folder) = std::env::var_os("LOCKSTEP_PICTURES") {
        let path = PathBuf::from(folder).join(name);
        std::fs::write(path.with_extension("svg"), drawing.svg()).unwrap();
        std::fs::write(path.with_extension("png"), drawing.png(2.0).unwrap()).unwrap();
    }
    is_readable(&drawing);
    drawing
}

/// No text covers another or leaves the picture, and every point is a number.
fn is_readable(drawing: &Drawing) {
    let texts = drawing.picture.texts();
    for (index, (one, text)) in texts.iter().enumerate() {
        assert!(one[0] >= 0.0 && one[2] <= drawing.width + 0.5, "{text:?} leaves the picture at {one:?}");
        assert!(one[1] >= 0.0 && one[3] <= drawing.height, "{text:?} leaves the picture at {one:?}");
        for (other, covered) in &texts[..index] {
            let inner = [other[0] + 2.0, other[1], other[2] - 2.0, other[3]];
            assert!(!overlap(one, &inner), "{text:?} at {one:?} covers {covered:?} at {other:?}");
        }
    }
    for element in &drawing.picture.elements {
        let (Element::Lines(_, _) | Element::Area(..)) = element else { continue };
        let points: Vec<_> = match element {
            Element::Lines(pieces, _) => pieces.concat(),
            Element::Area(corners, ..) => corners.clone(),
            _ => Vec::new(),
        };
        for (x, y) in points {
            assert!((-1.0..=drawing.width + 1.0).contains(&x), "{x} of {element:?}");
            assert!((-1.0..=drawing.height + 1.0).contains(&y), "{y} of {element:?}");
        }
    }
}

fn texts(drawing: &Drawing) -> Vec<&str> {
    drawing.picture.texts().into_iter().map(|(_, text)| text).collect()
}

fn has(drawing: &Drawing, text: &str) -> bool {
    texts(drawing).contains(&text)
}

/// The lines at limits: left, right and height of each.
fn limits(drawing: &Drawing) -> Vec<(f64, f64, f64)> {
    let line = |element: &Element| match element {
        // Samples in the legend are shorter.
        Element::Lines(pieces, stroke) if *stroke == Stroke::limit() && pieces[0][1].0 - pieces[0][0].0 != 22.0 => {
            Some((pieces[0][0].0, pieces[0][1].0, pieces[0][0].1))
        }
        _ => None,
    };
    drawing.picture.elements.iter().filter_map(line).collect()
}

/// The rings at worst samples and the triangles at first failures, without those of the legend.
fn rings(drawing: &Drawing) -> usize {
    let is_ring = |element: &&Element| matches!(element, Element::Disc(_, radius, [_, border], _) if *radius == 4.5 && *border == INK);
    drawing.picture.elements.iter().filter(is_ring).count()
}

fn selecting(signals: &[&str]) -> Selection {
    Selection { signals: signals.iter().map(|name| (*name).to_owned()).collect(), ..Selection::default() }
}
