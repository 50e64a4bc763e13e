//! Random fluctuation of thrust near the ground: one Ornstein–Uhlenbeck process for each rotor.
//!
//! ```text
//! P_i → P_i (1 + σ_ge n_i (1 - z))  for z < 1 m        n ← a n + √(1 - a²) N(0, 1),  a = exp(-Δ / τ)
//! ```
//!
//! | Symbol | Here                     | Unit | Meaning                                                     |
//! |--------|--------------------------|------|-------------------------------------------------------------|
//! | σ_ge   | `intensity`, parameter   | 1    | standard deviation at z = 0, as a fraction of the thrust    |
//! | n_i    | `samples`                | 1    | process of rotor i, standard deviation 1                    |
//! | τ      | [`CORRELATION_TIME_S`]   | s    | correlation time                                            |
//! | Δ      | `sample_time_s`          | s    | sample k of n holds on [kΔ, (k+1)Δ)                         |
//! | z      | position z               | m    | height of the centre of gravity                             |
//!
//! Geng & Chulin (2016) give this fluctuation as the reason for a separate controller mode near the ground, but no
//! formula; this one is the project's. The update is exact for any Δ (Gillespie (1996)), so its statistics do not
//! depend on Δ. Random numbers are drawn for rotors 1 to 4 in order, once for each sample, independent of σ_ge, the height
//! and the steps of the integration.

use serde::{Deserialize, Serialize};

use crate::random::Generator;

/// Correlation time of the fluctuation.
pub const CORRELATION_TIME_S: f64 = 0.05;

/// The four processes with the generator that drives them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct GroundTurbulence {
    samples: [f64; 4],
    generator: Generator,
}

impl GroundTurbulence {
    /// Starts the processes in their stationary distribution.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut generator = Generator::new(seed, stream);
        Self { samples: core::array::from_fn(|_| generator.normal()), generator }
    }

    /// Returns σ_ge n_i of each rotor.
    pub(super) fn fluctuation(&self, intensity: f64) -> [f64; 4] {
        self.samples.map(|sample| intensity * sample)
    }

    /// Draws the next `count` samples; the last of them holds.
    pub fn draw(&mut self, count: u64, sample_time_s: f64) {
        if count == 0 {
            return;
        }
        let kept = libm::exp(-sample_time_s / CORRELATION_TIME_S);
        let fresh = (1.0 - kept * kept).sqrt();
        for _ in 0..count {
            for sample in &mut self.samples {
                *sample = kept * *sample + fresh * self.generator.normal();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_and_correlation_do_not_depend_on_the_sample_time() {
        for (sample_time_s, samples_in_tau) in [(0.0025, 20), (0.01, 5)] {
            let mut turbulence = GroundTurbulence::new(1, 4);
            let trace: Vec<f64> = (0..200_000)
                .map(|_| {
                    turbulence.draw(1, sample_time_s);
                    turbulence.fluctuation(1.0)[2]
                })
                .collect();
            let lagged = |lag: usize| {
                trace.iter().zip(&trace[lag..]).map(|(a, b)| a * b).sum::<f64>() / (trace.len() - lag) as f64
            };
            assert!((lagged(0) - 1.0).abs() < 0.05, "variance {}", lagged(0));
            assert!((lagged(samples_in_tau) - libm::exp(-1.0)).abs() < 0.05, "after τ {}", lagged(samples_in_tau));
        }
    }
}
