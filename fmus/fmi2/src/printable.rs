//! Text from outside, made safe to print: names, paths and messages that cannot be taken for lines of the program and send no
//! commands to a terminal.

use std::fmt::Write;
use std::path::Path;

/// What begins the lines of a text after the first.
const CONTINUED: &str = "\n  | ";

/// Whether a character is a command to a terminal, ends a line, or reorders the characters of one.
fn is_command(letter: char) -> bool {
    letter.is_control() || matches!(letter, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text in one line: each character that is a command is replaced.
#[must_use]
pub fn line(text: &str) -> String {
    text.replace(is_command, "\u{fffd}")
}

/// A text whose line breaks and tabs stay; each other character that is a command is replaced.
#[must_use]
pub fn lines(text: &str) -> String {
    text.replace(|letter| is_command(letter) && !['\n', '\t'].contains(&letter), "\u{fffd}")
}

/// As [`lines`] for a rendered text that has no commands but those of its own colours.
#[must_use]
pub fn styled_lines(text: &str) -> String {
    text.replace(|letter| is_command(letter) && !['\n', '\t', '\u{1b}'].contains(&letter), "\u{fffd}")
}

/// A text of several lines within a message: those after the first begin with a mark.
#[must_use]
pub fn block(text: &str) -> String {
    lines(&text.replace("\r\n", "\n")).trim_end().replace('\n', CONTINUED)
}

/// A path as the user sees it: unchanged if it is printable, else quoted as `bash` reads it.
#[must_use]
pub fn path(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    match path.to_str().filter(|text| !text.contains(is_command)) {
        Some(text) => text.to_owned(),
        None => quoted(path.as_os_str().as_encoded_bytes()),
    }
}

/// A path or another text as one word of a command line for a shell. What cannot be printed is written as an octal number,
/// which `bash` and `zsh` read.
#[must_use]
pub fn shell_word(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./+:@%,".contains(c);
    match path.to_str() {
        Some(text) if !text.is_empty() && text.chars().all(is_plain) => text.to_owned(),
        Some(text) if !text.contains(is_command) => format!("'{}'", text.replace('\'', "'\\''")),
        _ => quoted(path.as_os_str().as_encoded_bytes()),
    }
}

/// Bytes between `$'` and `'`.
fn quoted(bytes: &[u8]) -> String {
    let mut word = "$'".to_owned();
    for chunk in bytes.utf8_chunks() {
        for letter in chunk.valid().chars() {
            match letter {
                '\'' | '\\' => word.extend(['\\', letter]),
                letter if is_command(letter) => octal(&mut word, letter.encode_utf8(&mut [0; 4]).as_bytes()),
                letter => word.push(letter),
            }
        }
        octal(&mut word, chunk.invalid());
    }
    word + "'"
}

fn octal(word: &mut String, bytes: &[u8]) {
    for byte in bytes {
        // Writing to a text cannot fail.
        let _ = write!(word, "\\{byte:03o}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stays_one_line_and_commands_nothing() {
        assert_eq!(
            line("a\nb\r\tc\u{1b}[2J\u{9b}m\u{202e}\u{2028} ü"),
            "a\u{fffd}b\u{fffd}\u{fffd}c\u{fffd}[2J\u{fffd}m\u{fffd}\u{fffd} ü"
        );
    }

    #[test]
    fn later_lines_of_a_block_are_marked() {
        assert_eq!(block("a\r\n\tb\u{1b}[2J\rc\n\n"), "a\n  | \tb\u{fffd}[2J\u{fffd}c");
    }

    #[cfg(unix)]
    #[test]
    fn a_path_is_printable_and_a_shell_reads_it() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt;
        for bytes in [&b"a/b.scn"[..], b"", b"my runs/it's", b"b\xe4d/a\nb\x1b[1m", b"\xe4'1\\", "ü\u{9b}1".as_bytes()]
        {
            let name = Path::new(OsStr::from_bytes(bytes));
            let word = shell_word(name);
            assert_eq!(line(&word), word);
            let said = std::process::Command::new("bash").arg("-c").arg(format!("printf %s {word}")).output();
            assert_eq!(said.expect("bash is there").stdout, bytes, "{word}");
        }
        assert_eq!(path(Path::new("my runs/it's")), "my runs/it's");
        assert_eq!(path(Path::new(OsStr::from_bytes(b"b\xe4d"))), "$'b\\344d'");
    }
}
