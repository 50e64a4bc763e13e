//! The constants of one quadcopter; the default is the OS4 airframe of Bouabdallah (2007).
//!
//! Mass, arm, inertia, thrust and torque coefficients, rotor inertia and blade data are those of OS4. The drag numbers
//! and the motor's time constant are this project's: with them hover in 12 m/s of wind needs 24° of tilt.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// How a rotor's thrust depends on the air flow at the rotor; see `rotor.rs`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum RotorModel {
    /// Combined blade element and momentum theory.
    #[default]
    Bemt,
    /// The formula of Geng & Chulin (2016), eq. 3, which holds the induced velocity fixed.
    Paper,
    /// Thrust k ω², independent of the air flow.
    Kw2,
}

/// Parameters of the airframe and of its environment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// m: mass.
    pub mass_kg: f64,
    /// l: distance from the centre of gravity to each rotor axis.
    pub arm_m: f64,
    /// h: height of the rotor hubs above the centre of gravity.
    pub hub_height_m: f64,
    /// Principal moments of inertia about body x, y, z; z is the yaw axis.
    pub inertia_kg_m2: Vector3<f64>,
    /// k: static thrust of a rotor divided by ω².
    pub thrust_coefficient_n_s2: f64,
    /// m_p: drag torque of a rotor divided by ω².
    pub torque_coefficient_n_m_s2: f64,
    /// J_r: moment of inertia of a rotor with its motor.
    pub rotor_inertia_kg_m2: f64,
    /// R: radius of a rotor.
    pub rotor_radius_m: f64,
    /// σ: blade area divided by disc area.
    pub rotor_solidity: f64,
    /// a: slope of the blade's lift coefficient.
    pub lift_slope_per_rad: f64,
    /// τ_m: time constant of a motor.
    pub motor_time_constant_s: f64,
    /// Least speed that a rotor can be commanded to.
    pub rotor_speed_min_rad_s: f64,
    /// Greatest speed that a rotor can be commanded to.
    pub rotor_speed_max_rad_s: f64,
    /// ρ: density of the air.
    pub air_density_kg_m3: f64,
    /// g: acceleration of gravity.
    pub gravity_m_s2: f64,
    /// S_0: area of the body in the wind, equal for all directions.
    pub body_area_m2: f64,
    /// P_s: fraction of a rotor's disc area that counts as drag area.
    pub disc_area_fraction: f64,
    /// C: drag coefficient.
    pub drag_coefficient: f64,
    /// How thrust depends on the air flow at the rotor.
    pub rotor_model: RotorModel,
    /// Whether the ground effect increases the thrust of rotors near the ground.
    pub ground_effect: bool,
    /// σ_ge: standard deviation of the thrust's fluctuation at the ground, as a fraction of the thrust; 0 disables it.
    pub ground_turbulence: f64,
    /// Δ: how long a sample of the fluctuation holds.
    pub ground_turbulence_sample_time_s: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            mass_kg: 0.65,
            arm_m: 0.23,
            hub_height_m: 0.05,
            inertia_kg_m2: Vector3::new(7.5e-3, 7.5e-3, 1.3e-2),
            thrust_coefficient_n_s2: 3.13e-5,
            torque_coefficient_n_m_s2: 7.5e-7,
            rotor_inertia_kg_m2: 6e-5,
            rotor_radius_m: 0.15,
            rotor_solidity: 0.167,
            lift_slope_per_rad: 5.7,
            motor_time_constant_s: 0.05,
            rotor_speed_min_rad_s: 40.0,
            rotor_speed_max_rad_s: 340.0,
            air_density_kg_m3: 1.225,
            gravity_m_s2: 9.81,
            body_area_m2: 0.015,
            disc_area_fraction: 0.15,
            drag_coefficient: 1.0,
            rotor_model: RotorModel::Bemt,
            ground_effect: true,
            ground_turbulence: 0.05,
            ground_turbulence_sample_time_s: 0.01,
        }
    }
}

impl Parameters {
    /// Returns the rotor speed in rad/s at which four rotors carry the weight in still air.
    #[must_use]
    pub fn hover_speed_rad_s(&self) -> f64 {
        (self.mass_kg * self.gravity_m_s2 / (4.0 * self.thrust_coefficient_n_s2)).sqrt()
    }

    pub(super) fn disc_area_m2(&self) -> f64 {
        core::f64::consts::PI * self.rotor_radius_m * self.rotor_radius_m
    }
}

#[test]
fn the_default_airframe_hovers_at_226_rad_s_with_more_than_twice_its_weight_in_reserve() {
    let parameters = Parameters::default();
    let hover = parameters.hover_speed_rad_s();
    assert!((hover - 225.678).abs() < 5e-4, "{hover}");
    let reserve = parameters.rotor_speed_max_rad_s * parameters.rotor_speed_max_rad_s / (hover * hover);
    assert!((reserve - 2.27).abs() < 5e-3, "{reserve}");
}
