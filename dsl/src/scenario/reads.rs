//! Which ports a value is computed from.

use super::{
    BooleanExpression, Condition, Drive, Formula, Gated, Near, Operand, Port, RealExpression, Scenario, Until,
};

/// What expressions name by slot.
#[derive(Clone, Copy, Debug)]
pub struct Slots<'a> {
    /// As [`Scenario::conditions`].
    pub conditions: &'a [Condition],
    /// As [`Scenario::shared`].
    pub shared: &'a [RealExpression],
}

impl Scenario {
    /// What its expressions name by slot.
    #[must_use]
    pub fn slots(&self) -> Slots<'_> {
        Slots { conditions: &self.conditions, shared: &self.shared }
    }
}

impl Drive {
    /// Visits each port that the value is computed from, those behind [`BooleanExpression::Rises`] and
    /// [`RealExpression::Shared`] included. A port may be visited more than once.
    pub fn reads(&self, slots: Slots<'_>, visit: &mut dyn FnMut(Port)) {
        match self {
            Self::Copy(port) => visit(*port),
            Self::Real(value) => value.reads(slots, visit),
            Self::Boolean(condition) => condition.reads(slots, visit),
            Self::Integer(_) | Self::String(_) | Self::Curve(_) => {}
        }
    }

    /// Whether the value depends on the sample before.
    #[must_use]
    pub fn rises(&self) -> bool {
        matches!(self, Self::Boolean(condition) if condition.has_rises())
    }
}

impl Formula {
    /// As [`Drive::reads`].
    pub fn reads(&self, slots: Slots<'_>, visit: &mut dyn FnMut(Port)) {
        match self {
            Self::Margin(margin) => margin.value.reads(slots, visit),
            Self::Condition(condition) => condition.reads(slots, visit),
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.reads(slots, visit)),
            Self::Always(_, body) | Self::Eventually(_, body) | Self::Finally(body) => body.reads(slots, visit),
            Self::Gated(Gated { gate, body, .. }) | Self::Until(Until { gate, body, .. }) => {
                gate.reads(slots, visit);
                body.reads(slots, visit);
            }
        }
    }
}

impl BooleanExpression {
    /// As [`Drive::reads`].
    pub fn reads(&self, slots: Slots<'_>, visit: &mut dyn FnMut(Port)) {
        match self {
            Self::Constant(_) => {}
            Self::Signal(port) => visit(*port),
            Self::Margin(margin) => margin.value.reads(slots, visit),
            Self::Same(left, right) => {
                for operand in [left, right] {
                    if let Operand::Signal(port) = operand {
                        visit(*port);
                    }
                }
            }
            Self::Rises(slot) => slots.conditions[*slot].is.reads(slots, visit),
            Self::Not(of) => of.reads(slots, visit),
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.reads(slots, visit)),
        }
    }

    fn has_rises(&self) -> bool {
        match self {
            Self::Rises(_) => true,
            Self::Not(of) => of.has_rises(),
            Self::And(parts) | Self::Or(parts) => parts.iter().any(Self::has_rises),
            Self::Constant(_) | Self::Signal(_) | Self::Margin(_) | Self::Same(..) => false,
        }
    }
}

impl RealExpression {
    pub(super) fn reads(&self, slots: Slots<'_>, visit: &mut dyn FnMut(Port)) {
        match self {
            Self::Constant(_) | Self::Time | Self::Curve(_) => {}
            Self::Signal(port) => visit(*port),
            Self::Affine { of, .. }
            | Self::InverseAffine { of, .. }
            | Self::Negate(of)
            | Self::Near(Near { of, .. }) => of.reads(slots, visit),
            Self::Add(left, right)
            | Self::Subtract(left, right)
            | Self::Multiply(left, right)
            | Self::Divide(left, right) => {
                left.reads(slots, visit);
                right.reads(slots, visit);
            }
            Self::Shared(slot) => slots.shared[*slot].reads(slots, visit),
            Self::Running(running) => running.of.reads(slots, visit),
            Self::Truth(condition) => condition.reads(slots, visit),
            Self::Call(_, arguments) => arguments.iter().for_each(|argument| argument.reads(slots, visit)),
        }
    }
}
