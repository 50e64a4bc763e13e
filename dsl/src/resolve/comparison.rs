//! Comparisons and chains of them.

use std::collections::BTreeSet;

use super::arithmetic::{Pair, is_vector};
use super::condition::{Bound, Condition, boolean_size, opposite as not};
use super::meaning::{Meaning, Measure, Origin, Real, Text};
use super::measure::si_name;
use super::real;
use super::running::{count_equals, is_count};
use super::scale::Scale;
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::{
    BooleanExpression, Function, Limit, Margin, MarginUnit, Near, Operand, Port, RealExpression, Value,
};
use crate::source::Span;
use crate::spelling;
use crate::syntax::{Comparator, ComparisonLink, Expression, ExpressionKind, Operator};

/// How many parts the operands may have together of what has them twice, as a comparison of Booleans has.
pub(super) const MOST_PARTS: usize = 2048;

/// Both sides of one comparison.
struct Sides<'c> {
    left: &'c Expression,
    right: &'c Expression,
    link: &'c ComparisonLink,
}

impl Sides<'_> {
    fn span(&self) -> Span {
        self.left.span.to(self.right.span)
    }
}

impl Scope<'_, '_> {
    /// `a < b < c`, `a == b ± d`: each neighbour pair holds.
    pub fn comparison(&self, first: &Expression, rest: &[ComparisonLink], span: Span) -> Option<Condition> {
        let meanings: Vec<_> = std::iter::once(first)
            .chain(rest.iter().map(|link| &link.operand))
            .map(|side| self.evaluate(side))
            .collect();
        if rest.len() > 1 && !one_way(rest) {
            let error = Diagnostic::error("E29", span, "a chain of comparisons goes one way");
            return self.refuse(error.help("write `a < b < c` or `a > b > c`, else join two with `and`"));
        }
        if rest.len() > 1 && meanings.iter().flatten().any(|meaning| meaning.size() > MOST_PARTS) {
            let error = Diagnostic::error("E39", span, "a value of this chain of comparisons has too many parts");
            return self.refuse(error.help("a chain has its inner values twice: compute them in fewer steps"));
        }
        let sides = std::iter::once(first).chain(rest.iter().map(|link| &link.operand)).zip(rest);
        let bounds: Vec<_> = sides
            .enumerate()
            .map(|(at, (left, link))| {
                let (l, r) = (meanings[at].as_deref()?, meanings[at + 1].as_deref()?);
                self.compared(&Sides { left, right: &link.operand, link }, l, r)
            })
            .collect();
        let mut bounds = bounds.into_iter().collect::<Option<Vec<_>>>()?;
        if bounds.len() == 1 { bounds.pop() } else { Some(Condition::And(bounds)) }
    }

    fn compared(&self, sides: &Sides<'_>, left: &Meaning, right: &Meaning) -> Option<Condition> {
        for (side, meaning) in [(sides.left, left), (sides.right, right)] {
            if is_vector(meaning) {
                let message = format!("`{}` is a vector and has no order", self.text(side.span));
                let error = Diagnostic::error("E22", side.span, message);
                return self.refuse(error.help("compare `norm(…)`, `dist(a, b)`, `max(…)` or one part"));
            }
        }
        let operator = sides.link.operator;
        if matches!(operator, Comparator::Equal | Comparator::NotEqual)
            && let Some(equal) = self.same(sides, left, right)?
        {
            if let Some(tolerance) = &sides.link.tolerance {
                let error = Diagnostic::error("E29", tolerance.span, "`±` belongs to reals only");
                return self.refuse(error.help("these are equal or they are not: leave `±` away"));
            }
            let same = if operator == Comparator::Equal { equal } else { not(equal) };
            return Some(Condition::Plain(same, Some(sides.span())));
        }
        let (l, r) = (self.operand(left, sides.left.span), self.operand(right, sides.right.span));
        let (l, r) = (l?, r?);
        let (left, right) = ((&l, sides.left.span), (&r, sides.right.span));
        let (l, r) = (self.read_beside(left, &r)?, self.read_beside(right, &l)?);
        self.check_scales((&l, left.1), (&r, right.1))?;
        self.bound(sides, &l, &r)
    }

