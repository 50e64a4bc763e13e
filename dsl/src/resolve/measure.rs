//! Units of measure of ports, and their names in messages.

use fmi2::description::{Kind, Variable};
use fmi2::units::{BaseUnit, Dimension};

use super::meaning::{Measure, Origin, Real, UnitName};
use super::real;
use super::scope::Scope;
use crate::scenario::{MarginUnit, Port, RealExpression};

/// Dimensions with an everyday name; exponents of kg m s A K mol cd rad.
const QUANTITIES: [([i8; 8], &str); 22] = [
    ([0, 0, 0, 0, 0, 0, 0, 0], "a plain number"),
    ([0, 1, 0, 0, 0, 0, 0, 0], "a length"),
    ([1, 0, 0, 0, 0, 0, 0, 0], "a mass"),
    ([0, 0, 1, 0, 0, 0, 0, 0], "a time"),
    ([0, 0, 0, 0, 1, 0, 0, 0], "a temperature"),
    ([0, 0, 0, 1, 0, 0, 0, 0], "a current"),
    ([0, 0, 0, 0, 0, 0, 0, 1], "an angle"),
    ([0, 2, 0, 0, 0, 0, 0, 0], "an area"),
    ([0, 3, 0, 0, 0, 0, 0, 0], "a volume"),
    ([0, 1, -1, 0, 0, 0, 0, 0], "a speed"),
    ([0, 1, -2, 0, 0, 0, 0, 0], "an acceleration"),
    ([0, 0, -1, 0, 0, 0, 0, 0], "a frequency"),
    ([0, 0, -1, 0, 0, 0, 0, 1], "a turn rate"),
    ([0, 0, -2, 0, 0, 0, 0, 1], "an angular acceleration"),
    ([1, 1, -2, 0, 0, 0, 0, 0], "a force"),
    ([1, 2, -2, 0, 0, 0, 0, 0], "a torque"),
    ([1, 2, -3, 0, 0, 0, 0, 0], "a power"),
    ([1, -1, -2, 0, 0, 0, 0, 0], "a pressure"),
    ([1, -3, 0, 0, 0, 0, 0, 0], "a density"),
    ([1, 2, 0, 0, 0, 0, 0, 0], "a moment of inertia"),
    ([1, 2, -3, -1, 0, 0, 0, 0], "a voltage"),
    ([0, 3, -1, 0, 0, 0, 0, 0], "a volume flow"),
];

/// `a force`, or the base units where it has no common name.
pub(super) fn quantity(dimension: Dimension) -> String {
    let word = QUANTITIES.iter().find(|(exponents, _)| *exponents == dimension.0);
    word.map_or_else(|| format!("a quantity in {dimension}"), |(_, word)| (*word).to_owned())
}

/// The SI unit of a dimension as a script can write it: `kg*m/s^2`, `s^-1`, empty for a plain number.
pub(super) fn si_name(dimension: Dimension) -> String {
    let mut name = String::new();
    let powers = || Dimension::BASE_NAMES.iter().zip(dimension.0);
    for (base, exponent) in powers().filter(|&(_, exponent)| exponent > 0) {
        let star = if name.is_empty() { "" } else { "*" };
        let power = if exponent == 1 { String::new() } else { format!("^{exponent}") };
        name += &format!("{star}{base}{power}");
    }
    for (base, exponent) in powers().filter(|&(_, exponent)| exponent < 0) {
        name += &match (name.is_empty(), exponent) {
            (true, _) => format!("{base}^{exponent}"),
            (false, -1) => format!("/{base}"),
            (false, _) => format!("/{base}^{}", exponent.unsigned_abs()),
        };
    }
    name
}

/// A unit for people; on a scale with an offset, differences are in SI.
pub(super) fn unit_name(name: &str, base: BaseUnit, written: bool) -> UnitName {
    let unit = if base.offset == 0.0 {
        MarginUnit { name: name.to_owned(), factor: base.factor }
    } else {
        MarginUnit { name: si_name(base.dimension), factor: 1.0 }
    };
    UnitName { unit, spelt: name.to_owned(), written }
}

impl Scope<'_, '_> {
    /// The declared unit of a Real variable; `None` if nothing but perhaps a name is known.
    pub fn declared_unit(&self, port: Port) -> Option<BaseUnit> {
        self.known(port.instance).base_of(port.variable)
    }

    /// The value of a Real variable, in SI.
    pub fn real_port(&self, port: Port) -> Real {
        let name = self.known(port.instance).unit_of(port.variable).unwrap_or_default();
        let signal = RealExpression::Signal(port);
        let (expression, measure, unit) = match self.declared_unit(port) {
            Some(base) => (real::to_si(signal, base), Measure::Known(base.dimension), unit_name(name, base, false)),
            None => (signal, Measure::Undeclared, unit_name(name, BaseUnit::default(), false)),
        };
        Real { expression, measure, unit: Some(unit), origin: Origin::Port(port), scale: self.scale(port) }
    }

    /// `N  (kg m/s^2, quadcopter)`: the unit of a variable with its base units and the FMU.
    pub fn port_unit(&self, port: Port) -> String {
        let owner = &self.script.instances[port.instance].unit.text;
        let variable: &Variable = self.variable(port);
        let name = self.known(port.instance).unit_of(port.variable);
        match (name, self.declared_unit(port)) {
            (Some(name), Some(base)) => match base.dimension.to_string() {
                si if si == name => format!("{name}  ({owner})"),
                si => format!("{name}  ({si}, {owner})"),
            },
            (Some(name), None) => format!("{name}, which {owner} does not define"),
            (None, _) if matches!(variable.kind, Kind::Integer { .. }) => format!("an Integer  ({owner})"),
            (None, _) => format!("no declared unit  ({owner})"),
        }
    }

    /// The same for any value.
    pub fn described(&self, value: &Real) -> String {
        if let Origin::Port(port) = value.origin {
            return self.port_unit(port);
        }
        let Measure::Known(dimension) = value.measure else { return "a value without unit".to_owned() };
        let si = dimension.to_string();
        match &value.unit {
            Some(unit) if unit.spelt == si => si,
            Some(unit) if !unit.spelt.is_empty() => format!("{}  ({si})", unit.spelt),
            _ if dimension == Dimension::NONE => "a plain number".to_owned(),
            _ => si,
        }
    }
}

/// A number for people.
pub(super) fn six_digits(value: f64) -> String {
    let rounded = format!("{value:.6}");
    let short = rounded.trim_end_matches('0').trim_end_matches('.');
    let exact = format!("{value}");
    if exact.len() <= short.len() || value.abs() < 1e-3 { exact } else { short.to_owned() }
}

#[test]
fn a_dimension_is_written_as_a_script_can_read_it() {
    assert_eq!(si_name(Dimension([1, 1, -2, 0, 0, 0, 0, 0])), "kg*m/s^2");
    assert_eq!(si_name(Dimension([0, 0, -1, 0, 0, 0, 0, 0])), "s^-1");
    assert_eq!(si_name(Dimension([1, -1, -2, 0, 0, 0, 0, 0])), "kg/m/s^2");
    assert_eq!(si_name(Dimension::NONE), "");
}

#[test]
fn a_number_is_shown_with_six_decimals_at_most() {
    assert_eq!(six_digits(-0.333_333_333), "-0.333333");
    assert_eq!(six_digits(3.0), "3");
    assert_eq!(six_digits(1e-9), "0.000000001");
}
