//! A violation in a description, with its position and rule.

use crate::printable;
use std::fmt;

use serde::{Deserialize, Serialize};

/// A position in `modelDescription.xml`, counted from 1; `0:0` for elements that were not read from a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// Severity of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Severity {
    /// A rule of the standard is broken.
    Error,
    /// No rule is broken, but some tools fail on it.
    Warning,
}

/// One violation in a description.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// Severity.
    pub severity: Severity,
    /// The section of FMI 2.0.5 with the rule, or `XML` where the file is not valid XML.
    pub rule: &'static str,
    /// Position in the file.
    pub position: Position,
    /// What was expected and what was found.
    pub message: String,
}

impl Finding {
    /// A broken rule.
    pub(crate) fn error(rule: &'static str, position: Position, message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, rule, position, message: message.into() }
    }

    /// A valid construct on which some tools fail.
    pub(crate) fn warning(rule: &'static str, position: Position, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, rule, position, message: message.into() }
    }
}

/// `12:5: error[2.2.7]: …`; without a position only `error[2.2.7]: …`.
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
        write!(f, "{severity}[{}]: {}", self.rule, printable::line(&self.message))
    }
}

impl std::error::Error for Finding {}
