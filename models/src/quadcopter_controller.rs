//! Controls a quadcopter to a setpoint: position PID, desired angles, backstepping attitude, mixer.
//!
//! ```text
//! setpoint, state -> position: force F -> P = |F|, desired roll and pitch -> attitude: moments -> mixer: rotor speeds
//! ```
//!
//! | Part               | What it does                                    | Source                               |
//! |--------------------|-------------------------------------------------|--------------------------------------|
//! | [`position`]       | force from the error of position and velocity   | Geng & Chulin (2016), eqs. 16, 17    |
//! | [`attitude`]       | moments from the error of the angles            | Geng & Chulin (2016), eqs. 18–21     |
//! | [`mixer`]          | rotor speeds from thrust and moments            | Geng & Chulin (2016), eq. 13, solved |
//! | [`gains`]          | the numbers of the modes q1 to q4               | this project's                       |
//!
//! Frame: ours. Sampled: one call is one sample, its outputs hold until the next. The paper's altitude axis is y, but
//! it also writes z for the altitude; here it is z throughout.

pub mod attitude;
pub mod gains;
pub mod mixer;
pub mod position;

#[cfg(test)]
mod flight_tests;
#[cfg(test)]
mod response_tests;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::vehicle;
pub use attitude::FormulaSet;
pub use gains::{Gains, Mode, Pid};

/// Vehicle parameters and limits of the controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// m: mass.
    pub mass_kg: f64,
    /// g: acceleration of gravity.
    pub gravity_m_s2: f64,
    /// Principal moments of inertia about body x, y, z.
    pub inertia_kg_m2: Vector3<f64>,
    /// l: distance from the centre of gravity to each rotor axis.
    pub arm_m: f64,
    /// k: thrust of a rotor divided by ω².
    pub thrust_coefficient_n_s2: f64,
    /// m_p: drag torque of a rotor divided by ω².
    pub torque_coefficient_n_m_s2: f64,
    /// Least speed commanded to a rotor.
    pub rotor_speed_min_rad_s: f64,
    /// Greatest speed commanded to a rotor.
    pub rotor_speed_max_rad_s: f64,
    /// Largest angle between the demanded force and the vertical.
    pub tilt_max_rad: f64,
    /// The attitude law.
    pub formula_set: FormulaSet,
}

impl Default for Parameters {
    fn default() -> Self {
        let plant = crate::quadcopter::Parameters::default();
        Self {
            mass_kg: plant.mass_kg,
            gravity_m_s2: plant.gravity_m_s2,
            inertia_kg_m2: plant.inertia_kg_m2,
            arm_m: plant.arm_m,
            thrust_coefficient_n_s2: plant.thrust_coefficient_n_s2,
            torque_coefficient_n_m_s2: plant.torque_coefficient_n_m_s2,
            rotor_speed_min_rad_s: plant.rotor_speed_min_rad_s,
            rotor_speed_max_rad_s: plant.rotor_speed_max_rad_s,
            tilt_max_rad: 25.0_f64.to_radians(),
            formula_set: FormulaSet::Corrected,
        }
    }
}

/// Outputs of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Commanded speeds of the rotors right, front, left, rear.
    pub rotor_speed_rad_s: [f64; 4],
    /// Roll that turns the thrust along the demanded force.
    pub roll_rad: f64,
    /// Pitch that turns the thrust along the demanded force; positive nose down.
    pub pitch_rad: f64,
    /// Sum of thrusts.
    pub thrust_n: f64,
}

/// State of the controller between samples.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// Integral parts of the force, world axes; at most 3 N each.
    pub integral_n: Vector3<f64>,
}

impl State {
    /// Takes one sample; `sample_time_s` is the time until the next.
    pub fn sample(
        &mut self,
        parameters: &Parameters,
        gains: &Gains,
        vehicle: &vehicle::State,
        setpoint: &vehicle::Setpoint,
        sample_time_s: f64,
    ) -> Command {
        let force_n =
            position::demanded_force_n(parameters, gains, vehicle, setpoint, &mut self.integral_n, sample_time_s);
        let (roll, pitch, yaw) = vehicle.attitude.euler_angles();
        let (roll_rad, pitch_rad) = position::desired_roll_pitch_rad(force_n, yaw);
        let moments_n_m = attitude::moments_n_m(
            parameters,
            gains,
            [roll, pitch, yaw],
            [roll_rad, pitch_rad, setpoint.yaw_rad],
            vehicle.rate_body_rad_s,
        );
        let thrust_n = force_n.norm();
        Command {
            rotor_speed_rad_s: mixer::rotor_speeds_rad_s(parameters, thrust_n, moments_n_m),
            roll_rad,
            pitch_rad,
            thrust_n,
        }
    }
}
