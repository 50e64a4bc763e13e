//! Signals over time: one panel for each group of one unit, all over one time axis.

use super::bands::Bands;
use super::choice::Panel;
use super::claimed::{Limit, value_at};
use super::font::{fitted, width};
use super::labels::{self, Labels, Legend, Sample};
use super::scale::{Axis, Scale, ends, extent, label, rounded};
use super::svg::{Anchor, CURVES, FAINT_INK, GRID, INK, Picture, Stroke};
use super::trace::{Kind, Samples};

/// The size of letters at ticks.
pub(super) const TICK: f64 = 11.0;
/// The widest name at a tick.
const WIDEST: f64 = 130.0;
/// A limit that would make the range this many times larger is not drawn: the curves would be flat.
const FARTHEST: f64 = 4.0;

/// Where panels are: the left and right end of the time axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub left: f64,
    pub right: f64,
    pub time: Scale,
}

/// A panel with its axis.
pub(super) struct Laid<'a> {
    panel: &'a Panel,
    axis: Axis,
    legend: Legend,
    /// Limits beyond the axis are only named.
    limits: Vec<&'a Limit>,
}

impl<'a> Laid<'a> {
    pub(super) fn new(panel: &'a Panel, ends_s: (f64, f64)) -> Self {
        let values = || panel.curves.iter().flat_map(|curve| curve.of_runs.iter().flatten().map(|(_, value)| *value));
        let range = extent(values());
        let is_near = |limit: &&Limit| {
            let with = extent(values().chain(limit.low).chain(limit.high));
            with.1 - with.0 <= FARTHEST * (range.1 - range.0)
        };
        let in_time = |limit: &&Limit| limit.from_s <= ends_s.1 && limit.to_s.is_none_or(|to| to >= ends_s.0);
        let limits: Vec<_> = panel.limits.iter().filter(in_time).filter(is_near).collect();
        let all = values().chain(limits.iter().flat_map(|limit| limit.low.into_iter().chain(limit.high)));
        let axis = match panel.kind {
            Kind::Real => Axis::around(extent(all), 4.0),
            Kind::Integer => Axis::of_integers(ends(all).unwrap_or((0.0, 1.0)), 4.0),
            Kind::Boolean => Axis { low: -0.2, high: 1.2, ticks: vec![0.0, 1.0], step: 1.0 },
            Kind::Enumeration => {
                let ticks: Vec<_> = panel.items.keys().map(|value| f64::from(*value)).collect();
                let (low, high) = ends(ticks.iter().copied().chain(values())).unwrap_or((0.0, 1.0));
                Axis { low: low - 0.5, high: high + 0.5, ticks, step: 1.0 }
            }
        };
        let mut laid = Self { panel, axis, legend: Legend::default(), limits };
        laid.name(ends_s);
        laid
    }

    /// What the legend says: curves, limits, and the points that are marked.
    fn name(&mut self, ends_s: (f64, f64)) {
        let (panel, legend) = (self.panel, &mut self.legend);
        if !panel.unit.is_empty() {
            legend.add(Sample::None, format!("[{}]", panel.unit));
        }
        for (index, curve) in panel.curves.iter().enumerate() {
            legend.add(Sample::Line(Stroke::of_curve(index, 1.8)), curve.name.as_str());
        }
        let mut named: Vec<&str> = Vec::new();
        let is_one = panel.limits.windows(2).all(|pair| pair[0].claim == pair[1].claim);
        for limit in &panel.limits {
            let is_drawn = self.limits.contains(&limit);
            let outside = if is_drawn { "" } else { " (outside)" };
            let sample = if is_drawn { Sample::Line(Stroke::limit()) } else { Sample::None };
            // A claim may limit several curves of a panel alike.
            if !named.contains(&limit.text.as_str()) {
                named.push(&limit.text);
                legend.add(sample, format!("{}{outside}", limit.text));
            }
            let in_time = |at: &f64| (ends_s.0..=ends_s.1).contains(at);
            let value = |at: f64| {
                let samples = panel.curves.get(limit.curve).and_then(|curve| curve.of_runs.first());
                samples.and_then(|samples| value_at(samples, at)).map_or_else(String::new, rounded)
            };
            // Of several claims each mark says which it is of.
            let of = if is_one { String::new() } else { format!("{} ", limit.claim) };
            if let Some(at) = limit.first_s.filter(in_time) {
                legend.add(Sample::First, format!("{of}fails first at {} s", label(at)));
            }
            if let Some(at) = limit.worst_s.filter(in_time) {
                let word = if limit.once { "best" } else { "worst" };
                legend.add(Sample::Worst, format!("{of}{word} {} at {} s", value(at), label(at)));
            }
        }
    }

