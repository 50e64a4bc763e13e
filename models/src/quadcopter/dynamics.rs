//! Forces, moments and the Runge-Kutta step of the quadcopter.
//!
//! ```text
//! m v' = R (0, 0, Σ P_i) - f - (0, 0, m g)                      Geng & Chulin (2016), eqs. 8, 9, 11
//! f_j  = ½ ρ C S_j V_j |V_j|,   V = v - W                       Geng & Chulin (2016), eq. 6
//! S_x = S_y = 4 P_s A sin η + S_0,  S_z = 4 P_s A cos η + S_0   Geng & Chulin (2016), eq. 7
//! I ω' = Σ r_i × (0, 0, P_i) - ω × (I ω + (0, 0, J_r W_s)) - (0, 0, Σ s_i (m_p ω_i² + J_r ω_i'))   eqs. 12, 13
//! P_i  = e_i T_i r_g,i (1 + σ_ge n_i (1 - z)),   W_s = Σ s_i ω_i,   s = (1, -1, 1, -1)             eq. 5
//! ```
//!
//! | Symbol   | Here             | Unit  | Meaning                                                              |
//! |----------|------------------|-------|----------------------------------------------------------------------|
//! | P_i, T_i | `thrusts_n`      | N     | thrust of rotor i with and without ground effect                     |
//! | e_i      | `effectiveness`  | 1     | remaining part of the thrust of rotor i; scales m_p ω_i² too         |
//! | r_i      | `hubs_body_m`    | m     | hub of rotor i: right, front, left, rear                             |
//! | s_i      | `SPIN`           | 1     | 1 where the rotor turns counter-clockwise seen from above            |
//! | f, W     | `drag_n`, `wind` | N, m/s | drag, wind; world axes                                             |
//! | η        | `cos_tilt`       | rad   | angle between the thrust and the vertical                            |
//! | A        | `disc_area_m2`   | m²    | disc area of a rotor                                                 |
//!
//! Frame: ours; roll moments come from rotors 3 and 1, pitch moments from 4 and 2.
//!
//! Departures from print: eq. 5 adds whole thrusts where increments are meant; eq. 6 has V² of the wind, which loses
//! the sign and omits the vehicle's own velocity; eq. 7 has π² for π r²; eq. 8 has the weight upwards; eq. 13 has
//! M₁ + … + M₄ without the signs, M_p for thrust moments, and no reaction to the rotors' acceleration.
//! When the vehicle is upside down, |cos η| is used, because an area is not negative.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::ground_effect;
use super::parameters::Parameters;
use super::rotor::{Flow, Rotor};
use super::{Inputs, State};

/// Sense in which each rotor turns about the body's z.
const SPIN: [f64; 4] = [1.0, -1.0, 1.0, -1.0];

/// Below this height of the centre of gravity the thrust fluctuates.
const FLUCTUATION_BELOW_M: f64 = 1.0;

/// A quadcopter's parameters with the values derived from them once.
pub struct Plant<'a> {
    parameters: &'a Parameters,
    rotor: Rotor,
    hubs_body_m: [Vector3<f64>; 4],
}

/// The time derivative of a [`State`].
pub struct Derivative {
    pub velocity_world_m_s: Vector3<f64>,
    pub acceleration_world_m_s2: Vector3<f64>,
    pub attitude_per_s: Quaternion<f64>,
    pub rate_body_rad_s2: Vector3<f64>,
    pub rotor_rad_s2: [f64; 4],
}

impl<'a> Plant<'a> {
    pub fn new(parameters: &'a Parameters) -> Self {
        let (l, h) = (parameters.arm_m, parameters.hub_height_m);
        let hubs_body_m =
            [Vector3::new(0.0, -l, h), Vector3::new(l, 0.0, h), Vector3::new(0.0, l, h), Vector3::new(-l, 0.0, h)];
        Self { parameters, rotor: Rotor::new(parameters), hubs_body_m }
    }

    /// Returns the thrust of each rotor; `fluctuation` is σ_ge n_i.
    pub fn thrusts_n(&self, state: &State, inputs: &Inputs, fluctuation: [f64; 4]) -> [f64; 4] {
        self.thrusts_at_attitude_n(state, state.body.attitude.to_rotation_matrix().matrix(), inputs, fluctuation)
    }

    fn thrusts_at_attitude_n(
        &self,
        state: &State,
        world_from_body: &Matrix3<f64>,
        inputs: &Inputs,
        fluctuation: [f64; 4],
    ) -> [f64; 4] {
        let body = &state.body;
        let airspeed_body = world_from_body.transpose() * (body.velocity_world_m_s - inputs.wind_world_m_s);
        let ground_speed_m_s = body.velocity_world_m_s.norm();
        let nearness = (FLUCTUATION_BELOW_M - body.position_m.z).max(0.0) / FLUCTUATION_BELOW_M;
        core::array::from_fn(|i| {
            let hub = self.hubs_body_m[i];
            let air = airspeed_body + body.rate_body_rad_s.cross(&hub);
            let flow = Flow { in_plane_m_s: (air.x * air.x + air.y * air.y).sqrt(), climb_m_s: air.z };
            let response = self.rotor.response(state.rotor_speed_rad_s[i], flow);
            let ratio = if self.parameters.ground_effect {
                let height_m = body.position_m.z + (world_from_body * hub).z;
                ground_effect::ratio(self.parameters.rotor_radius_m, height_m, ground_speed_m_s, response.induced_m_s)
            } else {
                1.0
            };
            inputs.effectiveness[i] * response.thrust_n * ratio * (1.0 + fluctuation[i] * nearness)
        })
    }

