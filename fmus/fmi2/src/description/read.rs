//! Reads `modelDescription.xml` from bytes: everything readable is read, and everything invalid becomes a finding.
//!
//! Neither the parser nor this reader recurses, so nesting needs no limit; document type definitions, and with them
//! entities, are rejected.

mod element;
mod encoding;
mod header;
mod structure;
mod types;
mod variable;

use element::{Element, Source};

use super::{Finding, ModelDescription, Position};

/// The largest file that is read, in bytes.
pub const MAX_BYTES: usize = 64 << 20;
/// The largest number of elements, texts and comments in a file.
pub const MAX_NODES: u32 = 4_000_000;

/// Reads a description and reports invalid syntax; [`check`](super::check::check) then checks the rules of the
/// standard.
///
/// # Errors
/// One finding with the reason why the file is unreadable: too large, an unknown encoding, not XML, or not FMI 2.0.
pub fn read(bytes: &[u8]) -> Result<(ModelDescription, Vec<Finding>), Finding> {
    if bytes.len() > MAX_BYTES {
        let message = format!("the file has {} bytes; at most {MAX_BYTES} are read", bytes.len());
        return Err(Finding::error("XML", Position::default(), message));
    }
    let (text, odd_encoding) = encoding::decode(bytes)?;
    let options = roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(&text, options).map_err(|error| not_xml(&error, &text))?;
    let source = Source::new(&text);
    source.extend(odd_encoding);
    let root = Element::new(document.root_element(), &source);
    if root.name() != "fmiModelDescription" {
        let message = format!("the root element is `{}`; expected `fmiModelDescription`", root.name());
        return Err(Finding::error("2.2.1", root.position(), message));
    }
    // A missing version is reported by the checker; another major version is another format.
    let version = root.attribute("fmiVersion").unwrap_or_default().trim();
    if !version.is_empty() && version.split('.').next() != Some("2") {
        let message = format!("the unit is made for FMI {version}; expected FMI 2.0");
        return Err(Finding::error("2.2.1", root.position(), message));
    }
    let model = header::model_description(&root);
    Ok((model, source.into_findings()))
}

/// The message of the XML parser without its position, because the finding has its own.
fn not_xml(error: &roxmltree::Error, text: &str) -> Finding {
    use roxmltree::Error;
    let at = error.pos();
    let said = error.to_string();
    let said = said.strip_suffix(&format!(" at {}:{}", at.row, at.col)).unwrap_or(&said);
    let parsed = Position { line: at.row, column: at.col };
    let (position, message) = match error {
        Error::DtdDetected => {
            let before = text.split("<!DOCTYPE").next().unwrap_or_default();
            (encoding::end_of(before), "a document type definition is refused: it could pull in other files".to_owned())
        }
        Error::NodesLimitReached => (parsed, format!("the file has more than {MAX_NODES} elements and texts")),
        Error::UnexpectedEndOfStream | Error::UnclosedRootNode => {
            (encoding::end_of(text), "the file ends before its root element does".to_owned())
        }
        Error::NoRootNode => (parsed, "the file has no root element".to_owned()),
        _ => (parsed, said.to_owned()),
    };
    Finding::error("XML", position, message)
}

#[cfg(test)]
mod tests;
