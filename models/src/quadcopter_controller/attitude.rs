//! Inner loop: backstepping moments that bring roll, pitch and yaw to the desired angles.
//!
//! ```text
//! z₁ = γ_d - γ,  z₂ = ω_x - k₁ z₁,  V₂ = (z₁² + z₂²)/2,  V₂' = -k₁ z₁² - k₂ z₂²      Geng & Chulin (2016), eqs. 18, 19
//! M_x = I_x ((1 + k₁k₂) (roll_d - roll) - (k₁ + k₂) ω_x)  + (ω × I ω)_x               Geng & Chulin (2016), eq. 20
//! M_y, M_z likewise with k₅, k₆ and k₃, k₄; the error of yaw is taken in [-π, π)         Geng & Chulin (2016), eq. 21
//! ```
//!
//! | Symbol       | Here              | Unit | Meaning                                     |
//! |--------------|-------------------|------|---------------------------------------------|
//! | M            | returned          | N·m  | moments about body x, y, z                  |
//! | ω            | `rate_body_rad_s` | rad/s | body axes                                  |
//! | k₁ … k₆      | [`Gains`]         | 1/s  | roll k₁ k₂, yaw k₃ k₄, pitch k₅ k₆          |
//! | I            | parameters        | kg·m² | principal moments of inertia               |
//!
//! Frame: ours; the paper's U₂, U₃, U₄ are M_x, M_z, -M_y. Valid for small angles and rates, where the angle rates
//! are the body rates; the desired angles are treated as constant. The error has the characteristic polynomial
//! s² + (k₁+k₂) s + (1+k₁k₂).
//!
//! Departures from print: the derivation needs γ_d' - ω_x for V₁', k₁ z₂² in V₂' and I_y - I_z in the coupling of roll
//! (I_z - I_x, I_x - I_y in yaw and pitch). The printed eqs. 20 and 21 have (k₁k₂ - 1) γ_d with the sign of feedback:
//! the vehicle goes to -(k₁k₂-1)/(k₁k₂+1) of the command. [`FormulaSet::Printed`] reproduces it.

use core::f64::consts::{PI, TAU};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::{Gains, Parameters};

/// Variants of the attitude law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum FormulaSet {
    /// As derived.
    #[default]
    Corrected,
    /// As printed in eqs. 20 and 21, with their errors.
    Printed,
}

/// Returns the moments about body x, y, z in N·m for the angles roll, pitch, yaw in radians.
#[must_use]
pub fn moments_n_m(
    parameters: &Parameters,
    gains: &Gains,
    angles_rad: [f64; 3],
    desired_rad: [f64; 3],
    rate_body_rad_s: Vector3<f64>,
) -> Vector3<f64> {
    let inertia = parameters.inertia_kg_m2;
    let k = [gains.roll_per_s, gains.pitch_per_s, gains.yaw_per_s];
    let w = rate_body_rad_s;
    match parameters.formula_set {
        FormulaSet::Corrected => {
            let error_rad = [
                desired_rad[0] - angles_rad[0],
                desired_rad[1] - angles_rad[1],
                wrapped_rad(desired_rad[2] - angles_rad[2]),
            ];
            let acceleration =
                Vector3::from_fn(|i, _| (1.0 + k[i][0] * k[i][1]) * error_rad[i] - (k[i][0] + k[i][1]) * w[i]);
            acceleration.component_mul(&inertia) + w.cross(&w.component_mul(&inertia))
        }
        FormulaSet::Printed => {
            let acceleration = Vector3::from_fn(|i, _| {
                let product = k[i][0] * k[i][1];
                -(product - 1.0) * desired_rad[i] - (product + 1.0) * angles_rad[i] - (k[i][0] + k[i][1]) * w[i]
            });
            let vertical_minus_roll = inertia.z - inertia.x;
            let coupling = Vector3::new(
                w.y * w.z * vertical_minus_roll,
                w.x * w.z * vertical_minus_roll,
                w.x * w.y * (inertia.x - inertia.z),
            );
            acceleration.component_mul(&inertia) + coupling
        }
    }
}

/// Returns the angle in [-π, π) that differs from `angle_rad` by whole turns.
fn wrapped_rad(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frames::{vector_from_geng_chulin, vector_to_geng_chulin};
    use crate::quadcopter_controller::Mode;
    use crate::vectors::{assert_all_close, get, number, numbers};

    #[test]
    fn the_moments_equal_those_of_the_vector() {
        let expected = get("backstepping_U2_U3_U4");
        let x = numbers(&get("quad_deriv")["x"]);
        let k = numbers(&expected["k"]);
        let gains = Gains {
            roll_per_s: [k[0], k[1]],
            yaw_per_s: [k[2], k[3]],
            pitch_per_s: [k[4], k[5]],
            ..Gains::of(Mode::Q2)
        };
        let (psi, theta, gamma) = (x[6], x[7], x[8]);
        let desired = [number(&expected["gamma_d"]), -number(&expected["theta_d"]), number(&expected["psi_d"])];
        let rate = vector_from_geng_chulin(Vector3::from_column_slice(&x[9..12]));
        let moments = moments_n_m(&Parameters::default(), &gains, [gamma, -theta, psi], desired, rate);
        assert_all_close(vector_to_geng_chulin(moments).as_slice(), &numbers(&expected["U"]), 1e-9);
    }

    #[test]
    fn the_lyapunov_function_decreases_as_derived() {
        let (parameters, gains) = (Parameters::default(), Gains::of(Mode::Q3));
        let rate = Vector3::new(0.5, -0.8, 0.3);
        let moments = moments_n_m(&parameters, &gains, [0.2, 0.0, 0.0], [0.05, 0.0, 0.0], rate);
        let coupling = rate.cross(&rate.component_mul(&parameters.inertia_kg_m2));
        let rate_change = ((moments - coupling).component_div(&parameters.inertia_kg_m2)).x;
        let [k1, k2] = gains.roll_per_s;
        let z1 = 0.05 - 0.2;
        let z2 = rate.x - k1 * z1;
        let falls = z1 * -rate.x + z2 * (rate_change + k1 * rate.x);
        assert!((falls + k1 * z1 * z1 + k2 * z2 * z2).abs() < 1e-12);
    }

    #[test]
    fn yaw_turns_the_short_way_round() {
        let moment = |yaw: f64, desired: f64| {
            let (parameters, gains) = (Parameters::default(), Gains::of(Mode::Q2));
            moments_n_m(&parameters, &gains, [0.0, 0.0, yaw], [0.0, 0.0, desired], Vector3::zeros()).z
        };
        assert!(moment(3.0, -3.0) > 0.0 && moment(-3.0, 3.0) < 0.0);
        assert!((moment(3.0, -3.0) - moment(0.0, TAU - 6.0)).abs() < 1e-12);
        assert_eq!(wrapped_rad(PI), -PI);
    }

    #[test]
    fn the_printed_law_settles_near_the_negative_of_the_command() {
        let parameters = Parameters { formula_set: FormulaSet::Printed, ..Parameters::default() };
        let gains = Gains { roll_per_s: [7.0, 7.0], ..Gains::of(Mode::Q2) };
        let moment = moments_n_m(&parameters, &gains, [-0.96 * 0.1, 0.0, 0.0], [0.1, 0.0, 0.0], Vector3::zeros());
        assert!(moment.norm() < 1e-15);
    }
}
