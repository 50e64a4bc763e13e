//! Rules for names of variables: unique, and of the structured grammar where the description declares it.

use std::collections::BTreeMap;

use super::Report;
use crate::description::{Kind, NamingConvention};

const RULE: &str = "2.2.9";

pub(super) fn check(report: &mut Report) {
    let model = report.model;
    let names = model.variables.iter().map(|variable| (variable.name.as_str(), variable.position));
    report.unique("2.2.7", "a variable", names);
    if model.variable_naming_convention != NamingConvention::Structured {
        let is_broken = |name: &str| name.contains(['\n', '\r', '\t']);
        for variable in model.variables.iter().filter(|variable| is_broken(&variable.name)) {
            let name = variable.name.escape_debug();
            report.error(RULE, variable.position, format!("`{name}` has a line break or a tab in its name"));
        }
        return;
    }
    // For each array (the name without its last indices) the indices of its previous element.
    let mut arrays: BTreeMap<(&str, &str), (Vec<u32>, &str)> = BTreeMap::new();
    for variable in model.variables.iter().filter(|variable| !variable.name.is_empty()) {
        let (name, position) = (variable.name.as_str(), variable.position);
        let is_real = matches!(variable.kind, Kind::Real(_));
        if let Err(rest) = structured(name) {
            let read = &name[..name.len() - rest.len()];
            let why = match rest.chars().next() {
                None => "it ends too early".to_owned(),
                Some(letter) if read.is_empty() => format!("`{letter}` cannot begin it"),
                Some(letter) => format!("`{letter}` cannot follow `{read}`"),
            };
            let message = format!(
                "`{name}` is no structured name: {why}. Quote the part, as in 'odd name', or declare \
                 variableNamingConvention=\"flat\""
            );
            report.error(RULE, position, message);
            continue;
        }
        if name.starts_with("der(") && !is_real {
            report.error(RULE, position, format!("`{name}` is a derivative by its name, but no Real"));
        }
        let Some((array, indices, rest)) = last_indices(name) else { continue };
        if let Some((earlier, before)) = arrays.insert((array, rest), (indices.clone(), name))
            && earlier >= indices
        {
            let message = format!("`{name}` stands after `{before}`; elements of an array go row by row, upwards");
            report.warning(RULE, position, message);
        }
    }
}

/// The array's name, the numbers in its last brackets, and what follows them.
fn last_indices(name: &str) -> Option<(&str, Vec<u32>, &str)> {
    if name.contains('\'') {
        return None;
    }
    let (open, close) = (name.rfind('[')?, name.rfind(']')?);
    let indices: Result<Vec<u32>, _> = name.get(open + 1..close)?.split(',').map(str::parse).collect();
    Some((&name[..open], indices.ok()?, &name[close + 1..]))
}

/// Reads a structured name; the error is the part that could not be read.
fn structured(name: &str) -> Result<(), &str> {
    let rest = match name.strip_prefix("der(") {
        None => identifier(name)?,
        Some(inner) => {
            let mut rest = identifier(inner)?;
            if let Some(order) = rest.strip_prefix(',') {
                rest = digits(order).ok_or(order)?;
            }
            rest.strip_prefix(')').ok_or(rest)?
        }
    };
    if rest.is_empty() { Ok(()) } else { Err(rest) }
}

/// `part {"." part}`, each part with optional indices; returns what follows.
fn identifier(mut text: &str) -> Result<&str, &str> {
    loop {
        text = match text.strip_prefix('\'') {
            Some(quoted) => quoted_name(quoted)?,
            None => plain_name(text)?,
        };
        if let Some(inner) = text.strip_prefix('[') {
            text = indices(inner)?;
        }
        match text.strip_prefix('.') {
            Some(next) => text = next,
            None => return Ok(text),
        }
    }
}

fn plain_name(text: &str) -> Result<&str, &str> {
    let rest = text.trim_start_matches(|letter: char| letter.is_ascii_alphanumeric() || letter == '_');
    let starts_well = text.starts_with(|letter: char| letter.is_ascii_alphabetic() || letter == '_');
    if starts_well { Ok(rest) } else { Err(text) }
}

/// After the opening quote: characters and escapes up to the closing one.
fn quoted_name(text: &str) -> Result<&str, &str> {
    let mut rest = text;
    loop {
        let mut letters = rest.chars();
        match letters.next() {
            Some('\'') if rest.len() < text.len() => return Ok(letters.as_str()),
            Some('\\') if letters.next().is_some_and(|letter| r#"'"?\abfnrtv"#.contains(letter)) => {}
            Some(letter) if letter.is_ascii_alphanumeric() || "_!#$%&()*+,-./:;<>=?@[]^{}|~ ".contains(letter) => {}
            _ => return Err(rest),
        }
        rest = letters.as_str();
    }
}

/// After the opening bracket: whole numbers between commas up to the closing one.
fn indices(mut text: &str) -> Result<&str, &str> {
    loop {
        text = digits(text).ok_or(text)?;
        match text.strip_prefix(',') {
            Some(next) => text = next,
            None => return text.strip_prefix(']').ok_or(text),
        }
    }
}

/// The text after one or more digits.
fn digits(text: &str) -> Option<&str> {
    let rest = text.trim_start_matches(|letter: char| letter.is_ascii_digit());
    (rest.len() < text.len()).then_some(rest)
}
