//! The mistakes that have a name: each with its own message and fix.

use super::failure::{Failure, closing, token};
use super::wording::{is_reserved, is_statement_word, model_of, statement_words};
use super::{explain, lines, slips};
use crate::diagnostic::{Diagnostic, Edit};
use crate::nearest::nearest;

/// The mistake that was made, if it is a known one.
pub(super) fn known(failure: &Failure<'_>) -> Option<Diagnostic> {
    [
        open_quote,
        connection_ends_in_value,
        connection_without_source,
        lonely_bracket,
        slips::decimal_comma,
        slips::power,
        slips::foreign_symbol,
        arrow_to_the_left,
        slips::assignment_for_comparison,
        slips::parted_digits,
        slips::leading_point,
        slips::loose_point,
        actions_without_braces,
        word_after_condition,
        ports_after_period,
        second_statement,
        reserved_name,
        odd_name,
        text_without_quotes,
        no_statement,
    ]
    .iter()
    .find_map(|mistake| mistake(failure))
}

/// An error at the place of the failure.
pub(super) fn error(failure: &Failure<'_>, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error("E00", failure.span(), message)
}

/// A bracket that is still open where a line, the text or an outer bracket ends, and where parsing continues.
pub(super) fn unclosed(failure: &Failure<'_>) -> Option<(Diagnostic, usize)> {
    let text = failure.blanked;
    let open = failure.open_brackets();
    let (opened, bracket) = *open.last()?;
    let closing = closing(bracket);
    let diagnostic = Diagnostic::error("E00", failure.span_of(opened, 1), format!("this `{bracket}` is never closed"))
        .help(format!("write the missing `{closing}`"));
    let found = failure.found();
    let broken_off = found.is_empty() && (bracket != '{' || failure.expects("}"));
    let other_closed = closes(found, &open) && !found.starts_with(closing);
    if broken_off && bracket == '{' {
        let next = text.len() - text[failure.at..].trim_start().len();
        if let Some(inside) = statement_in_braces(failure, opened, next) {
            return Some((inside, lines::next_statement(text, failure.at)));
        }
    }
    if broken_off || other_closed {
        let label = format!("expected `{closing}` here at the latest");
        let last = text[..failure.at].trim_end().len();
        let line = &text[opened..last];
        if broken_off && !line.contains(['\n', '\r']) {
            let written = if bracket == '{' { " }".to_owned() } else { closing.to_string() };
            let edit = Edit::before(failure.span_of(last, 0), written);
            let diagnostic = diagnostic.label(failure.span(), label).fix(format!("write `{closing}`"), [edit]);
            return Some((diagnostic, lines::next_statement(text, failure.at)));
        }
        return Some((diagnostic.label(failure.span(), label), lines::next_statement(text, failure.at)));
    }
    // The first word of a statement in the braces of an fmu line was read as a key, in those of an at block as an action.
    let line = lines::line_start(text, failure.at);
    let first = &text[line..lines::line_end(text, line)];
    if opened > line || bracket != '{' || failure.is_block(opened) || !lines::begins_statement(first) {
        return None;
    }
    let begins = line + first.len() - first.trim_start().len();
    if let Some(inside) = statement_in_braces(failure, opened, begins) {
        return Some((inside, lines::next_statement(text, failure.at)));
    }
    let place = failure.span_of(begins, lines::first_word(first).len().max(1));
    Some((diagnostic.label(place, "the next statement begins here"), line))
}

/// That a statement, which begins at a byte, is in braces of values or actions that are closed after it.
fn statement_in_braces(failure: &Failure<'_>, opened: usize, begins: usize) -> Option<Diagnostic> {
    let text = failure.blanked;
    let line = &text[begins..lines::line_end(text, begins)];
    if failure.is_block(opened) || !lines::begins_statement(line) || !failure.is_closed_later(opened) {
        return None;
    }
    let place = failure.span_of(begins, lines::first_word(line).len().max(1));
    let error = Diagnostic::error("E00", place, "a statement in braces that cannot contain one");
    Some(error.label(failure.span_of(opened, 1), "opened here").help("close the braces before it"))
}

/// Whether a closing bracket closes any of the open ones.
fn closes(bracket: &str, open: &[(usize, char)]) -> bool {
    open.iter().any(|(_, opening)| bracket.starts_with(closing(*opening)))
}

fn open_quote(failure: &Failure<'_>) -> Option<Diagnostic> {
    let found = failure.found();
    let quote = found.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
    let help = format!("write `{quote}` at its end; a text stands on one line");
    let is_word = !found.trim_end().contains([' ', '\t']) && found.trim_end().len() > 1;
    (!lines::is_closed(found)).then(|| {
        let error = error(failure, format!("this `{quote}` is never closed")).help(help);
        let end = failure.span_of(failure.at + found.trim_end().len(), 0);
        if is_word { error.fix(format!("write `{quote}`"), [Edit::before(end, quote.to_string())]) } else { error }
    })
}