    fn tick_text(&self, tick: f64) -> String {
        match self.panel.kind {
            Kind::Boolean => (if tick > 0.5 { "true" } else { "false" }).to_owned(),
            Kind::Enumeration => {
                let item = self.panel.items.iter().find(|(value, _)| f64::from(**value) == tick);
                item.map_or_else(|| rounded(tick), |(_, name)| fitted(name, TICK, WIDEST))
            }
            Kind::Real | Kind::Integer => self.axis.label(tick),
        }
    }

    /// The room that its ticks need on the left.
    pub(super) fn left(&self) -> f64 {
        self.axis.ticks.iter().map(|tick| width(&self.tick_text(*tick), TICK)).fold(0.0, f64::max)
    }

    /// The height of the field of its curves.
    fn field(&self) -> f64 {
        match self.panel.kind {
            Kind::Real | Kind::Integer => 118.0,
            Kind::Boolean => 40.0,
            Kind::Enumeration => (18.0 * (self.axis.high - self.axis.low)).clamp(54.0, 180.0),
        }
    }

    /// The height that it needs, with its legend, without the time axis.
    pub(super) fn height(&self, frame: &Frame) -> f64 {
        self.legend.height(frame.right - frame.left) + self.field() + 20.0
    }

    /// Draws it with its upper edge at `top`.
    pub(super) fn draw(&self, picture: &mut Picture, frame: &Frame, bands: &Bands, top: f64) {
        self.legend.draw(picture, (frame.left, top), frame.right - frame.left);
        let upper = top + self.legend.height(frame.right - frame.left) + 6.0;
        let bottom = upper + self.field();
        let up = Scale { low: self.axis.low, high: self.axis.high, first_pixel: bottom, last_pixel: upper };
        if self.panel.kind == Kind::Enumeration {
            self.fields(picture, frame, (upper, bottom));
        }
        bands.shade(picture, frame, (upper, bottom));
        self.grid(picture, frame, &up);
        for limit in &self.limits {
            for value in limit.low.into_iter().chain(limit.high) {
                let [from, to] = [limit.from_s, limit.to_s.unwrap_or(frame.time.high)]
                    .map(|at| frame.time.pixel(at.clamp(frame.time.low, frame.time.high)));
                let y = up.pixel(value);
                picture.line((from, y), (to.max(from + 4.0), y), Stroke::limit());
            }
        }
        self.curves(picture, frame, &up);
        for limit in &self.limits {
            let samples = self.panel.curves.get(limit.curve).and_then(|curve| curve.of_runs.first());
            let at = |at_s: Option<f64>| {
                let at_s = at_s.filter(|at| (frame.time.low..=frame.time.high).contains(at))?;
                Some((frame.time.pixel(at_s), up.pixel(value_at(samples?, at_s)?)))
            };
            if let Some(point) = at(limit.worst_s) {
                labels::worst(picture, point);
            }
            if let Some(point) = at(limit.first_s) {
                labels::first(picture, point);
            }
        }
        picture.line((frame.left, bottom), (frame.right, bottom), Stroke::new(FAINT_INK, 1.0));
    }

    /// The values of an enumeration as coloured fields behind its curve.
    fn fields(&self, picture: &mut Picture, frame: &Frame, (upper, bottom): (f64, f64)) {
        let samples = self.panel.curves.first().and_then(|curve| curve.of_runs.first());
        for (from, to, value) in samples.into_iter().flat_map(|samples| steps(samples, frame.time.high)) {
            let index = self.panel.items.keys().position(|item| f64::from(*item) == value).unwrap_or(0);
            let [left, right] = [from, to].map(|at| frame.time.pixel(at));
            picture.rectangle([left, upper, right, bottom], CURVES[index % CURVES.len()], 0.16);
        }
    }

    fn grid(&self, picture: &mut Picture, frame: &Frame, up: &Scale) {
        for &tick in &frame.ticks().0 {
            let x = frame.time.pixel(tick);
            picture.line((x, up.first_pixel), (x, up.last_pixel), Stroke::new(GRID, 1.0));
        }
        let mut taken = Labels::default();
        // The ends are read first; between them stands what has room.
        let mut order: Vec<_> = (0..self.axis.ticks.len()).collect();
        order.sort_by_key(|&index| (index > 0 && index + 1 < self.axis.ticks.len(), index));
        for index in order {
            let tick = self.axis.ticks[index];
            let y = up.pixel(tick);
            picture.line((frame.left, y), (frame.right, y), Stroke::new(GRID, 1.0));
            let place = ((frame.left - 8.0, y + 4.0), Anchor::End);
            taken.write(picture, &[place], (TICK, FAINT_INK), &self.tick_text(tick));
        }
    }

