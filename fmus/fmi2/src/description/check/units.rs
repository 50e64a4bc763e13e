//! Rules for `UnitDefinitions`.

use super::Report;
use crate::description::{DisplayUnit, UnitDefinition};
use crate::units::{BaseUnit, parse};

const RULE: &str = "2.2.2";

pub(super) fn check(report: &mut Report) {
    let model = report.model;
    report.unique(RULE, "a unit", model.units.iter().map(|unit| (unit.name.as_str(), unit.position)));
    for unit in &model.units {
        if let Some(base) = &unit.base {
            base_unit(report, unit, base);
        }
        let displays = unit.display_units.iter().map(|display| (display.name.as_str(), display.position));
        report.unique(RULE, &format!("a display unit of `{}`", unit.name), displays);
        for display in &unit.display_units {
            display_unit(report, unit, display);
        }
    }
}

fn base_unit(report: &mut Report, unit: &UnitDefinition, base: &BaseUnit) {
    let name = &unit.name;
    if !base.factor.is_finite() || base.factor == 0.0 || !base.offset.is_finite() {
        let message = format!(
            "the unit `{name}` has factor {} and offset {}; expected finite numbers and a factor that is not 0",
            base.factor, base.offset
        );
        report.error(RULE, unit.position, message);
        return;
    }
    // A name that is a known unit expression should have that meaning.
    let Ok(usual) = parse(name) else { return };
    let relative = (base.factor / usual.factor - 1.0).abs();
    if usual.dimension != base.dimension {
        let message = format!("`{name}` is defined as {}, but usually means {}", base.dimension, usual.dimension);
        report.warning(RULE, unit.position, message);
    } else if relative > 1e-6 || (base.offset - usual.offset).abs() > 1e-6 {
        let message = format!(
            "`{name}` is defined with factor {} and offset {}, but usually has {} and {}",
            base.factor, base.offset, usual.factor, usual.offset
        );
        report.warning(RULE, unit.position, message);
    }
}

fn display_unit(report: &mut Report, unit: &UnitDefinition, display: &DisplayUnit) {
    if !display.factor.is_finite() || display.factor == 0.0 || !display.offset.is_finite() {
        let message = format!(
            "the display unit `{}` of `{}` has factor {} and offset {}; expected finite numbers and a factor that is not 0",
            display.name, unit.name, display.factor, display.offset
        );
        report.error(RULE, display.position, message);
    }
}
