//! What `for` counts through: `a..b`, or a list of values that are known before the run.

use fmi2::units::BaseUnit;

use super::meaning::{Meaning, Measure, Origin, Real};
use super::measure::quantity;
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::RealExpression;
use crate::syntax::{Expression, ExpressionKind};

/// The values that a counter takes, at most so many and one more: the integers of a range in its written unit, or
/// the elements of a list.
pub(super) fn counted(scope: Scope<'_, '_>, range: &Expression, most: usize) -> Option<Vec<Real>> {
    let ExpressionKind::Range(from, to) = &range.kind else { return listed(scope, range) };
    let (from_meaning, to_meaning) = (scope.evaluate(from), scope.evaluate(to));
    let (from_meaning, to_meaning) = (from_meaning?, to_meaning?);
    let (first, last) = (scope.real(&from_meaning, from.span)?, scope.real(&to_meaning, to.span)?);
    let unit = last.unit.clone();
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
            let message = format!("a range counts whole numbers, and `{}` is none", scope.text(end.span));
            return scope
                .refuse(Diagnostic::error("E38", end.span, message).help("write whole ends, or a list of values"));
        }
        ends.push(whole);
    }
    let count = ((ends[1] - ends[0] + 1.0).max(0.0) as usize).min(most + 1);
    let value = |step: usize| {
        let number = ends[0] + step as f64;
        let origin = match last.origin {
            Origin::Literal { base, has_unit, .. } => Origin::Literal { number, base, has_unit },
            other => other,
        };
        let expression = RealExpression::Constant(base.to_si(number));
        Real { expression, unit: unit.clone(), origin, ..last.clone() }
    };
    Some((0..count).map(value).collect())
}

fn listed(scope: Scope<'_, '_>, list: &Expression) -> Option<Vec<Real>> {
    let meaning = scope.evaluate(list)?;
    let Meaning::List(elements) = &*meaning else {
        let message = format!("expected a range or a list, found {}", meaning.kind());
        let error = Diagnostic::error("E21", list.span, message);
        return scope.refuse(error.help("write for example `1..3` or `[2, 4, 8]`"));
    };
    let known = |element: &std::rc::Rc<Meaning>| {
        let value = scope.real(element, list.span)?;
        if value.constant().is_none() { scope.refuse(scope.must_be_known(list.span)) } else { Some(value) }
    };
    elements.iter().map(known).collect()
}
