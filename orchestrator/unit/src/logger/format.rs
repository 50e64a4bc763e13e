//! Formatting of printf formats that come from a unit, with a check for dangerous ones.

use std::ffi::{CStr, c_char, c_int};

/// The size of the first buffer in bytes; most messages are shorter.
const FIRST_TRY: usize = 1024;

/// The largest buffer: a longer text is cut anyway, and a wide field must not use up the memory.
const LONGEST: usize = super::LONGEST_TEXT + 4;

/// Why a format is refused: it contains `%n`, which writes to memory instead of reading an argument, or a width that
/// would keep the C library busy for seconds.
fn refused_because(format: &[u8]) -> Option<&'static str> {
    let mut rest = format;
    while let Some(at) = rest.iter().position(|&byte| byte == b'%') {
        rest = &rest[at + 1..];
        let length = rest.iter().take_while(|byte| b"0123456789$#-+ '.*IhlLqjzt".contains(byte)).count();
        let (modifiers, after) = rest.split_at(length);
        if modifiers.split(|byte| !byte.is_ascii_digit()).any(|digits| digits.len() > 6) {
            return Some("a width beyond a million");
        }
        match after {
            [b'n', ..] => return Some("%n"),
            [_, after @ ..] => rest = after,
            [] => break,
        }
    }
    None
}

/// Formats a message by `print`, which is called like `vsnprintf` with a buffer and its length: once, or twice if the
/// first buffer is too short. If the format is refused or `print` fails, the result is the format itself.
pub fn fill(format: &CStr, mut print: impl FnMut(*mut c_char, usize) -> c_int) -> Vec<u8> {
    if let Some(reason) = refused_because(format.to_bytes()) {
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
    for harmless in ["", "%", "100 %", "%%n", "%d\n", "%5.3f n", "%sn", "%-08.3llx n", "%1000d%1000d"] {
        assert_eq!(refused_because(harmless.as_bytes()), None, "{harmless}");
    }
    for memory in ["%n", "a %d %hhn", "%%%n", "%1$n", "%-08.*lln", "%d%5n", "% n"] {
        assert_eq!(refused_because(memory.as_bytes()), Some("%n"), "{memory}");
    }
    for wide in ["%2000000000d", "%.1234567f", "%s %-9999999s"] {
        assert_eq!(refused_because(wide.as_bytes()), Some("a width beyond a million"), "{wide}");
    }
}
