//! One element of the file with its attributes as typed values; unreadable ones become findings.

use std::cell::RefCell;
use std::str::FromStr;

use crate::description::{Finding, Position};

/// Findings beyond this number are left out: in a file that is wrong everywhere they have one cause.
const MAX_FINDINGS: usize = 1000;

/// Bytes between two noted places; counting on from one of them is all that a position costs.
const STRIDE: usize = 256;

/// The text being read, and the findings.
pub(super) struct Source<'a> {
    text: &'a str,
    /// The position of every [`STRIDE`]th byte, or of the character that it is part of.
    marks: Vec<(usize, Position)>,
    findings: RefCell<Vec<Finding>>,
}

impl<'a> Source<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let mut marks = Vec::with_capacity(text.len() / STRIDE + 1);
        let mut last = (0, Position { line: 1, column: 1 });
        for byte in (0..=text.len()).step_by(STRIDE) {
            let byte = text.floor_char_boundary(byte);
            last = (byte, after(last.1, &text[last.0..byte]));
            marks.push(last);
        }
        Self { text, marks, findings: RefCell::default() }
    }

    pub(super) fn extend(&self, findings: impl IntoIterator<Item = Finding>) {
        let mut all = self.findings.borrow_mut();
        for finding in findings {
            if all.len() < MAX_FINDINGS {
                all.push(finding);
            } else if all.len() == MAX_FINDINGS {
                all.push(Finding::error("XML", finding.position, "further findings are left out"));
            }
        }
    }

    pub(super) fn into_findings(self) -> Vec<Finding> {
        self.findings.into_inner()
    }

    fn place(&self, byte: usize) -> Position {
        let (from, position) = self.marks[(byte / STRIDE).min(self.marks.len() - 1)];
        after(position, self.text.get(from..byte).unwrap_or_default())
    }
}

/// The position behind a text that begins at another.
fn after(mut position: Position, text: &str) -> Position {
    for letter in text.chars() {
        if letter == '\n' {
            position = Position { line: position.line + 1, column: 1 };
        } else {
            position.column = position.column.saturating_add(1);
        }
    }
    position
}

/// One element.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    node: roxmltree::Node<'a, 'a>,
    source: &'a Source<'a>,
    position: Position,
}

impl<'a> Element<'a> {
    pub(super) fn new(node: roxmltree::Node<'a, 'a>, source: &'a Source<'a>) -> Self {
        Self { node, source, position: source.place(node.range().start) }
    }

    pub(super) fn name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    pub(super) fn position(&self) -> Position {
        self.position
    }

