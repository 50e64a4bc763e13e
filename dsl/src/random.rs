//! The random numbers of faults and of sweeps: hashes, so that each draw depends on what it is for and on nothing that
//! happened before.

use std::f64::consts::TAU;
use twox_hash::XxHash3_64;

/// The increment of SplitMix64.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// The random numbers of one fault, or of one axis of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draws(u64);

impl Draws {
    /// Those of the fault with this ordinal among the faults of a port, which has this full name; those of an axis have the
    /// name of its parameter and the ordinal 0.
    #[must_use]
    pub fn new(seed: i64, name: &str, ordinal: u64) -> Self {
        let words = [seed.cast_unsigned(), XxHash3_64::oneshot(name.as_bytes()), ordinal];
        Self(words.into_iter().fold(0, hash))
    }

    /// A number from 0 up to but not including 1; the last word is a tick, or a case.
    #[must_use]
    pub fn uniform(self, element: u64, tick: u64) -> f64 {
        fraction(self.word(element, tick))
    }

    /// A number of the normal distribution with mean 0 and standard deviation 1, by Box and Muller.
    #[must_use]
    pub fn normal(self, element: u64, tick: u64) -> f64 {
        let word = self.word(element, tick);
        let (distance, turn) = (1.0 - fraction(word), fraction(split_mix(word)));
        (-2.0 * libm::log(distance)).sqrt() * libm::cos(TAU * turn)
    }

    fn word(self, element: u64, tick: u64) -> u64 {
        hash(hash(self.0, element), tick)
    }
}

fn hash(state: u64, word: u64) -> u64 {
    split_mix(state ^ word)
}

/// The output of SplitMix64 in this state (Steele, Lea & Flood 2014, fig. 16, with the constants of its variant 13).
fn split_mix(state: u64) -> u64 {
    let z = state.wrapping_add(GAMMA);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The upper 53 bits as a fraction.
fn fraction(word: u64) -> f64 {
    (word >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn the_hash_is_split_mix_and_the_name_is_hashed_by_xxh3() {
    // The first outputs of SplitMix64 with the seed 1234567, and XXH3 of the empty text.
    assert_eq!(split_mix(1_234_567), 6_457_827_717_110_365_317);
    assert_eq!(split_mix(1_234_567_u64.wrapping_add(GAMMA)), 3_203_168_211_198_807_973);
    assert_eq!(XxHash3_64::oneshot(b""), 0x2d06_8005_38d3_94c2);
}

#[test]
fn draws_have_their_distribution() {
    let draws = Draws::new(1, "b.u", 0);
    let mean = |draw: &dyn Fn(u64) -> f64| (0..100_000).map(draw).sum::<f64>() / 1e5;
    let uniform = |tick| draws.uniform(0, tick);
    let normal = |tick| draws.normal(0, tick);
    let square = |x: f64| x * x;
    assert!((0..100_000).all(|tick| (0.0..1.0).contains(&uniform(tick))));
    assert!((mean(&uniform) - 0.5).abs() < 0.005 && (mean(&|tick| square(uniform(tick))) - 1.0 / 3.0).abs() < 0.005);
    assert!(mean(&normal).abs() < 0.01 && (mean(&|tick| square(normal(tick))) - 1.0).abs() < 0.02);
    let within = (0..100_000).filter(|&tick| normal(tick).abs() < 1.0).count();
    assert!((68_000..68_600).contains(&within), "{within}");
}

#[test]
fn every_part_of_the_key_changes_a_draw() {
    let first = Draws::new(1, "b.u", 0).uniform(0, 0);
    let others = [
        Draws::new(2, "b.u", 0).uniform(0, 0),
        Draws::new(1, "b.v", 0).uniform(0, 0),
        Draws::new(1, "b.u", 1).uniform(0, 0),
        Draws::new(1, "b.u", 0).uniform(1, 0),
        Draws::new(1, "b.u", 0).uniform(0, 1),
    ];
    assert!(others.iter().all(|other| other.to_bits() != first.to_bits()));
}
