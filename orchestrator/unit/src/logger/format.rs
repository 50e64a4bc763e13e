//! Formatting of printf formats that come from a unit, with a check for dangerous ones.

use std::ffi::{CStr, c_char, c_int};

/// The size of the first buffer in bytes; most messages are shorter.
const FIRST_TRY: usize = 1024;

/// The largest buffer: a longer text is cut anyway, and a wide field must not use up the memory.
const LONGEST: usize = super::LONGEST_TEXT + 4;

/// The most characters that the widths of a format may ask for: with more the C library is busy for seconds.
const WIDEST: u64 = 1_000_000;

/// An argument of a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// A number up to 64 bits or an address.
    Integer,
    /// A `double`.
    Real,
    /// A `long double`.
    LongReal,
}

/// The argument that a conversion reads; `None` if it reads none.
fn argument_of(conversion: u8, modifiers: &[u8]) -> Option<Argument> {
    match conversion {
        b'd' | b'i' | b'u' | b'x' | b'X' | b'o' | b'c' | b'C' | b's' | b'S' | b'p' => Some(Argument::Integer),
        b'a' | b'A' | b'e' | b'E' | b'f' | b'F' | b'g' | b'G' if modifiers.contains(&b'L') => Some(Argument::LongReal),
        b'a' | b'A' | b'e' | b'E' | b'f' | b'F' | b'g' | b'G' => Some(Argument::Real),
        _ => None,
    }
}

/// The characters that the widths between `%` and a conversion ask for; the precision of a text asks for none.
fn width_of(modifiers: &[u8], conversion: u8, mut read: impl FnMut(Argument) -> c_int) -> u64 {
    let mut asked = 0_u64;
    for (place, part) in modifiers.split(|&byte| byte == b'.').enumerate() {
        let given =
            part.iter().filter(|&&byte| byte == b'*').map(|_| u64::from(read(Argument::Integer).unsigned_abs()));
        let given: u64 = given.sum();
        let written = part.split(|byte| !byte.is_ascii_digit()).filter(|digits| !digits.is_empty());
        let written = written.map(|digits| str::from_utf8(digits).ok().and_then(|digits| digits.parse().ok()));
        let written = written.fold(0_u64, |sum, digits| sum.saturating_add(digits.unwrap_or(u64::MAX)));
        if place == 0 || !matches!(conversion, b's' | b'S') {
            asked = asked.saturating_add(given).saturating_add(written);
        }
    }
    asked
}

/// Why a format is refused: it contains `%n`, which writes to memory instead of reading an argument, or widths that
/// would keep the C library busy for seconds. `read` returns the next argument if it is an integer.
fn refused_because(format: &[u8], mut read: impl FnMut(Argument) -> c_int) -> Option<&'static str> {
    let mut rest = format;
    let mut asked = 0_u64;
    while let Some(at) = rest.iter().position(|&byte| byte == b'%') {
        rest = &rest[at + 1..];
        let length = rest.iter().take_while(|byte| b"0123456789$#-+ '.*IhlLqjzt".contains(byte)).count();
        let (modifiers, after) = rest.split_at(length);
        let [conversion, after @ ..] = after else { break };
        if *conversion == b'n' {
            return Some("%n");
        }
        if modifiers.contains(&b'$') && modifiers.contains(&b'*') {
            return Some("a width that is a numbered argument");
        }
        asked = asked.saturating_add(width_of(modifiers, *conversion, &mut read));
        if asked > WIDEST {
            return Some("a width beyond a million");
        }
        if let Some(argument) = argument_of(*conversion, modifiers) {
            read(argument);
        }
        rest = after;
    }
    None
}

/// Formats a message. `read` returns the next argument, of which only integers are used, and `print` is called like
/// `vsnprintf` with a buffer and its length: once, or twice if the first buffer is too short. If the format is refused or
/// `print` fails, the result is the format itself.
pub fn fill(
    format: &CStr,
    read: impl FnMut(Argument) -> c_int,
    mut print: impl FnMut(*mut c_char, usize) -> c_int,
) -> Vec<u8> {
    if let Some(reason) = refused_because(format.to_bytes(), read) {
        return [format.to_bytes(), b" (format refused: ", reason.as_bytes(), b")"].concat();
    }
    let mut buffer = vec![0_u8; FIRST_TRY];
    let mut length = print(buffer.as_mut_ptr().cast(), buffer.len());
    if usize::try_from(length).is_ok_and(|length| length >= buffer.len()) {
        buffer.resize((length as usize + 1).min(LONGEST), 0);
        length = print(buffer.as_mut_ptr().cast(), buffer.len());
    }
    let Ok(length) = usize::try_from(length) else { return format.to_bytes().to_vec() };
    // The last byte is the terminating zero.
    buffer.truncate(length.min(buffer.len() - 1));
    buffer
}

#[test]
fn only_conversions_that_write_to_memory_and_very_large_widths_are_refused() {
    let refused = |format: &str, arguments: &[c_int]| {
        let mut arguments = arguments.iter();
        refused_because(format.as_bytes(), |_| arguments.next().copied().unwrap_or_default())
    };
    for harmless in ["", "%", "100 %", "%%n", "%d\n", "%5.3f n", "%sn", "%-08.3llx n", "%1000d%1000d", "%.9999999s"] {
        assert_eq!(refused(harmless, &[]), None, "{harmless}");
    }
    for memory in ["%n", "a %d %hhn", "%%%n", "%1$n", "%-08.*lln", "%d%5n", "% n"] {
        assert_eq!(refused(memory, &[]), Some("%n"), "{memory}");
    }
    for wide in ["%2000000000d", "%.1234567f", "%s %-9999999s", "%600000d%600000d", "%99999999999999999999999d"] {
        assert_eq!(refused(wide, &[]), Some("a width beyond a million"), "{wide}");
    }
    const WIDE: c_int = 2_000_000_000;
    for (wide, arguments) in
        [("%*d", vec![WIDE]), ("%d %Lf %*d", vec![1, 1, -WIDE]), ("%.*f", vec![WIDE]), ("%*s", vec![WIDE])]
    {
        assert_eq!(refused(wide, &arguments), Some("a width beyond a million"), "{wide}");
    }
    for (harmless, arguments) in [("%d%*d", vec![WIDE, 5]), ("%.*s", vec![WIDE]), ("%*d%d", vec![5, WIDE, WIDE])] {
        assert_eq!(refused(harmless, &arguments), None, "{harmless}");
    }
    assert_eq!(refused("%1$*2$d", &[]), Some("a width that is a numbered argument"));
}
