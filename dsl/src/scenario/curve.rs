//! Values over time, row by row.

use serde::{Deserialize, Serialize};

/// A table of values over time; before its first row and after its last one the value is held.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Seconds and values, at least one row; times never fall. Rows of one time are a jump.
    pub rows: Vec<(f64, f64)>,
    /// Whether a value is held until the next row; else values between rows are interpolated linearly.
    pub held: bool,
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
