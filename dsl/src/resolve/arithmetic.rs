//! Sums and products of numbers and vectors.

use std::rc::Rc;

use super::fit::with_unit;
use super::meaning::{Meaning, Measure, Real, UnitName};
use super::measure::quantity;
use super::real;
use super::scale::Scale;
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::syntax::{Expression, Operator};

/// Two operands with their places.
#[derive(Clone, Copy)]
pub(super) struct Pair<'m> {
    /// The left operand.
    pub left: (&'m Real, Span),
    /// The right operand.
    pub right: (&'m Real, Span),
}

impl Scope<'_, '_> {
    /// `left operator right`, number by number.
    pub fn arithmetic(&self, operator: Operator, left: &Expression, right: &Expression) -> Option<Meaning> {
        let mut is_offset = false;
        for operand in [left, right] {
            if self.is_offset_literal(operand) {
                self.refuse_offset(operand, if is_sum(operator) { "a sum" } else { "a product" });
                is_offset = true;
            }
        }
        let (l, r) = (self.evaluate(left), self.evaluate(right));
        let (l, r) = (l?, r?);
        if is_offset {
            return None;
        }
        let spans = (left.span, right.span);
        match (is_vector(&l), is_vector(&r)) {
            (false, false) => {
                let (l, r) = (self.operand(&l, left.span), self.operand(&r, right.span));
                let (l, r) = (l?, r?);
                let (l, r) = if is_sum(operator) {
                    (self.read_beside((&l, left.span), &r)?, self.read_beside((&r, right.span), &l)?)
                } else {
                    (self.read_alone(&l, left.span)?, self.read_alone(&r, right.span)?)
                };
                self.combined(operator, (&l, &r), spans).map(Meaning::Real)
            }
            (true, true) if is_sum(operator) => self.vector_sum(operator, (&l, &r), spans),
            (true, false) if !is_sum(operator) => {
                let (l, r) = (self.reals(&l, left.span), self.real(&r, right.span));
                let r = r?;
                self.each(l?, |element| self.combined(operator, (&element, &r), spans))
            }
            (false, true) if operator == Operator::Multiply => {
                let (l, r) = (self.real(&l, left.span), self.reals(&r, right.span));
                let l = l?;
                self.each(r?, |element| self.combined(operator, (&l, &element), spans))
            }
            _ => {
                let (of_left, of_right) = (l.kind(), r.kind());
                let message = format!("`{}` is not defined between {of_left} and {of_right}", symbol(operator));
                let error = Diagnostic::error("E22", left.span, message).saying(of_left).label(right.span, of_right);
                self.refuse(error.help("vectors of one length add; a vector times or over a number is a vector"))
            }
        }
    }

    fn each(&self, elements: Vec<Real>, of: impl Fn(Real) -> Option<Real>) -> Option<Meaning> {
        let elements = elements.into_iter().map(|element| of(element).map(|value| Rc::new(Meaning::Real(value))));
        elements.collect::<Option<_>>().map(Meaning::List)
    }

    fn vector_sum(&self, operator: Operator, of: (&Meaning, &Meaning), spans: (Span, Span)) -> Option<Meaning> {
        let (left, right) = (self.reals(of.0, spans.0), self.reals(of.1, spans.1));
        let (left, right) = (left?, right?);
        if !self.same_length(left.len(), right.len(), spans) {
            return None;
        }
        let of_pair = |(l, r)| self.combined(operator, (l, r), spans).map(|value| Rc::new(Meaning::Real(value)));
        left.iter().zip(&right).map(of_pair).collect::<Option<_>>().map(Meaning::List)
    }

    /// Reports vectors of different lengths.
    pub fn same_length(&self, left: usize, right: usize, spans: (Span, Span)) -> bool {
        if left != right {
            let error = Diagnostic::error("E22", spans.0, format!("a vector of {left} meets a vector of {right}"));
            let error = error.saying(format!("{left} elements")).label(spans.1, format!("{right} elements"));
            self.report(error.help("pick the members that belong together, for example `.{x, y}`"));
        }
        left == right
    }

    fn combined(&self, operator: Operator, of: (&Real, &Real), spans: (Span, Span)) -> Option<Real> {
        let pair = Pair { left: (of.0, spans.0), right: (of.1, spans.1) };
        let measure = if is_sum(operator) {
            self.unified(pair, "E02", if operator == Operator::Add { "add" } else { "subtract" })?
        } else {
            self.product(operator, pair)?
        };
        let unit = if is_sum(operator) { preferred(of.0, of.1) } else { None };
        let expression = real::combine(operator, of.0.expression.clone(), of.1.expression.clone());
        let scale = Scale::combined(operator, of.0.scale, of.1.scale);
        self.finite(Real::computed(expression, measure, unit).on(scale), spans.0.to(spans.1))
    }

    /// Refuses a constant that is no number.
    pub fn finite(&self, value: Real, span: Span) -> Option<Real> {
        match value.constant() {
            Some(number) if !number.is_finite() => {
                let message = format!("`{}` is not a finite number", self.text(span));
                self.refuse(
                    Diagnostic::error("E38", span, message)
                        .help("it is computed before the run and has to be a number"),
                )
            }
            _ => Some(value),
        }
    }

    fn product(&self, operator: Operator, pair: Pair<'_>) -> Option<Measure> {
        let (Measure::Known(left), Measure::Known(right)) = (pair.left.0.measure, pair.right.0.measure) else {
            return Some(Measure::Undeclared);
        };
        let product = if operator == Operator::Multiply { left.checked_mul(right) } else { left.checked_div(right) };
        match product {
            Some(dimension) => Some(Measure::Known(dimension)),
            None => self.refuse(Diagnostic::error("E38", pair.left.1.to(pair.right.1), "an exponent passes 127 here")),
        }
    }

    /// The measure of both; reports a difference as `cannot {verb} a length and a time`, a quantity beside a variable
    /// without unit as a warning.
    pub fn unified(&self, pair: Pair<'_>, code: &'static str, verb: &str) -> Option<Measure> {
        let ((left, left_span), (right, right_span)) = (pair.left, pair.right);
        for ((value, span), (other, other_span)) in [(pair.left, pair.right), (pair.right, pair.left)] {
            if value.is_quantity() && other.measure == Measure::Undeclared {
                self.warn_undeclared(value, span, &self.text(other_span), other.port());
            }
        }
        self.warn_other_names(pair.left, pair.right);
        if let Some(measure) = left.measure.unify(right.measure) {
            return Some(measure);
        }
        let (Measure::Known(of_left), Measure::Known(of_right)) = (left.measure, right.measure) else {
            unreachable!("what is undeclared fits everything");
        };
        let message = match verb {
            "compare" => format!("cannot compare {} with {}", quantity(of_left), quantity(of_right)),
            "add" | "subtract" => format!("cannot {verb} {} and {}", quantity(of_left), quantity(of_right)),
            _ => format!("{verb} would mix {} with {}", quantity(of_left), quantity(of_right)),
        };
        let error = Diagnostic::error(code, left_span, message).saying(self.described(left));
        let error = error.label(right_span, self.described(right));
        self.refuse(self.help_unit(pair, error))
    }

    /// Help for a plain number beside a quantity: its unit is missing.
    fn help_unit(&self, pair: Pair<'_>, error: Diagnostic) -> Diagnostic {
        let wants = |(value, span): (&Real, Span), (other, _): (&Real, Span)| {
            let unit = other.unit.as_ref().map(|unit| unit.unit.name.clone()).filter(|name| !name.is_empty())?;
            let is_plain = value.measure == Measure::PLAIN && value.constant().is_some();
            is_plain.then(|| with_unit(&self.text(span), &unit))
        };
        match wants(pair.left, pair.right).or_else(|| wants(pair.right, pair.left)) {
            Some(help) => error.help(help),
            None => error.help("both sides need the same dimension; units of it are converted"),
        }
    }

    /// `-of`
    pub fn negated(&self, of: &Expression) -> Option<Meaning> {
        if self.is_offset_literal(of) {
            self.refuse_offset(of, "a product");
            return None;
        }
        let meaning = self.evaluate(of)?;
        let opposite = |value: Real| {
            let scale = if value.scale.is_difference() { value.scale } else { Scale::Either };
            Real::computed(real::negate(value.expression), value.measure, value.unit).on(scale)
        };
        if is_vector(&meaning) {
            let elements = self.reals(&meaning, of.span)?;
            let elements = elements.into_iter().map(|element| Rc::new(Meaning::Real(opposite(element))));
            return Some(Meaning::List(elements.collect()));
        }
        self.real(&meaning, of.span).map(|value| Meaning::Real(opposite(value)))
    }
}

/// The unit in which a sum, difference or extreme is shown: one that the script wrote precedes one that a unit declares.
pub(super) fn preferred(left: &Real, right: &Real) -> Option<UnitName> {
    let units = [&right.unit, &left.unit].into_iter().flatten().filter(|unit| !unit.unit.name.is_empty());
    let units: Vec<_> = units.collect();
    units.iter().find(|unit| unit.written).or(units.last()).map(|unit| (*unit).clone())
}

fn is_sum(operator: Operator) -> bool {
    matches!(operator, Operator::Add | Operator::Subtract)
}

pub(super) fn is_vector(meaning: &Meaning) -> bool {
    matches!(meaning, Meaning::List(_) | Meaning::Group(_))
}

fn symbol(operator: Operator) -> &'static str {
    match operator {
        Operator::Add => "+",
        Operator::Subtract => "-",
        Operator::Multiply => "*",
        Operator::Divide => "/",
    }
}
