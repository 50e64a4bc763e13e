//! Reads a unit expression; an error names the part that cannot be read and the nearest known unit.

use std::fmt;
use std::ops::Range;

use super::table::{PREFIXES, SYMBOLS, Symbol, find};
use super::{BaseUnit, Dimension};

/// A unit expression that could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownUnit {
    /// The whole expression.
    pub text: String,
    /// Byte range in the text of the part that could not be read.
    pub part: Range<usize>,
    /// Kind of the error.
    pub cause: Cause,
    /// A suggested replacement of the part, if there is a similar one.
    pub suggestion: Option<String>,
}

/// The kinds of error in a part of a unit expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A unit is missing.
    Missing,
    /// No unit has this name.
    Unknown,
    /// The text after a unit is neither an exponent nor an operator.
    Operator,
    /// A temperature scale with an offset is part of a product, quotient or power.
    Offset,
    /// An exponent is outside the range of -128 to 127.
    Exponent,
}

impl UnknownUnit {
    /// The part that could not be read.
    #[must_use]
    pub fn part(&self) -> &str {
        self.text.get(self.part.clone()).unwrap_or_default()
    }
}

impl fmt::Display for UnknownUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (text, part) = (&self.text, self.part());
        if part == text {
            write!(f, "`{part}` ")?;
        } else if !part.is_empty() {
            write!(f, "`{part}` in `{text}` ")?;
        }
        match self.cause {
            Cause::Missing if text.is_empty() => {
                f.write_str("a unit of measure is missing; a plain number has the unit `1`")
            }
            Cause::Missing => write!(f, "a unit of measure is missing in `{text}`"),
            Cause::Unknown => f.write_str("is not a unit"),
            Cause::Operator => f.write_str("is neither an exponent nor one of `*`, `/` and `.`"),
            Cause::Offset => f.write_str("has an offset and cannot stand in a product, quotient or power"),
            Cause::Exponent => f.write_str("gives an exponent out of range"),
        }?;
        match &self.suggestion {
            Some(suggestion) if self.cause == Cause::Offset => write!(f, "; a difference is written in `{suggestion}`"),
            Some(suggestion) => write!(f, "; did you mean `{suggestion}`?"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for UnknownUnit {}

/// Reads a unit expression: symbols joined by `*`, `.` and `/` (from left to right), each with an exponent (`2`, `^2`,
/// `^-2`, `-2`, `²`, `³`); `1` is the unit of a plain number. Blanks are not allowed.
///
/// The factor is the quotient of two exact products, so it is rounded once; only π adds a rounding of its own.
///
/// # Errors
/// Names the first part that is not a unit.
pub fn parse(text: &str) -> Result<BaseUnit, UnknownUnit> {
    let mut product = Product { dimension: Dimension::NONE, numerator: 1.0, denominator: 1.0 };
    let (mut at, mut divides) = (0, false);
    loop {
        let word = at..at + word_length(&text[at..]);
        let exponent = read_exponent(&text[word.end..]);
        let end = word.end + exponent.length;
        let fail =
            |part: Range<usize>, cause, suggestion| Err(UnknownUnit { text: text.to_owned(), part, cause, suggestion });
        if word.is_empty() {
            return if text[at..].is_empty() || text[at..].starts_with(['*', '/', '.']) {
                fail(at..at, Cause::Missing, None)
            } else {
                fail(at..text.len(), Cause::Unknown, None)
            };
        }
        let name = &text[word.clone()];
        if name == "1" && exponent.length > 0 {
            return fail(word.start..end, Cause::Unknown, None);
        }
        let Some(found) = find(name) else { return fail(word, Cause::Unknown, nearest(name)) };
        let unit = found.2;
        if unit.offset != 0.0 {
            if end == name.len() && end == text.len() {
                return Ok(BaseUnit { dimension: unit.dimension, factor: 1.0, offset: unit.offset });
            }
            return fail(word, Cause::Offset, Some("K".to_owned()));
        }
        let power = exponent.value.and_then(|value| if divides { value.checked_neg() } else { Some(value) });
        let Some(next) = power.and_then(|power| product.times(found, power)) else {
            return fail(word.start..end, Cause::Exponent, None);
        };
        product = next;
        match text[end..].chars().next() {
            None => return Ok(product.unit()),
            Some('*' | '.') => divides = false,
            Some('/') => divides = true,
            Some(_) => return fail(end..text.len(), Cause::Operator, None),
        }
        at = end + 1;
    }
}

/// Length of letters, or of one of the two symbols that are not letters, or of `°` with letters, or of the `1`.
fn word_length(text: &str) -> usize {
    if text.starts_with(['%', '1']) {
        return 1;
    }
    let degree = if text.starts_with('°') { '°'.len_utf8() } else { 0 };
    let letters = text[degree..].chars().take_while(|c| c.is_alphabetic());
    degree + letters.map(char::len_utf8).sum::<usize>()
}

/// An exponent and its length in bytes; `value` is `None` where it is out of range.
struct Exponent {
    value: Option<i8>,
    length: usize,
}

fn read_exponent(text: &str) -> Exponent {
    for (sign, value) in [("²", 2), ("³", 3)] {
        if text.starts_with(sign) {
            return Exponent { value: Some(value), length: sign.len() };
        }
    }
    let digits_at = usize::from(text.starts_with('^'));
    let sign = usize::from(text[digits_at..].starts_with('-'));
    let count = text[digits_at + sign..].bytes().take_while(u8::is_ascii_digit).count();
    if count == 0 {
        return Exponent { value: Some(1), length: 0 };
    }
    let length = digits_at + sign + count;
    Exponent { value: text[digits_at..length].parse().ok(), length }
}

/// The unit read so far.
#[derive(Clone, Copy)]
struct Product {
    dimension: Dimension,
    numerator: f64,
    denominator: f64,
}

impl Product {
    fn times(self, (above, below, unit): (f64, f64, &Symbol), power: i8) -> Option<Self> {
        let mut next = self;
        next.dimension = self.dimension.checked_mul(unit.dimension.checked_pow(power)?)?;
        for _ in 0..power.unsigned_abs() {
            let (up, down) = (above * unit.numerator, below * unit.denominator);
            let (up, down) = if power < 0 { (down, up) } else { (up, down) };
            next.numerator *= up;
            next.denominator *= down;
        }
        (next.numerator.is_finite() && next.denominator.is_finite()).then_some(next)
    }

    fn unit(self) -> BaseUnit {
        BaseUnit { dimension: self.dimension, factor: self.numerator / self.denominator, offset: 0.0 }
    }
}

/// The unit that was probably meant: two units without an operator, other letter case, the English name, or one
/// mistyped letter, in this order.
fn nearest(word: &str) -> Option<String> {
    let lower = word.to_lowercase();
    let symbols = || SYMBOLS.iter().filter(|unit| unit.symbol != "1");
    let prefixed = || {
        let prefixes = || PREFIXES.iter().map(|prefix| prefix.0);
        symbols()
            .filter(|unit| unit.takes_prefix)
            .flat_map(move |unit| prefixes().map(move |p| format!("{p}{}", unit.symbol)))
    };
    let by_case = || symbols().map(|unit| unit.symbol.to_owned()).chain(prefixed()).find(|s| s.to_lowercase() == lower);
    let near_name = |name: &str| name.starts_with(&lower) || strsim::levenshtein(&lower, name) <= 1 + word.len() / 5;
    let by_name = || symbols().find(|unit| lower.len() >= 3 && near_name(unit.name)).map(|unit| unit.symbol.to_owned());
    let by_split = || {
        // A single letter before a unit is probably a prefix: one that this unit does not take, or in the wrong case.
        let looks_like_prefix =
            |left: &str| matches!(left, "h" | "K") || PREFIXES.iter().any(|prefix| prefix.0 == left);
        let known = |&(left, right): &(&str, &str)| find(left).is_some() && find(right).is_some();
        let cuts = word.char_indices().skip(1).map(|(at, _)| word.split_at(at));
        let products = cuts.filter(|cut| known(cut) && !looks_like_prefix(cut.0));
        products.last().map(|(left, right)| format!("{left}*{right}"))
    };
    let by_letter = || {
        let near = |unit: &&Symbol| word.len() >= 2 && strsim::levenshtein(word, unit.symbol) == 1;
        symbols().find(near).map(|unit| unit.symbol.to_owned())
    };
    by_split().or_else(by_case).or_else(by_name).or_else(by_letter)
}