    fn bound(&self, sides: &Sides<'_>, left: &Real, right: &Real) -> Option<Condition> {
        let pair = Pair { left: (left, sides.left.span), right: (right, sides.right.span) };
        let measure = self.unified(pair, "E02", "compare")?;
        let unit = shown_in(measure, left, right);
        let difference =
            |from: &Real, to: &Real| real::combine(Operator::Subtract, from.expression.clone(), to.expression.clone());
        let operator = sides.link.operator;
        let (value, strict, upper) = match operator {
            Comparator::Less => (difference(right, left), true, true),
            Comparator::LessEqual => (difference(right, left), false, true),
            Comparator::Greater => (difference(left, right), true, false),
            Comparator::GreaterEqual => (difference(left, right), false, false),
            Comparator::Equal | Comparator::NotEqual => {
                let value = self.closeness(sides, difference(left, right), measure, (left, right))?;
                (value, false, false)
            }
        };
        if operator != Comparator::Equal
            && let Some(tolerance) = &sides.link.tolerance
        {
            let error = Diagnostic::error("E29", tolerance.span, "`±` stands in one `==` only");
            return self.refuse(error.help("for example `x == 3 m ± 1 cm`"));
        }
        let limit = match (operator, left.constant(), right.constant()) {
            (Comparator::Equal, ..) => None,
            (_, None, Some(_)) => Some(Limit { value: in_unit(right, &unit), upper }),
            (_, Some(_), None) => Some(Limit { value: in_unit(left, &unit), upper: !upper }),
            _ => None,
        };
        let positive = limit.filter(|limit| limit.value > 0.0);
        let scaled = positive.and_then(|_| self.scaled(sides, left.constant().is_none()));
        let margin = Margin { value, strict };
        Some(Condition::Bound(Bound { margin, measure, unit, limit, span: sides.span(), scaled }))
    }

    /// `d - |x - c|`
    fn closeness(
        &self,
        sides: &Sides<'_>,
        difference: RealExpression,
        measure: Measure,
        (left, right): (&Real, &Real),
    ) -> Option<RealExpression> {
        let Some(tolerance) = &sides.link.tolerance else {
            let (l, r) = (self.text(sides.left.span), self.text(sides.right.span));
            let message = "reals are equal within a tolerance only";
            let unit = shown_in(measure, left, right).name;
            let unit = if unit.is_empty() { unit } else { format!(" {}", spelling::unit(&unit)) };
            let example = format!("{l} == {r} ± 0.01{unit}");
            let help = if sides.link.operator == Comparator::Equal { example } else { format!("not ({example})") };
            return self
                .refuse(Diagnostic::error("E29", sides.link.operator_span, message).help(format!("write `{help}`")));
        };
        if sides.link.operator == Comparator::NotEqual {
            let error = Diagnostic::error("E29", sides.link.operator_span, "`±` stands in one `==` only");
            return self.refuse(error.help("write `not (x == c ± d)`"));
        }
        let meaning = self.evaluate(tolerance)?;
        let tolerance_value = self.operand(&meaning, tolerance.span)?;
        if tolerance_value.scale == (Scale::Point { offset: true }) {
            self.refuse_offset(tolerance, "a tolerance");
            return None;
        }
        if tolerance_value.constant().is_some_and(|tolerance| tolerance < 0.0) {
            let message = format!("`{}` is below zero, so nothing is within it", self.text(tolerance.span));
            return self
                .refuse(Diagnostic::error("E38", tolerance.span, message).help("write the tolerance without `-`"));
        }
        let beside = if left.port().is_some() { left } else { right };
        let tolerance_value = self.read_beside((&tolerance_value, tolerance.span), beside)?;
        let distance = match &sides.link.tolerance_time {
            Some(within) => self.distance_from_curve(within, (left, right))?,
            None => real::call(Function::Abs, vec![difference]),
        };
        let distance = Real::computed(distance, measure, right.unit.clone());
        let pair = Pair { left: (&distance, sides.span()), right: (&tolerance_value, tolerance.span) };
        self.unified(pair, "E02", "compare")?;
        Some(real::combine(Operator::Subtract, tolerance_value.expression, distance.expression))
    }

