//! What an expression can mean.

use std::rc::Rc;

use fmi2::units::{BaseUnit, Dimension};

use super::condition::{Condition, boolean_size};
use super::scale::Scale;
use crate::scenario::{BooleanExpression, MarginUnit, Near, Port, RealExpression};
use crate::source::{FileRef, Span};

/// The meaning of an expression. A part without meaning was reported and is `None`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Meaning {
    /// A real number, in SI.
    Real(Real),
    /// An Integer variable.
    Integer(Port),
    /// An Enumeration variable.
    Item(Port),
    /// A Boolean variable, comparison or claim.
    Condition(Condition),
    /// A text.
    Text(Text),
    /// A list literal, picked members, or a computed vector.
    List(Vec<Rc<Meaning>>),
    /// A group as a unit names it.
    Group(Group),
}

/// A real number, in SI.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Real {
    /// How it is computed.
    pub expression: RealExpression,
    /// What it measures.
    pub measure: Measure,
    /// The unit of measure that a user expects to see it in.
    pub unit: Option<UnitName>,
    /// Where it comes from.
    pub origin: Origin,
    /// Whether it is a point on a scale or a difference.
    pub scale: Scale,
}

/// What a real number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    /// Exponents of the base units.
    Known(Dimension),
    /// A variable without unit: fits everything, and is not a plain number.
    Undeclared,
}

/// A unit of measure for people; a difference, so without offset.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct UnitName {
    /// Its name and the SI value of one.
    pub unit: MarginUnit,
    /// The name as written or declared, which may be that of a scale with an offset.
    pub spelt: String,
    /// Whether the script wrote it, which counts before what a unit declares.
    pub written: bool,
}

/// Where a real number comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Origin {
    /// A number and its unit, as written.
    Literal {
        /// The number.
        number: f64,
        /// The unit.
        base: BaseUnit,
        /// Whether a unit was written.
        has_unit: bool,
    },
    /// The value of a variable.
    Port(Port),
    /// A computation.
    Computed,
}

/// A text.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Text {
    /// Written in the script.
    Literal(String),
    /// `file("x")`
    File(FileRef),
    /// A String variable.
    Port(Port),
}

/// Variables of one instance with a common beginning of their names.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Group {
    /// The instance.
    pub instance: usize,
    /// The common beginning.
    pub prefix: String,
    /// What follows the beginning, with the variable's index, in the description's order.
    pub members: Vec<(String, usize)>,
}

impl Measure {
    /// The measure of a plain number.
    pub const PLAIN: Self = Self::Known(Dimension::NONE);

    /// What both measure, with `rad` counting as 1; `None` if they differ.
    pub fn unify(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Undeclared, known) | (known, Self::Undeclared) => Some(known),
            (Self::Known(left), Self::Known(right)) if left.without_angle() == right.without_angle() => {
                Some(if left.0[7] == 0 { other } else { self })
            }
            _ => None,
        }
    }
}

impl Real {
    /// A computed value.
    pub fn computed(expression: RealExpression, measure: Measure, unit: Option<UnitName>) -> Self {
        Self { expression, measure, unit, origin: Origin::Computed, scale: Scale::Either }
    }

    /// The same value, known to be on a scale.
    pub fn on(self, scale: Scale) -> Self {
        Self { scale, ..self }
    }

    /// A plain number as written.
    pub fn plain(number: f64) -> Self {
        let origin = Origin::Literal { number, base: BaseUnit::default(), has_unit: false };
        Self {
            expression: RealExpression::Constant(number),
            measure: Measure::PLAIN,
            unit: None,
            origin,
            scale: Scale::Either,
        }
    }

    /// The variable, if it is the value of one.
    pub fn port(&self) -> Option<Port> {
        match self.origin {
            Origin::Port(port) => Some(port),
            _ => None,
        }
    }

    /// The value, if it is known before the run.
    pub fn constant(&self) -> Option<f64> {
        match self.expression {
            RealExpression::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// Whether the script wrote a number with a unit.
    pub fn is_quantity(&self) -> bool {
        matches!(self.origin, Origin::Literal { has_unit: true, .. })
    }
}

/// How many parts it has.
pub(super) fn real_size(value: &RealExpression) -> usize {
    use RealExpression as E;
    1 + match value {
        E::Constant(_) | E::Signal(_) | E::Time | E::Shared(_) | E::Curve(_) => 0,
        E::Affine { of, .. } | E::InverseAffine { of, .. } | E::Negate(of) | E::Near(Near { of, .. }) => real_size(of),
        E::Add(left, right) | E::Subtract(left, right) | E::Multiply(left, right) | E::Divide(left, right) => {
            real_size(left) + real_size(right)
        }
        E::Call(_, arguments) => arguments.iter().map(real_size).sum(),
        E::Running(running) => real_size(&running.of),
        E::Truth(condition) => boolean_size(condition),
    }
}

impl Meaning {
    /// A condition without a margin.
    pub fn plain(condition: BooleanExpression, span: Option<Span>) -> Self {
        Self::Condition(Condition::Plain(condition, span))
    }

    /// Whether the value is known before the run.
    pub fn is_constant(&self) -> bool {
        match self {
            Self::Real(real) => real.constant().is_some(),
            Self::Integer(_) | Self::Item(_) | Self::Group(_) | Self::Text(Text::Port(_)) => false,
            Self::Condition(condition) => matches!(condition.boolean(), Ok(BooleanExpression::Constant(_))),
            Self::Text(Text::Literal(_) | Text::File(_)) => true,
            Self::List(elements) => elements.iter().all(|element| element.is_constant()),
        }
    }

    /// How many parts it has.
    pub fn size(&self) -> usize {
        match self {
            Self::Real(real) => real_size(&real.expression),
            Self::Condition(condition) => condition.size(),
            Self::List(elements) => 1 + elements.iter().map(|element| element.size()).sum::<usize>(),
            Self::Integer(_) | Self::Item(_) | Self::Text(_) | Self::Group(_) => 1,
        }
    }

    /// What kind of thing it is, with an article.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Real(_) => "a number",
            Self::Integer(_) => "an Integer",
            Self::Item(_) => "an Enumeration",
            Self::Condition(_) => "a Boolean",
            Self::Text(Text::File(_)) => "a file",
            Self::Text(_) => "a text",
            Self::List(_) => "a list",
            Self::Group(_) => "a group",
        }
    }
}
