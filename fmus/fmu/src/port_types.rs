//! The scalar types, arrays, vectors and quaternions as ports.
#![allow(unsafe_code, reason = "Port is an unsafe trait: its references become offsets")]

use crate::declaration::Declaration;
use crate::port::{NoBound, Port};
use crate::visitor::Visitor;
use nalgebra::{Quaternion, Vector2, Vector3};

// SAFETY: a scalar passes itself.
unsafe impl Port for f64 {
    type Start = f64;
    type Bound = f64;
    const TAKES_UNIT: bool = true;

    fn from_start(start: f64) -> Self {
        start
    }

    fn unset() -> Self {
        0.0
    }

    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor) {
        visitor.real(self, declaration);
    }
}

// SAFETY: a scalar passes itself.
unsafe impl Port for i32 {
    type Start = i32;
    type Bound = i32;
    const TAKES_UNIT: bool = false;

    fn from_start(start: i32) -> Self {
        start
    }

    fn unset() -> Self {
        0
    }

    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor) {
        visitor.integer(self, declaration);
    }
}

// SAFETY: a scalar passes itself.
unsafe impl Port for bool {
    type Start = bool;
    type Bound = NoBound;
    const TAKES_UNIT: bool = false;

    fn from_start(start: bool) -> Self {
        start
    }

    fn unset() -> Self {
        false
    }

    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor) {
        visitor.boolean(self, declaration);
    }
}

// SAFETY: a scalar passes itself; its text is accessed through the `String` only.
unsafe impl Port for String {
    type Start = &'static str;
    type Bound = NoBound;
    const TAKES_UNIT: bool = false;

    fn from_start(start: &'static str) -> Self {
        start.to_owned()
    }

    fn unset() -> Self {
        Self::new()
    }

    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor) {
        visitor.string(self, declaration);
    }
}

// SAFETY: the elements are inside the array, in order.
unsafe impl<T: Port, const N: usize> Port for [T; N] {
    type Start = [T::Start; N];
    type Bound = T::Bound;
    const TAKES_UNIT: bool = T::TAKES_UNIT;
    const OWN_ROLES: bool = T::OWN_ROLES;
    const STARTS_ITSELF: bool = T::STARTS_ITSELF;

    fn from_start(start: [T::Start; N]) -> Self {
        start.map(T::from_start)
    }

    fn unset() -> Self {
        std::array::from_fn(|_| T::unset())
    }

    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor) {
        for (index, element) in self.iter_mut().enumerate() {
            visitor.element(index + 1, declaration, element);
        }
    }
}

// SAFETY: the components are inside the vector, in order.
unsafe impl Port for Vector2<f64> {
    type Start = [f64; 2];
    type Bound = f64;
    const TAKES_UNIT: bool = true;

    fn from_start(start: [f64; 2]) -> Self {
        Self::from(start)
    }

    fn unset() -> Self {
        Self::zeros()
    }

    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor) {
        for (name, component) in ["x", "y"].into_iter().zip(self.as_mut_slice()) {
            visitor.field(name, declaration, component);
        }
    }
}

// SAFETY: the components are inside the vector, in order.
unsafe impl Port for Vector3<f64> {
    type Start = [f64; 3];
    type Bound = f64;
    const TAKES_UNIT: bool = true;

    fn from_start(start: [f64; 3]) -> Self {
        Self::from(start)
    }

    fn unset() -> Self {
        Self::zeros()
    }

    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor) {
        for (name, component) in ["x", "y", "z"].into_iter().zip(self.as_mut_slice()) {
            visitor.field(name, declaration, component);
        }
    }
}

/// Scalars and start value are in the order w, x, y, z; the default is the identity.
// SAFETY: the four numbers are inside the quaternion.
unsafe impl Port for Quaternion<f64> {
    type Start = [f64; 4];
    type Bound = f64;
    const TAKES_UNIT: bool = true;

    fn from_start([w, x, y, z]: [f64; 4]) -> Self {
        Self::new(w, x, y, z)
    }

    fn unset() -> Self {
        Self::identity()
    }

    fn visit(&mut self, declaration: &Declaration, visitor: &mut Visitor) {
        let [x, y, z, w] = &mut self.coords.data.0[0];
        for (name, number) in [("w", w), ("x", x), ("y", y), ("z", z)] {
            visitor.field(name, declaration, number);
        }
    }
}
