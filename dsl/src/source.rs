//! The texts that a scenario is made of, and places in them.

use serde::{Deserialize, Serialize};

/// A range of bytes in one text of [`Sources`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Span {
    /// Index of the text in [`Sources`].
    pub text: u32,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The smallest span that covers both, which lie in one text.
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        Self { text: self.text, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// A named text: a script as its user named it, or an assignment of the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// What diagnostics call it, for example `scenarios/first_flight.scn` or `--set`.
    pub name: String,
    /// The text as it was read.
    pub text: String,
}

const BYTE_ORDER_MARK: char = '\u{feff}';

/// All texts of one scenario; a [`Span`] points into them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    texts: Vec<Source>,
}

impl Sources {
    /// Adds a text and returns its index; a byte order mark at its start is dropped.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> u32 {
        let mut text = text.into();
        if text.starts_with(BYTE_ORDER_MARK) {
            text.drain(..BYTE_ORDER_MARK.len_utf8());
        }
        self.texts.push(Source { name: name.into(), text });
        u32::try_from(self.texts.len() - 1).unwrap_or(u32::MAX)
    }

    /// The text with an index that [`Sources::add`] returned.
    #[must_use]
    pub fn text(&self, text: u32) -> &str {
        &self.texts[text as usize].text
    }

    /// What diagnostics call the text with an index that [`Sources::add`] returned.
    #[must_use]
    pub fn name(&self, text: u32) -> &str {
        &self.texts[text as usize].name
    }

    /// The text that a span lies in.
    #[must_use]
    pub fn of(&self, span: Span) -> &Source {
        &self.texts[span.text as usize]
    }

    /// The words that a span covers.
    #[must_use]
    pub fn slice(&self, span: Span) -> &str {
        self.of(span).text.get(span.start as usize..span.end as usize).unwrap_or_default()
    }

    /// Line and column, both from 1, of a span's first character.
    #[must_use]
    pub fn line_and_column(&self, span: Span) -> (usize, usize) {
        let before = self.of(span).text.get(..span.start as usize).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

#[test]
fn places_are_counted_in_lines_and_characters() {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", "\u{feff}é x\r\ny");
    let place = |start, end| sources.line_and_column(Span { text, start, end });
    assert_eq!((place(0, 2), place(3, 4), place(6, 7)), ((1, 1), (1, 3), (2, 1)));
    assert_eq!(sources.slice(Span { text, start: 3, end: 4 }), "x");
}
