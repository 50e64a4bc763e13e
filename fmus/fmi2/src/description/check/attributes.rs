//! Rules for the attributes that types and variables share: ranges, nominal values and units of Reals.

use std::fmt::Display;

use super::Report;
use crate::description::{Position, RealAttributes};

/// The element whose attributes are checked: the rule's section, the position and the element's name in messages.
pub(super) struct Place<'a> {
    pub(super) rule: &'static str,
    pub(super) position: Position,
    pub(super) what: &'a str,
}

/// Checks for finite numbers, a positive nominal value, and a defined unit.
pub(super) fn check(report: &mut Report, place: &Place, real: &RealAttributes) {
    let Place { rule, position, what } = *place;
    for (name, value) in [("min", real.min), ("max", real.max), ("nominal", real.nominal)] {
        match value {
            Some(value) if !value.is_finite() => {
                report.error(rule, position, format!("{what} has {name} {value}; expected a finite number"));
            }
            Some(value) if name == "nominal" && value <= 0.0 => {
                report.error(rule, position, format!("{what} has nominal {value}; expected more than 0"));
            }
            _ => {}
        }
    }
    if let Some(unit) = &real.unit
        && !report.units.contains_key(unit.as_str())
    {
        report.error(rule, position, format!("{what} has the unit `{unit}`, which UnitDefinitions does not define"));
    }
}

/// Checks that the display unit belongs to the unit: the element's own or the one inherited from the declared type.
pub(super) fn display_unit(report: &mut Report, place: &Place, real: &RealAttributes, inherited: Option<&str>) {
    let Place { rule, position, what } = *place;
    let Some(display) = &real.display_unit else { return };
    let Some(unit) = real.unit.as_deref().or(inherited) else {
        report.error(rule, position, format!("{what} has the displayUnit `{display}`, but no unit"));
        return;
    };
    let Some(definition) = report.units.get(unit) else { return };
    if !definition.display_units.iter().any(|known| known.name == *display) {
        let known: Vec<_> = definition.display_units.iter().map(|known| format!("`{}`", known.name)).collect();
        let has = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        let message = format!("{what} has the displayUnit `{display}`, but the display units of `{unit}` are: {has}");
        report.error(rule, position, message);
    }
}

/// Checks `min <= max`.
pub(super) fn range<T: PartialOrd + Display>(report: &mut Report, place: &Place, min: Option<T>, max: Option<T>) {
    if let (Some(min), Some(max)) = (min, max)
        && min > max
    {
        report.error(place.rule, place.position, format!("{} has min {min} above max {max}", place.what));
    }
}
