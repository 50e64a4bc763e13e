//! Outer loop: the force that moves the vehicle to its setpoint, and the tilt that gives the thrust its direction.
//!
//! ```text
//! F = K_p (p_d - p) + I + K_d (v_d - v) + m a_d + (0, 0, m g)          Geng & Chulin (2016), eq. 17
//! F_z in [0.3, 1.8] m g;   |F_h| at most F_z tan(tilt_max);   P = |F|
//! I' = K_i (p_d - p), not while F is limited or the error is large;   |I| at most 3 N in each direction
//! roll_d  = asin((F_x sin ψ - F_y cos ψ) / P)                            Geng & Chulin (2016), eq. 16
//! pitch_d = asin((F_x cos ψ + F_y sin ψ) / (P cos roll_d))
//! ```
//!
//! | Symbol      | Here            | Unit | Meaning                                                        |
//! |-------------|-----------------|------|----------------------------------------------------------------|
//! | F           | returned        | N    | demanded thrust force, world axes; F_h its horizontal part     |
//! | P           | length of F     | N    | thrust                                                         |
//! | I           | `integral_n`    | N    | integral part; F uses its value before the update              |
//! | ψ           | `yaw_rad`       | rad  | actual yaw                                                     |
//!
//! Frame: world, ours. The horizontal integral is held beyond 1 m of horizontal error, the vertical one beyond 0.3 m;
//! otherwise an altitude step overshoots by 20 %.
//!
//! Departures from print: eq. 17 has f_z in the vertical channel and divides only its proportional part by
//! cos γ cos θ; here the thrust is |F| of the whole demand. Eq. 16 has arccos, which gives 90° in hover, lacks cos γ_d,
//! up to 5.8° at 34° of roll, and takes the desired yaw, which misdirects the force while the vehicle still turns.

use nalgebra::Vector3;

use super::{Gains, Parameters};
use crate::vehicle;

const LEAST_VERTICAL_PART_OF_WEIGHT: f64 = 0.3;
const LARGEST_VERTICAL_PART_OF_WEIGHT: f64 = 1.8;
const LARGEST_INTEGRAL_N: f64 = 3.0;
const HORIZONTAL_GUARD_M: f64 = 1.0;
const VERTICAL_GUARD_M: f64 = 0.3;

/// Returns the demanded force in N, world axes, and updates the integral by one sample.
pub fn demanded_force_n(
    parameters: &Parameters,
    gains: &Gains,
    vehicle: &vehicle::State,
    setpoint: &vehicle::Setpoint,
    integral_n: &mut Vector3<f64>,
    sample_time_s: f64,
) -> Vector3<f64> {
    let weight_n = parameters.mass_kg * parameters.gravity_m_s2;
    let (horizontal, vertical) = (gains.horizontal, gains.vertical);
    let per_axis = |h: f64, v: f64| Vector3::new(h, h, v);
    let error_m = setpoint.position_m - vehicle.position_m;
    let velocity_error_m_s = setpoint.velocity_m_s - vehicle.velocity_world_m_s;
    let wanted_n = error_m.component_mul(&per_axis(horizontal.proportional_n_m, vertical.proportional_n_m))
        + *integral_n
        + velocity_error_m_s.component_mul(&per_axis(horizontal.derivative_n_s_m, vertical.derivative_n_s_m))
        + setpoint.acceleration_m_s2 * parameters.mass_kg
        + Vector3::new(0.0, 0.0, weight_n);

    let upwards_n =
        wanted_n.z.max(LEAST_VERTICAL_PART_OF_WEIGHT * weight_n).min(LARGEST_VERTICAL_PART_OF_WEIGHT * weight_n);
    let vertical_is_limited = upwards_n != wanted_n.z;
    let sideways_n = wanted_n.xy().norm();
    let sideways_limit_n = upwards_n * libm::tan(parameters.tilt_max_rad);
    let horizontal_is_limited = sideways_n > sideways_limit_n;
    let scale = if horizontal_is_limited { sideways_limit_n / sideways_n } else { 1.0 };

    let step = error_m.component_mul(&per_axis(horizontal.integral_n_m_s, vertical.integral_n_m_s)) * sample_time_s;
    if !horizontal_is_limited && error_m.xy().norm() < HORIZONTAL_GUARD_M {
        integral_n.x = (integral_n.x + step.x).clamp(-LARGEST_INTEGRAL_N, LARGEST_INTEGRAL_N);
        integral_n.y = (integral_n.y + step.y).clamp(-LARGEST_INTEGRAL_N, LARGEST_INTEGRAL_N);
    }
    if !vertical_is_limited && error_m.z.abs() < VERTICAL_GUARD_M {
        integral_n.z = (integral_n.z + step.z).clamp(-LARGEST_INTEGRAL_N, LARGEST_INTEGRAL_N);
    }
    Vector3::new(wanted_n.x * scale, wanted_n.y * scale, upwards_n)
}

/// Returns the roll and pitch in radians that turn the body's z along a force that points upwards.
#[must_use]
pub fn desired_roll_pitch_rad(force_n: Vector3<f64>, yaw_rad: f64) -> (f64, f64) {
    let (sin, cos) = libm::sincos(yaw_rad);
    let thrust_n = force_n.norm();
    let sin_roll = ((force_n.x * sin - force_n.y * cos) / thrust_n).clamp(-1.0, 1.0);
    let roll = libm::asin(sin_roll);
    let sin_pitch = (force_n.x * cos + force_n.y * sin) / (thrust_n * libm::cos(roll));
    (roll, libm::asin(sin_pitch.clamp(-1.0, 1.0)))
}

#[cfg(test)]
mod tests;
