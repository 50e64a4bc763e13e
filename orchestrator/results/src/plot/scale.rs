//! From values to pixels, with ticks at round numbers.

use crate::report::number::short;

/// A range of values mapped to a range of pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    pub low: f64,
    pub high: f64,
    pub first_pixel: f64,
    pub last_pixel: f64,
}

impl Scale {
    /// Covers the finite values among `values` with a margin, mapped to pixels.
    pub(super) fn around(values: impl IntoIterator<Item = f64>, first_pixel: f64, last_pixel: f64) -> Self {
        let (low, high) = extent(values);
        let margin = 0.06 * (high - low);
        Self { low: low - margin, high: high + margin, first_pixel, last_pixel }
    }

    pub(super) fn pixel(&self, value: f64) -> f64 {
        self.first_pixel + (value - self.low) / (self.high - self.low) * (self.last_pixel - self.first_pixel)
    }

    /// Round numbers inside the range, about `count` of them.
    pub(super) fn ticks(&self, count: f64) -> Vec<f64> {
        ticks(self.low, self.high, count)
    }
}

/// Larger values are not drawn: no other value would be visible, and their differences may be infinite.
const LARGEST: f64 = 1e300;

/// Smallest and largest value that can be drawn, at least a little apart; 0..1 without any.
pub(super) fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let drawable = values.into_iter().filter(|value| value.abs() <= LARGEST);
    let (low, high) = drawable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        (0.0, 1.0)
    } else if high - low < 1e-9 * (1.0 + low.abs()) {
        let room = (0.1 * low.abs()).max(0.5);
        (low - room, high + room)
    } else {
        (low, high)
    }
}

/// Multiples of 1, 2 or 5 times a power of ten between two values, about `count` of them.
pub(super) fn ticks(low: f64, high: f64, count: f64) -> Vec<f64> {
    let step = round_step((high - low) / count);
    let first = (low / step).ceil();
    let last = (high / step).floor();
    let mut ticks = Vec::new();
    let mut index = first;
    while index <= last && ticks.len() < 100 {
        ticks.push(index * step);
        index += 1.0;
    }
    ticks
}

fn round_step(raw: f64) -> f64 {
    let mut power = 1.0;
    while power * 10.0 <= raw {
        power *= 10.0;
    }
    while power > raw {
        power /= 10.0;
    }
    let factor = raw / power;
    power
        * if factor <= 1.0 {
            1.0
        } else if factor <= 2.0 {
            2.0
        } else if factor <= 5.0 {
            5.0
        } else {
            10.0
        }
}

/// The label of a tick.
pub(super) fn label(value: f64) -> String {
    let plain = match value.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e9 => format!("{value:.6}").trim_end_matches('0').trim_end_matches('.').to_owned(),
        _ => short(value),
    };
    plain.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-0.3, 10.2, 5.0), [0.0, 5.0, 10.0]);
        assert_eq!(ticks(0.0, 84.0, 8.0), [0.0, 20.0, 40.0, 60.0, 80.0]);
        assert_eq!(label(ticks(0.0, 0.35, 4.0)[1]), "0.1");
    }

    #[test]
    fn small_and_large_ticks_keep_their_digits() {
        let labels = |low, high| ticks(low, high, 4.0).into_iter().map(label).collect::<Vec<_>>();
        assert_eq!(labels(0.0, 3.5e-8), ["0", "1e\u{2212}8", "2e\u{2212}8", "3e\u{2212}8"]);
        assert_eq!(labels(-2e12, 2e12)[0], "\u{2212}2000000000000");
    }

    #[test]
    fn values_beyond_any_picture_have_no_ticks_of_their_own() {
        let (low, high) = extent([f64::MAX, -f64::MAX, 1e300, -1e300]);
        assert_eq!((low, high), (-1e300, 1e300));
        assert!(!Scale::around([f64::MAX, 1.0, -f64::MAX], 0.0, 1.0).ticks(4.0).is_empty());
    }

    #[test]
    fn a_constant_has_room_around_it() {
        assert_eq!(extent([3.0, 3.0, f64::NAN]), (2.5, 3.5));
        assert_eq!(extent([-2e20]), (-2.2e20, -1.8e20));
        assert_eq!(extent([]), (0.0, 1.0));
    }

    #[test]
    fn the_ends_lie_on_the_ends() {
        let scale = Scale { low: -1.0, high: 1.0, first_pixel: 100.0, last_pixel: 0.0 };
        assert_eq!((scale.pixel(-1.0), scale.pixel(0.0), scale.pixel(1.0)), (100.0, 50.0, 0.0));
    }
}
