//! How scripts write the names of a unit's variables, some of which need quotes, and texts.

use crate::parse::is_plain_unit;
use std::borrow::Cow;

/// The name of a variable as a script writes it: `state.position.x`, `plant.'der(x)'`. What is in quotes already, as
/// names of structured variables may be, is unchanged.
#[must_use]
pub fn variable(name: &str) -> Cow<'_, str> {
    let mut rest = name;
    loop {
        let Some(after) = part(rest).filter(|after| after.is_empty() || after.starts_with('.')) else {
            let plain = &name[..name.len() - rest.len()];
            let is_quotable = !rest.is_empty() && !rest.contains(['\'', '\n', '\r']);
            return if is_quotable { Cow::Owned(format!("{plain}'{rest}'")) } else { Cow::Borrowed(name) };
        };
        match after.strip_prefix('.') {
            Some(next) => rest = next,
            None => return Cow::Borrowed(name),
        }
    }
}

/// What follows the part of a path that a text begins with: a word or a quoted name, and its indices.
fn part(text: &str) -> Option<&str> {
    let after = match text.strip_prefix('\'') {
        Some(quoted) => quoted.split_once('\'').filter(|(name, _)| !name.is_empty())?.1,
        None => text.trim_start_matches(|letter: char| letter == '_' || letter.is_ascii_alphanumeric()),
    };
    let has_name = after.len() < text.len();
    let after = match after.strip_prefix('[') {
        Some(index) => index.split_once(']').filter(|(index, _)| is_index(index))?.1,
        None => after,
    };
    has_name.then_some(after)
}

/// Whether an index is numbers between commas, spelt as the language itself spells them.
fn is_index(index: &str) -> bool {
    index.split(',').all(|number| number.parse::<u32>().is_ok_and(|value| value.to_string() == number))
}

/// A unit of measure as a script writes it: other than simple names in quotes.
#[must_use]
pub fn unit(unit: &str) -> String {
    if is_plain_unit(unit) { unit.to_owned() } else { format!("'{unit}'") }
}

/// A text as a script writes it: in double quotes, with escapes for what cannot be in them.
#[must_use]
pub fn text(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n").replace('\t', "\\t"))
}

#[test]
fn names_are_quoted_from_the_part_on_that_is_no_word() {
    for plain in ["x", "state.position.x", "m[1,2].u", "'a b'.c[3]", "2nd", "step"] {
        assert_eq!(variable(plain), plain);
    }
    for (name, spelt) in [
        ("der(x)", "'der(x)'"),
        ("plant.der(a.b)", "plant.'der(a.b)'"),
        ("a[red].b", "'a[red].b'"),
        ("a[01]", "'a[01]'"),
        ("größe", "'größe'"),
        ("a..b", "a.'.b'"),
        ("a b.c", "'a b.c'"),
        ("", ""),
    ] {
        assert_eq!(variable(name), spelt);
    }
    assert_eq!(variable("der('a b')"), "der('a b')");
}

#[test]
fn quotes_and_line_breaks_of_texts_are_escaped() {
    assert_eq!(text("a \"b\"\nC:\\d"), r#""a \"b\"\nC:\\d""#);
}

#[test]
fn a_unit_of_measure_is_quoted_where_it_is_no_plain_name() {
    for plain in ["m/s^2", "%", "°C", "m²", "km/h"] {
        assert_eq!(unit(plain), plain);
    }
    for quoted in ["N.m", "in", "at", "1/s", "N-m", "m22", "a b", ""] {
        assert_eq!(unit(quoted), format!("'{quoted}'"));
    }
}
