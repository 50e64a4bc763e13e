//! A judged value, and how values are joined by `and`, `or` and the temporal operators.

use dsl::scenario::{Formula, Gated, Until};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// A margin with its verdict and the tick of the sample that it comes from.
///
/// The verdict is the sign of the margin; at zero, where strictness decides, a failing value is −0. So the total order of
/// floating-point numbers orders margins and verdicts at once.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Judged {
    signed: f64,
    /// The tick of the sample.
    pub tick: u64,
    /// The comparison or condition of the claim that it comes from, counted from left to right as the formula is compiled.
    pub part: u32,
}

/// A value, or `None` where the samples so far do not determine it.
pub type Decision = Option<Judged>;

impl Judged {
    /// Judges a comparison by its margin; not-a-number fails with margin −∞.
    #[must_use]
    pub fn margin(value: f64, strict: bool, tick: u64) -> Self {
        let signed = match value {
            value if value.is_nan() => f64::NEG_INFINITY,
            0.0 if strict => -0.0,
            0.0 => 0.0,
            value => value,
        };
        Self { signed, tick, part: 0 }
    }

    /// Judges a condition: its margin is infinite.
    #[must_use]
    pub fn condition(holds: bool, tick: u64) -> Self {
        Self { signed: if holds { f64::INFINITY } else { f64::NEG_INFINITY }, tick, part: 0 }
    }

    /// The same of a part of a claim.
    #[must_use]
    pub fn of(self, part: u32) -> Self {
        Self { part, ..self }
    }

    /// The same as the value of a gate, which is true or false.
    #[must_use]
    pub fn as_gate(self) -> Self {
        Self::condition(self.holds(), self.tick).of(self.part)
    }

    /// The verdict.
    #[must_use]
    pub fn holds(self) -> bool {
        self.signed.is_sign_positive()
    }

    /// The margin for reports, where −0 is 0.
    #[must_use]
    pub fn reported_margin(self) -> f64 {
        self.signed + 0.0
    }
}

/// Whether all must hold or one suffices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Join {
    /// `and`, `always`: the smallest margin counts.
    All,
    /// `or`, `eventually`: the largest margin counts.
    Any,
}

impl Join {
    /// How `and`, `or` or a temporal operator joins.
    #[must_use]
    pub fn of(formula: &Formula) -> Self {
        match formula {
            Formula::And(_) | Formula::Always(..) => Self::All,
            Formula::Gated(Gated { any, .. }) | Formula::Until(Until { any, .. }) if !any => Self::All,
            _ => Self::Any,
        }
    }

    /// The other one.
    #[must_use]
    pub fn opposite(self) -> Self {
        if self == Self::All { Self::Any } else { Self::All }
    }

    /// The joined value of nothing at this tick.
    #[must_use]
    pub fn of_nothing(self, tick: u64) -> Judged {
        Judged::condition(self == Self::All, tick)
    }

    /// Whether `a` takes precedence over `b` as the joined value.
    #[must_use]
    pub fn prefers(self, a: Judged, b: Judged) -> bool {
        let wanted = if self == Self::All { Ordering::Less } else { Ordering::Greater };
        a.signed.total_cmp(&b.signed) == wanted
    }

    /// Whether this value alone decides the joined value.
    #[must_use]
    pub fn is_decided_by(self, value: Judged) -> bool {
        value.holds() == (self == Self::Any)
    }
}

/// Values joined one after the other.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Joined {
    counts: Decision,
    /// The tick of the first value that fails, and the part of the claim that it comes from.
    pub first_failure: Option<(u64, u32)>,
    /// Whether one of the values is not decided.
    open: bool,
    /// Whether no more values will come.
    pub complete: bool,
}

impl Joined {
    /// No value joined yet.
    #[must_use]
    pub fn new(complete: bool) -> Self {
        Self { counts: None, first_failure: None, open: false, complete }
    }

    /// Joins one more value; among equal values the first is taken. Returns whether anything changed.
    pub fn take(&mut self, join: Join, decision: Decision) -> bool {
        let Some(value) = decision else { return !std::mem::replace(&mut self.open, true) };
        if !value.holds() {
            self.first_failure.get_or_insert((value.tick, value.part));
        }
        let counts = self.counts.is_none_or(|counts| join.prefers(value, counts));
        if counts {
            self.counts = decision;
        }
        counts
    }

    /// The same with no more values to come.
    #[must_use]
    pub fn completed(self) -> Self {
        Self { complete: true, ..self }
    }

    /// Joins a value of an earlier tick than all others: among equal values it is taken.
    pub fn take_earlier(&mut self, join: Join, decision: Decision) {
        let Some(value) = decision else { return self.open = true };
        if self.counts.is_none_or(|counts| !join.prefers(counts, value)) {
            self.counts = decision;
        }
    }

    /// Whether one of the values is not decided.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.open
    }

    /// The joined value of those that are decided.
    #[must_use]
    pub fn counting(&self) -> Decision {
        self.counts
    }

    /// The joined value, if it is decided.
    #[must_use]
    pub fn decision(&self, join: Join) -> Decision {
        self.counts.filter(|&value| self.complete && !self.open || join.is_decided_by(value))
    }
}

#[test]
fn at_zero_a_failing_margin_is_smaller_than_a_holding_one() {
    let [strict, lax] = [Judged::margin(0.0, true, 1), Judged::margin(-0.0, false, 2)];
    assert!(!strict.holds() && lax.holds());
    assert_eq!((strict.reported_margin().to_bits(), lax.reported_margin().to_bits()), (0, 0));
    assert!(Join::All.prefers(strict, lax) && Join::Any.prefers(lax, strict));
}

#[test]
fn not_a_number_fails() {
    let nan = Judged::margin(f64::NAN, false, 0);
    assert!(!nan.holds());
    assert_eq!(nan.reported_margin(), f64::NEG_INFINITY);
}
