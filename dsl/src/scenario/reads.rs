//! Which ports a value is computed from.

use super::{BooleanExpression, Condition, Drive, Formula, Operand, Port, RealExpression};

impl Drive {
    /// Visits each port that the value is computed from, those behind [`BooleanExpression::Rises`] included; `conditions` are
    /// those of the scenario by slot. A port may be visited more than once.
    pub fn reads(&self, conditions: &[Condition], visit: &mut dyn FnMut(Port)) {
        match self {
            Self::Copy(port) => visit(*port),
            Self::Real(value) => value.reads(visit),
            Self::Boolean(condition) => condition.reads(conditions, visit),
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
    pub fn reads(&self, conditions: &[Condition], visit: &mut dyn FnMut(Port)) {
        match self {
            Self::Margin(margin) => margin.value.reads(visit),
            Self::Condition(condition) => condition.reads(conditions, visit),
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.reads(conditions, visit)),
            Self::Always(_, body) | Self::Eventually(_, body) => body.reads(conditions, visit),
        }
    }
}

impl BooleanExpression {
    /// As [`Drive::reads`].
    pub fn reads(&self, conditions: &[Condition], visit: &mut dyn FnMut(Port)) {
        match self {
            Self::Constant(_) => {}
            Self::Signal(port) => visit(*port),
            Self::Margin(margin) => margin.value.reads(visit),
            Self::Same(left, right) => {
                for operand in [left, right] {
                    if let Operand::Signal(port) = operand {
                        visit(*port);
                    }
                }
            }
            Self::Rises(slot) => conditions[*slot].is.reads(conditions, visit),
            Self::Not(of) => of.reads(conditions, visit),
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.reads(conditions, visit)),
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
    fn reads(&self, visit: &mut dyn FnMut(Port)) {
        match self {
            Self::Constant(_) | Self::Time => {}
            Self::Signal(port) => visit(*port),
            Self::Affine { of, .. } | Self::InverseAffine { of, .. } | Self::Negate(of) => of.reads(visit),
            Self::Add(left, right)
            | Self::Subtract(left, right)
            | Self::Multiply(left, right)
            | Self::Divide(left, right) => {
                left.reads(visit);
                right.reads(visit);
            }
            Self::Call(_, arguments) => arguments.iter().for_each(|argument| argument.reads(visit)),
        }
    }
}
