//! Literals mean what the variable that they meet makes of their unit of measure: its FMU's definition of the name, a
//! difference where it is one, the bare number where the name has no definition.

use fmi2::units::BaseUnit;

use super::meaning::{Measure, Origin, Real};
use super::measure::unit_name;
use super::scale::Scale;
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::{Port, RealExpression};
use crate::source::Span;

/// A number with its unit, as written.
pub(super) fn literal(number: f64, base: BaseUnit, name: &str) -> Real {
    Real {
        expression: RealExpression::Constant(base.to_si(number)),
        measure: Measure::Known(base.dimension),
        unit: Some(unit_name(name, base, true)),
        origin: Origin::Literal { number, base, has_unit: true },
        scale: if base.offset == 0.0 { Scale::Either } else { Scale::Point { offset: true } },
    }
}

/// A number in a unit of measure of which only the name is known.
fn number_of(number: f64, name: &str) -> Real {
    Real { measure: Measure::Undeclared, ..literal(number, BaseUnit::default(), name) }
}

impl Scope<'_, '_> {
    /// A value as the variable that takes it reads it.
    pub fn read_for(&self, value: &Real, target: Port, span: Span) -> Option<Real> {
        let is_difference = self.known(target.instance).is_relative(target.variable);
        self.read(value, span, Some(target), is_difference)
    }

    /// A value as it is read in a sum or comparison with another.
    pub fn read_beside(&self, (value, span): (&Real, Span), other: &Real) -> Option<Real> {
        self.read(value, span, other.port(), other.scale.is_difference())
    }

    /// A value that meets no variable.
    pub fn read_alone(&self, value: &Real, span: Span) -> Option<Real> {
        self.read(value, span, None, false)
    }

    fn read(&self, value: &Real, span: Span, by: Option<Port>, is_difference: bool) -> Option<Real> {
        let (Origin::Literal { number, base, has_unit: true }, Some(unit)) = (value.origin, &value.unit) else {
            return Some(value.clone());
        };
        let name = unit.spelt.as_str();
        let own = by.and_then(|port| self.known(port.instance).unit(name)?.base);
        if own.is_none() && by.is_some_and(|port| self.undefined_unit(port) == Some(name)) {
            return Some(number_of(number, name));
        }
        if own.is_none() && self.meanings_of_unit(name).len() > 1 {
            return self.refuse(self.two_meanings(name, span));
        }
        let base = own.unwrap_or(base);
        let base = if is_difference { BaseUnit { offset: 0.0, ..base } } else { base };
        Some(literal(number, base, name))
    }

    /// The name of a variable's unit of measure if its FMU does not define it.
    pub fn undefined_unit(&self, port: Port) -> Option<&str> {
        let unit = self.known(port.instance);
        unit.unit_of(port.variable).filter(|_| unit.base_of(port.variable).is_none())
    }

    fn two_meanings(&self, name: &str, span: Span) -> Diagnostic {
        let meanings = self.meanings_of_unit(name).iter().map(|(base, instance)| {
            format!("{} in {}", super::unit_name::shown(*base), self.script.instances[*instance].name)
        });
        let meanings = meanings.collect::<Vec<_>>().join(", ");
        let error = Diagnostic::error("E33", span, format!("`{name}` has two meanings here")).saying(meanings);
        error.help(
            "only a value that goes to or is compared with a variable takes its FMU's meaning; write another unit",
        )
    }
}
