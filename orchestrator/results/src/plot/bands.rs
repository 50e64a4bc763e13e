//! Spans of time: the windows of the script, and the values of discrete signals as coloured bands over all panels.

use super::PlotError;
use super::font::{fitted, width};
use super::panel::{Frame, steps};
use super::run::{Run, Window};
use super::svg::{Anchor, CURVES, INK, Picture, Stroke};
use super::trace::Kind;

/// The height of a row.
const ROW: f64 = 18.0;
const TEXT: f64 = 11.0;
/// More rows of windows would leave no room for curves.
const MOST_ROWS: usize = 8;
/// More spans than this are not told apart.
const MOST_SPANS: usize = 2000;

/// A span of a mode.
#[derive(Debug)]
struct Span {
    from_s: f64,
    to_s: f64,
    colour: &'static str,
    text: String,
}

/// All bands of a picture.
#[derive(Debug, Default)]
pub(super) struct Bands {
    /// Rows of windows that do not overlap.
    rows: Vec<Vec<Window>>,
    /// How many windows have no row.
    left_out: usize,
    /// Each with its name.
    modes: Vec<(String, Vec<Span>)>,
}

impl Bands {
    pub(super) fn new(run: &Run, modes: &[String], ends_s: (f64, f64)) -> Result<Self, PlotError> {
        let mut bands = Self::default();
        for window in &run.windows {
            let to_s = window.to_s.unwrap_or(f64::INFINITY);
            if window.from_s > ends_s.1 || to_s < ends_s.0 {
                continue;
            }
            let is_same = |row: &Vec<Window>| row.last().is_some_and(|last| last.text == window.text);
            match bands.rows.iter().position(is_same) {
                Some(row) => bands.rows[row].push(window.clone()),
                None if bands.rows.len() < MOST_ROWS => bands.rows.push(vec![window.clone()]),
                None => bands.left_out += 1,
            }
        }
        for name in modes {
            bands.modes.push((name.clone(), spans(run, name, ends_s.1)?));
        }
        Ok(bands)
    }

    /// The height of the rows above the panels.
    pub(super) fn height(&self) -> f64 {
        let rows = self.rows.len() + self.modes.len() + usize::from(self.left_out > 0);
        if rows == 0 { 0.0 } else { rows as f64 * ROW + 8.0 }
    }

    /// The names of modes, which stand on the left.
    pub(super) fn left(&self) -> f64 {
        self.modes.iter().map(|(name, _)| width(&fitted(name, TEXT, 130.0), TEXT)).fold(0.0, f64::max)
    }

    /// Draws the rows.
    pub(super) fn draw(&self, picture: &mut Picture, frame: &Frame, mut top: f64) {
        for row in &self.rows {
            for (index, window) in row.iter().enumerate() {
                let [left, right] = ends(frame, window);
                picture.rectangle([left, top + 2.0, right, top + ROW - 2.0], INK, 0.16);
                picture.line((left, top + 2.0), (left, top + ROW - 2.0), Stroke::new(INK, 1.2));
                // The text goes on to the right of a short window; near the right edge it ends there.
                let text = fitted(&window.text, TEXT, frame.right - frame.left - 8.0);
                let x = (left + 4.0).min(frame.right - width(&text, TEXT) - 4.0);
                if index == 0 {
                    picture.text((x, top + 13.0), Anchor::Start, TEXT, INK, &text);
                }
            }
            top += ROW;
        }
        if self.left_out > 0 {
            let text = format!("and {} more", crate::counted(self.left_out, "window"));
            picture.text((frame.left + 4.0, top + 13.0), Anchor::Start, TEXT, INK, &text);
            top += ROW;
        }
        for (name, spans) in &self.modes {
            picture.text((frame.left - 8.0, top + 13.0), Anchor::End, TEXT, INK, &fitted(name, TEXT, 130.0));
            for span in spans {
                let [left, right] = [span.from_s, span.to_s].map(|at| frame.time.pixel(at));
                picture.rectangle([left, top + 1.0, right, top + ROW - 1.0], span.colour, 0.35);
                picture.line((left, top + 1.0), (left, top + ROW - 1.0), Stroke::new(INK, 0.8));
                if width(&span.text, TEXT) + 8.0 < right - left {
                    picture.text((left + 4.0, top + 13.0), Anchor::Start, TEXT, INK, &span.text);
                }
            }
            top += ROW;
        }
    }

    /// Shades a panel between its upper and lower edge.
    pub(super) fn shade(&self, picture: &mut Picture, frame: &Frame, (upper, bottom): (f64, f64)) {
        if let Some((_, spans)) = self.modes.first() {
            for span in spans {
                let [left, right] = [span.from_s, span.to_s].map(|at| frame.time.pixel(at));
                picture.rectangle([left, upper, right, bottom], span.colour, 0.12);
                picture.line((left, upper), (left, bottom), Stroke::new(INK, 0.8).faint(0.25));
            }
        }
        for window in self.rows.iter().flatten() {
            let [left, right] = ends(frame, window);
            picture.rectangle([left, upper, right, bottom], INK, 0.06);
            picture.line((left, upper), (left, bottom), Stroke::new(INK, 0.8).faint(0.4));
            if window.to_s.is_some_and(|to| to <= frame.time.high) {
                picture.line((right, upper), (right, bottom), Stroke::new(INK, 0.8).faint(0.4));
            }
        }
    }
}

/// The left and right end of a window that the picture shows, at least a line wide.
fn ends(frame: &Frame, window: &Window) -> [f64; 2] {
    let at = |time_s: f64| frame.time.pixel(time_s.clamp(frame.time.low, frame.time.high));
    let (left, right) = (at(window.from_s), at(window.to_s.unwrap_or(frame.time.high)));
    [left, right.max(left + 1.5)]
}

/// The spans of one value of a discrete column, each value with a colour of its own.
fn spans(run: &Run, name: &str, end_s: f64) -> Result<Vec<Span>, PlotError> {
    let Some(column) = run.table.column(name) else { return Err(PlotError::Unknown(name.to_owned())) };
    let unfit = |reason: &str| PlotError::Unfit { name: name.to_owned(), reason: reason.to_owned() };
    let kind = run.kind(name);
    if kind == Kind::Real {
        return Err(unfit("a mode is an enumeration, an Integer or a Boolean, this is a Real"));
    }
    let spans = steps(&run.samples(name), end_s);
    if spans.len() > MOST_SPANS {
        return Err(unfit(&format!("it changes {} times; --from and --to show a part", spans.len())));
    }
    let mut values: Vec<_> =
        spans.iter().map(|(_, _, value)| *value).chain(column.items.keys().map(|item| f64::from(*item))).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let text = |value: f64| match kind {
        Kind::Boolean => (if value > 0.5 { "true" } else { "false" }).to_owned(),
        _ => {
            let item = column.items.iter().find(|(item, _)| f64::from(**item) == value);
            item.map_or_else(|| super::scale::label(value), |(_, name)| name.clone())
        }
    };
    let span = |(from_s, to_s, value): (f64, f64, f64)| {
        let index = values.iter().position(|known| *known == value).unwrap_or(0);
        Span { from_s, to_s, colour: CURVES[index % CURVES.len()], text: text(value) }
    };
    Ok(spans.into_iter().map(span).collect())
}
