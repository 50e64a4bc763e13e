//! An SVG picture, built element by element.

use std::fmt::Write;

/// Text colours and the colours of curves; the curves' are told apart by people with any kind of colour vision
/// (Okabe & Ito's set, black left out).
pub(crate) const CURVES: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#999933"];
pub(crate) const INK: &str = "#24292f";
pub(crate) const FAINT_INK: &str = "#6e7781";
pub(crate) const GRID: &str = "#e3e6ea";

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke {
    pub colour: &'static str,
    pub width: f64,
    pub opacity: f64,
    pub dashed: bool,
}

impl Stroke {
    pub(crate) fn new(colour: &'static str, width: f64) -> Self {
        Self { colour, width, opacity: 1.0, dashed: false }
    }

    pub(crate) fn faint(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    pub(crate) fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }

    fn attributes(self) -> String {
        let opacity = if self.opacity < 1.0 { format!(" stroke-opacity=\"{}\"", self.opacity) } else { String::new() };
        let dash = if self.dashed { " stroke-dasharray=\"5 4\"" } else { "" };
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

/// A picture of fixed width that grows downwards.
#[derive(Debug, Default)]
pub(crate) struct Picture {
    body: String,
}

impl Picture {
    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing into a String cannot fail.
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    pub(crate) fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke) {
        self.curve(&[from, to], stroke);
    }

    /// An open line through points in the picture's pixels; points that are no numbers break it.
    pub(crate) fn curve(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        let mut path = String::new();
        let mut pen_down = false;
        for &(x, y) in points {
            if x.is_finite() && y.is_finite() {
                let _ = write!(path, "{}{:.1} {:.1}", if pen_down { 'L' } else { 'M' }, x, y);
            }
            pen_down = x.is_finite() && y.is_finite();
        }
        if !path.is_empty() {
            self.add(format_args!("<path d=\"{path}\" stroke-linejoin=\"round\" {}/>", stroke.attributes()));
        }
    }

    pub(crate) fn polygon(&mut self, points: &[(f64, f64)], colour: &str, opacity: f64) {
        let list: Vec<_> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        self.add(format_args!("<polygon points=\"{}\" fill=\"{colour}\" fill-opacity=\"{opacity}\"/>", list.join(" ")));
    }

    /// A rectangle with round corners: left, top, width and height in pixels.
    pub(crate) fn card(&mut self, [x, y, width, height]: [f64; 4], fill: &str, border: &str) {
        self.add(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"6\" fill=\"{fill}\" stroke=\"{border}\"/>"
        ));
    }

    pub(crate) fn dot(&mut self, (x, y): (f64, f64), radius: f64, colour: &str) {
        self.add(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{colour}\" stroke=\"#fff\" stroke-width=\"1.2\"/>"
        ));
    }

    pub(crate) fn text(&mut self, (x, y): (f64, f64), anchor: Anchor, size: f64, colour: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = escaped(text);
        self.add(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\" fill=\"{colour}\">{text}</text>"
        ));
    }

    /// Names with the colours of their curves, from the left.
    pub(crate) fn legend(&mut self, (mut x, y): (f64, f64), entries: &[(String, Stroke)]) {
        for (name, stroke) in entries {
            self.line((x, y - 4.0), (x + 18.0, y - 4.0), *stroke);
            self.text((x + 24.0, y), Anchor::Start, 12.0, INK, name);
            x += 24.0 + 7.0 * f64::from(u32::try_from(name.chars().count()).unwrap_or(0)) + 22.0;
        }
    }

    /// The whole picture.
    pub(crate) fn finish(self, title: &str, width: f64, height: f64) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif\">\n<title>{}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" rx=\"8\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escaped(title),
            self.body
        )
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_no_number_breaks_the_curve() {
        let mut picture = Picture::default();
        picture.curve(&[(0.0, 0.0), (1.0, 1.0), (f64::NAN, 2.0), (3.0, 3.0), (4.0, 4.0)], Stroke::new("#000", 1.0));
        assert!(picture.body.contains("d=\"M0.0 0.0L1.0 1.0M3.0 3.0L4.0 4.0\""), "{}", picture.body);
    }

    #[test]
    fn names_are_escaped() {
        let mut picture = Picture::default();
        picture.text((0.0, 0.0), Anchor::Start, 12.0, INK, "a<b>&c");
        assert!(picture.finish("t", 1.0, 1.0).contains("a&lt;b&gt;&amp;c"));
    }
}
