//! The text of a table as spreadsheets and other tools write it, cut into cells.
//!
//! Cells are separated by commas, semicolons or tabs: whichever comes first in the line of the names, or what a line
//! `sep=;` says. A quoted cell may hold separators and line breaks; a doubled quote in it is one quote. Lines that begin
//! with `#`, empty lines and rows of empty cells have no meaning.

use std::borrow::Cow;

/// What is wrong with a text: at which byte, and a remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wrong {
    pub at: usize,
    pub message: String,
    pub help: Option<String>,
}

impl Wrong {
    pub fn new(at: usize, message: impl Into<String>) -> Self {
        Self { at, message: message.into(), help: None }
    }

    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// A cell without quotes and blanks around it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Cell<'a> {
    /// The byte at which it begins in the text.
    pub at: usize,
    pub text: Cow<'a, str>,
}

/// A text that is read row by row.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    text: String,
    separator: char,
    /// The byte at which the next row begins.
    next: usize,
}

impl Sheet {
    /// Decodes a file: UTF-8, or UTF-16 with a byte order mark.
    ///
    /// # Errors
    /// It is no text, or in another encoding.
    pub fn decode(bytes: Vec<u8>) -> Result<Self, Wrong> {
        if bytes.starts_with(b"PK\x03\x04") {
            let help = "save the sheet as CSV, comma-separated values";
            return Err(Wrong::new(0, "this is a spreadsheet or another archive, not a text").help(help));
        }
        let text = match bytes.as_slice() {
            [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
            [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
            _ => utf8(bytes),
        }?;
        let text = text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text);
        let text = if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n") } else { text };
        Ok(Self::new(text))
    }

    /// A text whose lines end with `\n`.
    fn new(text: String) -> Self {
        let mut sheet = Self { text, separator: ',', next: 0 };
        let line = sheet.text.lines().next().unwrap_or_default();
        // The separator may be a tab, so only spaces are trimmed.
        let first = line.trim_matches([' ', '"']).to_ascii_lowercase();
        match first.strip_prefix("sep=").and_then(|rest| rest.chars().next()) {
            Some(separator) => {
                sheet.separator = separator;
                sheet.next = (line.len() + 1).min(sheet.text.len());
            }
            None => sheet.separator = first_separator(&sheet.text).unwrap_or(','),
        }
        sheet
    }

    /// Drops a last line without a line break: a run that broke may leave one.
    pub fn drop_incomplete_line(&mut self) {
        self.text.truncate(self.text.rfind('\n').map_or(0, |end| end + 1));
        self.next = self.next.min(self.text.len());
    }

    /// The separator.
    pub fn separator(&self) -> char {
        self.separator
    }

    /// Line and column, from 1, of a byte.
    pub fn place(&self, at: usize) -> (usize, usize) {
        let before = &self.text[..self.text.floor_char_boundary(at)];
        let begin = before.rfind('\n').map_or(0, |end| end + 1);
        (before.matches('\n').count() + 1, before[begin..].chars().count() + 1)
    }

    /// Whether a comment names the columns, as some tools write it.
    pub fn has_names_in_a_comment(&self) -> bool {
        let comment =
            |line: &str| line.trim_start().strip_prefix('#').map(|rest| rest.trim_start().to_ascii_lowercase());
        self.text.lines().map_while(comment).any(|rest| rest.starts_with("time"))
    }

    /// The next row with a cell that is not empty; `None` at the end.
    ///
    /// # Errors
    /// A quote is not closed.
    pub fn row(&mut self) -> Result<Option<Vec<Cell<'_>>>, Wrong> {
        while self.next < self.text.len() {
            let begin = self.next;
            let end = row_end(&self.text, begin)?;
            self.next = (end + 1).min(self.text.len());
            let line = &self.text[begin..end];
            let is_empty = |letter: char| letter.is_whitespace() || letter == self.separator || letter == '"';
            if !line.trim_start().starts_with('#') && !line.chars().all(is_empty) {
                return Ok(Some(cells(line, begin, self.separator)));
            }
        }
        Ok(None)
    }
}

fn utf8(bytes: Vec<u8>) -> Result<String, Wrong> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let line = bytes[..valid].iter().filter(|&&byte| byte == b'\n').count() + 1;
        let message = format!("line {line} is not in UTF-8: it holds the byte {:#04x}", bytes[valid]);
        Wrong::new(0, message).help("save the table as CSV in UTF-8")
    })
}

fn utf16(bytes: &[u8], number: impl Fn([u8; 2]) -> u16) -> Result<String, Wrong> {
    let (pairs, rest) = bytes.as_chunks();
    let text = String::from_utf16(&pairs.iter().map(|&pair| number(pair)).collect::<Vec<_>>());
    let error = || Wrong::new(0, "this is no valid UTF-16").help("save the table as CSV in UTF-8");
    text.ok().filter(|_| rest.is_empty()).ok_or_else(error)
}

