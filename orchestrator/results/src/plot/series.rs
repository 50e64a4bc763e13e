//! Signals over time, one panel for each group of one unit.

use super::scale::{Scale, label};
use super::svg::{Anchor, CURVES, FAINT_INK, GRID, INK, Picture, Stroke};

/// A panel's height in pixels, legend and axis included.
pub(super) const HEIGHT: f64 = 190.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 24.0;

/// What one panel shows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Panel {
    pub unit: String,
    pub curves: Vec<Curve>,
}

/// One signal.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub name: String,
    pub values: Vec<f64>,
}

/// Draws a panel whose upper edge is at `top`.
pub(super) fn draw(picture: &mut Picture, panel: &Panel, time_s: &[f64], top: f64, width: f64) {
    let ends = (time_s.first().copied().unwrap_or(0.0), time_s.last().copied().unwrap_or(1.0).max(1e-9));
    let across = Scale { low: ends.0, high: ends.1, first_pixel: LEFT, last_pixel: width - RIGHT };
    let (bottom, upper) = (top + HEIGHT - 34.0, top + 30.0);
    let values = panel.curves.iter().flat_map(|curve| curve.values.iter().copied());
    let up = Scale::around(values, bottom, upper);
    for tick in up.ticks(4.0) {
        picture.line((LEFT, up.pixel(tick)), (width - RIGHT, up.pixel(tick)), Stroke::new(GRID, 1.0));
        picture.text((LEFT - 8.0, up.pixel(tick) + 4.0), Anchor::End, 11.0, FAINT_INK, &label(tick));
    }
    for tick in across.ticks(9.0) {
        picture.line((across.pixel(tick), bottom), (across.pixel(tick), bottom + 4.0), Stroke::new(FAINT_INK, 1.0));
        picture.text((across.pixel(tick), bottom + 17.0), Anchor::Middle, 11.0, FAINT_INK, &label(tick));
    }
    picture.line((LEFT, bottom), (width - RIGHT, bottom), Stroke::new(FAINT_INK, 1.0));
    picture.text((width - RIGHT, bottom + 30.0), Anchor::End, 11.0, FAINT_INK, "time, s");
    if !panel.unit.is_empty() {
        picture.text((LEFT - 8.0, top + 18.0), Anchor::End, 11.0, INK, &panel.unit);
    }
    let strokes = CURVES.iter().cycle().map(|colour| Stroke::new(colour, 1.5));
    let mut legend = Vec::new();
    for (curve, stroke) in panel.curves.iter().zip(strokes) {
        let points = thinned(time_s, &curve.values, &across);
        let pixels: Vec<_> = points.iter().map(|&(t, v)| (across.pixel(t), up.pixel(v))).collect();
        picture.curve(&pixels, stroke);
        legend.push((curve.name.clone(), stroke));
    }
    picture.legend((LEFT, top + 18.0), &legend);
}

/// First, smallest, largest and last sample of every two pixels, so that a long run draws small and no peak is lost.
fn thinned(time_s: &[f64], values: &[f64], across: &Scale) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let samples: Vec<_> = time_s.iter().copied().zip(values.iter().copied()).filter(|(_, v)| !v.is_nan()).collect();
    for bucket in samples.chunk_by(|a, b| (across.pixel(a.0) / 2.0).floor() == (across.pixel(b.0) / 2.0).floor()) {
        let by_value = |index: &usize, other: &usize| bucket[*index].1.total_cmp(&bucket[*other].1);
        let last = bucket.len() - 1;
        let low = (0..=last).min_by(by_value).unwrap_or(0);
        let high = (0..=last).max_by(by_value).unwrap_or(0);
        let mut indices = [0, low, high, last];
        indices.sort_unstable();
        let mut unique = indices.to_vec();
        unique.dedup();
        kept.extend(unique.into_iter().map(|index| bucket[index]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_peaks() {
        let time_s: Vec<_> = (0..10_000).map(f64::from).collect();
        let mut values = vec![0.0; 10_000];
        values[5_003] = 7.0;
        let across = Scale { low: 0.0, high: 10_000.0, first_pixel: 0.0, last_pixel: 100.0 };
        let kept = thinned(&time_s, &values, &across);
        assert!(kept.len() <= 200, "{}", kept.len());
        assert!(kept.contains(&(5_003.0, 7.0)));
    }
}
