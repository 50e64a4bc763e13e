//! A picture as a list of shapes and texts, and its form as SVG.

use super::font;
use std::fmt::Write;

/// Text colours and the colours of curves; the curves' are told apart by people with any kind of colour vision
/// (Okabe & Ito's set, black left out).
pub(crate) const CURVES: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#999933"];
pub(crate) const INK: &str = "#24292f";
pub(crate) const FAINT_INK: &str = "#6e7781";
pub(crate) const GRID: &str = "#e3e6ea";
/// The dashes of curves of one panel: without colours they are told apart by these.
const DASHES: [Option<&str>; 5] = [None, Some("7 3"), Some("2 3"), Some("10 3 2 3"), Some("5 2 1 2 1 2")];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub colour: &'static str,
    pub width: f64,
    pub opacity: f64,
    /// Lengths of dashes and gaps in pixels.
    pub dash: Option<&'static str>,
}

impl Stroke {
    pub(crate) fn new(colour: &'static str, width: f64) -> Self {
        Self { colour, width, opacity: 1.0, dash: None }
    }

    /// The line of the curve with this number in its panel.
    pub(crate) fn of_curve(index: usize, width: f64) -> Self {
        Self { dash: DASHES[index % DASHES.len()], ..Self::new(CURVES[index % CURVES.len()], width) }
    }

    /// The same curve of another run, counted from 1: the broader and the paler, the later the run.
    pub(crate) fn of_other(self, run: usize) -> Self {
        let run = run as f64;
        Self { width: (1.0 + 2.0 * run) * self.width, opacity: 0.35 / run, dash: None, ..self }
    }

    pub(crate) fn faint(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    pub(crate) fn dashed(self) -> Self {
        Self { dash: Some("5 4"), ..self }
    }

    /// A line at a limit.
    pub(crate) fn limit() -> Self {
        Self { dash: Some("8 3 2 3"), ..Self::new(INK, 1.2) }
    }

    fn attributes(self) -> String {
        let opacity = if self.opacity < 1.0 { format!(" stroke-opacity=\"{}\"", self.opacity) } else { String::new() };
        let dash = self.dash.map_or_else(String::new, |dash| format!(" stroke-dasharray=\"{dash}\""));
        format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{opacity}{dash}", self.colour, self.width)
    }
}

/// The point of a text that its position refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A shape or a text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Element {
    /// Open lines through points.
    Lines(Vec<Vec<(f64, f64)>>, Stroke),
    /// A filled area: its corners, colour and opacity.
    Area(Vec<(f64, f64)>, &'static str, f64),
    /// A rectangle with round corners: left, top, width and height, fill and border.
    Card([f64; 4], &'static str, &'static str),
    /// A disc: middle, radius, fill, border and the width of that.
    Disc((f64, f64), f64, [&'static str; 2], f64),
    /// Position, anchor, size, colour, text.
    Text((f64, f64), Anchor, f64, &'static str, String),
}

/// A picture of fixed width that grows downwards.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Picture {
    pub elements: Vec<Element>,
}

impl Picture {
    pub(crate) fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        self.curve(&[from, to], stroke);
    }

    /// An open line through points in the picture's pixels; points that are no numbers break it.
    pub(crate) fn curve(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        let is_number = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
        let pieces = points.split(|point| !is_number(point)).filter(|piece| !piece.is_empty());
        let pieces: Vec<_> = pieces.map(<[_]>::to_vec).collect();
        if !pieces.is_empty() {
            self.elements.push(Element::Lines(pieces, stroke));
        }
    }

    pub(crate) fn polygon(&mut self, points: &[(f64, f64)], colour: &'static str, opacity: f64) {
        self.elements.push(Element::Area(points.to_vec(), colour, opacity));
    }

    /// A filled rectangle: left, top, right and bottom.
    pub(crate) fn rectangle(&mut self, [left, top, right, bottom]: [f64; 4], colour: &'static str, opacity: f64) {
        self.polygon(&[(left, top), (right, top), (right, bottom), (left, bottom)], colour, opacity);
    }

    /// A rectangle with round corners: left, top, width and height in pixels.
    pub(crate) fn card(&mut self, bounds: [f64; 4], fill: &'static str, border: &'static str) {
        self.elements.push(Element::Card(bounds, fill, border));
    }

    pub(crate) fn dot(&mut self, at: (f64, f64), radius: f64, colour: &'static str) {
        self.elements.push(Element::Disc(at, radius, [colour, "#fff"], 1.2));
    }

    /// A circle that is white inside.
    pub(crate) fn ring(&mut self, at: (f64, f64), radius: f64, colour: &'static str) {
        self.elements.push(Element::Disc(at, radius, ["#fff", colour], 1.8));
    }

    pub(crate) fn text(&mut self, at: (f64, f64), anchor: Anchor, size: f64, colour: &'static str, text: &str) {
        self.elements.push(Element::Text(at, anchor, size, colour, text.to_owned()));
    }

    /// Names with the colours of their curves, from the left.
    pub(crate) fn legend(&mut self, (mut x, y): (f64, f64), entries: &[(String, Stroke)]) {
        for (name, stroke) in entries {
            self.line((x, y - 4.0), (x + 18.0, y - 4.0), *stroke);
            self.text((x + 24.0, y), Anchor::Start, 12.0, INK, name);
            x += 24.0 + 7.0 * f64::from(u32::try_from(name.chars().count()).unwrap_or(0)) + 22.0;
        }
    }

    /// The whole picture as SVG.
    pub(crate) fn finish(&self, title: &str, width: f64, height: f64) -> String {
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif\">\n<title>{}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" rx=\"8\" fill=\"#ffffff\"/>\n",
            escaped(title),
        );
        for element in &self.elements {
            text.push_str(&element.svg());
            text.push('\n');
        }
        text + "</svg>\n"
    }

    /// The place of each text: left, top, right, bottom.
    #[cfg(test)]
    pub(crate) fn texts(&self) -> Vec<([f64; 4], &str)> {
        let placed = |element| match element {
            &Element::Text(at, anchor, size, _, ref text) => Some((text_bounds(at, anchor, size, text), text.as_str())),
            _ => None,
        };
        self.elements.iter().filter_map(placed).collect()
    }
}

/// The rectangle that a text needs: left, top, right, bottom.
pub(super) fn text_bounds((x, y): (f64, f64), anchor: Anchor, size: f64, text: &str) -> [f64; 4] {
    let width = font::width(text, size);
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - width / 2.0,
        Anchor::End => x - width,
    };
    [left, y - 0.76 * size, left + width, y + 0.24 * size]
}

