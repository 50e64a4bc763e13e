//! The thrust of one rotor in moving air, by one of three models.
//!
//! ```text
//! kw2    T = k ω²                                                  Geng & Chulin (2016), eq. 1
//! paper  T = k ω² √((V_h/w)² + (1 + V_c/w)²),   w = √(k ω²/(2 ρ A))   Geng & Chulin (2016), eqs. 2, 3
//! bemt   T = q K (θ_e (1/3 + μ²/2) - (V_c + v_i)/(2 Ω R))          blade element       Leishman (2006), ch. 3
//!        T = 2 ρ A v_i √(V_h² + (max(V_c, 0) + v_i)²)              momentum            Glauert (1935)
//!        q = ρ A (Ω R)²,  K = σ a / 2,  μ = V_h / (Ω R)
//! ```
//!
//! | Symbol | Here                  | Unit  | Meaning                                                             |
//! |--------|-----------------------|-------|---------------------------------------------------------------------|
//! | ω, Ω   | `speed_rad_s`         | rad/s | speed of the rotor; Ω is at least 1                                 |
//! | V_h    | `in_plane_m_s`        | m/s   | airspeed of the hub in the rotor's plane                            |
//! | V_c    | `climb_m_s`           | m/s   | airspeed of the hub along the thrust                                |
//! | v_i    | `induced_m_s`         | m/s   | induced velocity, directed against the thrust                       |
//! | w      | `static_induced_…`    | m/s   | induced velocity in still air                                       |
//! | θ_e    | `pitch_rad`           | rad   | pitch of an untwisted blade with the static thrust k ω²             |
//! | λ_h    | `hover_inflow`        | 1     | v_i / (Ω R) in hover                                                |
//! | σ, a   | parameters            | 1, 1/rad | solidity, lift slope                                             |
//! | T      | `thrust_n`            | N     | thrust, not negative                                                |
//!
//! Frame: that of the rotor, with its origin in the hub. Valid for climb and slow descent: momentum theory has no valid
//! branch in descent, so there the momentum equation is solved without V_c; between 40 and 340 rad/s with V_h up to
//! 20 m/s and V_c within ±6 m/s the error of six Newton steps is less than 7e-9 of k ω².
//!
//! Departures from print: eq. 3 multiplies the thrust by the ratio of resultant to induced velocity with the induced
//! velocity held fixed. Then climbing increases thrust, which makes heave unstable, and a side wind of 8 m/s multiplies
//! it by 2.8. Hence `bemt` is the default, calibrated so that hover gives k ω². In `paper`, eq. 3 is taken as the whole
//! thrust in wind; 1e-9 m/s is added to w so that a rotor at rest does not divide by zero.

use super::parameters::{Parameters, RotorModel};

const NEWTON_STEPS: usize = 6;

/// Airspeed of the rotor's hub.
#[derive(Debug, Clone, Copy)]
pub struct Flow {
    /// Component in the rotor's plane.
    pub in_plane_m_s: f64,
    /// Component along the thrust, positive in climb.
    pub climb_m_s: f64,
}

/// Thrust and induced velocity of a rotor in a [`Flow`].
#[derive(Debug, Clone, Copy)]
pub struct Response {
    /// Thrust, not negative.
    pub thrust_n: f64,
    /// Induced velocity: in this flow for `bemt`, in still air for the other models.
    pub induced_m_s: f64,
}

/// A rotor with the values that its model computes once.
#[derive(Debug, Clone)]
pub struct Rotor {
    model: RotorModel,
    thrust_coefficient_n_s2: f64,
    radius_m: f64,
    density_times_disc_kg_m: f64,
    half_solidity_times_slope: f64,
    hover_inflow: f64,
    pitch_rad: f64,
}

impl Rotor {
    /// Calibrates the blade so that hover gives the static thrust.
    pub fn new(parameters: &Parameters) -> Self {
        let density_times_disc_kg_m = parameters.air_density_kg_m3 * parameters.disc_area_m2();
        let radius_m = parameters.rotor_radius_m;
        let half_solidity_times_slope = parameters.rotor_solidity * parameters.lift_slope_per_rad / 2.0;
        let c_t = parameters.thrust_coefficient_n_s2 / (density_times_disc_kg_m * radius_m * radius_m);
        let hover_inflow = (c_t / 2.0).sqrt();
        Self {
            model: parameters.rotor_model,
            thrust_coefficient_n_s2: parameters.thrust_coefficient_n_s2,
            radius_m,
            density_times_disc_kg_m,
            half_solidity_times_slope,
            hover_inflow,
            pitch_rad: 3.0 * (c_t / half_solidity_times_slope + hover_inflow / 2.0),
        }
    }

    /// Returns thrust and induced velocity at a rotor speed in the given flow.
    pub fn response(&self, speed_rad_s: f64, flow: Flow) -> Response {
        let static_thrust_n = self.thrust_coefficient_n_s2 * speed_rad_s * speed_rad_s;
        let static_induced_m_s = (static_thrust_n / (2.0 * self.density_times_disc_kg_m)).sqrt();
        match self.model {
            RotorModel::Bemt => self.blade_element_and_momentum(speed_rad_s, flow),
            RotorModel::Paper => {
                let guarded = static_induced_m_s + 1e-9;
                let (across, along) = (flow.in_plane_m_s / guarded, 1.0 + flow.climb_m_s / guarded);
                let thrust_n = static_thrust_n * (across * across + along * along).sqrt();
                Response { thrust_n, induced_m_s: static_induced_m_s }
            }
            RotorModel::Kw2 => Response { thrust_n: static_thrust_n, induced_m_s: static_induced_m_s },
        }
    }

