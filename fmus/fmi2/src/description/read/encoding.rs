//! Decodes the bytes of an XML file to text, by byte order mark and XML declaration.

use std::borrow::Cow;

use crate::description::{Finding, Position};

/// Decodes UTF-8, UTF-16, US-ASCII, ISO-8859-1 and windows-1252; a file that declares UTF-8 but is not valid UTF-8 is
/// read as windows-1252, with a finding.
pub(super) fn decode(bytes: &[u8]) -> Result<(Cow<'_, str>, Option<Finding>), Finding> {
    let start = Position { line: 1, column: 1 };
    if let Some(rest) = bytes.strip_prefix(b"\xFF\xFE") {
        return utf_16(rest, u16::from_le_bytes);
    }
    if let Some(rest) = bytes.strip_prefix(b"\xFE\xFF") {
        return utf_16(rest, u16::from_be_bytes);
    }
    let (bytes, marked) = match bytes.strip_prefix(b"\xEF\xBB\xBF") {
        Some(rest) => (rest, true),
        None => (bytes, false),
    };
    let declared = if marked { None } else { declared_encoding(bytes) };
    match declared.as_deref() {
        None | Some("utf-8" | "utf8" | "us-ascii" | "ascii") => Ok(match str::from_utf8(bytes) {
            Ok(text) => (Cow::Borrowed(text), None),
            Err(error) => {
                let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
                let message = format!(
                    "byte {:#04x} is not UTF-8, the file's encoding; it is read as windows-1252 from the start",
                    bytes[error.valid_up_to()]
                );
                (Cow::Owned(windows_1252(bytes)), Some(Finding::error("XML", end_of(&good), message)))
            }
        }),
        // Browsers and libxml2 also read ISO-8859-1 as windows-1252: the codes that differ are control characters
        // there.
        Some("iso-8859-1" | "iso8859-1" | "iso_8859-1" | "latin1" | "latin-1" | "windows-1252" | "cp1252") => {
            Ok((Cow::Owned(windows_1252(bytes)), None))
        }
        Some(other) => {
            let message =
                format!("the encoding `{other}` is not known; expected UTF-8, UTF-16, ISO-8859-1 or windows-1252");
            Err(Finding::error("XML", start, message))
        }
    }
}

/// The encoding of `<?xml … encoding="…"?>` in lower case, if present.
fn declared_encoding(bytes: &[u8]) -> Option<String> {
    let head = &bytes[..bytes.len().min(256)];
    let declaration = head.strip_prefix(b"<?xml").and_then(|rest| {
        let end = rest.windows(2).position(|pair| pair == b"?>")?;
        str::from_utf8(&rest[..end]).ok()
    })?;
    let value = declaration.split_once("encoding")?.1.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
    Some(value[1..].split(quote).next()?.to_ascii_lowercase())
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<(Cow<'_, str>, Option<Finding>), Finding> {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    let text: Result<String, _> = char::decode_utf16(units).collect();
    match text {
        Ok(text) if bytes.len().is_multiple_of(2) => Ok((Cow::Owned(text), None)),
        _ => {
            let message = "the file begins with the byte order mark of UTF-16, but is not UTF-16";
            Err(Finding::error("XML", Position { line: 1, column: 1 }, message))
        }
    }
}

/// The characters of windows-1252 for the codes 0x80 to 0x9F.
const C1: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8D}', 'Ž', '\u{8F}', '\u{90}', '‘', '’',
    '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9D}', 'ž', 'Ÿ',
];

fn windows_1252(bytes: &[u8]) -> String {
    bytes
        .iter()
        .map(|&byte| match byte {
            0x80..=0x9F => C1[usize::from(byte - 0x80)],
            _ => char::from(byte),
        })
        .collect()
}

/// The position just after a text.
pub(super) fn end_of(text: &str) -> Position {
    let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
    let last = text.rsplit('\n').next().unwrap_or_default();
    Position { line: count(text.matches('\n').count() + 1), column: count(last.chars().count() + 1) }
}
