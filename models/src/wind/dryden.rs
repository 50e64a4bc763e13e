//! Dryden turbulence at low altitude, discretised exactly.
//!
//! ```text
//! σ_w = 0.1 W₂₀,  σ_u = σ_v = σ_w / (0.177 + 0.000823 h)^0.4          MIL-F-8785C (1980), 3.7.3; h in feet
//! L_w = h,        L_u = L_v = h / (0.177 + 0.000823 h)^1.2
//! H_u = σ_u √(2L_u/V) / (1 + τ s),   H_v,w = σ √(L/V) (1 + √3 τ s) / (1 + τ s)²,   τ = L / V
//!
//! with r = V Δ / L, a = e⁻ʳ and normal n, exactly for any Δ:
//! u  ← a u + σ_u √(1 - a²) n
//! y₂ ← r a y₁ + a y₂ + l₂₁ n₁ + l₂₂ n₂,   y₁ ← a y₁ + l₁₁ n₁,   v, w = σ (√3 y₁ + (1 - √3) y₂)
//! l₁₁ = √q₁₁, l₂₁ = q₁₂ / l₁₁, l₂₂ = √(q₂₂ - l₂₁²)
//! q₁₁ = (1 - a²)/2,  q₁₂ = ¼ - (r/2 + ¼) a²,  q₂₂ = ¼ - (r²/2 + r/2 + ¼) a²
//! ```
//!
//! | Symbol   | Here            | Unit | Meaning                                                              |
//! |----------|-----------------|------|----------------------------------------------------------------------|
//! | W₂₀      | `w20_m_s`       | m/s  | wind speed at 20 ft                                                  |
//! | h        | `height_m`      | m    | height, limited to 10 to 1000 ft                                     |
//! | σ, L     | [`Scales`]      | m/s, m | intensities and lengths                                            |
//! | V Δ      | `passed_m`      | m    | length of the field that passes in one sample                        |
//! | y₁, y₂   | `lateral`, `vertical` | 1 | filter states of v and of w                                        |
//! | q, l     | `Lateral`       | 1    | covariance of the noise of one sample, its lower Cholesky factor     |
//!
//! Frame: u along the mean wind, v to its left, w up. Valid from 3 to 305 m. MIL-HDBK-1797 (1997) halves L_v and L_w
//! and writes 2L in its filters: the same spectra. A sample draws normals for u (one), v (two) and w (two), in this
//! order. So does the start, which takes y from its stationary covariance [[½, ¼], [¼, ¼]]. For r < 0.05 q₁₂ and q₂₂
//! come from their series, because the closed forms suffer from cancellation. Gillespie (1996) derives such exact
//! updates.

use serde::{Deserialize, Serialize};

use crate::random::Generator;

const FOOT_M: f64 = 0.3048;
const SQRT_3: f64 = 1.732_050_807_568_877_2;
const SERIES_BELOW: f64 = 0.05;

/// Lengths and intensities of turbulence at one height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// L_u = L_v.
    pub horizontal_length_m: f64,
    /// L_w.
    pub vertical_length_m: f64,
    /// σ_u = σ_v.
    pub horizontal_intensity_m_s: f64,
    /// σ_w.
    pub vertical_intensity_m_s: f64,
}

impl Scales {
    /// Returns the scales at a height above the ground for a wind speed at 20 ft.
    #[must_use]
    pub fn at(height_m: f64, w20_m_s: f64) -> Self {
        let feet = (height_m / FOOT_M).clamp(10.0, 1000.0);
        let shape = 0.177 + 0.000_823 * feet;
        let vertical_intensity_m_s = 0.1 * w20_m_s;
        Self {
            horizontal_length_m: FOOT_M * feet / libm::pow(shape, 1.2),
            vertical_length_m: FOOT_M * feet,
            horizontal_intensity_m_s: vertical_intensity_m_s / libm::pow(shape, 0.4),
            vertical_intensity_m_s,
        }
    }
}

