//! Walks once over a unit and notes each scalar: its name, what was declared, its start value and where it lies.

use crate::declaration::{Declaration, Ports};
use crate::port::{FmiEnum, Port};

/// One FMI variable.
#[derive(Clone, Debug)]
pub struct Scalar {
    /// The structured name, `state.position.x`.
    pub name: String,
    /// What was declared for it.
    pub declaration: Declaration,
    /// Its value at the start.
    pub start: Value,
    /// Distance in bytes from the beginning of the unit's struct.
    pub(crate) offset: usize,
    /// Its type; an enumeration brings the access to its items.
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

/// What is known of an enumeration type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Enumeration {
    pub(crate) name: &'static str,
    pub(crate) description: &'static str,
    pub(crate) items: &'static [(&'static str, i32, &'static str)],
    pub(crate) access: EnumerationAccess,
}

/// Reads and writes an enumeration whose type only the visitor knew.
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

impl Visitor {
    /// The scalars of a unit in the order of declaration.
    pub(crate) fn scalars_of<U: Ports>(unit: &mut U) -> Vec<Scalar> {
        let base = std::ptr::from_mut(unit).addr();
        let mut visitor = Self { base, size: size_of::<U>(), path: String::new(), scalars: Vec::new() };
        unit.visit(&mut visitor);
        visitor.scalars
    }

    /// Visits a named field of the value in hand.
    pub fn field<P: Port>(&mut self, name: &str, declaration: &Declaration, port: &mut P) {
        let length = self.path.len();
        if length > 0 {
            self.path.push('.');
        }
        self.path.push_str(name);
        port.visit(declaration, self);
        self.path.truncate(length);
    }

    /// Visits an element of an array, counted from 1; the index of an array in an array stands behind a comma.
    pub(crate) fn element<P: Port>(&mut self, index: usize, declaration: &Declaration, port: &mut P) {
        let outer = self.path.clone();
        self.path = match outer.strip_suffix(']') {
            Some(open) => format!("{open},{index}]"),
            None => format!("{outer}[{index}]"),
        };
        port.visit(declaration, self);
        self.path = outer;
    }

    /// Names that stand beside the field in hand, as seen from the whole unit.
    #[must_use]
    pub fn scoped(&self, names: &[&str]) -> Vec<String> {
        let scope = if self.path.is_empty() { String::new() } else { format!("{}.", self.path) };
        names.iter().map(|name| format!("{scope}{name}")).collect()
    }

    /// Notes a Real.
    pub(crate) fn real(&mut self, value: &mut f64, declaration: &Declaration) {
        self.note(std::ptr::from_mut(value), Value::Real(*value), ScalarKind::Real, declaration);
    }

    /// Notes an Integer.
    pub(crate) fn integer(&mut self, value: &mut i32, declaration: &Declaration) {
        self.note(std::ptr::from_mut(value), Value::Integer(*value), ScalarKind::Integer, declaration);
    }

    /// Notes a Boolean.
    pub(crate) fn boolean(&mut self, value: &mut bool, declaration: &Declaration) {
        self.note(std::ptr::from_mut(value), Value::Boolean(*value), ScalarKind::Boolean, declaration);
    }

    /// Notes a String.
    pub(crate) fn string(&mut self, value: &mut String, declaration: &Declaration) {
        self.note(std::ptr::from_mut(value), Value::String(value.clone()), ScalarKind::String, declaration);
    }

    /// Notes an Enumeration.
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
