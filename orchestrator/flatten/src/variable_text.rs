//! Values of variables as scripts write them.

use dsl::scenario::Value;
use dsl::spelling;
use fmi2::description::{Kind, ModelDescription, Variable};
use fmi2::printable;

/// The start value as scripts write it, without its unit of measure; empty if there is none.
#[must_use]
pub fn start(description: &ModelDescription, variable: &Variable) -> String {
    let start = match &variable.kind {
        Kind::Real(real) => real.start.map(Value::Real),
        Kind::Integer { start, .. } | Kind::Enumeration { start, .. } => start.map(Value::Integer),
        Kind::Boolean { start } => start.map(Value::Boolean),
        Kind::String { start } => start.clone().map(Value::String),
    };
    start.map(|start| value(description, variable, &start)).unwrap_or_default()
}

/// A value of a variable as scripts write it, without its unit of measure; an enumeration's by the name of its item.
#[must_use]
pub fn value(description: &ModelDescription, variable: &Variable, value: &Value) -> String {
    match value {
        Value::Real(value) => results::shortest_decimal(*value),
        Value::Integer(value) => {
            let item = description.items_of(variable).iter().find(|item| item.value == *value);
            item.map_or_else(|| value.to_string(), |item| printable::line(&spelling::text(&item.name)))
        }
        Value::Boolean(value) => value.to_string(),
        Value::String(text) => printable::line(&spelling::text(text)),
        Value::File(file) => format!("file({})", spelling::text(&file.path)),
    }
}
