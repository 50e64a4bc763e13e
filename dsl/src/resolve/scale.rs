//! Points on a scale and differences between them: 20 degC is 293.15 K, a rise of 20 degC is 20 K.

use fmi2::units::{BaseUnit, Dimension};

use super::fit::Meeting;
use super::meaning::{Measure, Real};
use super::scope::Scope;
use crate::diagnostic::Diagnostic;
use crate::scenario::Port;
use crate::source::Span;
use crate::syntax::Operator;

/// The dimension of a temperature.
const TEMPERATURE: Dimension = Dimension([0, 0, 0, 0, 1, 0, 0, 0]);

/// Whether a number is a point on a scale or a difference, to which the offset of a unit of measure does not apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scale {
    /// A point on a scale.
    Point {
        /// Whether its unit of measure has an offset.
        offset: bool,
    },
    /// A difference.
    Difference {
        /// Whether a description says so (`relativeQuantity`); else it was computed from two points.
        declared: bool,
    },
    /// Nothing says which.
    Either,
}

impl Scale {
    /// The scale of a value in a unit of measure that nothing calls a difference.
    pub fn of(base: BaseUnit) -> Self {
        match base.offset != 0.0 {
            true => Self::Point { offset: true },
            false if base.dimension == TEMPERATURE => Self::Point { offset: false },
            false => Self::Either,
        }
    }

    /// Whether it is known to be a difference.
    pub fn is_difference(self) -> bool {
        matches!(self, Self::Difference { .. })
    }

    /// `left operator right`
    pub fn combined(operator: Operator, left: Self, right: Self) -> Self {
        use Scale::{Difference, Either, Point};
        match (operator, left, right) {
            (Operator::Add, Point { offset }, Difference { .. } | Either)
            | (Operator::Add, Difference { .. } | Either, Point { offset })
            | (Operator::Subtract, Point { offset }, Difference { .. }) => Point { offset },
            (Operator::Subtract, Point { .. }, Point { .. }) => Difference { declared: false },
            (Operator::Add | Operator::Subtract, Difference { declared: l }, Difference { declared: r }) => {
                Difference { declared: l || r }
            }
            (Operator::Multiply, Difference { declared }, Either)
            | (Operator::Multiply, Either, Difference { declared })
            | (Operator::Divide, Difference { declared }, Either) => Difference { declared },
            _ => Either,
        }
    }

    /// That of an extreme or a mean of both.
    pub fn joined(self, other: Self) -> Self {
        match (self, other) {
            (Self::Difference { declared: l }, Self::Difference { declared: r }) => {
                Self::Difference { declared: l || r }
            }
            (Self::Point { offset: l }, Self::Point { offset: r }) => Self::Point { offset: l || r },
            _ => Self::Either,
        }
    }

    /// Whether one is a difference, the other a point, and the two cannot be meant to be one quantity. A description
    /// that declares nothing may well mean a difference in K.
    pub fn clashes(self, other: Self) -> bool {
        match (self, other) {
            (Self::Difference { declared }, Self::Point { offset })
            | (Self::Point { offset }, Self::Difference { declared }) => declared || offset,
            _ => false,
        }
    }
}

impl Scope<'_, '_> {
    /// The scale that a variable is declared to be on.
    pub fn scale(&self, port: Port) -> Scale {
        let unit = self.known(port.instance);
        if unit.is_relative(port.variable) {
            return Scale::Difference { declared: true };
        }
        self.declared_unit(port).map_or(Scale::Either, Scale::of)
    }

    /// Whether a value cannot be meant for a variable, since one is a difference and the other a point on a scale.
    fn is_off_scale(&self, value: &Real, target: Port) -> bool {
        let unit = self.known(target.instance);
        let has_offset = unit.has_offset(target.variable);
        if !unit.is_relative(target.variable) {
            return value.scale.clashes(Scale::Point { offset: has_offset });
        }
        let is_port = value.port().is_some() && !value.scale.is_difference();
        value.scale == Scale::Point { offset: true } || (has_offset && is_port)
    }

    /// Refuses a difference where a variable takes a point on a scale, and the reverse.
    pub fn check_scale(&self, value: &Real, target: Port, at: Meeting<'_>) -> Option<()> {
        if !self.is_off_scale(value, target) {
            return Some(());
        }
        let (source, takes) = (self.text(at.source), self.port_name(target));
        let is_temperature = value.measure == Measure::Known(TEMPERATURE);
        let example =
            |operator| if is_temperature { format!(": `{source} {operator} 273.15 K`") } else { String::new() };
        let (gives, wants, help) = if value.scale.is_difference() {
            ("a difference", "a point on a scale", format!("add the point that it counts from{}", example("+")))
        } else {
            ("a point on a scale", "a difference", format!("subtract the point to count from{}", example("-")))
        };
        let error = Diagnostic::error("E32", at.source, format!("`{takes}` takes {wants}, and `{source}` is {gives}"));
        self.refuse(error.saying(format!("gives {gives}")).label(at.target, format!("takes {wants}")).help(help))
    }

    /// Refuses a comparison or extreme of a difference and a point on a scale.
    pub fn check_scales(&self, left: (&Real, Span), right: (&Real, Span)) -> Option<()> {
        if !left.0.scale.clashes(right.0.scale) {
            return Some(());
        }
        let is = |value: &Real| if value.scale.is_difference() { "a difference" } else { "a point on a scale" };
        let error = Diagnostic::error("E32", left.1, "a difference cannot be compared with a point on a scale");
        let error = error.saying(is(left.0)).label(right.1, is(right.0));
        self.refuse(error.help("compare two points or two differences: the difference of two points is `a - b`"))
    }
}

#[test]
fn a_difference_moves_a_point_and_two_points_make_a_difference() {
    use Scale::{Difference, Either, Point};
    let (point, rise) = (Point { offset: true }, Difference { declared: true });
    assert_eq!(Scale::combined(Operator::Add, point, rise), point);
    assert_eq!(Scale::combined(Operator::Subtract, point, point), Difference { declared: false });
    assert_eq!(Scale::combined(Operator::Subtract, rise, rise), rise);
    assert_eq!(Scale::combined(Operator::Multiply, Either, rise), rise);
    assert_eq!(Scale::combined(Operator::Multiply, point, Either), Either);
    assert_eq!(Scale::combined(Operator::Add, rise, Either), Either);
}
