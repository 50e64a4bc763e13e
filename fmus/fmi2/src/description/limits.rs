//! The values that a description allows a variable: `min` and `max`, of the variable or its type, and the items of an
//! enumeration.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{Kind, ModelDescription, TypeKind, Variable};

/// How far a Real may be beyond its limit, relative to the limit: a value that was converted from another unit of measure
/// differs from the number in the description by rounding.
const ROUNDING: f64 = 1e-12;

/// The values that a variable may take, in its own unit of measure.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// `min`
    pub min: Option<f64>,
    /// `max`
    pub max: Option<f64>,
    /// The values of the items of an enumeration; empty for other variables.
    pub items: Vec<i32>,
}

impl Limits {
    /// The limits of a variable whose declared type is this one.
    #[must_use]
    pub fn of(variable: &Variable, declared: Option<&TypeKind>) -> Self {
        let whole = |limit: Option<i32>| limit.map(f64::from);
        match (&variable.kind, declared) {
            (Kind::Real(real), Some(TypeKind::Real(inherited))) => {
                Self { min: real.min.or(inherited.min), max: real.max.or(inherited.max), items: Vec::new() }
            }
            (Kind::Real(real), _) => Self { min: real.min, max: real.max, items: Vec::new() },
            (Kind::Integer { min, max, .. }, Some(TypeKind::Integer { min: low, max: high })) => {
                Self { min: whole(min.or(*low)), max: whole(max.or(*high)), items: Vec::new() }
            }
            (Kind::Integer { min, max, .. }, _) => Self { min: whole(*min), max: whole(*max), items: Vec::new() },
            (Kind::Enumeration { min, max, .. }, declared) => {
                let items = match declared {
                    Some(TypeKind::Enumeration { items, .. }) => items.iter().map(|item| item.value).collect(),
                    _ => Vec::new(),
                };
                Self { min: whole(*min), max: whole(*max), items }
            }
            (Kind::Boolean { .. } | Kind::String { .. }, _) => Self::default(),
        }
    }

    /// Whether every value is allowed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.min.is_none() && self.max.is_none() && self.items.is_empty()
    }

    /// Whether a value is allowed; not-a-number, to which limits do not apply, is.
    #[must_use]
    pub fn allow(&self, value: f64) -> bool {
        let is_below = self.min.is_some_and(|min| value < min - ROUNDING * min.abs());
        let is_above = self.max.is_some_and(|max| value > max + ROUNDING * max.abs());
        let is_item = || self.items.iter().any(|&item| f64::from(item) == value);
        !is_below && !is_above && (self.items.is_empty() || is_item())
    }
}

/// `min 0 and max 10`, `max 10`, `the items 1, 2 and 5`.
impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        if !self.items.is_empty() {
            let items: Vec<_> = self.items.iter().map(ToString::to_string).collect();
            parts.push(format!("the items {}", items.join(", ")));
        }
        parts.extend(self.min.map(|min| format!("min {min}")));
        parts.extend(self.max.map(|max| format!("max {max}")));
        f.write_str(&parts.join(" and "))
    }
}

impl ModelDescription {
    /// The values that one of its variables may take.
    #[must_use]
    pub fn limits_of(&self, variable: &Variable) -> Limits {
        let declared = variable.declared_type.as_deref().and_then(|name| self.simple_type(name));
        Limits::of(variable, declared.map(|declared| &declared.kind))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_and_not_a_number_are_allowed() {
        let limits = Limits { min: Some(-0.1), max: Some(0.3), items: Vec::new() };
        for value in [-0.1, 0.1 + 0.2, f64::NAN] {
            assert!(limits.allow(value), "{value}");
        }
        for value in [-0.100_000_1, 0.300_000_1, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!limits.allow(value), "{value}");
        }
        assert!(!Limits { min: Some(0.0), ..Limits::default() }.allow(-1e-300));
        assert!(Limits { items: vec![1, -3], ..Limits::default() }.allow(-3.0));
        assert!(!Limits { items: vec![1, -3], ..Limits::default() }.allow(2.0));
    }

    #[test]
    fn limits_of_the_variable_precede_those_of_its_type() {
        let xml = br#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/>
          <TypeDefinitions>
            <SimpleType name="Part"><Real min="0" max="9"/></SimpleType>
            <SimpleType name="Mode"><Enumeration><Item name="a" value="1"/><Item name="b" value="5"/></Enumeration></SimpleType>
          </TypeDefinitions>
          <ModelVariables>
            <ScalarVariable name="part" valueReference="0"><Real declaredType="Part" max="1"/></ScalarVariable>
            <ScalarVariable name="mode" valueReference="0"><Enumeration declaredType="Mode"/></ScalarVariable>
            <ScalarVariable name="free" valueReference="1"><Real/></ScalarVariable>
          </ModelVariables></fmiModelDescription>"#;
        let (description, _) = crate::description::read::read(xml).unwrap_or_else(|finding| panic!("{finding:?}"));
        let shown = description.variables.iter().map(|variable| description.limits_of(variable).to_string());
        assert_eq!(shown.collect::<Vec<_>>(), ["min 0 and max 1", "the items 1, 5", ""]);
    }
}