/// Coefficients of the update of one second-order filter, also used for its start.
struct Lateral {
    r: f64,
    a: f64,
    l11: f64,
    l21: f64,
    l22: f64,
}

impl Lateral {
    /// Update for a field that passes by r times its length scale.
    fn passing(r: f64) -> Self {
        let a = libm::exp(-r);
        let a2 = a * a;
        let (r2, r3, r4) = (r * r, r * r * r, r * r * r * r);
        let (q12, q22) = if r < SERIES_BELOW {
            (r2 / 2.0 - 2.0 * r3 / 3.0 + r4 / 2.0, r3 / 3.0 - r4 / 2.0 + 2.0 * r4 * r / 5.0)
        } else {
            (0.25 - (r / 2.0 + 0.25) * a2, 0.25 - (r2 / 2.0 + r / 2.0 + 0.25) * a2)
        };
        Self::from_covariance(r, a, (1.0 - a2) / 2.0, q12, q22)
    }

    /// Draw from the stationary distribution, independent of the previous state.
    fn stationary() -> Self {
        Self::from_covariance(0.0, 0.0, 0.5, 0.25, 0.25)
    }

    fn from_covariance(r: f64, a: f64, q11: f64, q12: f64, q22: f64) -> Self {
        let l11 = q11.sqrt();
        let l21 = q12 / l11;
        Self { r, a, l11, l21, l22: (q22 - l21 * l21).max(0.0).sqrt() }
    }

    fn apply(&self, [y1, y2]: [f64; 2], generator: &mut Generator) -> [f64; 2] {
        let (n1, n2) = (generator.normal(), generator.normal());
        [self.a * y1 + self.l11 * n1, self.r * self.a * y1 + self.a * y2 + self.l21 * n1 + self.l22 * n2]
    }
}

/// The three filters with the generator that drives them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Turbulence {
    longitudinal_m_s: f64,
    lateral: [f64; 2],
    vertical: [f64; 2],
    sample_m_s: [f64; 3],
    generator: Generator,
}

impl Turbulence {
    /// Returns the filters with a first sample from the stationary distribution.
    #[must_use]
    pub fn start(scales: &Scales, generator: Generator) -> Self {
        let mut start =
            Self { longitudinal_m_s: 0.0, lateral: [0.0; 2], vertical: [0.0; 2], sample_m_s: [0.0; 3], generator };
        start.update(scales, 0.0, &Lateral::stationary(), &Lateral::stationary());
        start
    }

    /// Draws the next sample, after `passed_m` of the field have passed.
    pub fn advance(&mut self, scales: &Scales, passed_m: f64) {
        let lateral = Lateral::passing(passed_m / scales.horizontal_length_m);
        let vertical = Lateral::passing(passed_m / scales.vertical_length_m);
        self.update(scales, lateral.a, &lateral, &vertical);
    }

    /// Returns the present sample: along the mean wind, to its left, up.
    #[must_use]
    pub fn sample_m_s(&self) -> [f64; 3] {
        self.sample_m_s
    }

    fn update(&mut self, scales: &Scales, kept: f64, lateral: &Lateral, vertical: &Lateral) {
        let fresh = scales.horizontal_intensity_m_s * (1.0 - kept * kept).sqrt();
        self.longitudinal_m_s = kept * self.longitudinal_m_s + fresh * self.generator.normal();
        self.lateral = lateral.apply(self.lateral, &mut self.generator);
        self.vertical = vertical.apply(self.vertical, &mut self.generator);
        let output = |[y1, y2]: [f64; 2]| SQRT_3 * y1 + (1.0 - SQRT_3) * y2;
        self.sample_m_s = [
            self.longitudinal_m_s,
            scales.horizontal_intensity_m_s * output(self.lateral),
            scales.vertical_intensity_m_s * output(self.vertical),
        ];
    }
}

#[cfg(test)]
mod tests;
