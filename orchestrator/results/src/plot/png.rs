//! A picture as PNG: the shapes of the SVG drawn by pixels, texts as outlines of the program's own font.

use super::font::{self, OutlineBuilder};
use super::svg::{Anchor, Element, Picture, Stroke, text_bounds};
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Rect, StrokeDash, Transform};

/// More pixels would need more memory than a picture is worth.
const MOST_PIXELS: f64 = 2e8;

impl Picture {
    /// The whole picture, `scale` pixels for each of the SVG's; `None` where it would be too large.
    pub(crate) fn png(&self, width: f64, height: f64, scale: f64) -> Option<Vec<u8>> {
        let (columns, rows) = ((width * scale).ceil(), (height * scale).ceil());
        let is_possible = columns * rows <= MOST_PIXELS;
        if !is_possible {
            return None;
        }
        let mut pixels = Pixmap::new(columns as u32, rows as u32)?;
        pixels.fill(Color::WHITE);
        let mut canvas = Canvas { pixels, transform: Transform::from_scale(scale as f32, scale as f32) };
        self.elements.iter().for_each(|element| canvas.element(element));
        canvas.pixels.encode_png().ok()
    }
}

struct Canvas {
    pixels: Pixmap,
    transform: Transform,
}

impl Canvas {
    fn element(&mut self, element: &Element) {
        match element {
            Element::Lines(pieces, stroke) => {
                if let Some(path) = path(pieces, false) {
                    self.stroke(&path, *stroke);
                }
            }
            Element::Area(corners, colour, opacity) => {
                if let Some(path) = path(std::slice::from_ref(corners), true) {
                    self.fill(&path, colour, *opacity);
                }
            }
            Element::Card([x, y, width, height], fill, border) => {
                let bounds = Rect::from_xywh(*x as f32, *y as f32, *width as f32, *height as f32);
                if let Some(path) = bounds.map(PathBuilder::from_rect) {
                    self.fill(&path, fill, 1.0);
                    self.stroke(&path, Stroke::new(border, 1.0));
                }
            }
            Element::Disc((x, y), radius, [fill, border], width) => {
                if let Some(path) = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32) {
                    self.fill(&path, fill, 1.0);
                    self.stroke(&path, Stroke::new(border, *width));
                }
            }
            Element::Text(at, anchor, size, colour, text) => self.text(*at, *anchor, (*size, colour), text),
        }
    }

    fn fill(&mut self, path: &Path, colour: &str, opacity: f64) {
        self.pixels.fill_path(path, &paint(colour, opacity), FillRule::Winding, self.transform, None);
    }

    fn stroke(&mut self, path: &Path, stroke: Stroke) {
        let lengths = stroke.dash.map(|dash| dash.split(' ').filter_map(|length| length.parse().ok()).collect());
        let line = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_join: LineJoin::Round,
            line_cap: LineCap::Butt,
            dash: lengths.and_then(|lengths: Vec<f32>| StrokeDash::new(lengths, 0.0)),
            ..tiny_skia::Stroke::default()
        };
        self.pixels.stroke_path(path, &paint(stroke.colour, stroke.opacity), &line, self.transform, None);
    }

    fn text(&mut self, at: (f64, f64), anchor: Anchor, (size, colour): (f64, &str), text: &str) {
        let [mut x, ..] = text_bounds(at, anchor, size, text);
        let mut letters = Letters { builder: PathBuilder::new(), x: 0.0, y: at.1 as f32, scale: 1.0 };
        for letter in text.chars() {
            letters.x = x as f32;
            let mut outline = Outline::default();
            if let Some(units) = font::outline(letter, &mut outline) {
                letters.scale = (size / units) as f32;
                letters.add(&outline);
            }
            x += size * font::advance(letter);
        }
        if let Some(path) = letters.builder.finish() {
            self.fill(&path, colour, 1.0);
        }
    }
}

fn path(pieces: &[Vec<(f64, f64)>], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for piece in pieces {
        for (index, &(x, y)) in piece.iter().enumerate() {
            if index == 0 { builder.move_to(x as f32, y as f32) } else { builder.line_to(x as f32, y as f32) }
        }
        if closed {
            builder.close();
        }
    }
    builder.finish()
}

/// The colour `#rgb` or `#rrggbb`.
fn paint(colour: &str, opacity: f64) -> Paint<'static> {
    let digits: Vec<_> = colour.chars().filter_map(|digit| digit.to_digit(16)).collect();
    let part = |index: usize| match digits.as_slice() {
        short @ [_, _, _] => 17 * short[index],
        long => long.get(2 * index).zip(long.get(2 * index + 1)).map_or(0, |(high, low)| 16 * high + low),
    };
    let [red, green, blue] = [0, 1, 2].map(|index| u8::try_from(part(index)).unwrap_or(u8::MAX));
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, (255.0 * opacity).round() as u8);
    paint
}

/// The outline of a letter in units of the font, upwards.
#[derive(Default)]
struct Outline(Vec<Segment>);

enum Segment {
    Move([f32; 2]),
    Line([f32; 2]),
    Quadratic([f32; 4]),
    Cubic([f32; 6]),
    Close,
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.push(Segment::Move([x, y]));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.push(Segment::Line([x, y]));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.push(Segment::Quadratic([x1, y1, x, y]));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.push(Segment::Cubic([x1, y1, x2, y2, x, y]));
    }

    fn close(&mut self) {
        self.0.push(Segment::Close);
    }
}

/// The letters of a text as one path.
struct Letters {
    builder: PathBuilder,
    x: f32,
    y: f32,
    scale: f32,
}

impl Letters {
    fn add(&mut self, outline: &Outline) {
        let (left, base, scale) = (self.x, self.y, self.scale);
        let (x, y) = (|x: f32| left + scale * x, |y: f32| base - scale * y);
        for segment in &outline.0 {
            match *segment {
                Segment::Move([a, b]) => self.builder.move_to(x(a), y(b)),
                Segment::Line([a, b]) => self.builder.line_to(x(a), y(b)),
                Segment::Quadratic([a, b, c, d]) => self.builder.quad_to(x(a), y(b), x(c), y(d)),
                Segment::Cubic([a, b, c, d, e, f]) => self.builder.cubic_to(x(a), y(b), x(c), y(d), x(e), y(f)),
                Segment::Close => self.builder.close(),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::svg::INK;
    use super::*;

    fn dark_pixels(picture: &Picture) -> usize {
        let png = picture.png(100.0, 20.0, 2.0).unwrap();
        let pixels = Pixmap::decode_png(&png).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (200, 40));
        pixels.pixels().iter().filter(|pixel| pixel.red() < 128).count()
    }

    #[test]
    fn shapes_and_texts_leave_ink() {
        let mut picture = Picture::default();
        assert_eq!(dark_pixels(&picture), 0);
        picture.text((2.0, 15.0), Anchor::Start, 12.0, INK, "quad.roll");
        let text = dark_pixels(&picture);
        assert!((200..2000).contains(&text), "{text}");
        picture.rectangle([60.0, 0.0, 80.0, 20.0], INK, 1.0);
        assert!(dark_pixels(&picture) >= text + 1600);
    }

    #[test]
    fn a_picture_beyond_any_screen_is_refused() {
        assert_eq!(Picture::default().png(1e6, 1e6, 1.0), None);
        assert_eq!(Picture::default().png(f64::NAN, 1.0, 1.0), None);
    }
}
