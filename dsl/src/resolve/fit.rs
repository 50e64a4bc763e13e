//! Brings a value to the type and unit of the variable that takes it.

use std::rc::Rc;

use fmi2::description::Kind;
use fmi2::units::Dimension;

use super::condition::Condition;
use super::findings::Remedy;
use super::meaning::{Meaning, Measure, Origin, Real, Text};
use super::measure::{quantity, si_name};
use super::real;
use super::scope::Scope;
use super::script::RESERVED;
use super::signal::Signal;
use crate::diagnostic::{Diagnostic, Edit};
use crate::nearest::{listed, nearest};
use crate::scenario::{BooleanExpression, Curve, Drive, Port, RealExpression};
use crate::source::{FileRef, Span};
use crate::spelling;
use crate::syntax::{Expression, ExpressionKind};

/// A value in the type and unit of its target.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Fitted {
    /// What a run can compute.
    Drive(Drive),
    /// `file("x")`
    File(FileRef),
}

/// The places of an assignment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting<'p> {
    /// The value as written.
    pub source: Span,
    /// The target as written.
    pub target: Span,
    /// The arrow, if it is a connection.
    pub arrow: Option<&'p str>,
}

impl Scope<'_, '_> {
    /// The value as its target takes it.
    pub fn fit(&self, value: &Meaning, target: Port, at: Meeting<'_>) -> Option<Fitted> {
        let drive = match (&self.variable(target).kind, value) {
            (Kind::Real(_), Meaning::Real(value)) => self.fit_real(value, target, at)?,
            (Kind::Real(_), Meaning::Integer(port)) => Drive::Real(RealExpression::Signal(*port)),
            // A run checks that an Integer is the value of an item.
            (Kind::Integer { .. } | Kind::Enumeration { .. }, Meaning::Integer(port)) => Drive::Copy(*port),
            (Kind::Integer { .. } | Kind::Enumeration { .. } | Kind::Boolean { .. }, Meaning::Real(value))
                if matches!(value.expression, RealExpression::Curve(_)) =>
            {
                self.held_curve(value, target, at)?
            }
            (Kind::Integer { .. }, Meaning::Real(value)) => Drive::Integer(self.fit_integer(value, target, at)?),
            (Kind::Boolean { .. }, Meaning::Condition(Condition::Plain(BooleanExpression::Signal(port), _))) => {
                Drive::Copy(*port)
            }
            (Kind::Boolean { .. }, Meaning::Condition(condition)) => {
                Drive::Boolean(self.momentary(condition, at.source)?)
            }
            (Kind::Enumeration { .. }, Meaning::Item(port)) if self.same_items(*port, target) => Drive::Copy(*port),
            (Kind::Enumeration { .. }, Meaning::Item(port)) => {
                let message =
                    format!("`{}` and `{}` have different items", self.port_name(*port), self.port_name(target));
                let error = Diagnostic::error("E21", at.source, message).saying(self.items_with_values(*port));
                let error = error.label(at.target, self.items_with_values(target));
                return self.refuse(error.help("compare and compute instead: `x == \"item\"`"));
            }
            (Kind::Enumeration { .. }, Meaning::Text(Text::Literal(name))) => {
                Drive::Integer(self.item(target, name, at.source)?)
            }
            (Kind::String { .. }, Meaning::Text(Text::Literal(text))) => Drive::String(text.clone()),
            (Kind::String { .. }, Meaning::Text(Text::File(file))) => return Some(Fitted::File(file.clone())),
            (Kind::String { .. }, Meaning::Text(Text::Port(port))) => Drive::Copy(*port),
            (_, value) => return self.refuse(self.types_differ(value, target, at)),
        };
        self.refuse_driving_running(&drive, at.source)?;
        self.check_limits(&drive, target, at)?;
        Some(Fitted::Drive(drive))
    }

