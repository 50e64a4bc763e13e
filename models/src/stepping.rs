//! How many inner steps or samples of its own a model takes in a communication step.
//!
//! The margin of 1e-9 makes the count the same whether 10 ms came as 0.01 or as 0.009999999999999998.

const MARGIN: f64 = 1e-9;

/// Divides a communication step into the least number of equal inner steps not longer than `longest_s`.
///
/// Returns their number and the length of each in seconds.
#[must_use]
pub fn inner_steps(duration_s: f64, longest_s: f64) -> (u32, f64) {
    let count = (duration_s / longest_s - MARGIN).ceil().max(1.0);
    (count as u32, duration_s / count)
}

/// Returns how many sample instants `n · period_s` with n ≥ 1 have passed at `time_s`; an instant counts as passed
/// when it is reached.
#[must_use]
pub fn samples_due(time_s: f64, period_s: f64) -> u64 {
    (time_s / period_s + MARGIN).floor() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_communication_step_takes_the_fewest_inner_steps_that_are_short_enough() {
        assert_eq!(inner_steps(0.0025, 0.0025), (1, 0.0025));
        assert_eq!(inner_steps(0.005, 0.0025), (2, 0.0025));
        assert_eq!(inner_steps(0.006, 0.0025), (3, 0.002));
        assert_eq!(inner_steps(0.001, 0.0025), (1, 0.001));
        assert_eq!(inner_steps(0.007_500_000_000_000_001, 0.0025).0, 3);
    }

    #[test]
    fn samples_are_counted_alike_however_a_time_was_rounded() {
        assert_eq!(samples_due(0.03, 0.01), 3);
        assert_eq!(samples_due(0.1 + 0.2, 0.1), 3);
        assert_eq!(samples_due(0.299_999_999_999_999_9, 0.1), 3);
        assert_eq!(samples_due(0.2999, 0.1), 2);
        assert_eq!(samples_due(0.0, 0.1), 0);
    }
}
