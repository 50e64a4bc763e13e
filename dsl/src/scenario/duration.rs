//! Times of a run as text.

/// A simulated time for people: `5 ms`, `1.5 s`.
#[must_use]
pub fn duration(ns: u64) -> String {
    let (name, unit) = match ns {
        1_000_000_000.. | 0 => ("s", 1e9),
        1_000_000.. => ("ms", 1e6),
        1_000.. => ("us", 1e3),
        _ => ("ns", 1.0),
    };
    format!("{} {name}", ns as f64 / unit)
}

#[test]
fn a_duration_is_shown_in_the_unit_that_keeps_it_short() {
    assert_eq!(duration(5_000_000), "5 ms");
    assert_eq!(duration(12_340_000_000), "12.34 s");
    assert_eq!(duration(250_000), "250 us");
    assert_eq!(duration(7), "7 ns");
    assert_eq!(duration(0), "0 s");
}
