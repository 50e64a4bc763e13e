//! Slips in numbers and signs: the habits of other languages.

use super::failure::{Failure, is_word};
use super::mistakes::error;
use crate::diagnostic::{Diagnostic, Edit};
use crate::source::Span;

/// What to write, in words and as a change.
fn write(error: Diagnostic, span: Span, text: &str) -> Diagnostic {
    let words = format!("write `{}`", text.trim());
    error.help(words.clone()).fix(words, [Edit::new(span, text)])
}

/// `1,5 m`
pub(super) fn decimal_comma(failure: &Failure<'_>) -> Option<Diagnostic> {
    // In the braces of a unit the comma ends a value, and the digits after it are read as a key.
    let comma = match failure.found() {
        "," => failure.at,
        _ => {
            let before = failure.before().trim_end();
            let digits = before.len() - before.trim_end_matches(|c: char| c.is_ascii_digit()).len();
            before[..before.len() - digits].ends_with(',').then(|| failure.statement + before.len() - digits - 1)?
        }
    };
    let (before, after) = (&failure.blanked[..comma], &failure.blanked[comma + 1..]);
    let fraction = &after[..after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len())];
    let whole = &before[before.trim_end_matches(|c: char| c.is_ascii_digit()).len()..];
    let before = &before[..before.len() - whole.len()];
    if fraction.is_empty() || whole.is_empty() || before.ends_with(|c: char| is_word(c) || c == '.') {
        return None;
    }
    let span = failure.span_of(comma - whole.len(), whole.len() + 1 + fraction.len());
    let error =
        Diagnostic::error("E00", span, format!("`{whole},{fraction}` is no number: the decimal sign is a point"));
    Some(write(error, span, &format!("{whole}.{fraction}")))
}

/// `x^2`, `x²`, `5 m/s ^2`
pub(super) fn power(failure: &Failure<'_>) -> Option<Diagnostic> {
    // In a name, `²` counts as a letter.
    let found = failure.found();
    let skipped = found.find(['²', '³']).unwrap_or(0);
    let at = failure.at + skipped;
    let (found, rest) = (&found[skipped..], &failure.rest()[skipped..]);
    let (sign, power) = match found {
        "^" | "**" => (found.len(), rest[found.len()..].trim_start_matches([' ', '\t'])),
        "²" => (0, "2"),
        "³" => (0, "3"),
        _ => return None,
    };
    let digits = &power[..power.find(|c: char| !c.is_ascii_digit()).unwrap_or(power.len())];
    let written = match sign {
        0 => '²'.len_utf8(),
        _ => rest.len() - power.len() + digits.len(),
    };
    let before = &failure.blanked[failure.statement..at];
    let bare = before.trim_end();
    let operand = &bare[bare.trim_end_matches(|c: char| is_word(c) || matches!(c, '.' | '/' | '*')).len()..];
    let ahead = bare[..bare.len() - operand.len()].trim_end();
    let is_unit = operand.starts_with(char::is_alphabetic) && ahead.ends_with(|c: char| c.is_ascii_digit() || c == ']');
    let blanks = before.len() - bare.len();
    let span = failure.span_of(at, written);
    let begin = at - blanks - operand.len();
    let meant = format!("{operand}^{digits}");
    // What is written so already is wrong for another reason.
    let is_loose = !digits.is_empty() && failure.blanked[begin..at + written] != meant;
    if is_unit && is_loose && operand.ends_with(char::is_alphabetic) {
        let error = Diagnostic::error("E00", span, "the power of a unit of measure stands right behind it");
        return Some(write(error, failure.span_of(begin, operand.len() + blanks + written), &meant));
    }
    if is_unit && operand.ends_with(char::is_numeric) {
        let error = Diagnostic::error("E00", span, format!("`{operand}` has a power already"));
        return Some(error.help("a unit of measure has one power: `m/s^2`"));
    }
    let error = Diagnostic::error("E00", span, "values have no powers, only units of measure do");
    let is_path = operand.starts_with(|c: char| c == '_' || c.is_ascii_alphabetic())
        && operand.chars().all(|c| is_word(c) || c == '.');
    if is_path && matches!(digits, "2" | "3") {
        let factors = if digits == "2" { 2 } else { 3 };
        let product = vec![operand; factors].join(" * ");
        let joined = failure.span_of(begin, operand.len() + blanks + written);
        return Some(write(error, joined, &product));
    }
    Some(error.help("a power of a value is a product, `x * x`; that of a unit has no blanks, `m/s^2`"))
}

