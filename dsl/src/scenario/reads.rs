//! Which ports a value is computed from.

use super::{BooleanExpression, Drive, Formula, Operand, Port, RealExpression};

impl Drive {
    /// Tells each port that the value is computed from, those behind [`BooleanExpression::Rises`] included; `rises` are
    /// the conditions by slot. A port may be told more than once.
    pub fn reads(&self, rises: &[BooleanExpression], told: &mut dyn FnMut(Port)) {
        match self {
            Self::Copy(port) => told(*port),
            Self::Real(value) => value.reads(told),
            Self::Boolean(condition) => condition.reads(rises, told),
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
    pub fn reads(&self, rises: &[BooleanExpression], told: &mut dyn FnMut(Port)) {
        match self {
            Self::Margin(margin) => margin.value.reads(told),
            Self::Condition(condition) => condition.reads(rises, told),
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.reads(rises, told)),
            Self::Always(_, body) | Self::Eventually(_, body) => body.reads(rises, told),
        }
    }
}

impl BooleanExpression {
    /// As [`Drive::reads`].
    pub fn reads(&self, rises: &[Self], told: &mut dyn FnMut(Port)) {
        match self {
            Self::Constant(_) => {}
            Self::Signal(port) => told(*port),
            Self::Margin(margin) => margin.value.reads(told),
            Self::Same(left, right) => {
                for operand in [left, right] {
                    if let Operand::Signal(port) = operand {
                        told(*port);
                    }
                }
            }
            Self::Rises(slot) => rises[*slot].reads(rises, told),
            Self::Not(of) => of.reads(rises, told),
            Self::And(parts) | Self::Or(parts) => parts.iter().for_each(|part| part.reads(rises, told)),
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
    fn reads(&self, told: &mut dyn FnMut(Port)) {
        match self {
            Self::Constant(_) | Self::Time => {}
            Self::Signal(port) => told(*port),
            Self::Affine { of, .. } | Self::InverseAffine { of, .. } | Self::Negate(of) => of.reads(told),
            Self::Add(left, right)
            | Self::Subtract(left, right)
            | Self::Multiply(left, right)
            | Self::Divide(left, right) => {
                left.reads(told);
                right.reads(told);
            }
            Self::Call(_, arguments) => arguments.iter().for_each(|argument| argument.reads(told)),
        }
    }
}
