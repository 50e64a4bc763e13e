//! Conditions and claims: one tree, from which a run gets conditions at one point in time or formulas with margins.

use super::meaning::{Measure, real_size};
use super::running::latest_start_of;
use crate::scenario::{BooleanExpression, Limit, Margin, MarginUnit, RealExpression, TickWindow};
use crate::source::Span;
use crate::syntax::TemporalWord;

/// A condition or claim before negations are moved inward.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Condition {
    /// Without a margin, and where it is written; `None` for a Boolean port, of which reports show the port.
    Plain(BooleanExpression, Option<Span>),
    /// A comparison of reals.
    Bound(Bound),
    /// `not a`
    Not(Box<Condition>),
    /// `a and b`
    And(Vec<Condition>),
    /// `a or b`
    Or(Vec<Condition>),
    /// `always`, `eventually`, `hold for`, `finally`
    Temporal(Temporal),
    /// `g implies φ`
    Implies {
        /// `g`
        gate: Box<Condition>,
        /// Its place.
        gate_span: Span,
        /// `φ`
        then: Box<Condition>,
    },
    /// `φ until g`
    Until(Until),
}

/// A comparison of reals with what a report shows of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bound {
    /// The distance from the limit.
    pub margin: Margin,
    /// What the margin measures.
    pub measure: Measure,
    /// The unit in which the margin is shown.
    pub unit: MarginUnit,
    /// The limit, if one side is constant.
    pub limit: Option<Limit>,
    /// Its place.
    pub span: Span,
    /// The same comparison between plain numbers, as advice.
    pub scaled: Option<String>,
}

/// A temporal word with its window.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Temporal {
    /// The keyword.
    pub word: TemporalWord,
    /// Its place.
    pub span: Span,
    /// The place of the word and its window.
    pub head: Span,
    /// Its window; of `finally` that of all ticks.
    pub window: TickWindow,
    /// What must hold in the window.
    pub body: Box<Condition>,
}

/// `φ until g`
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Until {
    /// The place of the whole.
    pub span: Span,
    /// The place of `until` with its window.
    pub head: Span,
    /// The place of `g`.
    pub gate_span: Span,
    /// When `g` may come.
    pub window: TickWindow,
    /// `φ`
    pub body: Box<Condition>,
    /// `g`
    pub gate: Box<Condition>,
}

/// How many parts it has.
pub(super) fn boolean_size(condition: &BooleanExpression) -> usize {
    use BooleanExpression as B;
    1 + match condition {
        B::Constant(_) | B::Signal(_) | B::Same(..) | B::Rises(_) => 0,
        B::Margin(margin) => real_size(&margin.value),
        B::Not(of) => boolean_size(of),
        B::And(parts) | B::Or(parts) => parts.iter().map(boolean_size).sum(),
    }
}

impl Condition {
    /// How many parts it has.
    pub fn size(&self) -> usize {
        1 + match self {
            Self::Plain(condition, _) => boolean_size(condition),
            Self::Bound(bound) => real_size(&bound.margin.value),
            Self::Not(of) => of.size(),
            Self::And(parts) | Self::Or(parts) => parts.iter().map(Self::size).sum(),
            Self::Temporal(claim) => claim.body.size(),
            Self::Implies { gate, then, .. } => gate.size() + then.size(),
            Self::Until(Until { body, gate, .. }) => body.size() + gate.size(),
        }
    }

    /// The condition as one that a run evaluates at a point in time; false as long as a running value in it has no value.
    ///
    /// # Errors
    /// The place of a temporal word.
    pub fn boolean(&self) -> Result<BooleanExpression, Span> {
        let condition = self.at_any_time()?;
        let Some((from_tick @ 1.., step_s)) = latest_start_of(&condition) else { return Ok(condition) };
        // Half a step before it, so that rounding does not matter.
        #[expect(clippy::cast_precision_loss, reason = "exact up to 2^53 ticks")]
        let from_s = (from_tick as f64 - 0.5) * step_s;
        let since =
            RealExpression::Subtract(Box::new(RealExpression::Time), Box::new(RealExpression::Constant(from_s)));
        let begun = BooleanExpression::Margin(Margin { value: since, strict: false });
        Ok(BooleanExpression::And(vec![begun, condition]))
    }

    fn at_any_time(&self) -> Result<BooleanExpression, Span> {
        let all = |parts: &[Self]| parts.iter().map(Self::at_any_time).collect::<Result<Vec<_>, _>>();
        Ok(match self {
            Self::Plain(condition, _) => condition.clone(),
            Self::Bound(bound) => match bound.margin.value {
                RealExpression::Constant(margin) => {
                    BooleanExpression::Constant(if bound.margin.strict { margin > 0.0 } else { margin >= 0.0 })
                }
                _ => BooleanExpression::Margin(bound.margin.clone()),
            },
            Self::Not(inner) => opposite(inner.at_any_time()?),
            Self::And(parts) => joined(all(parts)?, false, BooleanExpression::And),
            Self::Or(parts) => joined(all(parts)?, true, BooleanExpression::Or),
            Self::Implies { gate, then, .. } => {
                joined(vec![opposite(gate.at_any_time()?), then.at_any_time()?], true, BooleanExpression::Or)
            }
            Self::Temporal(temporal) => return Err(temporal.span),
            Self::Until(until) => return Err(until.span),
        })
    }
}

/// `and` or `or`; one part that decides alone leaves nothing to compute, a part that never does is dropped.
fn joined(
    mut parts: Vec<BooleanExpression>,
    decides: bool,
    join: fn(Vec<BooleanExpression>) -> BooleanExpression,
) -> BooleanExpression {
    if parts.contains(&BooleanExpression::Constant(decides)) {
        return BooleanExpression::Constant(decides);
    }
    parts.retain(|part| *part != BooleanExpression::Constant(!decides));
    if parts.is_empty() { BooleanExpression::Constant(!decides) } else { join(parts) }
}

/// `not condition`
pub(super) fn opposite(condition: BooleanExpression) -> BooleanExpression {
    match condition {
        BooleanExpression::Constant(value) => BooleanExpression::Constant(!value),
        other => BooleanExpression::Not(Box::new(other)),
    }
}
