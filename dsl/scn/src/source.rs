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
    /// The smallest span that covers both, which are in one text.
    #[must_use]
    pub fn to(self, other: Self) -> Self {
        Self { text: self.text, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// A file that a text names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileRef {
    /// Index of the text in [`Sources`]: the path is relative to that text's folder.
    pub from: u32,
    /// The path as written.
    pub path: String,
}

/// A named text: a script as its user named it, or an assignment of the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// What diagnostics call it, for example `scenarios/first_flight.scn` or `--set`.
    pub name: String,
    /// The text as it was read.
    pub text: String,
    /// The first byte of each line.
    lines: Vec<usize>,
}

impl Source {
    /// A text with its name; a byte order mark at its start is dropped.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let mut text = text.into();
        if text.starts_with(BYTE_ORDER_MARK) {
            text.drain(..BYTE_ORDER_MARK.len_utf8());
        }
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { name: name.into(), text, lines }
    }

    /// The line, from 1, that contains a byte.
    #[must_use]
    pub fn line(&self, byte: usize) -> usize {
        self.lines.partition_point(|start| *start <= byte)
    }

    /// The first byte of the line that contains a byte.
    #[must_use]
    pub fn line_start(&self, byte: usize) -> usize {
        self.lines[self.line(byte) - 1]
    }
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
        self.texts.push(Source::new(name, text));
        u32::try_from(self.texts.len() - 1).unwrap_or(u32::MAX)
    }

    /// The source with an index that [`Sources::add`] returned.
    #[must_use]
    pub fn source(&self, text: u32) -> &Source {
        &self.texts[text as usize]
    }

    /// The text with an index that [`Sources::add`] returned.
    #[must_use]
    pub fn text(&self, text: u32) -> &str {
        &self.source(text).text
    }

    /// What diagnostics call the text with an index that [`Sources::add`] returned.
    #[must_use]
    pub fn name(&self, text: u32) -> &str {
        &self.source(text).name
    }

    /// The text that contains a span.
    #[must_use]
    pub fn of(&self, span: Span) -> &Source {
        self.source(span.text)
    }

    /// The text that a span covers.
    #[must_use]
    pub fn slice(&self, span: Span) -> &str {
        self.of(span).text.get(span.start as usize..span.end as usize).unwrap_or_default()
    }

    /// Line and column, both from 1, of a span's first character.
    #[must_use]
    pub fn line_and_column(&self, span: Span) -> (usize, usize) {
        let source = self.of(span);
        let byte = source.text.floor_char_boundary(span.start as usize);
        let start = source.line_start(byte);
        (source.line(byte), source.text[start..byte].chars().count() + 1)
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
