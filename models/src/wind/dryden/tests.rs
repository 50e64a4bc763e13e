//! Dryden turbulence against the vectors, its variances and its spectra.

use super::*;
use crate::vectors::{assert_all_close, assert_close, get, numbers};
use core::f64::consts::{PI, TAU};

const SPEED_M_S: f64 = 6.0;

fn scales() -> Scales {
    Scales::at(20.0, 6.0)
}

fn seeded(seed: u64) -> Turbulence {
    Turbulence::start(&scales(), Generator::new(seed, 0))
}

#[test]
fn scales_at_20_m_and_at_20_ft_equal_those_of_the_specification() {
    let ratio = |s: &Scales| s.horizontal_intensity_m_s / s.vertical_intensity_m_s;
    let s = scales();
    let actual = [s.horizontal_length_m, s.horizontal_length_m, s.vertical_length_m, ratio(&s)];
    assert_all_close(&actual, &numbers(&get("dryden")["scales"]), 1e-9);
    let low = Scales::at(6.096, 6.0);
    assert!((low.horizontal_length_m - 43.7659).abs() < 5e-5 && (ratio(&low) - 1.929_139).abs() < 5e-7);
}

#[test]
fn seed_1_gives_the_samples_of_the_vectors() {
    let expected = get("dryden");
    let mut turbulence = seeded(1);
    assert_all_close(&[turbulence.longitudinal_m_s], &numbers(&serde_json::json!([expected["init"]["u"]])), 1e-9);
    assert_all_close(&turbulence.lateral, &numbers(&expected["init"]["v"]), 1e-9);
    assert_all_close(&turbulence.vertical, &numbers(&expected["init"]["w"]), 1e-9);
    for n in 1..=1000 {
        turbulence.advance(&scales(), SPEED_M_S * 0.01);
        if n <= 3 {
            assert_all_close(&turbulence.sample_m_s(), &numbers(&expected["first"][n - 1]), 1e-9);
        }
    }
    assert_all_close(&turbulence.sample_m_s(), &numbers(&expected["sample_1000"]), 1e-9);
}

#[test]
fn the_series_for_small_steps_agrees_with_the_closed_form() {
    let (below, above) = (Lateral::passing(SERIES_BELOW * (1.0 - 1e-9)), Lateral::passing(SERIES_BELOW));
    assert_close(below.l21, above.l21, 1e-3);
    assert_close(below.l22, above.l22, 1e-3);
}

/// Standard deviations of u, v, w over `count` samples of `sample_time_s`.
fn deviations(sample_time_s: f64, count: usize) -> [f64; 3] {
    let mut turbulence = seeded(11);
    let mut squares = [0.0; 3];
    for _ in 0..count {
        turbulence.advance(&scales(), SPEED_M_S * sample_time_s);
        for (sum, x) in squares.iter_mut().zip(turbulence.sample_m_s()) {
            *sum += x * x;
        }
    }
    squares.map(|sum| (sum / count as f64).sqrt())
}

#[test]
fn standard_deviations_equal_the_intensities_for_any_sample_time() {
    // Two runs of 1e6 s and 4e6 s: with a correlation time of 19 s, shorter runs scatter by more than the 2 % allowed.
    for (sample_time_s, count) in [(1.0, 1_000_000), (20.0, 200_000)] {
        for (actual, expected) in deviations(sample_time_s, count).into_iter().zip([1.0782, 1.0782, 0.6]) {
            assert!((actual / expected - 1.0).abs() < 0.02, "{actual} for {expected} at Δ = {sample_time_s} s");
        }
    }
}

/// One-sided spectra in m²/s² per Hz expected from the filters, at a frequency in Hz.
fn theory(frequency_hz: f64) -> [f64; 3] {
    let s = scales();
    let squared = |length_m: f64| {
        let x = TAU * frequency_hz * length_m / SPEED_M_S;
        x * x
    };
    let first_order =
        |sigma: f64, length_m: f64| 4.0 * sigma * sigma * length_m / SPEED_M_S / (1.0 + squared(length_m));
    let second_order = |sigma: f64, length_m: f64| {
        let x2 = squared(length_m);
        2.0 * sigma * sigma * length_m / SPEED_M_S * (1.0 + 3.0 * x2) / ((1.0 + x2) * (1.0 + x2))
    };
    [
        first_order(s.horizontal_intensity_m_s, s.horizontal_length_m),
        second_order(s.horizontal_intensity_m_s, s.horizontal_length_m),
        second_order(s.vertical_intensity_m_s, s.vertical_length_m),
    ]
}

/// One-sided power of a Hann-windowed segment at a frequency, by Goertzel's recurrence.
fn periodogram(segment: &[f64], sample_time_s: f64, frequency_hz: f64) -> f64 {
    let length = segment.len() as f64;
    let coefficient = 2.0 * libm::cos(TAU * frequency_hz * sample_time_s);
    let (mut last, mut before, mut window_power) = (0.0, 0.0, 0.0);
    for (n, x) in segment.iter().enumerate() {
        let window = libm::sin(PI * n as f64 / length);
        let window = window * window;
        window_power += window * window;
        (before, last) = (last, window * x + coefficient * last - before);
    }
    2.0 * sample_time_s * (last * last + before * before - coefficient * last * before) / window_power
}

#[test]
fn spectra_are_those_of_the_filters_from_5_mhz_to_2_hz() {
    // Δ = 50 ms keeps aliasing from above 10 Hz below 2 % at 2 Hz.
    let (sample_time_s, length, segments) = (0.05, 16_384, 60);
    let frequencies: Vec<f64> = (0..16).map(|i| 0.005 * libm::pow(400.0, f64::from(i) / 15.0)).collect();
    let mut turbulence = seeded(5);
    let mut ratios = [0.0; 3];
    for _ in 0..segments {
        let mut traces = [Vec::new(), Vec::new(), Vec::new()];
        for _ in 0..length {
            turbulence.advance(&scales(), SPEED_M_S * sample_time_s);
            for (trace, x) in traces.iter_mut().zip(turbulence.sample_m_s()) {
                trace.push(x);
            }
        }
        for &frequency_hz in &frequencies {
            for i in 0..3 {
                ratios[i] += periodogram(&traces[i], sample_time_s, frequency_hz) / theory(frequency_hz)[i];
            }
        }
    }
    for (name, ratio) in ["u", "v", "w"].iter().zip(ratios) {
        let mean = ratio / f64::from(segments * 16);
        assert!((mean - 1.0).abs() < 0.05, "power of {name} is {mean} of what it shall be");
    }
}
