//! What `for` and the axes of `sweep` count through: `a..b`, or a list of values that are known before the run.

use fmi2::units::BaseUnit;

use super::meaning::{Meaning, Measure, Origin, Real};
use super::measure::quantity;
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::RealExpression;
use crate::syntax::{Expression, ExpressionKind};

/// The whole numbers of `a..b` in its written unit.
pub(super) struct Counting {
    /// How many they are.
    pub count: u64,
    first: f64,
    base: BaseUnit,
    /// The right end, whose measure and unit all have.
    last: Real,
}

impl Counting {
    /// The value so many steps behind the first.
    pub fn value(&self, steps: u64) -> Real {
        #[expect(clippy::cast_precision_loss, reason = "a range has at most 2e9 values")]
        let number = self.first + steps as f64;
        let origin = match self.last.origin {
            Origin::Literal { base, has_unit, .. } => Origin::Literal { number, base, has_unit },
            other => other,
        };
        Real { expression: RealExpression::Constant(self.base.to_si(number)), origin, ..self.last.clone() }
    }
}

/// The values that a counter takes, at most so many and one more: the whole numbers of a range in its written unit, or
/// the elements of a list.
pub(super) fn counted(scope: Scope<'_, '_>, range: &Expression, most: usize) -> Option<Vec<Real>> {
    let ExpressionKind::Range(from, to) = &range.kind else { return listed(scope, range) };
    let counting = counting(scope, range, (from, to))?;
    Some((0..counting.count.min(most as u64 + 1)).map(|steps| counting.value(steps)).collect())
}

/// The range from one expression to another.
pub(super) fn counting(
    scope: Scope<'_, '_>,
    range: &Expression,
    (from, to): (&Expression, &Expression),
) -> Option<Counting> {
    let (from_meaning, to_meaning) = (scope.evaluate(from), scope.evaluate(to));
    let (from_meaning, to_meaning) = (from_meaning?, to_meaning?);
    let (first, last) = (scope.real(&from_meaning, from.span)?, scope.real(&to_meaning, to.span)?);
    let base = match last.origin {
        Origin::Literal { base, .. } => base,
        _ => BaseUnit::default(),
    };
    let is_bare = matches!(first.origin, Origin::Literal { has_unit: false, .. });
    if !is_bare && first.measure != last.measure {
        let shown = |value: &Real| match value.measure {
            Measure::Known(dimension) => quantity(dimension),
            Measure::Undeclared => "a number without unit".to_owned(),
        };
        let message = format!("this range goes from {} to {}", shown(&first), shown(&last));
        return scope.refuse(Diagnostic::error("E02", range.span, message).help("give both ends one unit: `0..8 m/s`"));
    }
    let mut ends = Vec::new();
    for (value, end, is_bare) in [(&first, from, is_bare), (&last, to, false)] {
        let Some(si) = value.constant() else { return scope.refuse(scope.must_be_known(end.span)) };
        let number = if is_bare { si } else { base.from_si(si) };
        let whole = number.round();
        if (number - whole).abs() > 1e-9 * number.abs().max(1.0) || whole.abs() > 1e9 {
            let written = scope.text(end.span);
            let (message, help) = if whole.abs() > 1e9 {
                (format!("`{written}` is too far for the end of a range"), "a range goes up to 1000000000")
            } else {
                (
                    format!("a range counts whole numbers, and `{written}` is none"),
                    "write whole ends, or a list of values",
                )
            };
            return scope.refuse(Diagnostic::error("E38", end.span, message).help(help));
        }
        ends.push(whole);
    }
    let count = (ends[1] - ends[0] + 1.0).max(0.0) as u64;
    Some(Counting { count, first: ends[0], base, last })
}

fn listed(scope: Scope<'_, '_>, list: &Expression) -> Option<Vec<Real>> {
    let meaning = scope.evaluate(list)?;
    let Meaning::List(elements) = &*meaning else { return scope.refuse(no_values(&meaning, list)) };
    let known = |element: &std::rc::Rc<Meaning>| {
        let value = scope.real(element, list.span)?;
        if value.constant().is_none() { scope.refuse(scope.must_be_known(list.span)) } else { Some(value) }
    };
    elements.iter().map(known).collect()
}

/// That something is neither a range nor a list.
pub(super) fn no_values(found: &Meaning, written: &Expression) -> Diagnostic {
    let message = format!("expected a range or a list, found {}", found.kind());
    Diagnostic::error("E21", written.span, message).help("write for example `1..3` or `[2, 4, 8]`")
}
