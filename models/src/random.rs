//! Random numbers that are the same on every machine for the same seed and stream.
//!
//! ```text
//! SplitMix64 from seed XOR (stream · 0x9E3779B97F4A7C15) fills the four words of xoshiro256++
//!                                                        Blackman & Vigna (2021); Steele et al. (2014)
//! uniform = (word >> 11) · 2⁻⁵³                          in [0, 1)
//! u₁ = 1 - uniform, u₂ = uniform, r = √(-2 ln u₁)
//! normals = r cos(2π u₂), then r sin(2π u₂)              Box & Muller (1958)
//! ```
//!
//! The second normal of a pair is kept for the next call and is part of the state.

use core::f64::consts::TAU;

use serde::{Deserialize, Serialize};

const GOLDEN_GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

/// A seeded source of random numbers; clone or serialize it to continue with the same numbers elsewhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Generator {
    words: [u64; 4],
    spare_normal: Option<f64>,
}

impl Default for Generator {
    /// Seed 0, stream 0.
    fn default() -> Self {
        Self::new(0, 0)
    }
}

impl Generator {
    /// Starts the sequence that belongs to `seed` and `stream`; different streams of one seed give
    /// different sequences. Their initial states may have words in common: streams 0 and 2 of seed 1 do.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut split_mix = seed ^ stream.wrapping_mul(GOLDEN_GAMMA);
        let words = core::array::from_fn(|_| {
            split_mix = split_mix.wrapping_add(GOLDEN_GAMMA);
            let mut word = split_mix;
            word = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            word ^ (word >> 31)
        });
        Self { words, spare_normal: None }
    }

    /// Returns the next 64 random bits.
    pub fn next_u64(&mut self) -> u64 {
        let [a, b, c, d] = &mut self.words;
        let result = a.wrapping_add(*d).rotate_left(23).wrapping_add(*a);
        let shifted = *b << 17;
        *c ^= *a;
        *d ^= *b;
        *b ^= *c;
        *a ^= *d;
        *c ^= shifted;
        *d = d.rotate_left(45);
        result
    }

    /// Returns a number in [0, 1) with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        const SPACING: f64 = 1.0 / (1_u64 << 53) as f64;
        (self.next_u64() >> 11) as f64 * SPACING
    }

    /// Returns a number from the normal distribution with mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare_normal.take() {
            return spare;
        }
        let above_zero = 1.0 - self.uniform();
        let (sin, cos) = libm::sincos(TAU * self.uniform());
        let radius = (-2.0 * libm::log(above_zero)).sqrt();
        self.spare_normal = Some(radius * sin);
        radius * cos
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vectors::{assert_all_close, get, numbers};

    fn normals(seed: u64, stream: u64, count: usize) -> Vec<f64> {
        let mut generator = Generator::new(seed, stream);
        (0..count).map(|_| generator.normal()).collect()
    }

    #[test]
    fn seed_1_gives_the_words_and_uniforms_of_the_vectors() {
        let mut generator = Generator::new(1, 0);
        for word in get("rng_seed1_u64").as_array().unwrap() {
            assert_eq!(format!("{:#x}", generator.next_u64()), word.as_str().unwrap());
        }
        let mut generator = Generator::new(1, 0);
        for expected in numbers(&get("rng_seed1_uniform")) {
            assert_eq!(generator.uniform(), expected);
        }
    }

    #[test]
    fn seed_and_stream_give_the_normals_of_the_vectors() {
        assert_all_close(&normals(1, 0, 6), &numbers(&get("rng_seed1_normal")), 1e-14);
        assert_all_close(&normals(42, 3, 4), &numbers(&get("rng_seed42_stream3_normal")), 1e-14);
    }

    #[test]
    fn a_saved_generator_continues_with_the_spare_normal() {
        let mut generator = Generator::new(7, 2);
        generator.normal();
        let saved = serde_json::to_string(&generator).unwrap();
        let mut restored: Generator = serde_json::from_str(&saved).unwrap();
        for _ in 0..5 {
            assert_eq!(restored.normal(), generator.normal());
        }
    }

    #[test]
    fn normals_have_mean_0_and_variance_1() {
        let count = 200_000;
        let sample = normals(3, 5, count);
        let mean = sample.iter().sum::<f64>() / count as f64;
        let variance = sample.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count as f64;
        assert!(mean.abs() < 0.01 && (variance - 1.0).abs() < 0.02, "mean {mean}, variance {variance}");
    }
}
