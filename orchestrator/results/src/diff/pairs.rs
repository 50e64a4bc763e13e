//! Rows of two traces that have the same time.

use crate::shortest_decimal;
use std::fmt;

/// The rows of two traces, paired by time. Rows of one time are paired in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pairs {
    /// Time and rows of each pair.
    pub both: Vec<(f64, [usize; 2])>,
    /// The rows of each that the other lacks.
    pub only: [Option<OnlyRows>; 2],
}

/// Rows of a trace at whose times another one has none.
#[derive(Clone, Debug, PartialEq)]
pub struct OnlyRows {
    /// How many.
    pub count: usize,
    /// The first and the last time in seconds.
    pub ends_s: [f64; 2],
    /// Whether they follow each other without a row that both have.
    pub is_contiguous: bool,
    /// Whether all of them are before the first row of the other trace.
    pub before_the_other: bool,
}

impl Pairs {
    /// Pairs rows with these times, which never fall.
    pub fn of(first_s: &[f64], second_s: &[f64]) -> Self {
        let mut both = Vec::new();
        let mut only: [Vec<usize>; 2] = Default::default();
        let (mut a, mut b) = (0, 0);
        loop {
            match (first_s.get(a), second_s.get(b)) {
                (None, None) => break,
                (Some(&time_s), Some(&other_s)) if is_same(time_s, other_s) => {
                    both.push((time_s, [a, b]));
                    (a, b) = (a + 1, b + 1);
                }
                (Some(time_s), other_s) if other_s.is_none_or(|other_s| time_s < other_s) => {
                    only[0].push(a);
                    a += 1;
                }
                _ => {
                    only[1].push(b);
                    b += 1;
                }
            }
        }
        let [mine, others] = only;
        Self { both, only: [OnlyRows::of(&mine, first_s, second_s), OnlyRows::of(&others, second_s, first_s)] }
    }

    /// How many rows both have, with the times of the first and the last.
    pub fn common(&self) -> Option<(usize, [f64; 2])> {
        Some((self.both.len(), [self.both.first()?.0, self.both.last()?.0]))
    }
}

/// Whether two times mean one instant: ticks are whole nanoseconds, and other tools add up steps.
fn is_same(a_s: f64, b_s: f64) -> bool {
    (a_s - b_s).abs() < 0.5e-9 + 4.0 * f64::EPSILON * a_s.abs()
}

impl OnlyRows {
    fn of(rows: &[usize], time_s: &[f64], other_s: &[f64]) -> Option<Self> {
        let (&first, &last) = rows.first().zip(rows.last())?;
        Some(Self {
            count: rows.len(),
            ends_s: [time_s[first], time_s[last]],
            is_contiguous: last - first + 1 == rows.len(),
            before_the_other: other_s.first().is_some_and(|&begin_s| time_s[last] < begin_s),
        })
    }
}

/// `8000 rows from 0 s to 39.995 s`, `between` if the other trace has rows among them.
impl fmt::Display for OnlyRows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [from, to] = self.ends_s.map(shortest_decimal);
        match (self.count, self.is_contiguous) {
            (1, _) => write!(f, "1 row at {from} s"),
            (count, true) => write!(f, "{} from {from} s to {to} s", rows(count)),
            (count, false) => write!(f, "{} between {from} s and {to} s", rows(count)),
        }
    }
}

/// `1 row`, `2 rows`
pub(super) fn rows(count: usize) -> String {
    if count == 1 { "1 row".to_owned() } else { format!("{count} rows") }
}

#[test]
fn rows_are_paired_by_time_and_those_of_one_time_in_order() {
    let pairs = Pairs::of(&[0.0, 0.1, 0.1, 0.3, 0.4], &[0.0, 0.1, 0.2, 0.1 + 0.2, 0.5]);
    let both: Vec<_> = pairs.both.iter().map(|(_, rows)| *rows).collect();
    assert_eq!(both, [[0, 0], [1, 1], [3, 3]]);
    let only = pairs.only.map(|only| only.map(|only| only.to_string()).unwrap_or_default());
    assert_eq!(only, ["2 rows between 0.1 s and 0.4 s", "2 rows between 0.2 s and 0.5 s"]);
}