    /// The least distance between a value and a curve within a time.
    fn distance_from_curve(&self, within: &Expression, (left, right): (&Real, &Real)) -> Option<RealExpression> {
        let within_s = self.seconds(within)?;
        let (of, curve) = match (self.si_curve(&right.expression), self.si_curve(&left.expression)) {
            (Some(_), Some(_)) => {
                let message = "`within` after `±` is a tolerance of time beside one curve, and here are two";
                let help = "compute the one that may be early or late in a unit, or leave `within` away";
                return self.refuse(Diagnostic::error("E29", within.span, message).help(help));
            }
            (Some(curve), None) => (left, curve),
            (None, Some(curve)) => (right, curve),
            (None, None) => {
                let message = "`within` after `±` is a tolerance of time beside a curve";
                let error = Diagnostic::error("E29", within.span, message);
                let help = "write a plain `curve(\"ref.csv\", \"x\")` on one side of `==`, or leave `within` away";
                return self.refuse(error.help(help));
            }
        };
        Some(RealExpression::Near(Near { of: Box::new(of.expression.clone()), curve, within_s }))
    }

    /// The comparison of plain numbers that E10 advises, `x / c < 1`, which reverses below zero and ends there.
    fn scaled(&self, sides: &Sides<'_>, is_left: bool) -> Option<String> {
        let (of, limit) = if is_left { (sides.left, sides.right) } else { (sides.right, sides.left) };
        let is_simple = of.parenthesised || matches!(of.kind, ExpressionKind::Path(_) | ExpressionKind::Call { .. });
        let of = if is_simple { self.text(of.span) } else { format!("({})", self.text(of.span)) };
        let (symbol, mirrored) = match sides.link.operator {
            Comparator::Less => ("<", ">"),
            Comparator::LessEqual => ("<=", ">="),
            Comparator::Greater => (">", "<"),
            Comparator::GreaterEqual => (">=", "<="),
            Comparator::Equal | Comparator::NotEqual => return None,
        };
        let symbol = if is_left { symbol } else { mirrored };
        Some(format!("{of} / {} {symbol} 1", self.text(limit.span)))
    }

    /// Whether two discrete values are equal; `Some(None)` if they are reals.
    fn same(&self, sides: &Sides<'_>, left: &Meaning, right: &Meaning) -> Option<Option<BooleanExpression>> {
        let whole = |value: &Real| value.constant().filter(|v| value.measure == Measure::PLAIN && v.fract() == 0.0);
        let same = |l, r| Some(Some(BooleanExpression::Same(l, r)));
        match (left, right) {
            (Meaning::Integer(l), Meaning::Integer(r)) => same(Operand::Signal(*l), Operand::Signal(*r)),
            (Meaning::Integer(port), Meaning::Real(value)) | (Meaning::Real(value), Meaning::Integer(port)) => {
                let Some(number) = whole(value) else { return Some(None) };
                if number < f64::from(i32::MIN) || number > f64::from(i32::MAX) {
                    return Some(Some(BooleanExpression::Constant(false)));
                }
                same(Operand::Signal(*port), Operand::Constant(Value::Integer(number as i32)))
            }
            (Meaning::Real(l), Meaning::Real(r)) => match (whole(l), whole(r)) {
                (Some(l), Some(r)) => Some(Some(BooleanExpression::Constant(l == r))),
                (None, Some(_)) if is_count(&l.expression) => {
                    Some(Some(count_equals(l.expression.clone(), r.expression.clone())))
                }
                (Some(_), None) if is_count(&r.expression) => {
                    Some(Some(count_equals(r.expression.clone(), l.expression.clone())))
                }
                _ => Some(None),
            },
            (Meaning::Item(port), Meaning::Text(Text::Literal(name))) => same(
                Operand::Signal(*port),
                Operand::Constant(Value::Integer(self.item(*port, name, sides.right.span)?)),
            ),
            (Meaning::Text(Text::Literal(name)), Meaning::Item(port)) => same(
                Operand::Signal(*port),
                Operand::Constant(Value::Integer(self.item(*port, name, sides.left.span)?)),
            ),
            (Meaning::Item(l), Meaning::Item(r)) if self.same_items(*l, *r) => {
                same(Operand::Signal(*l), Operand::Signal(*r))
            }
            (Meaning::Text(Text::Literal(l)), Meaning::Text(Text::Literal(r))) => {
                Some(Some(BooleanExpression::Constant(l == r)))
            }
            (Meaning::Text(Text::Port(l)), Meaning::Text(Text::Port(r))) => {
                same(Operand::Signal(*l), Operand::Signal(*r))
            }
            (Meaning::Text(Text::Port(port)), Meaning::Text(Text::Literal(text)))
            | (Meaning::Text(Text::Literal(text)), Meaning::Text(Text::Port(port))) => {
                same(Operand::Signal(*port), Operand::Constant(Value::String(text.clone())))
            }
            (Meaning::Condition(l), Meaning::Condition(r)) => self.agreement(sides, l, r).map(Some),
            _ => {
                let message = format!("{} and {} are never equal", left.kind(), right.kind());
                let error = Diagnostic::error("E21", sides.left.span, message).saying(left.kind());
                let error = error.label(sides.right.span, right.kind());
                self.refuse(error.help("both sides of `==` need one type"))
            }
        }
    }

