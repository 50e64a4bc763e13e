//! What is wrong with a script: a value with place, cause and fix, and its picture.

use fmi2::printable;
use std::ops::Range;

use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};

use crate::source::{Sources, Span};

/// Whether the script can run all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The script cannot run.
    Error,
    /// The script runs; something may be wrong.
    Warning,
}

/// A text under a part of the script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The part.
    pub span: Span,
    /// What it is or gives; may be empty where the message is enough.
    pub text: String,
}

/// Bytes of a text, and what takes their place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// The bytes; none for an insertion.
    pub span: Span,
    /// The new text.
    pub text: String,
}

impl Edit {
    /// `text` in the place of `span`.
    #[must_use]
    pub fn new(span: Span, text: impl Into<String>) -> Self {
        Self { span, text: text.into() }
    }

    /// `text` before `span`.
    #[must_use]
    pub fn before(span: Span, text: impl Into<String>) -> Self {
        Self::new(Span { end: span.start, ..span }, text)
    }

    /// `text` after `span`.
    #[must_use]
    pub fn after(span: Span, text: impl Into<String>) -> Self {
        Self::new(Span { start: span.end, ..span }, text)
    }
}

/// A remedy that an editor can apply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What it does, for example ``write `==` ``.
    pub text: String,
    /// The changes; they are in one text and do not overlap.
    pub edits: Vec<Edit>,
}

impl Fix {
    /// A text with the changes made; places outside of it change nothing.
    #[must_use]
    pub fn applied(&self, text: &str) -> String {
        let mut edits: Vec<_> = self.edits.iter().collect();
        edits.sort_by_key(|edit| edit.span);
        let mut changed = text.to_owned();
        for edit in edits.into_iter().rev() {
            let bytes = edit.span.start as usize..edit.span.end as usize;
            if changed.get(bytes.clone()).is_some() {
                changed.replace_range(bytes, &edit.text);
            }
        }
        changed
    }
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
    /// How to fix it.
    pub help: Option<String>,
    /// Remedies as changes of the text, the most probable first; each removes the finding.
    pub fixes: Vec<Fix>,
}

impl Diagnostic {
    /// An error at one place.
    #[must_use]
    pub fn error(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        let labels = vec![Label { span, text: String::new() }];
        Self { severity: Severity::Error, code, message: message.into(), labels, help: None, fixes: Vec::new() }
    }

    /// A warning at one place.
    #[must_use]
    pub fn warning(code: &'static str, span: Span, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, span, message) }
    }

    /// Whether the script cannot run.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }

    /// Sets the label of the primary place.
    #[must_use]
    pub fn saying(mut self, text: impl Into<String>) -> Self {
        if let Some(first) = self.labels.first_mut() {
            first.text = text.into();
        }
        self
    }

    /// Adds a label at another place.
    #[must_use]
    pub fn label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Adds a remedy as changes of the text; what it does is said by `text`.
    #[must_use]
    pub fn fix(mut self, text: impl Into<String>, edits: impl IntoIterator<Item = Edit>) -> Self {
        self.fixes.push(Fix { text: text.into(), edits: edits.into_iter().collect() });
        self
    }

    /// Adds how to fix it, in words.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }
}

/// How many findings are shown: more of them mostly have the same cause.
pub const SHOWN: usize = 100;

/// The diagnostics as a user reads them, in the order of their places, each followed by an empty line. Of more than 100 the
/// others are counted in a last line; errors are shown before warnings take their place.
#[must_use]
pub fn render(sources: &Sources, diagnostics: &[Diagnostic], colour: bool) -> String {
    let mut in_order: Vec<_> = diagnostics.iter().collect();
    in_order.sort_by_key(|diagnostic| diagnostic.labels.first().map(|label| label.span));
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count();
    let warnings = diagnostics.len() - errors;
    let shown_errors = errors.min(SHOWN);
    let shown_warnings = warnings.min(SHOWN - shown_errors);
    let (mut errors_left, mut warnings_left) = (shown_errors, shown_warnings);
    in_order.retain(|diagnostic| {
        let left = if diagnostic.is_error() { &mut errors_left } else { &mut warnings_left };
        let is_shown = *left > 0;
        *left = left.saturating_sub(1);
        is_shown
    });
    let shown = in_order
        .into_iter()
        .map(|diagnostic| printable::styled_lines(&renderer.render(&[picture(sources, diagnostic)])) + "\n\n");
    shown.chain(not_shown(errors - shown_errors, warnings - shown_warnings)).collect()
}

