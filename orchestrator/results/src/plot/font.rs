//! Widths and outlines of letters, from the font that is part of the program, so that texts are laid out alike everywhere.

use std::sync::LazyLock;
use ttf_parser::Face;
pub(super) use ttf_parser::OutlineBuilder;

/// DejaVu Sans, the letters of Latin and Greek and signs of mathematics; licence beside it.
static FONT: &[u8] = include_bytes!("../../font/DejaVuSans-subset.ttf");

static FACE: LazyLock<Option<Face<'static>>> = LazyLock::new(|| Face::parse(FONT, 0).ok());

/// The width of a letter that the font lacks, as a part of the size.
const MISSING: f64 = 0.6;

/// The width of a text. Other fonts of pages without serifs are no wider.
pub(super) fn width(text: &str, size: f64) -> f64 {
    size * text.chars().map(advance).sum::<f64>()
}

/// How far the next letter is away, as a part of the size.
pub(super) fn advance(letter: char) -> f64 {
    let known = FACE.as_ref().and_then(|face| {
        let glyph = face.glyph_index(letter)?;
        Some(f64::from(face.glyph_hor_advance(glyph)?) / f64::from(face.units_per_em()))
    });
    known.unwrap_or(MISSING)
}

/// Writes the outline of a letter in units of the font, whose number in the size is returned; `None` for a letter that the
/// font lacks.
pub(super) fn outline(letter: char, builder: &mut dyn OutlineBuilder) -> Option<f64> {
    let face = FACE.as_ref()?;
    let glyph = face.glyph_index(letter)?;
    let _ = face.outline_glyph(glyph, builder);
    Some(f64::from(face.units_per_em()))
}

/// The text, or its beginning and an ellipsis where it is wider than `most`.
pub(super) fn fitted(text: &str, size: f64, most: f64) -> String {
    if width(text, size) <= most {
        return text.to_owned();
    }
    let mut left = most - width("…", size);
    let fits = |letter: &char| {
        left -= size * advance(*letter);
        left >= 0.0
    };
    let start: String = text.chars().take_while(fits).collect();
    start.trim_end().to_owned() + "…"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_the_letters_of_names_and_units() {
        for letter in "azAZ09 .,[]_-/^()²³·°µΩ−…×".chars() {
            assert!(FACE.as_ref().unwrap().glyph_index(letter).is_some(), "{letter}");
        }
    }

    #[test]
    fn a_long_text_is_cut_to_its_room() {
        assert_eq!(fitted("quad.roll", 12.0, 500.0), "quad.roll");
        let cut = fitted("a very long name of a signal", 12.0, 80.0);
        assert!(cut.ends_with('…') && width(&cut, 12.0) <= 80.0, "{cut}");
    }
}
