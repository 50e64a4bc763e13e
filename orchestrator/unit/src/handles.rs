//! Handles of a unit's variables: what its calls take in place of names or indices.

use fmi2::c::ValueReference;
use std::sync::Arc;

/// The handles of variables of one type, in the order of their values.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Handles(Box<[ValueReference]>);

impl Handles {
    /// How many variables there are.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// As the C functions take them.
    #[inline]
    pub(crate) fn as_ptr(&self) -> *const ValueReference {
        self.0.as_ptr()
    }
}

/// Value references as the unit's description has them.
impl<const N: usize> From<[ValueReference; N]> for Handles {
    fn from(references: [ValueReference; N]) -> Self {
        Self(references.into())
    }
}

/// The handle of each variable of a unit, by its index in the description.
#[derive(Clone, Debug)]
pub(crate) struct HandleTable(pub Arc<[ValueReference]>);

impl HandleTable {
    /// The handles of these variables; `None` if the unit has no variable of one of the indices.
    pub fn handles(&self, variables: impl IntoIterator<Item = usize>) -> Option<Handles> {
        let handles = variables.into_iter().map(|variable| self.0.get(variable).copied());
        handles.collect::<Option<Box<[_]>>>().map(Handles)
    }
}

#[test]
fn a_variable_that_the_unit_does_not_have_has_no_handle() {
    let table = HandleTable([7, 9, 7].into());
    assert_eq!(table.handles([2, 1]), Some(Handles::from([7, 9])));
    assert_eq!(table.handles([0, 3]), None);
}