/// E13: `x => 3 m`
fn connection_ends_in_value(failure: &Failure<'_>) -> Option<Diagnostic> {
    let arrow = failure.previous();
    let value = failure.found();
    let is_value =
        value.starts_with(|c: char| c.is_ascii_digit() || "\"([-.".contains(c)) || matches!(value, "true" | "false");
    if !matches!(arrow, "->" | "=>") || !is_value {
        return None;
    }
    let line = failure.line();
    let span = failure.span_of(failure.statement, line.len());
    let help = match arrow {
        "=>" => format!("to compare write `{}`", line.replacen("=>", ">=", 1)),
        _ => "a connection looks like `quad.state -> ctrl.state`; what is computed stands on its left".to_owned(),
    };
    let message = format!("`{line}` is a connection, and a connection ends in a port");
    Some(Diagnostic::error("E13", span, message).help(help))
}

fn connection_without_source(failure: &Failure<'_>) -> Option<Diagnostic> {
    let arrow = failure.found();
    if !matches!(arrow, "->" | "=>") || !failure.before().is_empty() {
        return None;
    }
    let message = format!("this connection has no source: nothing stands before `{arrow}`");
    Some(error(failure, message).help("a connection looks like `quad.state -> ctrl.state`"))
}

fn lonely_bracket(failure: &Failure<'_>) -> Option<Diagnostic> {
    let bracket = failure.found();
    if !matches!(bracket, ")" | "]" | "}") || closes(bracket, &failure.open_brackets()) {
        return None;
    }
    Some(error(failure, format!("this `{bracket}` closes nothing")).help("drop it, or open the bracket before"))
}

/// `a.u <- b.y`, which reads as `a.u < -b.y`.
fn arrow_to_the_left(failure: &Failure<'_>) -> Option<Diagnostic> {
    let arrow = failure.before().find("<-").filter(|_| failure.expects("->"))?;
    let span = failure.span_of(failure.at - failure.before().len() + arrow, 2);
    let error = Diagnostic::error("E00", span, "arrows point to the right");
    let error = error.help("turn the connection: `quad.state -> ctrl.state`");
    let line = failure.line();
    let (target, source) = line.split_once("<-")?;
    let turned = format!("{} -> {}", source.trim(), target.trim());
    let whole = failure.span_of(failure.statement, line.len());
    Some(if source.contains("<-") { error } else { error.fix(format!("write `{turned}`"), [Edit::new(whole, turned)]) })
}

fn actions_without_braces(failure: &Failure<'_>) -> Option<Diagnostic> {
    let action = failure.found();
    if !matches!(action, "set" | "fault") || !failure.expects("{") {
        return None;
    }
    let message = format!("`{action}` stands in braces");
    let end = failure.span_of(failure.statement + failure.line().len(), 0);
    let braces = [Edit::before(failure.span(), "{ "), Edit::after(end, " }")];
    Some(error(failure, message).help(format!("write {}", failure.begun().example)).fix("write braces", braces))
}

/// `assert clear: x > 3 m always`, `assert clear: eventually x > 3 m within 5 s`
fn word_after_condition(failure: &Failure<'_>) -> Option<Diagnostic> {
    let word = failure.found();
    let is_window = matches!(word, "within" | "after");
    if !(is_window || matches!(word, "always" | "eventually" | "finally" | "hold" | "not")) || !failure.expects("*") {
        return None;
    }
    if is_window {
        let message = format!("`{word}` comes right after `always` or `eventually`");
        return Some(error(failure, message).help(format!("write for example `eventually {word} 5 s x > 3 m`")));
    }
    let line = failure.line();
    let (before, behind) = (failure.before(), line.get(failure.before().len() + word.len()..).unwrap_or_default());
    let begun = before.split_once(':').filter(|_| lines::first_word(before) == "assert");
    let error = error(failure, format!("`{word}` comes before its condition"));
    let Some((head, condition)) = begun else {
        return Some(match word {
            "not" => error.help("write `not` to the left of it"),
            _ => error.help(format!("`{word}` belongs to an `assert`")),
        });
    };
    let before = [head, ": ", word, " ", behind.trim()].concat();
    let written = format!("{} {}", before.trim_end(), condition.trim());
    let text = format!("write `{written}`");
    Some(error.help(text.clone()).fix(text, [Edit::new(failure.span_of(failure.statement, line.len()), written)]))
}

/// `record a.x every 20 ms, b.x`
fn ports_after_period(failure: &Failure<'_>) -> Option<Diagnostic> {
    let is_record = lines::first_word(failure.before()) == "record";
    if failure.found() != "," || !is_record || !failure.before().contains(" every ") {
        return None;
    }
    let help = "ports with a period of their own have a `record` line of their own";
    let edit = Edit::new(failure.span(), "\nrecord");
    Some(error(failure, "`every` ends a record line").help(help).fix("begin another `record` line", [edit]))
}

