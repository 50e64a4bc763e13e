//! The traits of types that can be ports: their scalars, in order, and the location of each.
#![allow(unsafe_code, reason = "Port is an unsafe trait: its references become offsets")]

use crate::declaration::Declaration;
use crate::visitor::Visitor;

/// A type that can be a port: `f64`, `i32`, `bool`, `String`, vectors, quaternions, arrays, enumerations and groups.
///
/// Derive it (`Group`, `FmiEnum`) instead of writing it.
///
/// # Safety
///
/// `visit` passes the visitor references to fields that are inside `self` and keep their offset and type for the whole
/// life of the value, whatever its content: no payload of an enum, nothing behind a pointer. It visits the same fields
/// in the same order for every value of the type.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be a port",
    label = "no port",
    note = "ports are f64, i32, bool, String, Vector2<f64>, Vector3<f64>, Quaternion<f64>, arrays of ports, enums with `derive(FmiEnum)` and structs with `derive(Group)`"
)]
pub unsafe trait Port: Sized {
    /// Type of a start value in the attribute.
    type Start;
    /// Type of `min`, `max` and `nominal` in the attribute; [`NoBound`] for types without them.
    type Bound: Into<f64>;
    /// Whether the port needs a `unit`: it has Reals without a unit of their own.
    const TAKES_UNIT: bool;
    /// Whether the fields inside declare their own roles (input, output and so on).
    const OWN_ROLES: bool = false;
    /// Whether the type has its own start values, so that the field needs none.
    const STARTS_ITSELF: bool = false;

    /// The port with a start value.
    fn from_start(start: Self::Start) -> Self;

    /// The port without a start value.
    fn unset() -> Self;

    /// Passes each scalar of the port to the visitor.
    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor);
}

/// The bound of a type without bounds: an enum without values.
#[derive(Clone, Copy, Debug)]
pub enum NoBound {}

impl From<NoBound> for f64 {
    fn from(bound: NoBound) -> Self {
        match bound {}
    }
}

/// An enumeration of FMI; derive it for an enum whose variants carry no data.
pub trait FmiEnum: Copy + 'static {
    /// Name of the type.
    const NAME: &'static str;
    /// Description of the type.
    const DESCRIPTION: &'static str;
    /// Name, value and description of each item.
    const ITEMS: &'static [(&'static str, i32, &'static str)];

    /// The value of an item.
    fn value(self) -> i32;

    /// The item of a value.
    fn from_value(value: i32) -> Option<Self>;
}