    fn drag_n(&self, air_world_m_s: Vector3<f64>, cos_tilt: f64) -> Vector3<f64> {
        let p = self.parameters;
        let discs_m2 = 4.0 * p.disc_area_fraction * p.disc_area_m2();
        let side_m2 = discs_m2 * (1.0 - cos_tilt * cos_tilt).max(0.0).sqrt() + p.body_area_m2;
        let top_m2 = discs_m2 * cos_tilt.abs() + p.body_area_m2;
        let areas_m2 = Vector3::new(side_m2, side_m2, top_m2);
        let half_rho_c = 0.5 * p.air_density_kg_m3 * p.drag_coefficient;
        areas_m2.zip_map(&air_world_m_s, |area, v| half_rho_c * area * v * v.abs())
    }

    /// Returns the moment about the centre of gravity in body axes, without the body's own gyroscopic term.
    fn moment_n_m(
        &self,
        state: &State,
        thrusts_n: [f64; 4],
        rotor_rad_s2: [f64; 4],
        effectiveness: [f64; 4],
    ) -> Vector3<f64> {
        let p = self.parameters;
        let mut moment = Vector3::zeros();
        let mut spin_sum_rad_s = 0.0;
        for i in 0..4 {
            let speed = state.rotor_speed_rad_s[i];
            moment += self.hubs_body_m[i].cross(&Vector3::new(0.0, 0.0, thrusts_n[i]));
            let air_torque = effectiveness[i] * p.torque_coefficient_n_m_s2 * speed * speed;
            moment.z -= SPIN[i] * (air_torque + p.rotor_inertia_kg_m2 * rotor_rad_s2[i]);
            spin_sum_rad_s += SPIN[i] * speed;
        }
        let rotor_momentum = Vector3::new(0.0, 0.0, p.rotor_inertia_kg_m2 * spin_sum_rad_s);
        moment - state.body.rate_body_rad_s.cross(&rotor_momentum)
    }

    pub fn derivative(&self, state: &State, inputs: &Inputs, fluctuation: [f64; 4]) -> Derivative {
        let p = self.parameters;
        let body = &state.body;
        let rotation = body.attitude.to_rotation_matrix();
        let world_from_body = rotation.matrix();
        let thrusts_n = self.thrusts_at_attitude_n(state, world_from_body, inputs, fluctuation);
        let rotor_rad_s2: [f64; 4] = core::array::from_fn(|i| {
            let command = inputs.rotor_command_rad_s[i].max(p.rotor_speed_min_rad_s).min(p.rotor_speed_max_rad_s);
            (command - state.rotor_speed_rad_s[i]) / p.motor_time_constant_s
        });
        let up_body_in_world = world_from_body.column(2).into_owned();
        let force_n = up_body_in_world * thrusts_n.iter().sum::<f64>()
            - self.drag_n(body.velocity_world_m_s - inputs.wind_world_m_s, up_body_in_world.z);
        let rate = body.rate_body_rad_s;
        let moment = self.moment_n_m(state, thrusts_n, rotor_rad_s2, inputs.effectiveness)
            - rate.cross(&rate.component_mul(&p.inertia_kg_m2));
        Derivative {
            velocity_world_m_s: body.velocity_world_m_s,
            acceleration_world_m_s2: force_n / p.mass_kg - Vector3::new(0.0, 0.0, p.gravity_m_s2),
            attitude_per_s: body.attitude.quaternion() * Quaternion::from_imag(rate) * 0.5,
            rate_body_rad_s2: moment.component_div(&p.inertia_kg_m2),
            rotor_rad_s2,
        }
    }

    /// Takes one classical fourth-order Runge-Kutta step; the attitude is normalised after it.
    pub fn runge_kutta_step(&self, state: &State, inputs: &Inputs, fluctuation: [f64; 4], step_s: f64) -> State {
        let k1 = self.derivative(state, inputs, fluctuation);
        let k2 = self.derivative(&moved(state, &k1, step_s / 2.0), inputs, fluctuation);
        let k3 = self.derivative(&moved(state, &k2, step_s / 2.0), inputs, fluctuation);
        let k4 = self.derivative(&moved(state, &k3, step_s), inputs, fluctuation);
        let mut next = *state;
        for (k, weight) in [(k1, 1.0 / 6.0), (k2, 1.0 / 3.0), (k3, 1.0 / 3.0), (k4, 1.0 / 6.0)] {
            next = moved(&next, &k, step_s * weight);
        }
        next.body.attitude = UnitQuaternion::new_normalize(next.body.attitude.into_inner());
        next
    }
}

/// Returns the state plus `time_s` times a derivative; its attitude is not exactly of unit length.
fn moved(state: &State, along: &Derivative, time_s: f64) -> State {
    let mut next = *state;
    next.body.position_m += along.velocity_world_m_s * time_s;
    next.body.velocity_world_m_s += along.acceleration_world_m_s2 * time_s;
    next.body.rate_body_rad_s += along.rate_body_rad_s2 * time_s;
    let attitude = state.body.attitude.quaternion() + along.attitude_per_s * time_s;
    next.body.attitude = UnitQuaternion::new_unchecked(attitude);
    for (speed, change) in next.rotor_speed_rad_s.iter_mut().zip(along.rotor_rad_s2) {
        *speed += change * time_s;
    }
    next
}

#[cfg(test)]
mod tests;
