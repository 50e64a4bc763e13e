//! Values that meet a variable whose unit of measure is not known: none is declared, or a name without a definition.

use fmi2::units::parse;

use super::fit::Meeting;
use super::meaning::{Measure, Origin, Real};
use super::measure::{si_name, six_digits};
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::nearest::listed;
use crate::scenario::Port;
use crate::source::Span;
use crate::spelling;

impl Scope<'_, '_> {
    /// Warns where the number that a variable gets is not what both units of measure say.
    pub fn warn_undeclared_target(&self, value: &Real, target: Port, at: Meeting<'_>) {
        let name = self.port_name(target);
        let undefined = self.undefined_unit(target);
        match (value.origin, undefined) {
            (Origin::Port(source), _) => self.warn_other_name(source, target, at),
            (Origin::Literal { has_unit: true, .. }, _) if self.declared_unit(target).is_none() => {
                self.warn_undeclared(value, at.source, &name, Some(target));
            }
            (Origin::Computed, Some(unit)) if !matches!(value.measure, Measure::PLAIN | Measure::Undeclared) => {
                let Measure::Known(dimension) = value.measure else { return };
                let (source, si) = (self.text(at.source), si_name(dimension));
                let message = format!("{}; the value is passed in {si}", self.is_in_undefined(&name, unit, target));
                let warning = Diagnostic::warning("W01", at.source, message);
                let help = format!("to convert it write `({source}) in {}`", spelling::unit(unit));
                let accept = format!("to accept it write `({source}) in {si}`");
                let converts = parse(unit).is_ok_and(|base| base.dimension == dimension);
                self.report(warning.help(if converts { format!("{help}; {accept}") } else { accept }));
            }
            _ => {}
        }
    }

    /// `` `a.v` is in km/h, which nu.fmu does not define``
    fn is_in_undefined(&self, name: &str, unit: &str, port: Port) -> String {
        format!("`{name}` is in {unit}, which {} does not define", self.script.instances[port.instance].unit.text)
    }

    /// Warns of a connection between units of measure of different names of which one has no definition.
    fn warn_other_name(&self, source: Port, target: Port, at: Meeting<'_>) {
        let Some([gives, takes]) = self.other_names([source, target]) else { return };
        let is_undefined = [source, target].map(|port| self.undefined_unit(port).is_some());
        let message = format!("{}: the number passes as it is", self.names_differ((source, gives), (target, takes)));
        let warning = Diagnostic::warning("W01", at.source, message).saying(format!("gives {gives}"));
        let warning = warning.label(at.target, format!("takes {takes}"));
        let (from, to) = (self.port_name(source), self.port_name(target));
        let converts = match (parse(gives), parse(takes)) {
            (Ok(gives), Ok(takes)) => gives.dimension == takes.dimension,
            _ => false,
        };
        let (gives, takes) = (spelling::unit(gives), spelling::unit(takes));
        let convert = match is_undefined {
            [true, true] => format!("({from} as {gives}) in {takes}"),
            [true, false] => format!("{from} as {gives}"),
            [false, _] => format!("{from} in {takes}"),
        };
        let written = |value: &str| at.arrow.map_or(value.to_owned(), |arrow| format!("{value} {arrow} {to}"));
        let accept = format!("to accept it write `{}`", written(&format!("1 * {from}")));
        self.report(warning.help(match converts {
            true => format!("to convert it write `{}`; {accept}", written(&convert)),
            false => accept,
        }));
    }

    /// The names of the units of measure of two variables, if they differ and not both have a definition.
    fn other_names(&self, ports: [Port; 2]) -> Option<[&str; 2]> {
        let names = ports.map(|port| self.known(port.instance).unit_of(port.variable));
        let [Some(left), Some(right)] = names else { return None };
        let is_undefined = ports.iter().any(|port| self.undefined_unit(*port).is_some());
        (left != right && is_undefined).then_some([left, right])
    }

    fn names_differ(&self, (left, of_left): (Port, &str), (right, of_right): (Port, &str)) -> String {
        let lacking = [(left, of_left), (right, of_right)].into_iter();
        let lacking: Vec<_> =
            lacking.filter(|(port, _)| self.undefined_unit(*port).is_some()).map(|(_, name)| name).collect();
        let have = if lacking.len() > 1 { "have" } else { "has" };
        let (left, right, lacking) = (self.port_name(left), self.port_name(right), listed(lacking));
        format!("`{left}` is in {of_left} and `{right}` in {of_right}, and {lacking} {have} no definition")
    }

    /// Warns that two variables meet in a sum or comparison whose units of measure differ by name and are not both defined.
    pub fn warn_other_names(&self, left: (&Real, Span), right: (&Real, Span)) {
        let (Some(of_left), Some(of_right)) = (left.0.port(), right.0.port()) else { return };
        let Some([l, r]) = self.other_names([of_left, of_right]) else { return };
        let message = format!("{}: the numbers meet as they are", self.names_differ((of_left, l), (of_right, r)));
        let warning =
            Diagnostic::warning("W01", left.1, message).saying(format!("in {l}")).label(right.1, format!("in {r}"));
        self.report(warning.help("give a value without a defined unit its unit by `as`, for example `x as km/h`"));
    }

    /// Warns that a quantity is passed to a variable without a known unit, or meets one.
    /// `variable` is the text of what it meets, `of` the variable if it is one.
    pub fn warn_undeclared(&self, value: &Real, span: Span, variable: &str, of: Option<Port>) {
        let (Origin::Literal { number, base, has_unit: true }, Some(si)) = (value.origin, value.constant()) else {
            return;
        };
        if value.measure == Measure::Undeclared {
            return;
        }
        let undefined = of.and_then(|port| Some((port, self.undefined_unit(port)?)));
        let written = spelling::unit(value.unit.as_ref().map_or("", |unit| unit.spelt.as_str()));
        let si_unit = si_name(base.dimension);
        let shown = if si_unit.is_empty() { String::new() } else { format!(" ({si_unit})") };
        let why = match undefined {
            Some((port, unit)) => self.is_in_undefined(variable, unit, port),
            None => format!("`{variable}` declares no unit"),
        };
        let message = format!("{why}; {number} {written} is passed as {}{shown}", six_digits(si));
        let accept = if si_unit.is_empty() { format!("{si}") } else { format!("{number} {written} in {si_unit}") };
        let accept = format!("to accept it write `{accept}`");
        let converted = undefined.filter(|(_, unit)| parse(unit).is_ok_and(|own| own.dimension == base.dimension));
        let help = match converted {
            Some((_, unit)) => {
                format!("to convert it write `{number} {written} in {}`; {accept}", spelling::unit(unit))
            }
            None if si == number => accept,
            None => format!("to pass {number} write `{number} {written} in {written}`; {accept}"),
        };
        self.report(Diagnostic::warning("W01", span, message).help(help));
    }
}
