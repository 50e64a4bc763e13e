//! Calls of functions.

use std::rc::Rc;

use fmi2::units::Dimension;

use super::arithmetic::{Pair, is_vector, preferred};
use super::comparison::MOST_PARTS;
use super::condition::Condition;
use super::findings::Remedy;
use super::meaning::{Meaning, Measure, Real, Text, real_size};
use super::measure::quantity;
use super::real;
use super::running::RUNNING;
use super::scale::Scale;
use super::scope::Scope;
use super::sweep::DISTRIBUTIONS;
use crate::diagnostic::Diagnostic;
use crate::nearest::nearest;
use crate::scenario::{self, BooleanExpression, Function};
use crate::source::{FileRef, Span};
use crate::syntax::{Expression, Operator, Word};

const NAMES: [&str; 21] = [
    "abs", "min", "max", "sum", "mean", "sqrt", "exp", "log", "floor", "sin", "cos", "tan", "atan2", "norm", "dist",
    "mod", "all", "any", "rises", "file", "curve",
];

/// The dimension of an angle.
const ANGLE: Dimension = Dimension([0, 0, 0, 0, 0, 0, 0, 1]);

/// A call whose arguments have a meaning.
struct Call<'c> {
    name: &'c Word,
    span: Span,
    arguments: Vec<(Rc<Meaning>, Span)>,
}

impl Scope<'_, '_> {
    /// `function(arguments)`
    pub fn call(&self, function: &Word, arguments: &[Expression], span: Span) -> Option<Meaning> {
        let name = function.text.as_str();
        if name == "curve" {
            return self.curve(arguments, span);
        }
        if DISTRIBUTIONS.contains(&name) {
            return self.refuse(self.draw_outside_of_sweep(function, span));
        }
        if RUNNING.contains(&name) {
            return self.running(function, arguments, span);
        }
        if !NAMES.contains(&name) {
            let error = Diagnostic::error("E01", function.span, format!("there is no function `{name}`"));
            return self.refuse(match nearest(name, NAMES.into_iter().chain(RUNNING)) {
                Some(near) => Remedy::meant(near, function.span).of(error),
                None => error.help(format!("the functions are {} {}", NAMES.join(" "), RUNNING.join(" "))),
            });
        }
        if name == "sum" {
            let offset: Vec<_> = arguments.iter().filter(|argument| self.is_offset_literal(argument)).collect();
            offset.iter().for_each(|argument| self.refuse_offset(argument, "a sum"));
            if !offset.is_empty() {
                return None;
            }
        }
        let meanings: Vec<_> =
            arguments.iter().map(|argument| Some((self.evaluate(argument)?, argument.span))).collect();
        let call = Call { name: function, span, arguments: meanings.into_iter().collect::<Option<_>>()? };
        match name {
            "min" | "max" | "sum" | "mean" => self.reduced(&call),
            "norm" => self.norm(&call),
            "dist" => self.dist(&call),
            "atan2" => self.atan2(&call),
            "mod" => self.modulo(&call),
            "all" | "any" => self.quantified(&call),
            "rises" => self.rises(&call),
            "file" => self.file(&call),
            _ => self.unary(&call),
        }
    }

    fn count<const N: usize>(&self, call: &Call<'_>) -> Option<[(Rc<Meaning>, Span); N]> {
        if let Ok(arguments) = call.arguments.clone().try_into() {
            return Some(arguments);
        }
        let expected = if N == 1 { "one argument".to_owned() } else { format!("{N} arguments") };
        let message = format!("`{}` takes {expected}, found {}", call.name.text, call.arguments.len());
        let help = if N == 1 { "for example `abs(x)`" } else { "for example `dist(a, b)`" };
        self.refuse(Diagnostic::error("E31", call.span, message).help(help))
    }

    fn unary(&self, call: &Call<'_>) -> Option<Meaning> {
        let [(argument, span)] = self.count(call)?;
        let value = self.real(&argument, span)?;
        let (function, measure) = match call.name.text.as_str() {
            "abs" => (Function::Abs, Some(value.measure)),
            "sqrt" => (Function::Sqrt, root(value.measure)),
            "exp" => (Function::Exp, plain(value.measure)),
            "log" => (Function::Log, plain(value.measure)),
            "floor" => (Function::Floor, plain(value.measure)),
            "sin" => (Function::Sin, plain(value.measure)),
            "cos" => (Function::Cos, plain(value.measure)),
            _ => (Function::Tan, plain(value.measure)),
        };
        let Some(measure) = measure else {
            let Measure::Known(dimension) = value.measure else { unreachable!("what is undeclared fits everything") };
            let message = format!("`{}` has no value for {}", call.name.text, quantity(dimension));
            let error = Diagnostic::error("E02", span, message).saying(self.described(&value));
            return self.refuse(error.help("take the number out with `in`, or divide by a quantity"));
        };
        let is_abs = function == Function::Abs;
        let scale = if is_abs && value.scale.is_difference() { value.scale } else { Scale::Either };
        let unit = if is_abs { value.unit } else { None };
        let value = Real::computed(real::call(function, vec![value.expression]), measure, unit).on(scale);
        self.finite(value, call.span).map(Meaning::Real)
    }

