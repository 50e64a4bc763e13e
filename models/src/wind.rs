//! Wind at a vehicle: a steady profile, Dryden turbulence carried along it, and discrete gusts.
//!
//! ```text
//! W = mean · p(h) + u e₁ + v e₂ + w e_z + Σ gusts
//! p(h) = 1 (uniform)  or  ln(h/z₀) / ln(6.096/z₀), h in [1, 300] m (log)      MIL-F-8785C (1980), 3.7.3
//! gust: ½ A (1 - cos(2π (t - t₀)/T)) on t₀ < t < t₀ + T
//! ```
//!
//! | Symbol     | Here                   | Unit | Meaning                                                           |
//! |------------|------------------------|------|-------------------------------------------------------------------|
//! | mean       | `mean_world_m_s`       | m/s  | steady wind, for `Log` at 6.096 m (20 ft)                         |
//! | h          | `vehicle_position_m.z` | m    | height of the vehicle                                             |
//! | z₀         | `roughness_m`          | m    | roughness length of the ground, less than 1                       |
//! | u, v, w    | [`dryden`]             | m/s  | turbulence along, left of and above the mean wind                 |
//! | e₁, e₂     | `along`, `left`        | 1    | horizontal directions: of the mean wind (x in calm), left of it   |
//! | t₀, T, A   | [`Gust`]               | s, s, m/s | start, duration and amplitude of a gust                      |
//!
//! Frame: world. The wind vector points to where the air moves. Turbulence has its own sample time: sample n holds from
//! n Δ until (n+1) Δ. The field is frozen: it passes the vehicle with their relative velocity, at least 1 m/s.

pub mod dryden;

use core::f64::consts::TAU;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::random::Generator;

const REFERENCE_HEIGHT_M: f64 = 6.096;
const LEAST_PASSING_SPEED_M_S: f64 = 1.0;

/// How the steady wind depends on height.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Profile {
    /// Uniform: equal at all heights.
    #[default]
    Uniform,
    /// Logarithmic in height.
    Log,
}

/// Parameters of the wind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// How the steady wind depends on height.
    pub profile: Profile,
    /// z₀: roughness length of the ground; between 0 and 1 m.
    pub roughness_m: f64,
    /// W₂₀: wind speed at 20 ft that sets the intensity of the turbulence; 0 disables it.
    pub turbulence_m_s: f64,
    /// Δ: sample time of the turbulence.
    pub sample_time_s: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self { profile: Profile::Uniform, roughness_m: 0.0457, turbulence_m_s: 0.0, sample_time_s: 0.01 }
    }
}

/// Inputs of the wind, held over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs {
    /// Steady wind.
    pub mean_world_m_s: Vector3<f64>,
    /// Position at which the wind is computed.
    pub vehicle_position_m: Vector3<f64>,
    /// Velocity of that position.
    pub vehicle_velocity_m_s: Vector3<f64>,
}

/// One horizontal gust of the form 1 - cos.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Gust {
    /// Start time.
    pub start_s: f64,
    /// Duration.
    pub duration_s: f64,
    /// Greatest speed, reached at half of the duration.
    pub amplitude_m_s: f64,
    /// Direction in which it blows, counter-clockwise from x.
    pub direction_rad: f64,
}

impl Gust {
    /// Returns the contribution of the gust at a time.
    #[must_use]
    pub fn velocity_world_m_s(&self, time_s: f64) -> Vector3<f64> {
        let since_s = time_s - self.start_s;
        if since_s <= 0.0 || since_s >= self.duration_s {
            return Vector3::zeros();
        }
        let speed = 0.5 * self.amplitude_m_s * (1.0 - libm::cos(TAU * since_s / self.duration_s));
        let (sin, cos) = libm::sincos(self.direction_rad);
        Vector3::new(speed * cos, speed * sin, 0.0)
    }
}

/// The state of the turbulence; steady wind and gusts have none.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    turbulence: dryden::Turbulence,
}

impl State {
    /// Returns the state with sample 0, which holds from time 0.
    #[must_use]
    pub fn start(parameters: &Parameters, inputs: &Inputs, seed: u64, stream: u64) -> Self {
        let scales = dryden::Scales::at(inputs.vehicle_position_m.z, parameters.turbulence_m_s);
        Self { turbulence: dryden::Turbulence::start(&scales, Generator::new(seed, stream)) }
    }

    /// Draws the next `samples` samples, whose instants lie in one step; the last of them holds.
    pub fn draw(&mut self, parameters: &Parameters, inputs: &Inputs, samples: u64) {
        let scales = dryden::Scales::at(inputs.vehicle_position_m.z, parameters.turbulence_m_s);
        let passing_m_s =
            (steady_world_m_s(parameters, inputs) - inputs.vehicle_velocity_m_s).norm().max(LEAST_PASSING_SPEED_M_S);
        for _ in 0..samples {
            self.turbulence.advance(&scales, passing_m_s * parameters.sample_time_s);
        }
    }

    /// Returns the wind at the vehicle at `time_s`.
    #[must_use]
    pub fn velocity_world_m_s(
        &self,
        parameters: &Parameters,
        inputs: &Inputs,
        gusts: &[Gust],
        time_s: f64,
    ) -> Vector3<f64> {
        let mean = inputs.mean_world_m_s;
        let along = Vector3::new(mean.x, mean.y, 0.0).try_normalize(0.0).unwrap_or_else(Vector3::x);
        let left = Vector3::new(-along.y, along.x, 0.0);
        let [u, v, w] = self.turbulence.sample_m_s();
        let turbulence = along * u + left * v + Vector3::new(0.0, 0.0, w);
        let gusts: Vector3<f64> = gusts.iter().map(|gust| gust.velocity_world_m_s(time_s)).sum();
        steady_world_m_s(parameters, inputs) + turbulence + gusts
    }
}

/// Returns the steady wind at the vehicle's height.
#[must_use]
pub fn steady_world_m_s(parameters: &Parameters, inputs: &Inputs) -> Vector3<f64> {
    match parameters.profile {
        Profile::Uniform => inputs.mean_world_m_s,
        Profile::Log => {
            let height_m = inputs.vehicle_position_m.z.clamp(1.0, 300.0);
            let factor =
                libm::log(height_m / parameters.roughness_m) / libm::log(REFERENCE_HEIGHT_M / parameters.roughness_m);
            inputs.mean_world_m_s * factor
        }
    }
}

#[cfg(test)]
mod tests;
