//! The built-in symbols: SI base and derived units, and other common units.

use super::Dimension;

/// One symbol: `si = numerator / denominator * value + offset`. Both numbers are exact, except for π.
pub(super) struct Symbol {
    pub(super) symbol: &'static str,
    /// The English name, for suggestions.
    pub(super) name: &'static str,
    pub(super) dimension: Dimension,
    pub(super) numerator: f64,
    pub(super) denominator: f64,
    pub(super) offset: f64,
    /// Whether it takes the prefixes of [`PREFIXES`].
    pub(super) takes_prefix: bool,
}

/// A prefix with its numerator and denominator.
pub(super) const PREFIXES: [(&str, f64, f64); 8] = [
    ("n", 1.0, 1e9),
    ("u", 1.0, 1e6),
    ("µ", 1.0, 1e6),
    ("m", 1.0, 1e3),
    ("c", 1.0, 1e2),
    ("k", 1e3, 1.0),
    ("M", 1e6, 1.0),
    ("G", 1e9, 1.0),
];

/// A unit of factor 1 that takes prefixes.
const fn si(symbol: &'static str, name: &'static str, dimension: [i8; 8]) -> Symbol {
    Symbol {
        symbol,
        name,
        dimension: Dimension(dimension),
        numerator: 1.0,
        denominator: 1.0,
        offset: 0.0,
        takes_prefix: true,
    }
}

/// A unit with a factor.
const fn scaled(mut unit: Symbol, numerator: f64, denominator: f64, takes_prefix: bool) -> Symbol {
    unit.numerator = numerator;
    unit.denominator = denominator;
    unit.takes_prefix = takes_prefix;
    unit
}

/// A unit with an offset, which cannot be part of an expression.
const fn shifted(mut unit: Symbol, offset: f64) -> Symbol {
    unit.offset = offset;
    unit.takes_prefix = false;
    unit
}

const MASS: [i8; 8] = [1, 0, 0, 0, 0, 0, 0, 0];
const LENGTH: [i8; 8] = [0, 1, 0, 0, 0, 0, 0, 0];
const TIME: [i8; 8] = [0, 0, 1, 0, 0, 0, 0, 0];
const TEMPERATURE: [i8; 8] = [0, 0, 0, 0, 1, 0, 0, 0];
const ANGLE: [i8; 8] = [0, 0, 0, 0, 0, 0, 0, 1];
const NUMBER: [i8; 8] = [0; 8];

/// Every symbol, base units first; where two readings exist (`min`, `cd`), a whole symbol takes precedence over a
/// prefixed one.
pub(super) const SYMBOLS: [Symbol; 46] = [
    si("m", "meter", LENGTH),
    scaled(si("g", "gram", MASS), 1.0, 1e3, true),
    si("s", "second", TIME),
    si("A", "ampere", [0, 0, 0, 1, 0, 0, 0, 0]),
    si("K", "kelvin", TEMPERATURE),
    si("mol", "mole", [0, 0, 0, 0, 0, 1, 0, 0]),
    si("cd", "candela", [0, 0, 0, 0, 0, 0, 1, 0]),
    si("rad", "radian", ANGLE),
    si("N", "newton", [1, 1, -2, 0, 0, 0, 0, 0]),
    si("Hz", "hertz", [0, 0, -1, 0, 0, 0, 0, 0]),
    si("Pa", "pascal", [1, -1, -2, 0, 0, 0, 0, 0]),
    si("J", "joule", [1, 2, -2, 0, 0, 0, 0, 0]),
    si("W", "watt", [1, 2, -3, 0, 0, 0, 0, 0]),
    si("V", "volt", [1, 2, -3, -1, 0, 0, 0, 0]),
    si("C", "coulomb", [0, 0, 1, 1, 0, 0, 0, 0]),
    si("F", "farad", [-1, -2, 4, 2, 0, 0, 0, 0]),
    si("Ohm", "ohm", [1, 2, -3, -2, 0, 0, 0, 0]),
    si("Ω", "ohm", [1, 2, -3, -2, 0, 0, 0, 0]),
    si("S", "siemens", [-1, -2, 3, 2, 0, 0, 0, 0]),
    si("Wb", "weber", [1, 2, -2, -1, 0, 0, 0, 0]),
    si("T", "tesla", [1, 0, -2, -1, 0, 0, 0, 0]),
    si("H", "henry", [1, 2, -2, -2, 0, 0, 0, 0]),
    si("sr", "steradian", [0, 0, 0, 0, 0, 0, 0, 2]),
    si("lm", "lumen", [0, 0, 0, 0, 0, 0, 1, 2]),
    si("lx", "lux", [0, -2, 0, 0, 0, 0, 1, 2]),
    si("Bq", "becquerel", [0, 0, -1, 0, 0, 0, 0, 0]),
    si("Gy", "gray", [0, 2, -2, 0, 0, 0, 0, 0]),
    si("Sv", "sievert", [0, 2, -2, 0, 0, 0, 0, 0]),
    si("kat", "katal", [0, 0, -1, 0, 0, 1, 0, 0]),
    scaled(si("t", "tonne", MASS), 1e3, 1.0, false),
    scaled(si("min", "minute", TIME), 60.0, 1.0, false),
    scaled(si("h", "hour", TIME), 3600.0, 1.0, false),
    scaled(si("d", "day", TIME), 86_400.0, 1.0, false),
    scaled(si("L", "liter", [0, 3, 0, 0, 0, 0, 0, 0]), 1.0, 1e3, true),
    scaled(si("bar", "bar", [1, -1, -2, 0, 0, 0, 0, 0]), 1e5, 1.0, true),
    scaled(si("rpm", "rpm", [0, 0, -1, 0, 0, 0, 0, 1]), std::f64::consts::PI, 30.0, false),
    scaled(si("deg", "degree", ANGLE), std::f64::consts::PI, 180.0, false),
    scaled(si("°", "degree", ANGLE), std::f64::consts::PI, 180.0, false),
    scaled(si("%", "percent", NUMBER), 1.0, 100.0, false),
    shifted(si("degC", "celsius", TEMPERATURE), 273.15),
    shifted(si("°C", "celsius", TEMPERATURE), 273.15),
    scaled(si("ft", "feet", LENGTH), 3048.0, 1e4, false),
    scaled(si("nmi", "nautical mile", LENGTH), 1852.0, 1.0, false),
    scaled(si("kn", "knot", [0, 1, -1, 0, 0, 0, 0, 0]), 1852.0, 3600.0, false),
    scaled(si("in", "inch", LENGTH), 254.0, 1e4, false),
    scaled(si("1", "1", NUMBER), 1.0, 1.0, false),
];

/// The factor of the prefix and the symbol of a word, or `None`.
pub(super) fn find(word: &str) -> Option<(f64, f64, &'static Symbol)> {
    let of = |word: &str| SYMBOLS.iter().find(|unit| unit.symbol == word);
    if let Some(unit) = of(word) {
        return Some((1.0, 1.0, unit));
    }
    PREFIXES.iter().find_map(|&(prefix, numerator, denominator)| {
        let unit = of(word.strip_prefix(prefix)?).filter(|unit| unit.takes_prefix)?;
        Some((numerator, denominator, unit))
    })
}