    fn curves(&self, picture: &mut Picture, frame: &Frame, up: &Scale) {
        let runs = self.panel.curves.iter().map(|curve| curve.of_runs.len()).max().unwrap_or(0);
        for run in (0..runs).rev() {
            for (index, curve) in self.panel.curves.iter().enumerate() {
                let stroke = Stroke::of_curve(index, 1.5);
                let stroke = if run == 0 { stroke } else { stroke.of_other(run) };
                let Some(samples) = curve.of_runs.get(run) else { continue };
                let shown = match self.panel.kind {
                    Kind::Real => thinned(samples, &frame.time),
                    _ => stairs(samples, frame.time.high, &frame.time),
                };
                // What is too large for any picture leaves the panel, not the page.
                let place = |value: f64| up.pixel(value).clamp(up.last_pixel - 1.0, up.first_pixel + 1.0);
                let pixels: Vec<_> = shown.iter().map(|&(t, v)| (frame.time.pixel(t), place(v))).collect();
                picture.curve(&pixels, stroke);
            }
        }
    }
}

impl Frame {
    /// The times with a line, and their distance.
    pub(super) fn ticks(&self) -> (Vec<f64>, f64) {
        let axis = super::scale::ticks(self.time.low, self.time.high, ((self.right - self.left) / 90.0).max(3.0));
        match axis.0.len() {
            3.. => axis,
            _ => super::scale::ticks(self.time.low, self.time.high, 6.0),
        }
    }

    /// The time axis below the last panel.
    pub(super) fn time_axis(&self, picture: &mut Picture, bottom: f64) {
        let (ticks, step) = self.ticks();
        let mut labels = Labels::default();
        let title = ((self.right, bottom + 32.0), Anchor::End);
        labels.write(picture, &[title], (TICK, INK), "time [s]");
        for &tick in &ticks {
            let x = self.time.pixel(tick);
            picture.line((x, bottom), (x, bottom + 4.0), Stroke::new(FAINT_INK, 1.0));
            let text = super::scale::label_in_steps(tick, step);
            labels.write(picture, &[((x, bottom + 17.0), Anchor::Middle)], (TICK, FAINT_INK), &text);
        }
        let text = rounded(self.time.high);
        if ticks.last().is_some_and(|last| self.time.high - last > 0.05 * step) {
            picture.line((self.right, bottom), (self.right, bottom + 4.0), Stroke::new(FAINT_INK, 1.0));
            labels.write(picture, &[((self.right, bottom + 17.0), Anchor::End)], (TICK, FAINT_INK), &text);
        }
    }
}

/// Spans of equal values: from, to, value; the last one lasts to the end.
pub(super) fn steps(samples: &[(f64, f64)], end_s: f64) -> Vec<(f64, f64, f64)> {
    let mut spans: Vec<(f64, f64, f64)> = Vec::new();
    for &(time_s, value) in samples {
        if let Some(span) = spans.last_mut() {
            span.1 = time_s;
        }
        if spans.last().is_none_or(|span| span.2 != value) {
            spans.push((time_s, time_s, value));
        }
    }
    if let Some(span) = spans.last_mut() {
        span.1 = span.1.max(end_s);
    }
    spans
}

/// The corners of stairs: a value holds until the next. Changes that are nearer than half a pixel become a vertical line.
fn stairs(samples: &[(f64, f64)], end_s: f64, across: &Scale) -> Samples {
    let corners = steps(samples, end_s).into_iter().flat_map(|(from, to, value)| [(from, value), (to, value)]);
    thinned(&corners.collect::<Vec<_>>(), across)
}

/// First, smallest, largest and last sample of every two pixels, so that a long run draws small and no peak is lost.
fn thinned(samples: &[(f64, f64)], across: &Scale) -> Samples {
    let mut kept: Samples = Vec::new();
    let place = |sample: &(f64, f64)| across.pixel(sample.0).floor();
    for bucket in samples.chunk_by(|a, b| place(a) == place(b)) {
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

    const ACROSS: Scale = Scale { low: 0.0, high: 10_000.0, first_pixel: 0.0, last_pixel: 100.0 };

    #[test]
    fn thinning_keeps_the_peaks() {
        let mut samples: Samples = (0..10_000).map(|time| (f64::from(time), 0.0)).collect();
        samples[5_003].1 = 7.0;
        let kept = thinned(&samples, &ACROSS);
        assert!(kept.len() <= 300, "{}", kept.len());
        assert!(kept.contains(&(5_003.0, 7.0)));
    }

    #[test]
    fn a_discrete_value_holds_until_the_next() {
        let samples = [(0.0, 1.0), (1000.0, 1.0), (4000.0, 3.0)];
        assert_eq!(steps(&samples, 9000.0), [(0.0, 4000.0, 1.0), (4000.0, 9000.0, 3.0)]);
        let corners = [(0.0, 1.0), (4000.0, 1.0), (4000.0, 3.0), (9000.0, 3.0)];
        assert_eq!(stairs(&samples, 9000.0, &ACROSS), corners);
    }
}