    fn blade_element_and_momentum(&self, speed_rad_s: f64, flow: Flow) -> Response {
        let tip_m_s = speed_rad_s.max(1.0) * self.radius_m;
        let in_plane_squared = flow.in_plane_m_s * flow.in_plane_m_s;
        let mu_squared = in_plane_squared / (tip_m_s * tip_m_s);
        let scale_n = self.density_times_disc_kg_m * tip_m_s * tip_m_s * self.half_solidity_times_slope;
        let lift = self.pitch_rad * (1.0 / 3.0 + mu_squared / 2.0);
        let blade_thrust_n = |induced: f64| scale_n * (lift - (flow.climb_m_s + induced) / (2.0 * tip_m_s));
        let climb = flow.climb_m_s.max(0.0);
        let two_rho_a = 2.0 * self.density_times_disc_kg_m;
        let mut induced_m_s = self.hover_inflow * tip_m_s;
        for _ in 0..NEWTON_STEPS {
            let through = climb + induced_m_s;
            let resultant = (in_plane_squared + through * through).sqrt() + 1e-9;
            let residual = two_rho_a * induced_m_s * resultant - blade_thrust_n(induced_m_s);
            let slope = two_rho_a * (resultant + induced_m_s * through / resultant) + scale_n / (2.0 * tip_m_s);
            induced_m_s = (induced_m_s - residual / slope).max(0.0);
        }
        Response { thrust_n: blade_thrust_n(induced_m_s).max(0.0), induced_m_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vectors::{assert_close, get, number};

    const HOVER_RAD_S: f64 = 225.677_892_5;

    fn rotor(rotor_model: RotorModel) -> Rotor {
        Rotor::new(&Parameters { rotor_model, ..Parameters::default() })
    }

    fn thrust_n(rotor: &Rotor, speed_rad_s: f64, in_plane_m_s: f64, climb_m_s: f64) -> f64 {
        rotor.response(speed_rad_s, Flow { in_plane_m_s, climb_m_s }).thrust_n
    }

    #[test]
    fn the_calibration_equals_that_of_the_specification() {
        let rotor = rotor(RotorModel::Bemt);
        assert!((rotor.pitch_rad - 0.235_70).abs() < 5e-6 && (rotor.hover_inflow - 0.089_626).abs() < 5e-7);
    }

    #[test]
    fn blade_element_and_momentum_give_the_table_of_the_vectors() {
        let rotor = rotor(RotorModel::Bemt);
        for row in get("thrust_bemt").as_array().unwrap() {
            let flow = Flow { in_plane_m_s: number(&row["Vh"]), climb_m_s: number(&row["Vc"]) };
            let response = rotor.response(number(&row["w"]), flow);
            assert_close(response.thrust_n, number(&row["T"]), 1e-8);
            assert_close(response.induced_m_s, number(&row["vi"]), 1e-8);
        }
    }

    #[test]
    fn all_models_give_the_static_thrust_in_still_air() {
        for model in [RotorModel::Bemt, RotorModel::Paper, RotorModel::Kw2] {
            for speed in [40.0, HOVER_RAD_S, 340.0] {
                assert_close(thrust_n(&rotor(model), speed, 0.0, 0.0), 3.13e-5 * speed * speed, 1e-8);
            }
        }
    }

    #[test]
    fn climbing_decreases_thrust_by_theory_and_increases_it_by_the_printed_formula() {
        let slope = |rotor: Rotor| {
            4.0 * (thrust_n(&rotor, HOVER_RAD_S, 0.0, 1e-4) - thrust_n(&rotor, HOVER_RAD_S, 0.0, 0.0)) / 1e-4
        };
        assert!((slope(rotor(RotorModel::Bemt)) + 0.84).abs() < 0.2);
        assert!((slope(rotor(RotorModel::Paper)) - 2.10).abs() < 0.01);
    }

    #[test]
    fn the_printed_formula_multiplies_thrust_in_side_wind() {
        let rotor = rotor(RotorModel::Paper);
        let weight_quarter_n = thrust_n(&rotor, HOVER_RAD_S, 0.0, 0.0);
        assert!((thrust_n(&rotor, HOVER_RAD_S, 5.0, 0.0) / weight_quarter_n - 1.93).abs() < 0.005);
        assert!((thrust_n(&rotor, HOVER_RAD_S, 8.0, 0.0) / weight_quarter_n - 2.82).abs() < 0.005);
    }

    #[test]
    fn six_newton_steps_satisfy_the_momentum_equation_over_the_flight_envelope() {
        let rotor = rotor(RotorModel::Bemt);
        for speed in [40.0, 100.0, 220.0, 340.0] {
            for in_plane_m_s in [0.0, 1.0, 5.0, 20.0] {
                for climb_m_s in [-6.0, -2.0, 0.0, 2.0, 6.0_f64] {
                    let response = rotor.response(speed, Flow { in_plane_m_s, climb_m_s });
                    let through = climb_m_s.max(0.0) + response.induced_m_s;
                    let resultant = (in_plane_m_s * in_plane_m_s + through * through).sqrt();
                    let momentum_n = 2.0 * rotor.density_times_disc_kg_m * response.induced_m_s * resultant;
                    let residual = (momentum_n - response.thrust_n).abs() / (3.13e-5 * speed * speed);
                    assert!(residual < 7e-9, "{residual:e} at {speed} {in_plane_m_s} {climb_m_s}");
                }
            }
        }
    }
}