    /// The child elements, in the file's order.
    pub(super) fn children(&self) -> impl Iterator<Item = Self> + use<'a> {
        let source = self.source;
        self.node.children().filter(roxmltree::Node::is_element).map(move |node| Self::new(node, source))
    }

    /// Applies `read` to each child element with this name; others are reported as unknown.
    pub(super) fn each<T>(&self, rule: &'static str, name: &str, read: impl Fn(&Self) -> Option<T>) -> Vec<T> {
        let mut items = Vec::new();
        for child in self.children() {
            if child.name() == name {
                items.extend(read(&child));
            } else {
                child.unknown(rule, self.name());
            }
        }
        items
    }

    /// As [`Self::each`] for a list that must not be empty, which the checker cannot detect later.
    pub(super) fn items<T>(&self, rule: &'static str, name: &str, read: impl Fn(&Self) -> Option<T>) -> Vec<T> {
        if self.children().all(|child| child.name() != name) {
            self.error(rule, format!("`{}` is empty; a list without any `{name}` must be left out", self.name()));
        }
        self.each(rule, name, read)
    }

    /// Reports the element as unknown inside `parent`.
    pub(super) fn unknown(&self, rule: &'static str, parent: &str) {
        self.warning(rule, format!("`{parent}` has no element `{}` in FMI 2.0; it is ignored", self.name()));
    }

    /// Reports attributes outside this list; attributes of other namespaces belong to tools and are accepted.
    pub(super) fn expect_attributes(&self, rule: &'static str, known: &[&str]) {
        for attribute in self.node.attributes() {
            if attribute.namespace().is_none() && !known.contains(&attribute.name()) {
                let message = format!("`{}` has no attribute `{}` in FMI 2.0", self.name(), attribute.name());
                let position = self.source.place(attribute.range().start);
                self.source.extend([Finding::warning(rule, position, format!("{message}; it is ignored"))]);
            }
        }
    }

    pub(super) fn error(&self, rule: &'static str, message: String) {
        self.source.extend([Finding::error(rule, self.position, message)]);
    }

    pub(super) fn warning(&self, rule: &'static str, message: String) {
        self.source.extend([Finding::warning(rule, self.position, message)]);
    }

    /// An error at the attribute.
    fn attribute_error(&self, rule: &'static str, name: &str, message: String) {
        let place = self.node.attribute_node(name).map(|attribute| self.source.place(attribute.range().start));
        self.source.extend([Finding::error(rule, place.unwrap_or(self.position), message)]);
    }

    /// The attribute's raw text.
    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// The attribute, if present.
    pub(super) fn text(&self, name: &str) -> Option<String> {
        self.attribute(name).map(str::to_owned)
    }

    /// The attribute, empty if it is missing; the checker reports names that are empty.
    pub(super) fn text_or_empty(&self, name: &str) -> String {
        self.text(name).unwrap_or_default()
    }

    /// Reports that a mandatory attribute is missing.
    pub(super) fn missing(&self, rule: &'static str, name: &str) {
        self.error(rule, format!("`{}` has no attribute `{name}`, which is mandatory", self.name()));
    }

    /// The attribute as a number; an invalid one is reported with what was expected.
    pub(super) fn number<T: Number>(&self, rule: &'static str, name: &str) -> Option<T> {
        let written = self.attribute(name)?;
        let number = T::read(written.trim());
        if number.is_none() {
            let hint = if written.contains(',') { "; decimals have a point" } else { "" };
            self.attribute_error(rule, name, format!("`{name}=\"{written}\"`: expected {}{hint}", T::EXPECTED));
        }
        number
    }

    /// The attribute as a Boolean, in upper or lower case; `None` if it is missing or invalid.
    pub(super) fn boolean(&self, rule: &'static str, name: &str) -> Option<bool> {
        let written = self.attribute(name)?;
        let value = match written.trim() {
            "true" | "1" => return Some(true),
            "false" | "0" => return Some(false),
            other if other.eq_ignore_ascii_case("true") => Some(true),
            other if other.eq_ignore_ascii_case("false") => Some(false),
            _ => None,
        };
        self.attribute_error(rule, name, format!("`{name}=\"{written}\"`: expected true, false, 1 or 0"));
        value
    }

    /// The attribute as one of several words; `None` if it is missing or another word.
    pub(super) fn choice<T: Copy>(
        &self,
        rule: &'static str,
        name: &str,
        of: &[T],
        word: fn(T) -> &'static str,
    ) -> Option<T> {
        let written = self.attribute(name)?;
        let found = of.iter().copied().find(|&choice| word(choice) == written.trim());
        if found.is_none() {
            let words: Vec<_> = of.iter().map(|&choice| word(choice)).collect();
            let message = format!("`{name}=\"{written}\"`: expected one of {}", words.join(", "));
            self.attribute_error(rule, name, message);
        }
        found
    }

    /// The attribute as a list of words separated by blanks, each read by `read`; an unreadable word is reported and
    /// makes the whole list `None`, as if it were missing.
    pub(super) fn list<T>(
        &self,
        rule: &'static str,
        name: &str,
        expected: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Option<Vec<T>> {
        let mut values = Vec::new();
        for word in self.attribute(name)?.split_whitespace() {
            let Some(value) = read(word) else {
                self.attribute_error(rule, name, format!("`{word}` in `{name}`: expected {expected}"));
                return None;
            };
            values.push(value);
        }
        Some(values)
    }
}

/// A type of number in the schema.
pub(super) trait Number: Sized {
    /// The expected form, for messages.
    const EXPECTED: &'static str;
    fn read(text: &str) -> Option<Self>;
}

impl Number for f64 {
    const EXPECTED: &'static str = "a number";
    /// `INF` and `NaN` are readable; the checker rejects them where numbers must be finite.
    fn read(text: &str) -> Option<Self> {
        Self::from_str(text).ok()
    }
}

impl Number for i32 {
    const EXPECTED: &'static str = "a whole number from -2147483648 to 2147483647";
    fn read(text: &str) -> Option<Self> {
        Self::from_str(text).ok()
    }
}

impl Number for u32 {
    const EXPECTED: &'static str = "a whole number from 0 to 4294967295";
    fn read(text: &str) -> Option<Self> {
        Self::from_str(text).ok()
    }
}

impl Number for i8 {
    const EXPECTED: &'static str = "a whole number from -128 to 127";
    fn read(text: &str) -> Option<Self> {
        Self::from_str(text).ok()
    }
}

/// Converts an index that counts from 1 to one that counts from 0; 0 becomes `usize::MAX`, which the checker reports.
pub(super) fn from_one(index: u32) -> usize {
    index.checked_sub(1).map_or(usize::MAX, |index| index as usize)
}

#[test]
fn a_position_is_counted_in_lines_and_characters_wherever_it_is_asked_for() {
    let text = format!("{}\né{}<x/>", "ä".repeat(STRIDE), "é\n".repeat(STRIDE));
    let source = Source::new(&text);
    let at = |byte| (source.place(byte).line, source.place(byte).column);
    assert_eq!(at(text.len() - 4), (2 + 256, 1));
    assert_eq!((at(0), at(2), at(2 * STRIDE), at(2 * STRIDE + 3)), ((1, 1), (1, 2), (1, 257), (2, 2)));
}