    fn fit_real(&self, value: &Real, target: Port, at: Meeting<'_>) -> Option<Drive> {
        let value = &self.read_for(value, target, at.source)?;
        let (Measure::Known(given), Some(taken)) = (value.measure, self.declared_unit(target)) else {
            self.warn_undeclared_target(value, target, at);
            return Some(match value.origin {
                Origin::Port(port) => Drive::Copy(port),
                _ => Drive::Real(value.expression.clone()),
            });
        };
        let agrees = match value.origin {
            Origin::Computed => given.without_angle() == taken.dimension.without_angle(),
            Origin::Literal { .. } | Origin::Port(_) => given == taken.dimension,
        };
        if !agrees {
            return self.refuse(self.dimensions_differ(value, target, at));
        }
        self.check_scale(value, target, at)?;
        Some(match value.origin {
            Origin::Literal { number, base, .. } if base == taken => Drive::Real(RealExpression::Constant(number)),
            Origin::Port(port) if self.declared_unit(port) == Some(taken) => Drive::Copy(port),
            _ => Drive::Real(real::from_si(value.expression.clone(), taken)),
        })
    }

    fn dimensions_differ(&self, value: &Real, target: Port, at: Meeting<'_>) -> Diagnostic {
        let (Measure::Known(given), Some(taken)) = (value.measure, self.declared_unit(target)) else {
            unreachable!("what is undeclared fits everything");
        };
        let (gives, takes) = (quantity(given), quantity(taken.dimension));
        let message = match at.arrow {
            Some(_) => format!("cannot connect {gives} to {takes}"),
            None => format!("cannot set {takes} to {gives}"),
        };
        let error = Diagnostic::error("E02", at.source, message).saying(format!("gives {}", self.described(value)));
        let error = error.label(at.target, format!("takes {}", self.port_unit(target)));
        let (source, sink) = (self.text(at.source), self.text(at.target));
        let unit = self.known(target.instance).unit_of(target.variable).unwrap_or_default();
        if value.measure == Measure::PLAIN && value.constant().is_some() {
            return error.help(with_unit(&source, unit));
        }
        if taken.dimension == Dimension::NONE {
            let own = value.unit.as_ref().map_or(si_name(given), |unit| unit.spelt.clone());
            return error.help(format!("take the number out: `{source} in {own}`"));
        }
        let factor = taken.dimension.checked_div(given).map(si_name).filter(|factor| !factor.is_empty());
        let source = if source.contains(' ') { format!("({source})") } else { source };
        match (at.arrow, factor) {
            (Some(arrow), Some(factor)) => {
                error.help(format!("compute it on the left, for example `{source} * 0.2 {factor} {arrow} {sink}`"))
            }
            _ => error.help(format!("it takes a value such as `1 {unit}`")),
        }
    }

    /// A curve that drives a variable of another type than Real: its rows are held.
    fn held_curve(&self, value: &Real, target: Port, at: Meeting<'_>) -> Option<Drive> {
        let RealExpression::Curve(curve) = &value.expression else { return None };
        let is_boolean = matches!(self.variable(target).kind, Kind::Boolean { .. });
        let range = if is_boolean { 0.0..=1.0 } else { f64::from(i32::MIN)..=f64::from(i32::MAX) };
        let fits = |value: f64| value.fract() == 0.0 && range.contains(&value);
        if let Some((time_s, value)) = curve.rows.iter().find(|(_, value)| !fits(*value)) {
            let what = if is_boolean { "a Boolean, true or false," } else { "a whole number of 32 bits" };
            let message = format!("`{}` takes {what} and the column has {value} at {time_s} s", self.port_name(target));
            return self.refuse(Diagnostic::error("E38", at.source, message).help("mend the column, or take another"));
        }
        Some(Drive::Curve(Curve { held: true, ..(**curve).clone() }))
    }

    fn fit_integer(&self, value: &Real, target: Port, at: Meeting<'_>) -> Option<i32> {
        let name = self.port_name(target);
        let Some(number) = value.constant().filter(|_| value.measure == Measure::PLAIN) else {
            let message = format!("`{name}` takes an Integer, a real is not narrowed to one");
            let error = Diagnostic::error("E21", at.source, message).saying(format!("gives {}", self.described(value)));
            return self.refuse(
                error.label(at.target, "takes an Integer").help("connect an Integer output, or write a whole number"),
            );
        };
        if number.fract() != 0.0 || number < f64::from(i32::MIN) || number > f64::from(i32::MAX) {
            let message = format!("`{name}` takes an Integer, and {number} is none");
            let error = Diagnostic::error("E38", at.source, message);
            return self.refuse(error.help(format!("Integers are whole and go from {} to {}", i32::MIN, i32::MAX)));
        }
        Some(number as i32)
    }