    /// The numbers of a call: its arguments, or the elements of its one list.
    fn numbers(&self, call: &Call<'_>) -> Option<Vec<(Real, Span)>> {
        if let [(vector, span)] = call.arguments.as_slice()
            && is_vector(vector)
        {
            return Some(self.reals(vector, *span)?.into_iter().map(|value| (value, *span)).collect());
        }
        let numbers = call.arguments.iter().map(|(value, span)| Some((self.real(value, *span)?, *span)));
        numbers.collect()
    }

    fn reduced(&self, call: &Call<'_>) -> Option<Meaning> {
        let name = call.name.text.as_str();
        if let [(only, span)] = call.arguments.as_slice()
            && !is_vector(only)
        {
            let text = self.text(*span);
            let message = format!("`{name}` of one number is that number");
            let help = match name {
                "min" => format!("over time this is a claim: `always {text} > …`"),
                "max" => format!("over time this is a claim: `always {text} < …`"),
                _ => format!("give several, or compare over time: `always {text} < …`"),
            };
            return self.refuse(Diagnostic::error("E31", call.span, message).help(help));
        }
        let values = self.numbers(call)?;
        let function = match name {
            "min" => Function::Min,
            "max" => Function::Max,
            "sum" => Function::Sum,
            _ => Function::Mean,
        };
        let code = if matches!(function, Function::Min | Function::Max) { "E10" } else { "E02" };
        self.joined(call, function, &values, code).map(Meaning::Real)
    }

    /// A function of numbers of one dimension.
    fn joined(&self, call: &Call<'_>, function: Function, values: &[(Real, Span)], code: &'static str) -> Option<Real> {
        let Some(((first, first_span), rest)) = values.split_first() else {
            let message = format!("`{}` of nothing has no value", call.name.text);
            return self.refuse(Diagnostic::error("E31", call.span, message).help("give a list or several numbers"));
        };
        let mut all = first.clone();
        for (value, span) in rest {
            let pair = Pair { left: (&all, *first_span), right: (value, *span) };
            let measure = self.unified(pair, code, &format!("`{}`", call.name.text))?;
            let unit = preferred(&all, value);
            let scale = match function {
                Function::Sum => Scale::combined(Operator::Add, all.scale, value.scale),
                Function::Norm => Scale::Either,
                _ => {
                    self.check_scales(pair.left, pair.right)?;
                    all.scale.joined(value.scale)
                }
            };
            all = Real { measure, unit, scale, ..all };
        }
        let expressions = values.iter().map(|(value, _)| value.expression.clone()).collect();
        let joined = Real::computed(real::call(function, expressions), all.measure, all.unit).on(all.scale);
        self.finite(joined, call.span)
    }

    fn norm(&self, call: &Call<'_>) -> Option<Meaning> {
        let values = self.numbers(call)?;
        self.joined(call, Function::Norm, &values, "E02").map(Meaning::Real)
    }

    fn dist(&self, call: &Call<'_>) -> Option<Meaning> {
        let [(left, left_span), (right, right_span)] = self.count(call)?;
        let (from, to) = (self.reals(&left, left_span), self.reals(&right, right_span));
        let (from, to) = (from?, to?);
        if !self.same_length(from.len(), to.len(), (left_span, right_span)) {
            return None;
        }
        let difference = |(from, to): (&Real, &Real)| {
            let measure = self.unified(Pair { left: (from, left_span), right: (to, right_span) }, "E02", "subtract")?;
            let expression = real::combine(Operator::Subtract, from.expression.clone(), to.expression.clone());
            Some((Real::computed(expression, measure, preferred(from, to)), call.span))
        };
        let differences: Option<Vec<_>> = from.iter().zip(&to).map(difference).collect();
        let distance = self.joined(call, Function::Norm, &differences?, "E02")?;
        Some(Meaning::Real(distance.on(Scale::Difference { declared: false })))
    }

