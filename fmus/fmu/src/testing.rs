//! The tests that every unit gets from [`export!`](crate::export).

/// The tests of a unit.
#[doc(hidden)]
#[macro_export]
macro_rules! export_tests {
    ($library:ident) => {};
}