impl Element {
    fn svg(&self) -> String {
        match self {
            Self::Lines(pieces, stroke) => {
                let mut path = String::new();
                for (x, y, command) in pieces.iter().flat_map(|piece| {
                    piece.iter().enumerate().map(|(index, (x, y))| (x, y, if index == 0 { 'M' } else { 'L' }))
                }) {
                    // Writing into a String cannot fail.
                    let _ = write!(path, "{command}{x:.1} {y:.1}");
                }
                format!("<path d=\"{path}\" stroke-linejoin=\"round\" {}/>", stroke.attributes())
            }
            Self::Area(corners, colour, opacity) => {
                let list: Vec<_> = corners.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
                format!("<polygon points=\"{}\" fill=\"{colour}\" fill-opacity=\"{opacity}\"/>", list.join(" "))
            }
            Self::Card([x, y, width, height], fill, border) => format!(
                "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"6\" fill=\"{fill}\" stroke=\"{border}\"/>"
            ),
            Self::Disc((x, y), radius, [fill, border], width) => format!(
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"{border}\" stroke-width=\"{width}\"/>"
            ),
            Self::Text((x, y), anchor, size, colour, text) => {
                let anchor = match anchor {
                    Anchor::Start => "start",
                    Anchor::Middle => "middle",
                    Anchor::End => "end",
                };
                let text = escaped(text);
                format!(
                    "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\" fill=\"{colour}\">{text}</text>"
                )
            }
        }
    }
}

/// The text as XML can contain it.
fn escaped(text: &str) -> String {
    let printable: String = text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    printable.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_no_number_breaks_the_curve() {
        let mut picture = Picture::default();
        picture.curve(&[(0.0, 0.0), (1.0, 1.0), (f64::NAN, 2.0), (3.0, 3.0), (4.0, 4.0)], Stroke::new("#000", 1.0));
        let svg = picture.finish("t", 1.0, 1.0);
        assert!(svg.contains("d=\"M0.0 0.0L1.0 1.0M3.0 3.0L4.0 4.0\""), "{svg}");
    }

    #[test]
    fn names_are_escaped() {
        let mut picture = Picture::default();
        picture.text((0.0, 0.0), Anchor::Start, 12.0, INK, "a<b>&c\u{1}d");
        assert!(picture.finish("t", 1.0, 1.0).contains("a&lt;b&gt;&amp;c d"));
    }

    #[test]
    fn the_curves_of_a_panel_differ_without_colours() {
        let strokes: Vec<_> = (0..5).map(|index| Stroke::of_curve(index, 1.5).dash).collect();
        assert!((0..5).all(|one| (0..one).all(|other| strokes[one] != strokes[other])), "{strokes:?}");
        assert!(Stroke::of_curve(0, 1.5).of_other(1).width > 3.0);
    }
}
