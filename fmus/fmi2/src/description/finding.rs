//! What is wrong with a description, where, and by which rule.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A place in `modelDescription.xml`, counted from 1; `0:0` for what was never read from a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Severity {
    /// A rule of the standard is broken.
    Error,
    /// No rule is broken, but tools stumble over it.
    Warning,
}

/// One thing that is wrong with a description.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// The section of FMI 2.0.5 that says so, or `XML` where the file is no readable XML.
    pub rule: &'static str,
    /// Where it was found.
    pub position: Position,
    /// What was expected and what was found.
    pub message: String,
}

impl Finding {
    /// A broken rule.
    pub(crate) fn error(rule: &'static str, position: Position, message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, rule, position, message: message.into() }
    }

    /// A habit that tools stumble over.
    pub(crate) fn warning(rule: &'static str, position: Position, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, rule, position, message: message.into() }
    }
}

/// `12:5: error[2.2.7]: …`; without a place only `error[2.2.7]: …`.
impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Position { line, column } = self.position;
        if line > 0 {
            write!(f, "{line}:{column}: ")?;
        }
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        write!(f, "{severity}[{}]: {}", self.rule, self.message)
    }
}

impl std::error::Error for Finding {}
