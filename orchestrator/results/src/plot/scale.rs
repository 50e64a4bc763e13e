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
    pub(super) fn pixel(&self, value: f64) -> f64 {
        self.first_pixel + (value - self.low) / (self.high - self.low) * (self.last_pixel - self.first_pixel)
    }
}

/// An axis between two ticks, so that its ends can be read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub low: f64,
    pub high: f64,
    /// At least three.
    pub ticks: Vec<f64>,
    /// Their distance.
    pub step: f64,
}

impl Axis {
    /// Around two values, with about `count` ticks.
    pub(super) fn around((low, high): (f64, f64), count: f64) -> Self {
        let mut step = round_step((high - low) / count.max(1.0));
        loop {
            let (first, last) = ((low / step + 1e-9).floor(), (high / step - 1e-9).ceil());
            if last - first >= 2.0 || step < f64::MIN_POSITIVE * 1e3 {
                let ticks = (0..100).map(|index| first + f64::from(index)).take_while(|index| *index <= last);
                return Self { low: first * step, high: last * step, ticks: ticks.map(|at| at * step).collect(), step };
            }
            step = round_step(step * 0.4);
        }
    }

    /// Around integers: a tick at whole numbers only.
    pub(super) fn of_integers((low, high): (f64, f64), count: f64) -> Self {
        let (low, high) = (low.floor(), high.ceil());
        let middle = (low + high) / 2.0;
        let (low, high) = if high - low < 2.0 { (middle.floor() - 1.0, middle.floor() + 1.0) } else { (low, high) };
        let step = round_step((high - low) / count.max(2.0)).max(1.0);
        let (first, last) = ((low / step).floor(), (high / step).ceil());
        let ticks = (0..100).map(|index| first + f64::from(index)).take_while(|index| *index <= last);
        Self { low: first * step, high: last * step, ticks: ticks.map(|at| at * step).collect(), step }
    }

    /// The text at a tick.
    pub(super) fn label(&self, tick: f64) -> String {
        label_in_steps(tick, self.step)
    }
}

/// Larger values are not drawn: no other value would be visible, and their differences may be infinite.
const LARGEST: f64 = 1e300;
/// A range is at least this part of its values: what differs less is the same value.
const LEAST_PART: f64 = 1e-3;
/// And at least this much.
const LEAST: f64 = 1e-9;

/// Smallest and largest value that can be drawn, a little apart at least; `None` without any.
pub(super) fn ends(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let drawable = values.into_iter().filter(|value| value.abs() <= LARGEST);
    let (low, high) = drawable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    (low <= high).then_some((low, high))
}

/// The ends with room around what hardly differs; 0..1 without any value.
pub(super) fn extent(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let Some((low, high)) = ends(values) else { return (0.0, 1.0) };
    let largest = low.abs().max(high.abs());
    if high - low >= (LEAST_PART * largest).max(LEAST) {
        return (low, high);
    }
    let middle = low + (high - low) / 2.0;
    let room = if largest < LEAST { 0.5 } else { 0.05 * largest };
    (middle - room, middle + room)
}

/// Multiples of 1, 2 or 5 times a power of ten between two values, about `count` of them, and their distance.
pub(super) fn ticks(low: f64, high: f64, count: f64) -> (Vec<f64>, f64) {
    let step = round_step((high - low) / count.max(1.0));
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let indices = (0..100).map(|index| first + f64::from(index)).take_while(|index| *index <= last);
    (indices.map(|index| index * step).collect(), step)
}

