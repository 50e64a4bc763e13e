//! Texts that never cover each other, and legends that wrap.

use super::font::{fitted, width};
use super::svg::{Anchor, INK, Picture, Stroke, text_bounds};

/// The size of letters of legends.
const TEXT: f64 = 12.0;
/// The height of a line of a legend.
pub(super) const LINE: f64 = 17.0;
const SAMPLE: f64 = 22.0;
const GAP: f64 = 18.0;

/// The places of a picture that texts need.
#[derive(Debug, Default)]
pub(super) struct Labels {
    taken: Vec<[f64; 4]>,
}

impl Labels {
    /// Writes a text at the first of these places at which it covers no other; returns whether there is one.
    pub(super) fn write(
        &mut self,
        picture: &mut Picture,
        places: &[((f64, f64), Anchor)],
        (size, colour): (f64, &'static str),
        text: &str,
    ) -> bool {
        let is_free = |bounds: &[f64; 4]| !self.taken.iter().any(|other| overlap(bounds, other));
        let place = places.iter().find(|(at, anchor)| is_free(&text_bounds(*at, *anchor, size, text)));
        if let Some(&(at, anchor)) = place {
            self.taken.push(text_bounds(at, anchor, size, text));
            picture.text(at, anchor, size, colour, text);
        }
        place.is_some()
    }
}

/// Whether two rectangles have points in common, or are nearer than texts should be.
pub(super) fn overlap(a: &[f64; 4], b: &[f64; 4]) -> bool {
    let room = 2.0;
    a[0] < b[2] + room && b[0] < a[2] + room && a[1] < b[3] && b[1] < a[3]
}

/// How an entry of a legend is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sample {
    Line(Stroke),
    /// A field of a colour, with its opacity.
    Field(&'static str, f64),
    /// The first sample that fails.
    First,
    /// The worst sample.
    Worst,
    /// Text alone.
    None,
}

/// Names with samples of what they name, in as many lines as they need.
#[derive(Debug, Default)]
pub(super) struct Legend {
    entries: Vec<(Sample, String)>,
}

impl Legend {
    pub(super) fn add(&mut self, sample: Sample, text: impl Into<String>) {
        self.entries.push((sample, text.into()));
    }

    /// The place of each entry from the upper left corner, with its text cut to the room that there is.
    fn places(&self, room: f64) -> Vec<(f64, usize, String)> {
        let (mut x, mut line) = (0.0, 0);
        let place = |(sample, text): &(Sample, String)| {
            let before = if *sample == Sample::None { 0.0 } else { SAMPLE + 6.0 };
            let text = fitted(text, TEXT, room - before);
            let needed = before + width(&text, TEXT);
            if x > 0.0 && x + needed > room {
                (x, line) = (0.0, line + 1);
            }
            let at = x;
            x += needed + GAP;
            (at, line, text)
        };
        self.entries.iter().map(place).collect()
    }

    /// The height that it needs.
    pub(super) fn height(&self, room: f64) -> f64 {
        self.places(room).last().map_or(0.0, |(_, line, _)| (*line as f64 + 1.0) * LINE)
    }

    /// Draws it with its upper left corner at a point.
    pub(super) fn draw(&self, picture: &mut Picture, (left, top): (f64, f64), room: f64) {
        for ((x, line, text), (sample, _)) in self.places(room).into_iter().zip(&self.entries) {
            let (x, y) = (left + x, top + line as f64 * LINE + 0.72 * LINE);
            let middle = (x + SAMPLE / 2.0, y - 4.0);
            match sample {
                Sample::Line(stroke) => picture.line((x, y - 4.0), (x + SAMPLE, y - 4.0), *stroke),
                Sample::Field(colour, opacity) => {
                    picture.rectangle([x, y - 10.0, x + SAMPLE, y + 2.0], colour, *opacity);
                }
                Sample::First => first(picture, middle),
                Sample::Worst => worst(picture, middle),
                Sample::None => {}
            }
            let before = if *sample == Sample::None { 0.0 } else { SAMPLE + 6.0 };
            picture.text((x + before, y), Anchor::Start, TEXT, INK, &text);
        }
    }
}

/// The mark of the first sample that fails: a triangle.
pub(super) fn first(picture: &mut Picture, (x, y): (f64, f64)) {
    let corners = |size: f64| [(x - size, y + 0.8 * size), (x + size, y + 0.8 * size), (x, y - size)];
    picture.polygon(&corners(7.0), "#ffffff", 1.0);
    picture.polygon(&corners(5.5), INK, 1.0);
}

/// The mark of the worst sample: a ring.
pub(super) fn worst(picture: &mut Picture, at: (f64, f64)) {
    picture.ring(at, 4.5, INK);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_wraps_and_its_texts_do_not_overlap() {
        let mut legend = Legend::default();
        for index in 0..12 {
            legend.add(Sample::Line(Stroke::of_curve(index, 1.5)), format!("vehicle[{index}].state.position.x"));
        }
        let mut picture = Picture::default();
        legend.draw(&mut picture, (0.0, 0.0), 500.0);
        assert_eq!(legend.height(500.0), 6.0 * LINE);
        let texts = picture.texts();
        assert!(texts.iter().all(|(bounds, _)| bounds[2] <= 500.0), "{texts:?}");
        for (index, (one, _)) in texts.iter().enumerate() {
            assert!(texts[..index].iter().all(|(other, _)| !overlap(one, other)), "{texts:?}");
        }
    }

    #[test]
    fn a_label_takes_the_first_free_place_or_none() {
        let (mut labels, mut picture) = (Labels::default(), Picture::default());
        let places = [((0.0, 10.0), Anchor::Start), ((0.0, 40.0), Anchor::Start)];
        let written = [0, 1, 2].map(|_| labels.write(&mut picture, &places, (12.0, INK), "text"));
        assert_eq!(written, [true, true, false]);
    }
}