    /// What a value means that goes to this signal: the bare name of an item is refused as one.
    pub fn evaluate_for(&self, value: &Expression, target: Option<&Signal>) -> Option<Rc<Meaning>> {
        let (ExpressionKind::Path(path), Some(Signal::One(port))) = (&value.kind, target) else {
            return self.evaluate(value);
        };
        let is_enumeration = matches!(self.variable(*port).kind, Kind::Enumeration { .. });
        let is_known = self.look_up(&path.root.text).is_some() || RESERVED.contains(&&*path.root.text);
        if !is_enumeration || is_known || !path.tail.is_empty() {
            return self.evaluate(value);
        }
        let items = self.known(port.instance).items_of(port.variable).iter().map(|item| item.name.as_str());
        let message = format!("`{}` takes an item in quotes", self.port_name(*port));
        let error = Diagnostic::error("E34", value.span, message);
        self.refuse(match nearest(&path.root.text, items) {
            Some(near) => {
                let text = format!("write `\"{near}\"`");
                error.help(text.clone()).fix(text, [Edit::new(value.span, format!("\"{near}\""))])
            }
            None => error.help(format!("its items are {}", self.items(*port))),
        })
    }

    /// The value of an enumeration's item.
    pub fn item(&self, port: Port, name: &str, span: Span) -> Option<i32> {
        let items = self.known(port.instance).items_of(port.variable);
        if let Some(item) = items.iter().find(|item| item.name == name) {
            return Some(item.value);
        }
        let error = Diagnostic::error("E34", span, format!("`{}` has no item `{name}`", self.port_name(port)));
        let written = name.to_owned();
        self.refuse_and_search(error, move |scope| {
            let items = scope.known(port.instance).items_of(port.variable);
            let near = nearest(&written, items.iter().map(|item| item.name.as_str()));
            Some(match near {
                Some(near) => {
                    let help = format!("did you mean \"{near}\"? Its items are {}", scope.items(port));
                    Remedy { help, ..Remedy::meant(&format!("\"{near}\""), span) }
                }
                None => Remedy::from(format!("its items are {}", scope.items(port))),
            })
        })
    }

    fn items(&self, port: Port) -> String {
        let items = self.known(port.instance).items_of(port.variable);
        listed(items.iter().map(|item| item.name.as_str()))
    }

    /// The items in order of their values.
    fn items_with_values(&self, port: Port) -> String {
        let mut items: Vec<_> = self.known(port.instance).items_of(port.variable).iter().collect();
        items.sort_by_key(|item| item.value);
        let items = items.iter().map(|item| format!("`{}` = {}", item.name, item.value));
        items.collect::<Vec<_>>().join(", ")
    }

    fn types_differ(&self, value: &Meaning, target: Port, at: Meeting<'_>) -> Diagnostic {
        let takes = match self.variable(target).kind {
            Kind::Real(_) => "a Real",
            Kind::Integer { .. } => "an Integer",
            Kind::Boolean { .. } => "a Boolean",
            Kind::Enumeration { .. } => "an Enumeration",
            Kind::String { .. } => "a String",
        };
        let message = format!("`{}` takes {takes}, found {}", self.port_name(target), value.kind());
        let error = Diagnostic::error("E21", at.source, message).saying(format!("gives {}", value.kind()));
        let error = error.label(at.target, format!("takes {takes}"));
        match (&self.variable(target).kind, value) {
            (Kind::Enumeration { .. }, _) => error.help(format!("it takes one of {} in quotes", self.items(target))),
            (Kind::Boolean { .. }, Meaning::Real(_) | Meaning::Integer(_)) => {
                error.help("a comparison is a Boolean: `x > 0.5`")
            }
            _ => error.help("types have to be equal; only an Integer widens to a Real"),
        }
    }
}

/// The help for a plain number where one with a unit of measure is meant: units stand at literals only.
pub(super) fn with_unit(number: &str, unit: &str) -> String {
    let is_literal = number.parse::<f64>().is_ok();
    format!("write the unit: `{number} {}{}`", if is_literal { "" } else { "* 1 " }, spelling::unit(unit))
}
