//! A quadcopter in wind: rigid body, four rotors with lag, ground effect, drag and ground contact.
//!
//! ```text
//! ω_i'  = (ω_cmd,i - ω_i) / τ_m             motors                                   rotor.rs: thrust
//! m v'  = R Σ P_i - f - m g                 Geng & Chulin (2016), eqs. 8, 9, 11      dynamics.rs
//! I ω'  = Σ r_i × P_i + M - ω × I ω         Geng & Chulin (2016), eqs. 12, 13        dynamics.rs
//! q'    = ½ q ∘ (0, ω)                      in place of Geng & Chulin (2016), eq. 14
//! ```
//!
//! | Symbol | Here                | Unit   | Meaning                                                             |
//! |--------|---------------------|--------|---------------------------------------------------------------------|
//! | ω_i    | `rotor_speed_rad_s` | rad/s  | speed of rotor i: 1 right, 2 front, 3 left, 4 rear                  |
//! | q      | `body.attitude`     | 1      | body to world                                                       |
//! | v      | `body.velocity_…`   | m/s    | over the ground, world axes                                         |
//! | ω      | `body.rate_…`       | rad/s  | body axes                                                           |
//! | τ_m    | parameter           | s      | time constant of a motor                                            |
//!
//! Frame: ours (see the crate documentation). Classical Runge-Kutta steps of at most [`INNER_STEP_S`]; inputs are held.
//! A unit quaternion is integrated because the Euler angles of eq. 14 are singular at 90° and because the equation is
//! printed with a division by `cos γ` where `cos θ` is meant; [`State::roll_pitch_yaw_rad`] returns the angles.
//! Valid while the flow through the rotors is downwards: no vortex ring state; no in-plane rotor force is modelled.
//! Source: Geng & Chulin (2016), eqs. 1–14; airframe of Bouabdallah (2007).

mod contact;
mod dynamics;
mod ground_effect;
mod ground_turbulence;
mod parameters;
mod rotor;

#[cfg(test)]
mod conservation_tests;

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::vehicle;
use dynamics::Plant;

pub use ground_turbulence::GroundTurbulence;
pub use parameters::{Parameters, RotorModel};

/// Longest inner step of the integration.
pub const INNER_STEP_S: f64 = 0.0025;

/// The inputs of the quadcopter, held over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs {
    /// Commanded rotor speeds; the step limits them to the speed range of the motors.
    pub rotor_command_rad_s: [f64; 4],
    /// Velocity of the air over the ground, world axes.
    pub wind_world_m_s: Vector3<f64>,
    /// Remaining part of each rotor's thrust and drag torque: 1 healthy, 0 lost. The rotor still turns and still has
    /// its inertia.
    pub effectiveness: [f64; 4],
}

/// A number of the state that is not finite: the integration has diverged, or an input is too large for an `f64`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NotFinite {
    quantity: &'static str,
    /// Counted from 1.
    number: usize,
    value: f64,
}

impl core::fmt::Display for NotFinite {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { quantity, number, value } = self;
        write!(f, "number {number} of the {quantity} became {value}: an input may be too large, or the step too long")
    }
}

impl std::error::Error for NotFinite {}

/// The complete state from which the next step starts.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// The rigid body.
    pub body: vehicle::State,
    /// Rotor speeds: right, front, left, rear.
    pub rotor_speed_rad_s: [f64; 4],
}

impl State {
    /// Returns a level state without rotation, with the rotors at hover speed if `airborne`, else at their least speed.
    #[must_use]
    pub fn start(
        parameters: &Parameters,
        position_m: Vector3<f64>,
        velocity_world_m_s: Vector3<f64>,
        yaw_rad: f64,
        airborne: bool,
    ) -> Self {
        let speed = if airborne { parameters.hover_speed_rad_s() } else { parameters.rotor_speed_min_rad_s };
        Self {
            body: vehicle::State {
                position_m,
                attitude: UnitQuaternion::from_euler_angles(0.0, 0.0, yaw_rad),
                velocity_world_m_s,
                rate_body_rad_s: Vector3::zeros(),
            },
            rotor_speed_rad_s: [speed; 4],
        }
    }

    /// Advances the state by inner steps of `inner_s`, at most [`INNER_STEP_S`] each, with the inputs held. `samples` gives
    /// for each inner step how many samples of the turbulence are due until its end.
    ///
    /// # Errors
    /// The first number of the state that is not finite.
    pub fn step(
        &mut self,
        parameters: &Parameters,
        inputs: &Inputs,
        inner_s: f64,
        samples: impl Iterator<Item = u64>,
        turbulence: &mut GroundTurbulence,
    ) -> Result<(), NotFinite> {
        let plant = Plant::new(parameters);
        for samples in samples {
            *self = plant.runge_kutta_step(self, inputs, turbulence.fluctuation(parameters.ground_turbulence), inner_s);
            self.check_finite()?;
            contact::settle(&mut self.body, inner_s);
            turbulence.draw(samples, parameters.ground_turbulence_sample_time_s);
        }
        Ok(())
    }

    fn check_finite(&self) -> Result<(), NotFinite> {
        let vehicle::State { position_m, attitude, velocity_world_m_s, rate_body_rad_s } = &self.body;
        let numbers: [(&'static str, &[f64]); 5] = [
            ("position", position_m.as_slice()),
            ("attitude", attitude.coords.as_slice()),
            ("velocity", velocity_world_m_s.as_slice()),
            ("rate", rate_body_rad_s.as_slice()),
            ("rotor speed", &self.rotor_speed_rad_s),
        ];
        for (quantity, numbers) in numbers {
            if let Some(index) = numbers.iter().position(|number| !number.is_finite()) {
                return Err(NotFinite { quantity, number: index + 1, value: numbers[index] });
            }
        }
        Ok(())
    }

    /// Advances the state by a duration that is a multiple of [`INNER_STEP_S`].
    #[cfg(test)]
    pub(crate) fn advance(
        &mut self,
        parameters: &Parameters,
        inputs: &Inputs,
        duration_s: f64,
        turbulence: &mut GroundTurbulence,
    ) {
        let count = (duration_s / INNER_STEP_S).round();
        assert!((count * INNER_STEP_S - duration_s).abs() < 1e-9, "{duration_s} s");
        let parameters = Parameters { ground_turbulence_sample_time_s: INNER_STEP_S, ..parameters.clone() };
        let samples = std::iter::repeat_n(1, count as usize);
        assert_eq!(self.step(&parameters, inputs, INNER_STEP_S, samples, turbulence), Ok(()));
    }

    /// Returns the sum of the rotors' thrusts in N for this state and these inputs.
    #[must_use]
    pub fn thrust_n(&self, parameters: &Parameters, inputs: &Inputs, turbulence: &GroundTurbulence) -> f64 {
        Plant::new(parameters)
            .thrusts_n(self, inputs, turbulence.fluctuation(parameters.ground_turbulence))
            .iter()
            .sum()
    }

    /// Returns roll, pitch and yaw in radians; pitch is positive nose down.
    #[must_use]
    pub fn roll_pitch_yaw_rad(&self) -> [f64; 3] {
        let (roll, pitch, yaw) = self.body.attitude.euler_angles();
        [roll, pitch, yaw]
    }

    /// Returns whether the vehicle stands on the ground.
    #[must_use]
    pub fn contact(&self) -> bool {
        self.body.position_m.z <= 0.0
    }
}
