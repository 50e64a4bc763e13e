//! What is wrong with a script: a value with place, cause and fix, and its picture.

use std::ops::Range;

use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};

use crate::source::{Sources, Span};

/// Whether the script can run all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The script cannot run.
    Error,
    /// The script runs; something deserves a look.
    Warning,
}

/// Words under a part of the script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The part.
    pub span: Span,
    /// What it is or gives; may be empty where the message says it all.
    pub text: String,
}

/// One finding about a script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// `E02`, `W01`: stable, so that it can be looked up.
    pub code: &'static str,
    /// What is wrong, in one line without a full stop.
    pub message: String,
    /// Where; the first is the primary place.
    pub labels: Vec<Label>,
    /// How to mend it.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error at one place.
    #[must_use]
    pub fn error(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        let labels = vec![Label { span, text: String::new() }];
        Self { severity: Severity::Error, code, message: message.into(), labels, help: None }
    }

    /// A warning at one place.
    #[must_use]
    pub fn warning(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, span, message) }
    }

    /// Says something under the primary place.
    #[must_use]
    pub fn saying(mut self, text: impl Into<String>) -> Self {
        if let Some(first) = self.labels.first_mut() {
            first.text = text.into();
        }
        self
    }

    /// Adds words under another place.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Adds the fix.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }
}

/// The diagnostics as a user reads them, in the order of their places, each followed by an empty line.
#[must_use]
pub fn render(sources: &Sources, diagnostics: &[Diagnostic], colour: bool) -> String {
    let mut in_order: Vec<_> = diagnostics.iter().collect();
    in_order.sort_by_key(|diagnostic| diagnostic.labels.first().map(|label| label.span));
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    in_order.into_iter().map(|diagnostic| renderer.render(&[picture(sources, diagnostic)]) + "\n\n").collect()
}

/// Message, one excerpt for each text that the labels lie in, and help.
fn picture<'a>(sources: &'a Sources, diagnostic: &'a Diagnostic) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let mut texts: Vec<u32> = Vec::new();
    for label in &diagnostic.labels {
        if !texts.contains(&label.span.text) {
            texts.push(label.span.text);
        }
    }
    let excerpts = texts.into_iter().map(|text| excerpt(sources, &diagnostic.labels, text));
    let group = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code).elements(excerpts);
    match &diagnostic.help {
        Some(help) => group.element(Level::HELP.message(help.as_str())),
        None => group,
    }
}

/// The lines of one text that labels lie in.
fn excerpt<'a>(sources: &'a Sources, labels: &'a [Label], text: u32) -> Snippet<'a, Annotation<'a>> {
    let marked = || labels.iter().enumerate().filter(|(_, label)| label.span.text == text);
    let source = sources.text(text);
    let ranges = marked().map(|(_, label)| bytes(source, label.span));
    let covered = ranges.reduce(|all, one| all.start.min(one.start)..all.end.max(one.end)).unwrap_or_default();
    let start = source[..covered.start].rfind('\n').map_or(0, |line_break| line_break + 1);
    let end = source[covered.end..].find('\n').map_or(source.len(), |length| covered.end + length);
    let first_line = source[..start].matches('\n').count() + 1;
    let annotations = marked().map(|(index, label)| {
        let kind = if index == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
        let range = bytes(source, label.span);
        let annotation = kind.span(range.start - start..range.end - start);
        if label.text.is_empty() { annotation } else { annotation.label(label.text.as_str()) }
    });
    let name = sources.name(text);
    Snippet::source(&source[start..end]).line_start(first_line).path(name).annotations(annotations)
}

/// The bytes of a span, within the text and between characters.
fn bytes(source: &str, span: Span) -> Range<usize> {
    let start = source.floor_char_boundary(span.start as usize);
    let end = source.ceil_char_boundary(span.end as usize);
    start..end.max(start)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: u32, start: u32, end: u32) -> Span {
        Span { text, start, end }
    }

    #[test]
    fn findings_are_shown_by_place_with_labels_and_help() {
        let mut sources = Sources::default();
        let script = sources.add("quad.scn", "step 5 ms\r\nctrl.thrust => quad.moment\n\tx -> y\n");
        let command = sources.add("--set", "gust = 6");
        let later = Diagnostic::warning("W01", at(script, 39, 40), "`x` declares no unit");
        let earlier = Diagnostic::error("E02", at(script, 11, 22), "cannot connect a force to a torque")
            .saying("gives N")
            .label(at(script, 26, 37), "takes N*m")
            .label(at(command, 7, 8), "set here")
            .help("compute it on the left");
        insta::assert_snapshot!(render(&sources, &[later, earlier], false), @r"
        error[E02]: cannot connect a force to a torque
         --> quad.scn:2:1
          |
        2 | ctrl.thrust => quad.moment
          | ^^^^^^^^^^^    ----------- takes N*m
          | |
          | gives N
          |
         ::: --set:1:8
          |
        1 | gust = 6
          |        - set here
          |
          = help: compute it on the left

        warning[W01]: `x` declares no unit
         --> quad.scn:3:2
          |
        3 |     x -> y
          |     ^
        ");
    }

    #[test]
    fn places_outside_the_text_are_shown_at_its_end() {
        let mut sources = Sources::default();
        let text = sources.add("a.scn", "é");
        for span in [at(text, 1, 1), at(text, 5, 9), at(text, 2, 1), at(text, 0, u32::MAX)] {
            assert!(render(&sources, &[Diagnostic::error("E00", span, "here")], false).contains("a.scn:1:"));
        }
    }

    #[test]
    fn colour_is_an_addition() {
        let mut sources = Sources::default();
        let text = sources.add("a.scn", "step");
        let shown = render(&sources, &[Diagnostic::error("E00", at(text, 0, 4), "here")], true);
        assert!(shown.contains('\u{1b}'));
    }
}
