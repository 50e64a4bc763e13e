//! Time of a unit: rounded to whole nanoseconds, divided into equal parts, counted in samples.

use std::ops::Range;

/// Numbers of samples that are due.
pub type Samples = Range<u64>;

/// Distance to a whole nanosecond, in nanoseconds, up to which a time is rounded to it.
const SNAP_NS: f64 = 1e-3;
/// Fraction of a period or of an inner step that is treated as a rounding error.
const ROUNDING: f64 = 1e-9;
/// Up to here every whole number of nanoseconds is a distinct `f64`.
const LARGEST_NS: f64 = 9.0e15;

/// A time or a duration: a whole number of nanoseconds if it is close to one, else the given seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Time {
    Nanoseconds(i64),
    Seconds(f64),
}

impl Time {
    /// The nearest nanosecond where that is within 1e-3 ns, so that `(n+1)·h - n·h` of any importer gives equal bits.
    pub(crate) fn from_s(seconds: f64) -> Self {
        let exact = seconds * 1e9;
        // A cast is many times faster than `round`, which is a function call on baseline x86-64; out of range it
        // saturates.
        #[expect(clippy::cast_possible_truncation, reason = "what does not fit fails the comparison")]
        let nearest = (exact + 0.5_f64.copysign(exact)) as i64;
        #[expect(clippy::cast_precision_loss, reason = "below LARGEST_NS the number is exact")]
        if exact.abs() <= LARGEST_NS && (exact - nearest as f64).abs() <= SNAP_NS {
            return Self::Nanoseconds(nearest);
        }
        Self::Seconds(seconds)
    }

    /// In seconds; a whole number of nanoseconds gives the `f64` nearest to its decimal.
    #[expect(clippy::cast_precision_loss, reason = "below LARGEST_NS the number is exact")]
    pub(crate) fn as_s(self) -> f64 {
        match self {
            Self::Nanoseconds(ns) => ns as f64 / 1e9,
            Self::Seconds(seconds) => seconds,
        }
    }

    /// The sum; exact where both are whole nanoseconds.
    pub(crate) fn plus(self, length: Self) -> Self {
        match (self, length) {
            (Self::Nanoseconds(start), Self::Nanoseconds(length)) => Self::Nanoseconds(start.saturating_add(length)),
            _ => Self::from_s(self.as_s() + length.as_s()),
        }
    }
}

/// One communication step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    start_s: f64,
    length_s: f64,
    end_s: f64,
}

/// Equal parts of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Number of parts, at least one.
    pub count: u32,
    /// Length of each, in seconds.
    pub length_s: f64,
}

impl Step {
    pub(crate) fn new(start: Time, length: Time) -> Self {
        Self { start_s: start.as_s(), length_s: length.as_s(), end_s: start.plus(length).as_s() }
    }

    /// Start of the step, in seconds.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// End of the step, in seconds.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.end_s
    }

    /// Length of the step, in seconds.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.length_s
    }

    /// Divides the step into the fewest equal parts that are not longer than `longest_s`.
    ///
    /// # Panics
    ///
    /// If `longest_s` is not positive, or so small that the parts cannot be counted.
    #[must_use]
    pub fn parts(&self, longest_s: f64) -> Parts {
        assert!(longest_s > 0.0, "the longest part of a step must be positive, not {longest_s} s");
        let count = (self.length_s / longest_s - ROUNDING).ceil().max(1.0);
        assert!(count <= f64::from(u32::MAX), "a step of {} s has too many parts of {longest_s} s", self.length_s);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and u32::MAX")]
        let whole = count as u32;
        Parts { count: whole, length_s: self.length_s / count }
    }

    /// One of the equal parts of the step, counted from 0; neighbouring parts meet at equal bits.
    #[must_use]
    pub fn part(&self, parts: Parts, number: u32) -> Self {
        let border_s = |number: u32| {
            if number == parts.count { self.end_s } else { self.start_s + f64::from(number) * parts.length_s }
        };
        Self { start_s: border_s(number), length_s: parts.length_s, end_s: border_s(number + 1) }
    }

    /// The numbers of the samples that are due in this step: after its start, up to and including its end.
    ///
    /// Sample n holds on [n·period, (n+1)·period).
    ///
    /// # Panics
    ///
    /// If the period is not positive.
    #[must_use]
    pub fn samples(&self, period_s: f64) -> Samples {
        Samples { start: due(self.start_s, period_s), end: due(self.end_s, period_s) }
    }
}