fn round_step(raw: f64) -> f64 {
    let mut power = 1.0;
    while power * 10.0 <= raw {
        power *= 10.0;
    }
    while power > raw && power > f64::MIN_POSITIVE * 1e3 {
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

/// The label of a tick, with as many digits as tell it from its neighbours.
pub(super) fn label_in_steps(value: f64, step: f64) -> String {
    let value = if value.abs() < 1e-6 * step { 0.0 } else { value };
    if value == 0.0 || !(1e-5..1e9).contains(&step) || value.abs() >= 1e9 {
        return label(value);
    }
    let powers = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5];
    let is_whole = |scaled: f64| (scaled - scaled.round()).abs() < 1e-6 * scaled;
    let places = powers.iter().position(|power| is_whole(step * power)).unwrap_or(powers.len());
    signed(format!("{value:.places$}"))
}

/// The label of a value.
pub(super) fn label(value: f64) -> String {
    signed(match value.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e9 => format!("{value:.6}").trim_end_matches('0').trim_end_matches('.').to_owned(),
        1e9.. => {
            let text = format!("{value:.2e}");
            let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
            format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
        }
        _ => short(value),
    })
}

/// A value in a sentence: four digits that count.
pub(super) fn rounded(value: f64) -> String {
    let places = match value.abs() {
        1000.0.. => 0,
        100.0.. => 1,
        10.0.. => 2,
        1.0.. => 3,
        0.1.. => 4,
        _ => return label(value),
    };
    let text = format!("{value:.places$}");
    signed(if places > 0 { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text })
}

fn signed(text: String) -> String {
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-0.3, 10.2, 5.0).0, [0.0, 5.0, 10.0]);
        assert_eq!(ticks(0.0, 84.0, 8.0).0, [0.0, 20.0, 40.0, 60.0, 80.0]);
    }

    #[test]
    fn an_axis_has_three_ticks_at_least_and_ends_at_ticks() {
        for (low, high) in [(0.0, 1.0), (-0.3, 10.2), (9.9, 10.1), (-1e-6, 1e-6), (0.8, 5.1), (-2e12, 2e12)] {
            let axis = Axis::around((low, high), 4.0);
            assert!(axis.ticks.len() >= 3 && axis.ticks.len() < 12, "{axis:?}");
            assert!(axis.low <= low + 1e-9 * low.abs() && axis.high >= high - 1e-9 * high.abs(), "{axis:?}");
            assert_eq!((axis.ticks[0], axis.ticks.last().copied().unwrap()), (axis.low, axis.high));
            let labels: Vec<_> = axis.ticks.iter().map(|tick| axis.label(*tick)).collect();
            assert!(labels.windows(2).all(|pair| pair[0] != pair[1]), "{labels:?}");
        }
        let integers = Axis::of_integers((3.0, 3.0), 4.0);
        assert_eq!(integers.ticks, [2.0, 3.0, 4.0]);
    }

    #[test]
    fn labels_have_the_digits_of_their_step() {
        assert_eq!(label_in_steps(0.30000000000000004, 0.1), "0.3");
        assert_eq!(label_in_steps(1.0, 0.25), "1.00");
        assert_eq!(label_in_steps(3e-8, 1e-8), "3e\u{2212}8");
        assert_eq!(label_in_steps(-2e12, 1e12), "\u{2212}2e12");
        assert_eq!(rounded(15.968_267), "15.97");
    }

    #[test]
    fn values_beyond_any_picture_have_no_ticks_of_their_own() {
        let (low, high) = extent([f64::MAX, -f64::MAX, 1e300, -1e300]);
        assert_eq!((low, high), (-1e300, 1e300));
        assert!(Axis::around(extent([f64::MAX, 1.0, -f64::MAX]), 4.0).ticks.len() >= 3);
    }

    #[test]
    fn what_hardly_differs_has_room_around_it() {
        assert_eq!(extent([3.0, 3.0, f64::NAN]), (2.85, 3.15));
        assert_eq!(extent([1e-14, -1e-15]).1 - extent([1e-14, -1e-15]).0, 1.0);
        assert_eq!(extent([10.0, 10.000_001]).1.round(), 11.0);
        assert_eq!(extent([]), (0.0, 1.0));
    }

    #[test]
    fn the_ends_lie_on_the_ends() {
        let scale = Scale { low: -1.0, high: 1.0, first_pixel: 100.0, last_pixel: 0.0 };
        assert_eq!((scale.pixel(-1.0), scale.pixel(0.0), scale.pixel(1.0)), (100.0, 50.0, 0.0));
    }
}