/// The first separator outside of quotes in the line of the names.
fn first_separator(text: &str) -> Option<char> {
    let has_meaning = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut quoted = false;
    text.lines().find(has_meaning)?.chars().find(|&letter| {
        quoted ^= letter == '"';
        !quoted && matches!(letter, ',' | ';' | '\t')
    })
}

/// The byte of the line break that ends a row, or the end of the text.
fn row_end(text: &str, begin: usize) -> Result<usize, Wrong> {
    let rest = &text.as_bytes()[begin..];
    let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
    let line = &text[begin..begin + end];
    if !line.contains('"') || line.trim_start().starts_with('#') {
        return Ok(begin + end);
    }
    let mut open = None;
    for (at, &byte) in rest.iter().enumerate() {
        match byte {
            b'"' => open = if open.is_none() { Some(begin + at) } else { None },
            b'\n' if open.is_none() => return Ok(begin + at),
            _ => {}
        }
    }
    open.map_or(Ok(text.len()), |at| Err(Wrong::new(at, "this quote is not closed")))
}

/// The cells of a row that begins at a byte of the text.
fn cells(row: &str, begin: usize, separator: char) -> Vec<Cell<'_>> {
    let mut cells = Vec::new();
    let (mut from, mut quoted) = (0, false);
    for (at, letter) in row.char_indices() {
        quoted ^= letter == '"';
        if letter == separator && !quoted {
            cells.push(cell(&row[from..at], begin + from));
            from = at + letter.len_utf8();
        }
    }
    cells.push(cell(&row[from..], begin + from));
    cells
}

fn cell(written: &str, begin: usize) -> Cell<'_> {
    let at = begin + written.len() - written.trim_start().len();
    let written = written.trim();
    if !written.contains('"') {
        return Cell { at, text: Cow::Borrowed(written) };
    }
    let mut text = String::new();
    let mut letters = written.chars().peekable();
    let mut quoted = false;
    while let Some(letter) = letters.next() {
        match letter {
            '"' if quoted && letters.next_if_eq(&'"').is_some() => text.push('"'),
            '"' => quoted = !quoted,
            letter => text.push(letter),
        }
    }
    Cell { at, text: Cow::Owned(text.trim().to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(bytes: &[u8]) -> Vec<Vec<String>> {
        let mut sheet = Sheet::decode(bytes.to_vec()).unwrap();
        let mut rows = Vec::new();
        while let Some(row) = sheet.row().unwrap() {
            rows.push(row.into_iter().map(|cell| cell.text.into_owned()).collect());
        }
        rows
    }

    #[test]
    fn separators_comments_line_ends_and_encodings_of_spreadsheets_mean_the_same() {
        let expected = [["time", "m[1,2]"], ["0", "1"], ["1", "TRUE"]];
        for text in [
            "time,\"m[1,2]\"\n0,1\n1,TRUE\n",
            "time;m[1,2]\r\n0;1\r\n\r\n1;TRUE",
            "# a table, made\n\"time\"\tm[1,2]\r# and more\r0 \t 1\r\t\r1\tTRUE\r",
            "sep=;\ntime;m[1,2]\n0;1\n;\n1;\"TRUE\"\n",
            "\"sep=\t\"\ntime\tm[1,2]\n0\t1\n1\tTRUE\n",
        ] {
            assert_eq!(rows(text.as_bytes()), expected, "{text:?}");
            assert_eq!(rows(format!("\u{feff}{text}").as_bytes()), expected, "{text:?}");
            let wide = |number: fn(u16) -> [u8; 2]| -> Vec<u8> {
                format!("\u{feff}{text}").encode_utf16().flat_map(number).collect()
            };
            assert_eq!(rows(&wide(u16::to_le_bytes)), expected, "{text:?}");
            assert_eq!(rows(&wide(u16::to_be_bytes)), expected, "{text:?}");
        }
    }

    #[test]
    fn a_quoted_cell_may_hold_separators_quotes_and_line_breaks() {
        assert_eq!(rows(b"time,\"say \"\"x,\ny\"\"\"\n0,1\n"), [["time", "say \"x,\ny\""], ["0", "1"]]);
    }

    #[test]
    fn what_is_no_text_or_has_an_open_quote_is_an_error_at_its_place() {
        let wrong = |bytes: &[u8]| Sheet::decode(bytes.to_vec()).unwrap_err().message;
        assert_eq!(wrong(b"PK\x03\x04rest"), "this is a spreadsheet or another archive, not a text");
        assert_eq!(wrong(b"time,u\n0,1\xb0\n"), "line 2 is not in UTF-8: it holds the byte 0xb0");
        assert_eq!(wrong(b"\xff\xfet"), "this is no valid UTF-16");
        let mut sheet = Sheet::decode("time,\u{e4}\n0,\"1\n1,2\n".into()).unwrap();
        sheet.row().unwrap();
        let open = sheet.row().unwrap_err();
        assert_eq!((open.message.as_str(), sheet.place(open.at)), ("this quote is not closed", (2, 3)));
    }
}
