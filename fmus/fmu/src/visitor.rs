//! Visits a unit once and records each scalar: its name, declaration, start value and offset.

use crate::declaration::{Declaration, Ports};
use crate::port::{FmiEnum, Port};

/// One FMI variable.
#[derive(Clone, Debug)]
pub struct Scalar {
    /// The structured name, `state.position.x`.
    pub name: String,
    /// Its declaration.
    pub declaration: Declaration,
    /// Its start value.
    pub start: Value,
    /// Offset in bytes in the unit's struct.
    pub(crate) offset: usize,
    /// Its type; for an enumeration with access to its items.
    pub(crate) kind: ScalarKind,
}

/// A value of any base type.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Real
    Real(f64),
    /// Integer or Enumeration
    Integer(i32),
    /// Boolean
    Boolean(bool),
    /// String
    String(String),
}

/// The type of a scalar.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ScalarKind {
    Real,
    Integer,
    Enumeration(Enumeration),
    Boolean,
    String,
}

/// An enumeration type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Enumeration {
    pub(crate) name: &'static str,
    pub(crate) description: &'static str,
    pub(crate) items: &'static [(&'static str, i32, &'static str)],
    pub(crate) access: EnumerationAccess,
}

/// Functions that read and write an enumeration whose type is known only during the visit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EnumerationAccess {
    /// # Safety
    ///
    /// The pointer is to a live value of the visited type.
    pub(crate) get: unsafe fn(*const u8) -> i32,
    /// Returns whether the value is one of the items; writes nothing if it is not.
    ///
    /// # Safety
    ///
    /// The pointer is to a live value of the visited type.
    pub(crate) set: unsafe fn(*mut u8, i32) -> bool,
    /// Whether the value is one of the items.
    pub(crate) is_item: fn(i32) -> bool,
}

/// Collects the scalars of a unit.
#[derive(Debug)]
pub struct Visitor {
    base: usize,
    size: usize,
    path: String,
    scalars: Vec<Scalar>,
}

impl Scalar {
    /// Whether the name is its own, or that of a group or array that it belongs to.
    pub(crate) fn is_named(&self, name: &str) -> bool {
        self.name.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
    }
}

impl Visitor {
    /// The scalars of a unit in the order of declaration.
    pub(crate) fn scalars_of<U: Ports>(unit: &mut U) -> Vec<Scalar> {
        let base = std::ptr::from_mut(unit).addr();
        let mut visitor = Self { base, size: size_of::<U>(), path: String::new(), scalars: Vec::new() };
        unit.visit(&mut visitor);
        visitor.scalars
    }

    /// Visits a named field of the current value.
    pub fn field<P: Port>(&mut self, name: &str, declaration: &Declaration, port: &mut P) {
        let length = self.path.len();
        if length > 0 {
            self.path.push('.');
        }
        self.path.push_str(name);
        port.visit(declaration, self);
        self.path.truncate(length);
    }

    /// Visits an element of an array, counted from 1; the index of a nested array follows a comma.
    pub(crate) fn element<P: Port>(&mut self, index: usize, declaration: &Declaration, port: &mut P) {
        let outer = self.path.clone();
        self.path = match outer.strip_suffix(']') {
            Some(open) => format!("{open},{index}]"),
            None => format!("{outer}[{index}]"),
        };
        port.visit(declaration, self);
        self.path = outer;
    }

    /// The full name, from the unit's struct, of a field of the current value.
    #[must_use]
    pub fn full_name(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) }
    }

    /// The full names of fields of the current value.
    #[must_use]
    pub fn full_names(&self, names: &[&str]) -> Vec<String> {
        names.iter().map(|name| self.full_name(name)).collect()
    }

    /// Records a Real.
    pub(crate) fn real(&mut self, value: &mut f64, declaration: &Declaration) {
        self.note(std::ptr::from_mut(value), Value::Real(*value), ScalarKind::Real, declaration);
    }

    /// Records an Integer.
    pub(crate) fn integer(&mut self, value: &mut i32, declaration: &Declaration) {
        self.note(std::ptr::from_mut(value), Value::Integer(*value), ScalarKind::Integer, declaration);
    }

    /// Records a Boolean.
    pub(crate) fn boolean(&mut self, value: &mut bool, declaration: &Declaration) {
        self.note(std::ptr::from_mut(value), Value::Boolean(*value), ScalarKind::Boolean, declaration);
    }

    /// Records a String.
    pub(crate) fn string(&mut self, value: &mut String, declaration: &Declaration) {
        self.note(std::ptr::from_mut(value), Value::String(value.clone()), ScalarKind::String, declaration);
    }

    /// Records an Enumeration.
    pub fn enumeration<E: FmiEnum>(&mut self, value: &mut E, declaration: &Declaration) {
        let enumeration = Enumeration {
            name: E::NAME,
            description: E::DESCRIPTION,
            items: E::ITEMS,
            access: crate::body::enumeration_access::<E>(),
        };
        let start = Value::Integer(value.value());
        self.note(std::ptr::from_mut(value), start, ScalarKind::Enumeration(enumeration), declaration);
    }

    fn note<T>(&mut self, place: *mut T, start: Value, kind: ScalarKind, declaration: &Declaration) {
        let offset = place.addr().wrapping_sub(self.base);
        assert!(
            offset.checked_add(size_of::<T>()).is_some_and(|end| end <= self.size),
            "port `{}` lies outside the unit's struct: it cannot be reached through a pointer",
            self.path
        );
        let declaration = declaration.clone();
        self.scalars.push(Scalar { name: self.path.clone(), declaration, start, offset, kind });
    }
}
