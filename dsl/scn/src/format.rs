//! One style for scripts, made by changing blanks and line breaks only.
//!
//! ```text
//! text --tokens--> tokens, comments among them --lines--> lines with indentation --align--> columns --> text
//! ```
//!
//! Line breaks stay where they are; empty lines in a row become one. Every brace indents by two blanks, and so does a
//! bracket that a later line closes and a line that continues a statement. `=`, arrows, the conditions of claims, the
//! clauses and braces of units and comments at the end of lines are aligned in neighbouring lines of one kind. Of the
//! tokens only units of measure change: `m/s2` becomes `m/s^2`.

mod align;
mod lines;
mod tokens;

use crate::diagnostic::Diagnostic;
use crate::parse::shape;
use crate::source::Sources;

/// One text of `sources`, a whole file, in the style of the language. What is formatted stays as it is when it is formatted
/// again, and has the same meaning.
///
/// # Errors
/// Every syntax error of the text.
pub fn format(sources: &Sources, text: u32) -> Result<String, Vec<Diagnostic>> {
    let shape = shape(sources, text)?;
    let tokens = tokens::tokens(sources.text(text), &shape);
    let mut lines = lines::lines(&tokens);
    align::align(&mut lines);
    Ok(lines.iter().map(lines::Line::text).collect())
}

#[cfg(test)]
mod tests;
