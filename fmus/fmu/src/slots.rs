//! The table behind value references: for each base type, the offsets of the scalars and when they may be set.

use crate::declaration::Role;
use crate::describe::attributes;
use crate::visitor::{EnumerationAccess, Scalar, ScalarKind};
use fmi2::calls::{Permission, State, settable};

/// The table of one unit. A value reference is an index into the list of its base type.
#[derive(Debug)]
pub(crate) struct Slots {
    pub(crate) reals: Vec<RealSlot>,
    pub(crate) integers: Vec<IntegerSlot>,
    pub(crate) booleans: Vec<Slot>,
    pub(crate) strings: Vec<Slot>,
    /// The Reals that the unit computes.
    pub(crate) computed_reals: Vec<usize>,
    /// Size of the unit's struct in bytes.
    pub(crate) size: usize,
}

/// The states in which a scalar may be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Settable {
    /// The unit computes it.
    Never,
    /// A start value: before the run.
    BeforeTheRun,
    /// An input or a tunable parameter: between steps too.
    BetweenSteps,
}

impl Settable {
    /// The table of the standard, in a form that is fast to evaluate in a call.
    fn of(scalar: &Scalar) -> Self {
        let (causality, variability, initial) = attributes(scalar);
        let may_be_set = |state| settable(state, causality, variability, initial) == Permission::Always;
        if may_be_set(State::StepComplete) {
            Self::BetweenSteps
        } else if may_be_set(State::Instantiated) {
            Self::BeforeTheRun
        } else {
            Self::Never
        }
    }

    /// Whether it may be set in a state in which set calls are permitted.
    #[inline]
    pub(crate) fn in_state(self, state: State) -> bool {
        match self {
            Self::Never => false,
            Self::BeforeTheRun => state != State::StepComplete,
            Self::BetweenSteps => true,
        }
    }
}

/// A Boolean or String.
#[derive(Debug)]
pub(crate) struct Slot {
    pub(crate) name: String,
    pub(crate) offset: usize,
    pub(crate) settable: Settable,
}

/// A Real with its bounds; by default those of the finite numbers.
#[derive(Debug)]
pub(crate) struct RealSlot {
    pub(crate) offset: usize,
    pub(crate) min: f64,
    pub(crate) max: f64,
    pub(crate) settable: Settable,
    pub(crate) name: String,
}

/// An Integer or Enumeration.
#[derive(Debug)]
pub(crate) struct IntegerSlot {
    pub(crate) offset: usize,
    pub(crate) access: IntegerAccess,
    pub(crate) settable: Settable,
    pub(crate) name: String,
}

/// The type of the scalar of an [`IntegerSlot`].
#[derive(Debug)]
pub(crate) enum IntegerAccess {
    Plain { min: i32, max: i32 },
    Enumeration(EnumerationAccess),
}

impl Slots {
    /// The table of these scalars; also the value reference of each.
    pub(crate) fn of(scalars: &[Scalar], size: usize) -> (Self, Vec<u32>) {
        let mut slots =
            Self { reals: vec![], integers: vec![], booleans: vec![], strings: vec![], computed_reals: vec![], size };
        let references = scalars.iter().map(|scalar| slots.add(scalar)).collect();
        (slots, references)
    }

    fn add(&mut self, scalar: &Scalar) -> u32 {
        let Scalar { name, offset, declaration, .. } = scalar;
        let (name, offset, settable) = (name.clone(), *offset, Settable::of(scalar));
        let (min, max) = (declaration.min.unwrap_or(f64::MIN), declaration.max.unwrap_or(f64::MAX));
        let index = match scalar.kind {
            ScalarKind::Real => {
                if !matches!(declaration.role, Role::Input | Role::Parameter { .. }) {
                    self.computed_reals.push(self.reals.len());
                }
                self.reals.push(RealSlot { offset, min, max, settable, name });
                self.reals.len() - 1
            }
            ScalarKind::Integer => {
                #[expect(
                    clippy::cast_possible_truncation,
                    reason = "bounds of Integers were i32; without one it saturates"
                )]
                let access = IntegerAccess::Plain { min: min as i32, max: max as i32 };
                self.integers.push(IntegerSlot { offset, access, settable, name });
                self.integers.len() - 1
            }
            ScalarKind::Enumeration(enumeration) => {
                let access = IntegerAccess::Enumeration(enumeration.access);
                self.integers.push(IntegerSlot { offset, access, settable, name });
                self.integers.len() - 1
            }
            ScalarKind::Boolean => {
                self.booleans.push(Slot { name, offset, settable });
                self.booleans.len() - 1
            }
            ScalarKind::String => {
                self.strings.push(Slot { name, offset, settable });
                self.strings.len() - 1
            }
        };
        u32::try_from(index).unwrap_or(u32::MAX)
    }
}
