//! Values over time, row by row.

use super::RealExpression;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A table of values over time; before its first row and after its last one the value is held.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Seconds and values, at least one row; times never fall. Rows of one time are a jump.
    pub rows: Vec<(f64, f64)>,
    /// Whether a value is held until the next row; else values between rows are interpolated linearly.
    pub held: bool,
}

/// `|x - c(s)|` at the instant s at which it is least, of all that are at most `within_s` away.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Near {
    /// `x`
    pub of: Box<RealExpression>,
    /// `c`
    pub curve: Arc<Curve>,
    /// In seconds, zero or more.
    pub within_s: f64,
}

impl Curve {
    /// The value at a time. At the time of a row it is the row's, the last one's if there are several.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        let slack_s = slack_s(time_s);
        let after = self.rows.partition_point(|&(row_s, _)| row_s <= time_s + slack_s);
        let (from_s, from) = self.rows[after.saturating_sub(1)];
        match self.rows.get(after) {
            Some(&(to_s, to)) if !self.held && from_s + slack_s < time_s => {
                let weight = (to_s - time_s) / (to_s - from_s);
                weight * from + (1.0 - weight) * to
            }
            _ => from,
        }
    }

    /// The least distance of a number from the values of the curve at the times from one to another; where it jumps, these
    /// are the values before and behind the jump. Not a number if one of them is not. It looks at all rows of that time.
    #[must_use]
    pub fn least_distance(&self, number: f64, [first_s, last_s]: [f64; 2]) -> f64 {
        let mut last = self.at(first_s);
        let mut least = (number - last).abs();
        let mut add = |value: f64, is_straight: bool| {
            let is_crossed = is_straight && (number - last) * (number - value) < 0.0;
            let distance = if is_crossed { 0.0 } else { (number - value).abs() };
            if distance.is_nan() || distance < least {
                least = distance;
            }
            last = value;
        };
        let after = self.rows.partition_point(|&(row_s, _)| row_s <= first_s + slack_s(first_s));
        let mut before_s = f64::NEG_INFINITY;
        let inside = self.rows[after..].iter().take_while(|(row_s, _)| *row_s <= last_s + slack_s(last_s));
        for (at, &(row_s, value)) in inside.enumerate() {
            // The first row is held before its time, and rows of one time are a jump.
            add(value, !self.held && row_s > before_s && after + at > 0);
            before_s = row_s;
        }
        add(self.at(last_s), !self.held);
        least
    }
}

/// How far apart two floats may be that mean the same instant: other tools multiply or add up steps, so that their
/// tables say 0.30000000000000004.
fn slack_s(time_s: f64) -> f64 {
    (4.0 * f64::EPSILON * time_s.abs()).max(1e-12)
}

#[test]
fn a_curve_gives_its_rows_exactly_and_holds_its_ends() {
    let curve = |held| Curve { rows: vec![(0.1, 1.0), (0.3, 0.7), (0.3, 5.0), (0.4, 6.0)], held };
    for (time_s, value) in [(-1.0, 1.0), (0.1, 1.0), (0.3, 5.0), (0.4, 6.0), (9.0, 6.0)] {
        assert_eq!((curve(false).at(time_s), curve(true).at(time_s)), (value, value), "at {time_s} s");
    }
}

#[test]
fn between_rows_a_curve_is_straight_or_held() {
    let curve = |held| Curve { rows: vec![(0.0, 1.0), (2.0, 5.0)], held };
    assert_eq!((curve(false).at(0.5), curve(true).at(0.5)), (2.0, 1.0));
}

#[test]
fn a_row_counts_at_the_instant_that_it_was_meant_for() {
    let mut added_s = 0.0;
    let rows = (0..1000).map(|row| {
        let of_row = (added_s, f64::from(row));
        added_s += 0.01;
        of_row
    });
    let rows: Vec<_> = rows.collect();
    for held in [false, true] {
        let curve = Curve { rows: rows.clone(), held };
        for row in 0..1000_u32 {
            assert_eq!(curve.at(f64::from(row * 10) / 1e3), f64::from(row));
        }
    }
}

#[test]
fn the_least_distance_within_a_span_of_time_is_that_of_brute_force() {
    // Rises, jumps at 2 s from 4 to -1, falls; and is held before 1 s and after 4 s.
    let curve = Curve { rows: vec![(1.0, 0.0), (2.0, 4.0), (2.0, -1.0), (4.0, -3.0)], held: false };
    for number in [-4.0, -2.5, -0.5, 0.0, 1.0, 3.9, 5.0] {
        for first in 0..50_u32 {
            for steps in [0, 1, 7, 20] {
                let [first_s, last_s] = [f64::from(first) / 10.0, f64::from(first + steps) / 10.0];
                let between = (0..=1000).map(|part| first_s + (last_s - first_s) * f64::from(part) / 1e3);
                let distances = between.map(|time_s| (number - curve.at(time_s)).abs());
                let brute = distances.fold(f64::INFINITY, f64::min);
                let least = curve.least_distance(number, [first_s, last_s]);
                // Steps of the brute force are at most 2 ms, in which the curve moves by 0.008.
                assert!(
                    (brute - 0.009..=brute + 1e-12).contains(&least),
                    "{number} {first_s} {last_s}: {least} {brute}"
                );
            }
        }
    }
    assert_eq!(curve.least_distance(1.0, [1.9, 2.1]), 2.0 - 0.05 + 0.05, "not between the ends of the jump");
    assert_eq!(curve.least_distance(4.5, [1.5, 2.0]), 0.5, "up to the value before the jump");
    assert_eq!(curve.least_distance(4.5, [2.0, 3.0]), 5.5, "which is not in a span that begins behind it");
    assert!(curve.least_distance(f64::NAN, [0.0, 9.0]).is_nan());
    let gap = Curve { rows: vec![(0.0, 0.0), (1.0, f64::NAN), (2.0, 0.0)], held: false };
    assert!(gap.least_distance(0.0, [0.0, 2.0]).is_nan());
}