/// The number of samples that are due up to this time: numbers 0 to floor(time / period), none before time 0.
#[must_use]
pub(crate) fn due(time_s: f64, period_s: f64) -> u64 {
    assert!(period_s > 0.0, "the period of samples must be positive, not {period_s} s");
    let last = (time_s / period_s + ROUNDING).floor();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float to integer cast saturates")]
    let count = (last + 1.0) as u64;
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(start_s: f64, length_s: f64) -> Step {
        Step::new(Time::from_s(start_s), Time::from_s(length_s))
    }

    #[test]
    fn differences_of_multiples_give_the_bits_of_the_step() {
        let h = 0.005;
        for n in 0..200_000 {
            let n = f64::from(n);
            let one = step(n * h, (n + 1.0) * h - n * h);
            assert_eq!(one.length_s().to_bits(), h.to_bits(), "step {n}");
            assert_eq!(one.end_s().to_bits(), ((n + 1.0) * 5.0 / 1000.0).to_bits(), "step {n}");
        }
    }

    #[test]
    fn a_sixtieth_of_a_second_is_not_rounded_to_nanoseconds() {
        assert_eq!(step(0.0, 1.0 / 60.0).length_s().to_bits(), (1.0_f64 / 60.0).to_bits());
    }

    #[test]
    fn a_step_has_the_fewest_parts_that_the_longest_length_allows() {
        assert_eq!(step(0.0, 0.01).parts(0.0025), Parts { count: 4, length_s: 0.0025 });
        assert_eq!(step(0.0, 0.011).parts(0.0025).count, 5);
        assert_eq!(step(0.0, 0.001).parts(0.0025), Parts { count: 1, length_s: 0.001 });
        assert_eq!(step(0.0, 0.3).parts(0.1).count, 3, "0.3 / 0.1 is a little below 3");
    }

    #[test]
    fn every_sample_is_due_in_exactly_one_step() {
        for (h, period) in [(0.005, 0.01), (0.01, 0.01), (0.03, 0.01), (0.007, 0.01), (1.0 / 60.0, 0.01)] {
            let mut next = 1;
            for n in 0..10_000 {
                let samples = step(f64::from(n) * h, h).samples(period);
                assert_eq!(samples.start, next, "step {n} of {h} s, period {period} s");
                next = samples.end;
            }
        }
    }

    #[test]
    fn every_sample_is_due_in_exactly_one_part_of_a_step() {
        for (h, longest) in [(0.02, 0.0025), (0.007, 0.0025), (0.1, 0.03), (1.0 / 60.0, 0.004)] {
            for n in 0..10_000 {
                let whole = step(f64::from(n) * h, h);
                let parts = whole.parts(longest);
                let mut next = whole.samples(0.01).start;
                for number in 0..parts.count {
                    let samples = whole.part(parts, number).samples(0.01);
                    assert_eq!(samples.start, next, "part {number} of step {n} of {h} s");
                    next = samples.end;
                }
                assert_eq!(next, whole.samples(0.01).end);
            }
        }
    }

    #[test]
    fn a_sample_is_due_at_its_instant_in_spite_of_rounding() {
        assert_eq!(due(0.0, 0.1), 1, "sample 0");
        assert_eq!(due(0.1 + 0.2, 0.1), 4);
        assert_eq!(due(0.7, 0.1), 8, "0.7 / 0.1 is a little below 7");
        assert_eq!(due(-1.0, 0.1), 0);
    }
}
