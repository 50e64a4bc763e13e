//! Start values as users of other tools give them: a variable's name and a bare value in its own unit.

use dsl::scenario::{Preset, Value};
use fmi2::description::{Kind, ModelDescription};
use std::collections::BTreeSet;

/// The preset that a setting such as `mass = 1.6` means; `None` leaves it to the language of scripts, which knows units
/// of measure, groups and what is wrong with the rest.
pub(super) fn bare(setting: &str, description: &ModelDescription) -> Option<Preset> {
    let (name, value) = setting.split_once('=')?;
    let index = description.variable(name.trim())?;
    let variable = &description.variables[index];
    let value = parsed(value.trim(), &variable.kind).filter(|_| variable.has_settable_start())?;
    Some(Preset { variable: index, value })
}

/// The first of these presets that the description does not allow: what is wrong with it.
pub(super) fn missed_limits(presets: &[Preset], description: &ModelDescription) -> Option<String> {
    presets.iter().find_map(|preset| {
        let variable = &description.variables[preset.variable];
        let value = match preset.value {
            Value::Real(value) => value,
            Value::Integer(value) => f64::from(value),
            Value::Boolean(_) | Value::String(_) | Value::File(_) => return None,
        };
        let limits = description.limits_of(variable);
        let message = || format!("`{}` cannot be {value}: its description says {limits}", variable.name);
        (!limits.allow(value)).then(message)
    })
}

/// The first variable that gets two of these presets: what is wrong with it.
pub(super) fn given_twice<'a>(
    presets: impl IntoIterator<Item = &'a Preset>,
    description: &ModelDescription,
) -> Option<String> {
    let mut seen = BTreeSet::new();
    let twice = presets.into_iter().find(|preset| !seen.insert(preset.variable))?;
    Some(format!("`{}` gets two start values", description.variables[twice.variable].name))
}

fn parsed(text: &str, kind: &Kind) -> Option<Value> {
    match kind {
        Kind::Real(_) => text.parse().ok().filter(|value: &f64| value.is_finite()).map(Value::Real),
        Kind::Integer { .. } | Kind::Enumeration { .. } => text.parse().ok().map(Value::Integer),
        Kind::Boolean { .. } => match text {
            "true" | "1" => Some(Value::Boolean(true)),
            "false" | "0" => Some(Value::Boolean(false)),
            _ => None,
        },
        Kind::String { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::simulate::alone::tests::tank;

    #[test]
    fn a_bare_value_is_in_the_variables_own_unit() {
        let description = tank();
        let value = |setting| bare(setting, &description).map(|preset| preset.value);
        assert_eq!(value("area = 2.5"), Some(Value::Real(2.5)));
        assert_eq!(value("mode=2"), Some(Value::Integer(2)));
        assert_eq!(value("open = 0"), Some(Value::Boolean(false)));
    }

    #[test]
    fn a_bare_value_that_the_description_does_not_allow_is_named() {
        let description = tank();
        let missed = |setting| missed_limits(&[bare(setting, &description).unwrap()], &description);
        assert_eq!(missed("mode = 3").unwrap(), "`mode` cannot be 3: its description says the items 1, 2");
        assert_eq!(missed("mode = 2"), None);
        assert_eq!(missed("area = -1").unwrap(), "`area` cannot be -1: its description says min 0.5");
    }

    #[test]
    fn everything_else_is_left_to_the_language() {
        let description = tank();
        for setting in ["area = 2.5 m^2", "aera = 2", "area", "level = 3", "label = \"x\"", "area = inf", "open = yes"]
        {
            assert_eq!(bare(setting, &description), None, "{setting}");
        }
    }
}
