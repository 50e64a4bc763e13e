//! Numbers for people: three significant digits that keep their sign.

use crate::shortest_decimal;

/// Three significant digits, without trailing zeros; only zero itself is shown as `0`.
#[must_use]
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return shortest_decimal(value);
    }
    match exponent(value) {
        -4..=5 => with_decimals(value, decimals(value)),
        _ => shortest_decimal(format!("{value:.2e}").parse().unwrap_or(value)),
    }
}

/// A number shown beside another one that differs by `nearness`: with enough decimals for both the number and the
/// difference.
#[must_use]
pub fn beside(value: f64, nearness: f64) -> String {
    if value == 0.0 || !value.is_finite() || !(-9..=5).contains(&exponent(value)) {
        return short(value);
    }
    let near = if nearness.is_finite() && nearness != 0.0 { decimals(nearness) } else { 0 };
    with_decimals(value, decimals(value).max(near).min(12))
}

/// A wall-clock duration.
#[must_use]
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{} s", short(s)),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{} h", short(s / 3600.0)),
    }
}

/// The decimal exponent after rounding to three digits: 0 for 1 to 9.99.
fn exponent(value: f64) -> i32 {
    let text = format!("{value:.2e}");
    text.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

fn decimals(value: f64) -> usize {
    usize::try_from(2 - exponent(value)).unwrap_or(0)
}

fn with_decimals(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_margin_has_three_digits_and_never_the_wrong_sign() {
        let shown = [1.3149, 0.12, -2.4, -0.000_49, 0.9996, 42.349, 123.4, 12345.6, 0.0, -0.0].map(short);
        assert_eq!(shown, ["1.31", "0.12", "-2.4", "-0.00049", "1", "42.3", "123", "12346", "0", "0"]);
        assert_eq!([1.2345e-9, -4.0e-300, 6.5432e7].map(short), ["1.23e-9", "-4e-300", "65400000"]);
    }

    #[test]
    fn what_was_seen_differs_visibly_from_the_limit_it_missed() {
        assert_eq!(beside(35.0 + 0.0004, -0.0004), "35.0004");
        assert_eq!(beside(37.4, -2.4), "37.4");
        assert_eq!(beside(0.001, 1e4), "0.001");
        assert_eq!(beside(0.0, 0.3), "0");
    }

    #[test]
    fn durations_are_given_in_seconds_minutes_or_hours() {
        assert_eq!([0.0123, 6.2, 300.0, 9000.0].map(duration), ["0.0123 s", "6.2 s", "5 min", "2.5 h"]);
    }

    proptest::proptest! {
        #[test]
        fn the_sign_is_kept_and_the_value_is_close(bits: u64) {
            let value = f64::from_bits(bits);
            if value.is_finite() && value != 0.0 {
                let read: f64 = short(value).parse().unwrap();
                assert!(read.signum() == value.signum() && read != 0.0, "{value:e} as {}", short(value));
                assert!(!read.is_finite() || ((read - value) / value).abs() < 0.006, "{value:e} as {}", short(value));
            }
        }
    }
}