/// `... and 9,900 more errors`
fn not_shown(errors: usize, warnings: usize) -> Option<String> {
    let counted =
        |count: usize, what: &str| format!("{} more {what}{}", grouped(count), if count == 1 { "" } else { "s" });
    match (errors, warnings) {
        (0, 0) => None,
        (errors, 0) => Some(format!("... and {}\n\n", counted(errors, "error"))),
        (0, warnings) => Some(format!("... and {}\n\n", counted(warnings, "warning"))),
        _ => Some(format!("... and {} and {}\n\n", counted(errors, "error"), counted(warnings, "warning"))),
    }
}

/// A count with a comma before each three digits.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut grouped = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// Message, one excerpt for each text that has labels, and help.
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
    let group = level.primary_title(printable::lines(&diagnostic.message)).id(diagnostic.code).elements(excerpts);
    match &diagnostic.help {
        Some(help) => group.element(Level::HELP.message(printable::lines(help))),
        None => group,
    }
}

/// The lines of one text that have labels.
fn excerpt<'a>(sources: &'a Sources, labels: &'a [Label], text: u32) -> Snippet<'a, Annotation<'a>> {
    let marked = || labels.iter().enumerate().filter(|(_, label)| label.span.text == text);
    let (lines, source) = (sources.source(text), sources.text(text));
    let ranges = marked().map(|(_, label)| bytes(source, label.span));
    let covered = ranges.reduce(|all, one| all.start.min(one.start)..all.end.max(one.end)).unwrap_or_default();
    let start = lines.line_start(covered.start);
    let end = source[covered.end..].find('\n').map_or(source.len(), |length| covered.end + length);
    let first_line = lines.line(covered.start);
    let annotations = marked().map(|(index, label)| {
        let kind = if index == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
        let range = bytes(source, label.span);
        let annotation = kind.span(range.start - start..range.end - start);
        if label.text.is_empty() { annotation } else { annotation.label(printable::line(&label.text)) }
    });
    let name = sources.name(text);
    Snippet::source(&source[start..end]).line_start(first_line).path(printable::line(name)).annotations(annotations)
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
    fn of_more_than_a_hundred_findings_the_others_are_counted() {
        let mut sources = Sources::default();
        let text = sources.add("a.scn", "x\n".repeat(3_000));
        let finding = |line: u32, is_error: bool| {
            let place = at(text, 2 * line, 2 * line + 1);
            if is_error { Diagnostic::error("E01", place, "unknown") } else { Diagnostic::warning("W01", place, "odd") }
        };
        let rendered = |findings: &[Diagnostic]| render(&sources, findings, false);
        let shown = |text: &str| (text.matches("error[").count(), text.matches("warning[").count());
        let mut errors: Vec<_> = (200..300).map(|line| finding(line, true)).collect();
        assert_eq!(shown(&rendered(&errors)), (100, 0));
        assert!(!rendered(&errors).contains("more"));
        errors.push(finding(300, true));
        assert!(rendered(&errors).ends_with("\n\n... and 1 more error\n\n"));
        let mut all: Vec<_> = (0..200).map(|line| finding(line, false)).collect();
        assert!(rendered(&all).ends_with("\n\n... and 100 more warnings\n\n"));
        all.extend(errors.drain(..40));
        assert_eq!(shown(&rendered(&all)), (40, 60));
        all.extend((500..2_960).map(|line| finding(line, true)));
        assert_eq!(shown(&rendered(&all)), (100, 0));
        assert!(rendered(&all).ends_with("\n\n... and 2,400 more errors and 200 more warnings\n\n"));
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
    fn nothing_that_a_script_holds_commands_the_terminal() {
        let mut sources = Sources::default();
        let text = sources.add("a\nerror: \u{1b}[2J.scn", "step \u{1b}[31m \u{9b}31m \u{202e} ü");
        let span = at(text, 0, 4);
        let odd = Diagnostic::error("E00", span, "a\u{1b}[2J\u{9b}\nb").saying("c\r\u{1b}").help("d\u{1b}\ne\u{7}");
        let commands =
            |text: &str| text.contains(|c: char| c != '\n' && printable::line(&c.to_string()) != c.to_string());
        let plain = render(&sources, std::slice::from_ref(&odd), false);
        assert!(!commands(&plain) && plain.lines().filter(|line| line.starts_with("error")).count() == 1, "{plain}");
        let styled = render(&sources, &[odd], true);
        assert!(!styled.contains("\u{1b}[2J") && !styled.contains("\u{1b}[31m \u{fffd}"), "{styled}");
    }

    #[test]
    fn colour_is_an_addition() {
        let mut sources = Sources::default();
        let text = sources.add("a.scn", "step");
        let shown = render(&sources, &[Diagnostic::error("E00", at(text, 0, 4), "here")], true);
        assert!(shown.contains('\u{1b}'));
    }
}