/// Signs of other languages.
pub(super) fn foreign_symbol(failure: &Failure<'_>) -> Option<Diagnostic> {
    let found = failure.found();
    let (help, written) = match found {
        ";" => ("a statement ends with its line: drop the `;`", ""),
        "//" => ("a comment begins with `#`", "#"),
        "&&" | "&" => ("write `and`", "and"),
        "||" | "|" => ("write `or`", "or"),
        "!" => ("write `not`", "not"),
        "≥" => ("write `>=`", ">="),
        "≤" => ("write `<=`", "<="),
        "≠" => ("write `!=`", "!="),
        ":=" => ("write `=`", "="),
        "==" if !failure.expects("==") => ("to give a value write `=`", "="),
        "-->" => ("write `->`", "->"),
        "==>" => ("write `=>`", "=>"),
        "=>" if !failure.expects("->") && failure.expects("<=") => ("to compare write `>=`", ">="),
        _ => return None,
    };
    let after = &failure.rest()[found.len()..];
    let is_word_written = written.ends_with(char::is_alphabetic);
    let before = if is_word_written && failure.before().ends_with(is_word) { " " } else { "" };
    let behind = if is_word_written && !after.starts_with([' ', '\t']) { " " } else { "" };
    let text = if written.is_empty() { "drop it".to_owned() } else { format!("write `{written}`") };
    let edit = Edit::new(failure.span(), [before, written, behind].concat());
    Some(error(failure, format!("`{found}` is no sign that can stand here")).help(help).fix(text, [edit]))
}

/// `x = 3` in a condition.
pub(super) fn assignment_for_comparison(failure: &Failure<'_>) -> Option<Diagnostic> {
    if failure.found() != "=" || !failure.expects("==") || failure.expects("->") || failure.expects("]") {
        return None;
    }
    if failure.rest().starts_with("=<") {
        let span = Span { end: failure.span().start + 2, ..failure.span() };
        let error = Diagnostic::error("E00", span, "`=<` is no sign that compares").help("to compare write `<=`");
        return Some(error.fix("write `<=`", [Edit::new(span, "<=")]));
    }
    let error = error(failure, "`=` gives a value, it does not compare").help("to compare write `==`");
    Some(error.fix("write `==`", [Edit::new(failure.span(), "==")]))
}

/// `1_000`
pub(super) fn parted_digits(failure: &Failure<'_>) -> Option<Diagnostic> {
    let found = failure.found();
    if !found.contains('_') || !found.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let joined = found.replace('_', "");
    let help = format!("the digits of a number stand together: `{joined}`");
    let error = error(failure, format!("`{found}` is no number")).help(help);
    Some(error.fix(format!("write `{joined}`"), [Edit::new(failure.span(), joined)]))
}

/// `.5`
pub(super) fn leading_point(failure: &Failure<'_>) -> Option<Diagnostic> {
    let after = failure.rest().strip_prefix('.').filter(|_| failure.expects_value())?;
    let fraction = &after[..after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len())];
    let span = failure.span_of(failure.at, 1 + fraction.len());
    let error = Diagnostic::error("E00", span, "a number begins with a digit");
    (!fraction.is_empty()).then(|| write(error, span, &format!("0.{fraction}")))
}

/// `5.`, `1.2.3`
pub(super) fn loose_point(failure: &Failure<'_>) -> Option<Diagnostic> {
    let number = failure.previous();
    let digits = match number.strip_suffix('.') {
        Some(digits) => digits,
        None if failure.found() == "." => number,
        None => return None,
    };
    let is_number = !digits.is_empty() && digits.chars().all(|c| c == '.' || c.is_ascii_digit());
    let span = failure.span_of(failure.at - number.len(), number.len() + usize::from(!number.ends_with('.')));
    let error = Diagnostic::error("E00", span, "this point belongs to no number");
    is_number.then(|| {
        if digits.len() == number.len() {
            return error.help("a number has one decimal point");
        }
        let help = format!("write `{digits}` or `{digits}.0`");
        error.help(help).fix(format!("write `{digits}`"), [Edit::new(span, digits)])
    })
}