    /// Whether two conditions hold or not together.
    fn agreement(&self, sides: &Sides<'_>, left: &Condition, right: &Condition) -> Option<BooleanExpression> {
        let (l, r) = (self.momentary(left, sides.left.span), self.momentary(right, sides.right.span));
        let (l, r) = (l?, r?);
        if boolean_size(&l) + boolean_size(&r) > MOST_PARTS {
            let error = Diagnostic::error("E39", sides.span(), "this comparison of Booleans has too many parts");
            return self.refuse(error.help("each `==` of Booleans has both sides twice: compute it inside a unit"));
        }
        Some(agree(l, r))
    }

    /// Whether two enumerations have items of the same names and values, in whatever order.
    pub fn same_items(&self, left: Port, right: Port) -> bool {
        let items = |port: Port| {
            let items = self.known(port.instance).items_of(port.variable).iter();
            items.map(|item| (item.name.as_str(), item.value)).collect::<BTreeSet<_>>()
        };
        items(left) == items(right)
    }
}

fn one_way(rest: &[ComparisonLink]) -> bool {
    let all = |ways: [Comparator; 2]| rest.iter().all(|link| ways.contains(&link.operator));
    all([Comparator::Less, Comparator::LessEqual]) || all([Comparator::Greater, Comparator::GreaterEqual])
}

/// Both hold or neither does.
fn agree(left: BooleanExpression, right: BooleanExpression) -> BooleanExpression {
    use BooleanExpression as B;
    match (left, right) {
        (B::Constant(true), other) | (other, B::Constant(true)) => other,
        (B::Constant(false), other) | (other, B::Constant(false)) => not(other),
        (B::Signal(l), B::Signal(r)) => B::Same(Operand::Signal(l), Operand::Signal(r)),
        (l, r) => B::Or(vec![B::And(vec![l.clone(), r.clone()]), B::And(vec![not(l), not(r)])]),
    }
}

/// The unit of the literal, else that of the signal, else SI.
fn shown_in(measure: Measure, left: &Real, right: &Real) -> MarginUnit {
    let named = |value: &Real| value.unit.clone().filter(|unit| !unit.unit.name.is_empty());
    let is_literal = |value: &Real| value.is_quantity();
    let of_literal = [right, left].into_iter().filter(|value| is_literal(value)).find_map(named);
    let written = || [right, left].into_iter().filter_map(named).find(|unit| unit.written);
    let declared = || [left, right].into_iter().find_map(named);
    match (of_literal.or_else(written).or_else(declared), measure) {
        (Some(unit), _) => unit.unit,
        (None, Measure::Known(dimension)) => MarginUnit { name: si_name(dimension), factor: 1.0 },
        (None, Measure::Undeclared) => MarginUnit { name: String::new(), factor: 1.0 },
    }
}

/// A constant in the unit of its margin; a literal of that unit is the number as written.
fn in_unit(value: &Real, unit: &MarginUnit) -> f64 {
    match (value.origin, value.constant()) {
        (Origin::Literal { number, base, .. }, _) if base.offset == 0.0 && base.factor == unit.factor => number,
        (_, Some(si)) => si / unit.factor,
        (_, None) => unreachable!("only constants are limits"),
    }
}
