//! Mixer: the rotor speeds that give a thrust and three moments.
//!
//! ```text
//! T₁,₃ = (P - m_z)/4 ∓ M_x/(2l),   T₂,₄ = (P + m_z)/4 ∓ M_y/(2l),   m_z = M_z k / m_p,   ω_i = √(T_i / k)
//! ```
//!
//! | Symbol     | Here                        | Unit  | Meaning                                                  |
//! |------------|-----------------------------|-------|----------------------------------------------------------|
//! | P          | `thrust_n`                  | N     | sum of thrusts                                           |
//! | M          | `moments_n_m`               | N·m   | about body x, y, z                                       |
//! | m_z        | `yaw_n`                     | N     | thrust moved from one pair to the other; at most 0.4 P   |
//! | T_i, ω_i   | `thrusts_n`, returned       | N, rad/s | rotors right, front, left, rear                       |
//! | k, m_p, l  | parameters                  |       | coefficients of thrust and torque, arm                   |
//!
//! Frame: body, ours. Thrust has priority: moments are limited so that no rotor of a pair needs negative thrust or more
//! than k ω_max²; only beyond 10 N can a full yaw moment reduce thrust. In wind the rotors give more than k ω²; the
//! integral of the outer loop compensates for it.
//! Source: the moments of Geng & Chulin (2016), eq. 13, solved for the thrusts; the limits are this project's.

use nalgebra::Vector3;

use super::Parameters;

const LARGEST_YAW_PART_OF_THRUST: f64 = 0.4;

/// Returns the rotor speeds in rad/s: right, front, left, rear.
#[must_use]
pub fn rotor_speeds_rad_s(parameters: &Parameters, thrust_n: f64, moments_n_m: Vector3<f64>) -> [f64; 4] {
    let p = parameters;
    let k = p.thrust_coefficient_n_s2;
    let largest_n = k * p.rotor_speed_max_rad_s * p.rotor_speed_max_rad_s;
    let yaw_limit_n = LARGEST_YAW_PART_OF_THRUST * thrust_n;
    let yaw_n = limited(moments_n_m.z * k / p.torque_coefficient_n_m_s2, yaw_limit_n);
    let (side_n, front_rear_n) = ((thrust_n - yaw_n) / 4.0, (thrust_n + yaw_n) / 4.0);
    let half_difference_n =
        |moment_n_m: f64, mean_n: f64| limited(moment_n_m / (2.0 * p.arm_m), mean_n.min(largest_n - mean_n));
    let roll_n = half_difference_n(moments_n_m.x, side_n);
    let pitch_n = half_difference_n(moments_n_m.y, front_rear_n);
    let thrusts_n = [side_n - roll_n, front_rear_n - pitch_n, side_n + roll_n, front_rear_n + pitch_n];
    thrusts_n.map(|thrust_n| (thrust_n.max(0.0) / k).sqrt().max(p.rotor_speed_min_rad_s).min(p.rotor_speed_max_rad_s))
}

/// Returns `value` limited to ±`limit`; a limit below zero counts as zero.
fn limited(value: f64, limit: f64) -> f64 {
    let limit = limit.max(0.0);
    value.max(-limit).min(limit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vectors::{assert_all_close, get, number, numbers};

    #[test]
    fn the_speeds_equal_those_of_the_vector() {
        let expected = get("mixer");
        let moment = |key: &str| number(&expected[key]);
        let ours = Vector3::new(moment("Mx"), -moment("Mz"), moment("My"));
        let speeds = rotor_speeds_rad_s(&Parameters::default(), moment("P"), ours);
        assert_all_close(&speeds, &numbers(&expected["w"]), 1e-9);
    }

    #[test]
    fn the_speeds_reproduce_thrust_and_moments_within_the_limits() {
        let p = Parameters::default();
        let wanted = Vector3::new(0.1, -0.2, 0.02);
        let t = rotor_speeds_rad_s(&p, 6.0, wanted).map(|w| p.thrust_coefficient_n_s2 * w * w);
        let yaw_n = t[1] + t[3] - t[0] - t[2];
        let ratio_m = p.torque_coefficient_n_m_s2 / p.thrust_coefficient_n_s2;
        let given = Vector3::new((t[2] - t[0]) * p.arm_m, (t[3] - t[1]) * p.arm_m, yaw_n * ratio_m);
        assert!((t.iter().sum::<f64>() - 6.0).abs() < 1e-12 && (given - wanted).norm() < 1e-12);
    }

    #[test]
    fn a_moment_too_large_does_not_change_the_thrust() {
        let p = Parameters { rotor_speed_min_rad_s: 0.0, ..Parameters::default() };
        let cases = [
            (Vector3::new(9.0, 0.0, 0.0), [4.0, 12.0]),
            (Vector3::new(0.0, -9.0, 0.0), [4.0, 12.0]),
            (Vector3::new(0.0, 0.0, 9.0), [4.0, 10.0]),
        ];
        for (moments, thrusts_n) in cases {
            for thrust_n in thrusts_n {
                let speeds = rotor_speeds_rad_s(&p, thrust_n, moments);
                let sum: f64 = speeds.iter().map(|w| p.thrust_coefficient_n_s2 * w * w).sum();
                assert!((sum - thrust_n).abs() < 1e-9, "{sum} for {thrust_n}");
            }
        }
    }

    #[test]
    fn speeds_stay_within_the_range_of_the_motors() {
        let p = Parameters::default();
        assert_eq!(rotor_speeds_rad_s(&p, 0.0, Vector3::zeros()), [40.0; 4]);
        assert_eq!(rotor_speeds_rad_s(&p, 100.0, Vector3::zeros()), [340.0; 4]);
    }
}
