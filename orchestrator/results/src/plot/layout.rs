//! The whole picture from top to bottom: title, paths, bands, panels, time axis.

use super::bands::Bands;
use super::choice::Choice;
use super::font::fitted;
use super::labels::{LINE, Legend, Sample};
use super::panel::{Frame, Laid};
use super::paths::Space;
use super::run::Run;
use super::scale::{Scale, rounded};
use super::svg::{Anchor, FAINT_INK, INK, Picture, Stroke};
use super::{PlotError, Selection};

const MARGIN: f64 = 16.0;
/// The least room on the left of the panels.
const LEFT: f64 = 48.0;
/// Between panels.
const GAP: f64 = 6.0;

/// Draws the picture; returns it with its height.
pub(super) fn draw(
    runs: &[Run],
    selection: &Selection,
    choice: &Choice,
    width: f64,
) -> Result<(Picture, f64), PlotError> {
    let Some(first) = runs.first() else { return Err(PlotError::Empty) };
    let mut picture = Picture::default();
    let ends_s = times(runs);
    let mut top = head(&mut picture, runs, choice, ends_s, width);
    let space = Space::new(runs, selection, choice)?;
    if !space.is_empty() {
        top += space.draw(&mut picture, selection, top, width) + 4.0;
    }
    let bands = Bands::new(first, &selection.modes, ends_s)?;
    let panels: Vec<_> = choice.panels.iter().map(|panel| Laid::new(panel, ends_s)).collect();
    if panels.is_empty() && bands.height() == 0.0 {
        return Ok((picture, top + MARGIN));
    }
    let left = panels.iter().map(Laid::left).fold(bands.left(), f64::max);
    let (left, right) = ((left + 12.0).max(LEFT) + MARGIN / 2.0, width - MARGIN - 8.0);
    let time = Scale { low: ends_s.0, high: ends_s.1, first_pixel: left, last_pixel: right };
    let frame = Frame { left, right, time };
    bands.draw(&mut picture, &frame, top);
    top += bands.height();
    let mut bottom = top;
    for panel in &panels {
        panel.draw(&mut picture, &frame, &bands, top);
        // Below the field of a panel is room for the lowest number of its axis.
        bottom = top + panel.height(&frame) - 14.0;
        top += panel.height(&frame) + GAP;
    }
    if panels.is_empty() {
        picture.line((left, bottom), (right, bottom), Stroke::new(FAINT_INK, 1.0));
    }
    frame.time_axis(&mut picture, bottom);
    Ok((picture, (bottom + 44.0).ceil()))
}

/// The times that all panels show, not quite equal.
fn times(runs: &[Run]) -> (f64, f64) {
    let rows = || runs.iter().flat_map(|run| run.table.time_s());
    let (first, last) = (rows().fold(f64::INFINITY, f64::min), rows().fold(f64::NEG_INFINITY, f64::max));
    (first, last.max(first + 1e-9 * (1.0 + first.abs())))
}

/// Title, what is shown of how much, and which line is which run; returns where the rest begins.
fn head(picture: &mut Picture, runs: &[Run], choice: &Choice, ends_s: (f64, f64), width: f64) -> f64 {
    let room = width - 2.0 * MARGIN;
    let names = runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>().join(" and ");
    let Some(first) = runs.first() else { return MARGIN };
    let title = if first.title.is_empty() { &names } else { &first.title };
    picture.text((MARGIN, 27.0), Anchor::Start, 16.0, INK, &fitted(title, 16.0, room));
    let (shown, all) = choice.shown;
    let mut facts = Legend::default();
    if !first.title.is_empty() {
        facts.add(Sample::None, names);
    }
    first.set.iter().for_each(|set| facts.add(Sample::None, set.as_str()));
    facts.add(Sample::None, format!("{} s to {} s", rounded(ends_s.0), rounded(ends_s.1)));
    facts.add(Sample::None, format!("{shown} of {}", crate::counted(all, "signal")));
    if !first.claims.is_empty() {
        let failed: Vec<_> =
            first.claims.iter().filter(|claim| claim.verdict == "failed").map(|claim| claim.name.as_str()).collect();
        let held = first.claims.iter().filter(|claim| ["ok", "untested"].contains(&claim.verdict.as_str())).count();
        let failed = if failed.is_empty() { String::new() } else { format!(", failed: {}", failed.join(", ")) };
        let verb = if first.claims.len() == 1 { "holds" } else { "hold" };
        facts.add(Sample::None, format!("{held} of {} {verb}{failed}", crate::counted(first.claims.len(), "claim")));
    }
    if !first.end.is_empty() && first.end != "stop time" {
        facts.add(Sample::None, format!("end: {}", first.end));
    } else if first.table.partial {
        facts.add(Sample::None, "did not come to its end");
    }
    facts.draw(picture, (MARGIN, 34.0), room);
    let mut top = 34.0 + facts.height(room);
    if let [_, others @ ..] = runs
        && !others.is_empty()
    {
        let mut which = Legend::default();
        which.add(Sample::Line(Stroke::new(INK, 1.6)), format!("thin: {}", first.name));
        for (index, other) in others.iter().enumerate() {
            let word = if index == 0 { "broad" } else { "broader" };
            let set = if other.set.is_empty() { String::new() } else { format!(" ({})", other.set.join(", ")) };
            which.add(Sample::Line(Stroke::new(INK, 1.6).of_other(index + 1)), format!("{word}: {}{set}", other.name));
        }
        which.draw(picture, (MARGIN, top), room);
        top += which.height(room);
    }
    top + LINE / 2.0
}