    fn atan2(&self, call: &Call<'_>) -> Option<Meaning> {
        let [(y, y_span), (x, x_span)] = self.count(call)?;
        let (y, x) = (self.real(&y, y_span), self.real(&x, x_span));
        let (y, x) = (y?, x?);
        self.unified(Pair { left: (&y, y_span), right: (&x, x_span) }, "E02", "compare")?;
        let angle = real::call(Function::Atan2, vec![y.expression, x.expression]);
        Some(Meaning::Real(Real::computed(angle, Measure::Known(ANGLE), None)))
    }

    /// `a - b floor(a / b)`
    fn modulo(&self, call: &Call<'_>) -> Option<Meaning> {
        let [(left, left_span), (right, right_span)] = self.count(call)?;
        let (a, b) = (self.real(&left, left_span), self.real(&right, right_span));
        let (a, b) = (a?, b?);
        let measure = self.unified(Pair { left: (&a, left_span), right: (&b, right_span) }, "E02", "`mod`")?;
        let unit = preferred(&a, &b);
        if real_size(&a.expression) + real_size(&b.expression) > MOST_PARTS {
            let error = Diagnostic::error("E39", call.span, "this `mod` has too many parts");
            return self.refuse(error.help("`mod` has both of its arguments twice: compute it in fewer steps"));
        }
        let ratio = real::combine(Operator::Divide, a.expression.clone(), b.expression.clone());
        let whole = real::combine(Operator::Multiply, b.expression, real::call(Function::Floor, vec![ratio]));
        let rest = real::combine(Operator::Subtract, a.expression, whole);
        self.finite(Real::computed(rest, measure, unit), call.span).map(Meaning::Real)
    }

    fn quantified(&self, call: &Call<'_>) -> Option<Meaning> {
        let mut parts = Vec::new();
        for (meaning, span) in &call.arguments {
            match &**meaning {
                Meaning::List(elements) => {
                    parts.extend(elements.iter().map(|element| self.as_condition(element, *span)));
                }
                Meaning::Group(group) => {
                    parts.extend(group.ports().map(|port| self.as_condition(&self.port_meaning(port), *span)));
                }
                other => parts.push(self.as_condition(other, *span)),
            }
        }
        let parts = parts.into_iter().collect::<Option<Vec<_>>>()?;
        if parts.is_empty() {
            let message = format!("`{}` of nothing has no value", call.name.text);
            return self.refuse(Diagnostic::error("E31", call.span, message).help("give a list or several conditions"));
        }
        let joined = if call.name.text == "all" { Condition::And(parts) } else { Condition::Or(parts) };
        Some(Meaning::Condition(joined))
    }

    fn rises(&self, call: &Call<'_>) -> Option<Meaning> {
        let [(condition, span)] = self.count(call)?;
        let condition = self.as_condition(&condition, span)?;
        let condition = self.momentary(&condition, span)?;
        let slot = self.condition_slot(scenario::Condition { is: condition, held_ticks: 0 });
        Some(Meaning::plain(BooleanExpression::Rises(slot), Some(call.span)))
    }

    /// A condition that is judged at one point in time.
    pub fn momentary(&self, condition: &Condition, span: Span) -> Option<BooleanExpression> {
        condition.boolean().map_or_else(
            |word| {
                let message = format!("`{}` looks ahead in time, which only claims do", self.text(word));
                let error = Diagnostic::error("E30", span, message);
                let error = if word == span { error } else { error.label(word, "here") };
                self.refuse(error.help("write it in an `assert`, or in a `let` that only asserts use"))
            },
            Some,
        )
    }

    fn file(&self, call: &Call<'_>) -> Option<Meaning> {
        let [(path, span)] = self.count(call)?;
        match &*path {
            Meaning::Text(Text::Literal(path)) => {
                if let Err(problem) = self.request.loader.file(self.request.sources.of(span), path) {
                    let error = Diagnostic::error("E40", span, problem.message);
                    return self.refuse(Diagnostic { help: problem.help, ..error });
                }
                Some(Meaning::Text(Text::File(FileRef { from: span.text, path: path.clone() })))
            }
            other => {
                let message = format!("`file` takes the path as a text, found {}", other.kind());
                self.refuse(Diagnostic::error("E31", span, message).help("for example `file(\"yard.csv\")`"))
            }
        }
    }
}

fn root(measure: Measure) -> Option<Measure> {
    match measure {
        Measure::Undeclared => Some(Measure::Undeclared),
        Measure::Known(dimension) => {
            let exact = dimension.checked_sqrt().or_else(|| dimension.without_angle().checked_sqrt());
            exact.map(Measure::Known)
        }
    }
}

fn plain(measure: Measure) -> Option<Measure> {
    measure.unify(Measure::PLAIN).map(|_| Measure::PLAIN)
}