/// `step 5 ms stop 90 s`
fn second_statement(failure: &Failure<'_>) -> Option<Diagnostic> {
    let word = failure.found();
    if !is_statement_word(word) || failure.expects_name() || failure.expects_value() || failure.before().is_empty() {
        return None;
    }
    let message = format!("expected the end of the line after `{}`, found `{word}`", failure.previous());
    let edit = Edit::before(failure.span(), "\n");
    let error = error(failure, message).help("each statement stands on a line of its own");
    Some(error.fix("begin another line", [edit]))
}

fn reserved_name(failure: &Failure<'_>) -> Option<Diagnostic> {
    let word = failure.found();
    if !failure.expects_name() || !is_reserved(word) || failure.before().is_empty() {
        return None;
    }
    if failure.before().trim_end() == "assert" {
        let edit = Edit::before(failure.span(), "claim: ");
        let error = error(failure, format!("expected the name of the claim, found `{word}`"));
        return Some(error.help(format!("write for example `assert claim: {word} …`")).fix("write `claim:`", [edit]));
    }
    let message = format!("`{word}` belongs to the language and cannot be a name here");
    Some(error(failure, message).help(format!("take another name, for example `{word}_1`; after a dot it is free")))
}

fn odd_name(failure: &Failure<'_>) -> Option<Diagnostic> {
    let word = failure.found();
    if word.is_ascii() || !word.starts_with(|c: char| c == '_' || c.is_alphanumeric()) {
        return None;
    }
    let help = "names are made of the letters a to z and A to Z, digits and `_`; other names of a unit's variables stand in \
        single quotes, `plant.'größe'`";
    Some(error(failure, format!("`{word}` is no name")).help(help))
}

fn text_without_quotes(failure: &Failure<'_>) -> Option<Diagnostic> {
    let found = failure.found();
    let only_text = failure.expects("\"") && failure.expected.len() == 1;
    if found.is_empty() || !(only_text || (failure.expects("\"") && found.starts_with('\''))) {
        return None;
    }
    let bare = found.trim_matches('\'');
    let (previous, found) = (failure.previous(), explain::found(failure));
    let message = format!("expected a text in double quotes after `{previous}`, found {found}");
    let is_name = bare.starts_with(|c: char| c == '_' || c.is_alphanumeric());
    let model = failure.begun();
    let error = error(failure, message);
    if !is_name {
        return Some(error.help(format!("{} looks like {}", model.called, model.example)));
    }
    let text = format!("write `\"{bare}\"`");
    Some(error.help(text.clone()).fix(text, [Edit::new(failure.span(), format!("\"{bare}\""))]))
}

/// A line that begins with no statement word and holds no arrow.
fn no_statement(failure: &Failure<'_>) -> Option<Diagnostic> {
    let line = &failure.blanked[failure.statement..];
    let word = token(line);
    let written_as_statement = failure.expects("->") || failure.before().is_empty() || failure.at == failure.statement;
    if is_statement_word(word)
        || !written_as_statement
        || !word.starts_with(|c: char| c == '_' || c.is_ascii_alphanumeric())
    {
        return None;
    }
    let at_word = |message: String| Diagnostic::error("E00", failure.span_of(failure.statement, word.len()), message);
    if matches!(word, "set" | "fault") {
        let message = format!("`{word}` stands in the braces of `at`, `when` or `while`");
        return Some(
            at_word(message).help(format!("write {}", model_of(if word == "set" { "at" } else { "while" }).example)),
        );
    }
    let path_alone = failure.before().trim_end() == word;
    if failure.found() == "=" {
        let help = if path_alone {
            format!("to name a value write `let {word} = …`; `param {word} = …` lets the command line change it")
        } else {
            "a unit's parameter is set in the braces of its fmu line, and during the run by `set` in an at block"
                .to_owned()
        };
        return Some(error(failure, "a statement does not begin with a value that is set").help(help));
    }
    let message = format!("`{word}` begins no statement");
    let is_path = line[word.len()..].starts_with(['.', '[', '(']);
    if let Some(meant) = nearest(word, statement_words()).filter(|_| !is_path) {
        let model = model_of(meant);
        let help = format!("did you mean `{meant}`? {} looks like {}", model.called, model.example);
        let edit = Edit::new(failure.span_of(failure.statement, word.len()), meant);
        return Some(at_word(message).help(help).fix(format!("write `{meant}`"), [edit]));
    }
    let found = explain::found(failure);
    let message = format!("expected `->` or `=>` after `{}`, found {found}", failure.previous());
    let words = statement_words().collect::<Vec<_>>().join(" ");
    let help = format!("a connection looks like `quad.state -> ctrl.state`; the other statements begin with {words}");
    (!failure.before().is_empty()).then(|| error(failure, message).help(help))
}
