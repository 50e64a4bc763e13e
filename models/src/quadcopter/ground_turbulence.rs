//! Random fluctuation of thrust near the ground: one Ornstein–Uhlenbeck process for each rotor.
//!
//! ```text
//! P_i → P_i (1 + σ_ge n_i (1 - z))  for z < 1 m        n ← a n + √(1 - a²) N(0, 1),  a = exp(-h / τ)
//! ```
//!
//! | Symbol | Here                     | Unit | Meaning                                                     |
//! |--------|--------------------------|------|-------------------------------------------------------------|
//! | σ_ge   | `intensity`, parameter   | 1    | standard deviation at z = 0, as a fraction of the thrust    |
//! | n_i    | `samples`                | 1    | process of rotor i, standard deviation 1                    |
//! | τ      | [`CORRELATION_TIME_S`]   | s    | correlation time                                            |
//! | h      | `duration_s`             | s    | inner step; n is held over it                               |
//! | z      | position z               | m    | height of the centre of gravity                             |
//!
//! Geng & Chulin (2016) give this fluctuation as the reason for a separate controller mode near the ground, but no
//! formula; this one is the project's. The update is exact for any step (Gillespie (1996)), so its statistics do not
//! depend on the step. Random numbers are drawn for rotors 1 to 4 in order, once at the start and once for each inner
//! step, independent of σ_ge and the height.

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

    pub(super) fn advance(&mut self, duration_s: f64) {
        let kept = libm::exp(-duration_s / CORRELATION_TIME_S);
        let fresh = (1.0 - kept * kept).sqrt();
        for sample in &mut self.samples {
            *sample = kept * *sample + fresh * self.generator.normal();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variance_and_correlation_do_not_depend_on_the_step() {
        for (step_s, steps_in_tau) in [(0.0025, 20), (0.01, 5)] {
            let mut turbulence = GroundTurbulence::new(1, 4);
            let trace: Vec<f64> = (0..200_000)
                .map(|_| {
                    turbulence.advance(step_s);
                    turbulence.fluctuation(1.0)[2]
                })
                .collect();
            let lagged = |lag: usize| {
                trace.iter().zip(&trace[lag..]).map(|(a, b)| a * b).sum::<f64>() / (trace.len() - lag) as f64
            };
            assert!((lagged(0) - 1.0).abs() < 0.05, "variance {}", lagged(0));
            assert!((lagged(steps_in_tau) - libm::exp(-1.0)).abs() < 0.05, "after τ {}", lagged(steps_in_tau));
        }
    }
}
