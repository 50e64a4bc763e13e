//! `integral average rms highest lowest slope count duration`: running values of signals and conditions.

use std::rc::Rc;

use super::arithmetic::is_vector;
use super::grid::{Least, SECOND};
use super::meaning::{Meaning, Measure, Real};
use super::scale::Scale;
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::{
    BooleanExpression as B, Drive, Function, Margin, Near, RealExpression as E, Running, RunningKind,
};
use crate::source::Span;
use crate::syntax::{Expression, Word};

/// The names of the running values.
pub(super) const RUNNING: [&str; 8] = ["integral", "average", "rms", "highest", "lowest", "slope", "count", "duration"];

impl Scope<'_, '_> {
    /// A running value: of a signal or condition, with the first time that counts.
    pub fn running(&self, function: &Word, arguments: &[Expression], span: Span) -> Option<Meaning> {
        let (of, from) = match arguments {
            [of] => (of, None),
            [of, from] => (of, Some(from)),
            _ => {
                let message = format!("`{}` takes one or two arguments, found {}", function.text, arguments.len());
                let help = "for example `rms(x)`, or `rms(x, 15 s)` with the first time that counts";
                return self.refuse(Diagnostic::error("E31", span, message).help(help));
            }
        };
        let meaning = self.evaluate(of);
        let from_tick = from.map_or(Some(0), |from| self.ticks(from, Least::Zero));
        let (meaning, from_tick, grid) = (meaning?, from_tick?, self.grid()?);
        #[expect(clippy::cast_precision_loss, reason = "exact up to 104 days; beyond, rounded once")]
        let step_s = grid.step_ns as f64 / 1e9;
        let running = |kind, of| E::Running(Running { kind, of: Box::new(of), from_tick, step_s });
        let kind = match function.text.as_str() {
            "integral" => RunningKind::Integral,
            "average" => RunningKind::Average,
            "rms" => RunningKind::Rms,
            "highest" => RunningKind::Highest,
            "lowest" => RunningKind::Lowest,
            "slope" => RunningKind::Slope,
            name => return self.summed_condition(name == "count", &meaning, of.span, running).map(Meaning::Real),
        };
        let one = |value: Real| {
            let value = summed(kind, value, |of| running(kind, of));
            self.finite(value, span)
        };
        if is_vector(&meaning) {
            let values = self.reals(&meaning, of.span)?.into_iter();
            let values = values.map(|value| one(value).map(|value| Rc::new(Meaning::Real(value))));
            return values.collect::<Option<_>>().map(Meaning::List);
        }
        one(self.real(&meaning, of.span)?).map(Meaning::Real)
    }

    fn summed_condition(
        &self,
        is_count: bool,
        meaning: &Meaning,
        span: Span,
        running: impl Fn(RunningKind, E) -> E,
    ) -> Option<Real> {
        let condition = self.as_condition(meaning, span)?;
        let condition = self.momentary(&condition, span)?;
        if has_rises(&condition) {
            let error = Diagnostic::error("E31", span, "a running value takes no `rises`");
            return self.refuse(error.help("`count` counts how often a condition became true: leave `rises` away"));
        }
        let of = E::Truth(Box::new(condition));
        Some(if is_count {
            Real::computed(running(RunningKind::Count, of), Measure::PLAIN, None)
        } else {
            Real::computed(running(RunningKind::Duration, of), Measure::Known(SECOND), None)
        })
    }

    /// Refuses a running value that would go to a unit.
    pub fn refuse_driving_running(&self, drive: &Drive, span: Span) -> Option<()> {
        match drive {
            Drive::Real(value) => self.refuse_running(value, span),
            Drive::Boolean(condition) if latest_start_of(condition).is_some() => self.refuse_as_running(span),
            _ => Some(()),
        }
    }

    /// The same for a real value.
    pub fn refuse_running(&self, value: &E, span: Span) -> Option<()> {
        if latest_start(value).is_some() { self.refuse_as_running(span) } else { Some(()) }
    }

    fn refuse_as_running<T>(&self, span: Span) -> Option<T> {
        let message = format!("`{}` is a running value, which no unit can be given", self.text(span));
        let error = Diagnostic::error("E30", span, message);
        self.refuse(error.help("put it into a unit; in a script running values stand in claims, conditions and `let`s"))
    }
}

fn summed(kind: RunningKind, value: Real, running: impl Fn(E) -> E) -> Real {
    let times = |power: i8| match value.measure {
        Measure::Known(dimension) => {
            let time = if power > 0 { dimension.checked_mul(SECOND) } else { dimension.checked_div(SECOND) };
            time.map_or(Measure::Undeclared, Measure::Known)
        }
        Measure::Undeclared => Measure::Undeclared,
    };
    let (measure, unit, scale) = match kind {
        RunningKind::Integral => (times(1), None, Scale::Either),
        RunningKind::Slope => (times(-1), None, Scale::Either),
        _ => (value.measure, value.unit, value.scale),
    };
    Real::computed(running(value.expression), measure, unit).on(scale)
}

/// Whether a value is `count(…)`, a whole number.
pub(super) fn is_count(value: &E) -> bool {
    matches!(value, E::Running(Running { kind: RunningKind::Count, .. }))
}

/// That a count is equal to a whole number.
pub(super) fn count_equals(count: E, number: E) -> B {
    let distance = E::Call(Function::Abs, vec![E::Subtract(Box::new(count), Box::new(number))]);
    B::Margin(Margin { value: E::Negate(Box::new(distance)), strict: false })
}

fn has_rises(condition: &B) -> bool {
    match condition {
        B::Rises(_) => true,
        B::Not(of) => has_rises(of),
        B::And(parts) | B::Or(parts) => parts.iter().any(has_rises),
        B::Constant(_) | B::Signal(_) | B::Margin(_) | B::Same(..) => false,
    }
}

/// The tick of the last first sample of the running values in an expression, with the step in seconds; `None` without any.
pub(super) fn latest_start(value: &E) -> Option<(u64, f64)> {
    match value {
        E::Constant(_) | E::Signal(_) | E::Time | E::Shared(_) | E::Curve(_) => None,
        E::Affine { of, .. } | E::InverseAffine { of, .. } | E::Negate(of) | E::Near(Near { of, .. }) => {
            latest_start(of)
        }
        E::Add(left, right) | E::Subtract(left, right) | E::Multiply(left, right) | E::Divide(left, right) => {
            later(latest_start(left), latest_start(right))
        }
        E::Call(_, arguments) => arguments.iter().map(latest_start).fold(None, later),
        E::Running(running) => later(Some((running.from_tick, running.step_s)), latest_start(&running.of)),
        E::Truth(condition) => latest_start_of(condition),
    }
}

/// The same for a condition.
pub(super) fn latest_start_of(condition: &B) -> Option<(u64, f64)> {
    match condition {
        B::Margin(margin) => latest_start(&margin.value),
        B::Not(of) => latest_start_of(of),
        B::And(parts) | B::Or(parts) => parts.iter().map(latest_start_of).fold(None, later),
        B::Constant(_) | B::Signal(_) | B::Same(..) | B::Rises(_) => None,
    }
}

fn later(one: Option<(u64, f64)>, other: Option<(u64, f64)>) -> Option<(u64, f64)> {
    if other.map(|(tick, _)| tick) > one.map(|(tick, _)| tick) { other } else { one }
}
