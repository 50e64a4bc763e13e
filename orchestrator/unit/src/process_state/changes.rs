//! The kinds of change that are looked for.

use std::fmt;
use std::ops::{BitOr, BitOrAssign};

/// A set of kinds of change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes(u8);

impl Changes {
    /// No change.
    pub const NONE: Self = Self(0);
    pub(crate) const ROUNDING: Self = Self(1);
    pub(crate) const FLUSH_TO_ZERO: Self = Self(2);
    pub(crate) const EXCEPTIONS: Self = Self(4);
    pub(crate) const PRECISION: Self = Self(8);
    /// All that belongs to floating-point control.
    pub(crate) const FLOATING_POINT: Self = Self(15);
    pub(crate) const LOCALE: Self = Self(16);
    pub(crate) const FOLDER: Self = Self(32);

    const NAMES: [(Self, &str); 6] = [
        (Self::ROUNDING, "the rounding mode"),
        (Self::FLUSH_TO_ZERO, "flush-to-zero"),
        (Self::EXCEPTIONS, "the floating-point exception masks"),
        (Self::PRECISION, "the x87 precision"),
        (Self::LOCALE, "the locale"),
        (Self::FOLDER, "the working directory"),
    ];

    /// Whether both sets have a kind in common.
    pub(crate) fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// The kinds that are not in `other`.
    pub(crate) fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }
}

impl BitOr for Changes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Changes {
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = Self::NAMES.iter().filter(|(kind, _)| self.meets(*kind)).map(|(_, name)| *name).collect();
        match names.as_slice() {
            [] => f.write_str("nothing"),
            [name] => f.write_str(name),
            [names @ .., last] => write!(f, "{} and {last}", names.join(", ")),
        }
    }
}
