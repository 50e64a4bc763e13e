//! The quadcopter's derivative against the test vectors, the Euler form, and terms that must vanish or change sign.

use super::*;
use crate::frames::{
    angles_to_geng_chulin, attitude_from_geng_chulin_angles, vector_from_geng_chulin, vector_to_geng_chulin,
};
use crate::quadcopter::RotorModel;
use crate::vectors::{assert_all_close, get, numbers};
use crate::vehicle;

const CALM: [f64; 4] = [0.0; 4];

fn inputs(rotor_command_rad_s: [f64; 4]) -> Inputs {
    Inputs { rotor_command_rad_s, wind_world_m_s: Vector3::zeros(), effectiveness: [1.0; 4] }
}

fn hovering(parameters: &Parameters, height_m: f64) -> State {
    State::start(parameters, Vector3::new(0.0, 0.0, height_m), Vector3::zeros(), 0.3, true)
}

/// The state and inputs of `quad_deriv`, given in the paper's frame.
fn vector_state() -> (State, Inputs) {
    let x = numbers(&get("quad_deriv")["x"]);
    let ours = |from: usize| vector_from_geng_chulin(Vector3::from_column_slice(&x[from..from + 3]));
    let body = vehicle::State {
        position_m: ours(0),
        attitude: attitude_from_geng_chulin_angles([x[6], x[7], x[8]]),
        velocity_world_m_s: ours(3),
        rate_body_rad_s: ours(9),
    };
    let command: [f64; 4] = numbers(&get("quad_deriv")["wc"]).try_into().unwrap();
    let wind = vector_from_geng_chulin(Vector3::from_column_slice(&numbers(&get("quad_deriv")["W"])));
    let state = State { body, rotor_speed_rad_s: x[12..].try_into().unwrap() };
    (state, Inputs { wind_world_m_s: wind, ..inputs(command) })
}

/// Geng & Chulin (2016), eq. 14 with `cos θ` where `cos γ` is printed: ψ', θ', γ'.
fn euler_angle_rates([_, theta, gamma]: [f64; 3], w: Vector3<f64>) -> [f64; 3] {
    let e = w.y * libm::cos(gamma) - w.z * libm::sin(gamma);
    let theta_rate = w.y * libm::sin(gamma) + w.z * libm::cos(gamma);
    [e / libm::cos(theta), theta_rate, w.x - libm::tan(theta) * e]
}

#[test]
fn the_derivative_equals_that_of_the_vectors_for_every_rotor_model() {
    let models =
        [(RotorModel::Bemt, "deriv_bemt"), (RotorModel::Paper, "deriv_paper_eq3"), (RotorModel::Kw2, "deriv_k_w2")];
    for (rotor_model, key) in models {
        let parameters = Parameters { rotor_model, ..Parameters::default() };
        let (state, inputs) = vector_state();
        let derivative = Plant::new(&parameters).derivative(&state, &inputs, CALM);
        let angles = angles_to_geng_chulin(&state.body.attitude);
        let mut actual = Vec::new();
        actual.extend_from_slice(vector_to_geng_chulin(derivative.velocity_world_m_s).as_slice());
        actual.extend_from_slice(vector_to_geng_chulin(derivative.acceleration_world_m_s2).as_slice());
        actual.extend(euler_angle_rates(angles, vector_to_geng_chulin(state.body.rate_body_rad_s)));
        actual.extend_from_slice(vector_to_geng_chulin(derivative.rate_body_rad_s2).as_slice());
        actual.extend(derivative.rotor_rad_s2);
        assert_all_close(&actual, &numbers(&get("quad_deriv")[key]), 1e-9);
    }
}

#[test]
fn the_quaternion_turns_as_the_euler_angles_do() {
    let (state, inputs) = vector_state();
    let parameters = Parameters::default();
    let derivative = Plant::new(&parameters).derivative(&state, &inputs, CALM);
    let angles_after = |time_s: f64| {
        let q = state.body.attitude.into_inner() + derivative.attitude_per_s * time_s;
        angles_to_geng_chulin(&UnitQuaternion::new_normalize(q))
    };
    let (h, rates) = (1e-5, &numbers(&get("quad_deriv")["deriv_bemt"])[6..9]);
    let (after, before) = (angles_after(h), angles_after(-h));
    for i in 0..3 {
        assert!(((after[i] - before[i]) / (2.0 * h) - rates[i]).abs() < 1e-9);
    }
}

#[test]
fn the_rotation_matrix_turns_with_the_body_rate() {
    let (state, inputs) = vector_state();
    let parameters = Parameters::default();
    let derivative = Plant::new(&parameters).derivative(&state, &inputs, CALM);
    let rotation_after = |time_s: f64| {
        let q = state.body.attitude.into_inner() + derivative.attitude_per_s * time_s;
        UnitQuaternion::new_normalize(q).to_rotation_matrix().into_inner()
    };
    let h = 1e-5;
    let measured = (rotation_after(h) - rotation_after(-h)) / (2.0 * h);
    let expected = rotation_after(0.0) * state.body.rate_body_rad_s.cross_matrix();
    assert!((measured - expected).abs().max() < 1e-9);
    let defect = rotation_after(0.0).transpose() * rotation_after(0.0) - Matrix3::identity();
    assert!(defect.abs().max() < 1e-14);
}

#[test]
fn hover_is_an_equilibrium() {
    for rotor_model in [RotorModel::Bemt, RotorModel::Paper, RotorModel::Kw2] {
        let parameters = Parameters { rotor_model, ..Parameters::default() };
        let derivative = Plant::new(&parameters).derivative(
            &hovering(&parameters, 5.0),
            &inputs([parameters.hover_speed_rad_s(); 4]),
            CALM,
        );
        assert!(derivative.acceleration_world_m_s2.norm() < 1e-8);
        assert!(derivative.rate_body_rad_s2.norm() < 1e-8);
        assert!(derivative.velocity_world_m_s.norm() + derivative.attitude_per_s.norm() < 1e-8);
        assert_eq!(derivative.rotor_rad_s2, [0.0; 4]);
    }
}

#[test]
fn near_the_ground_a_lower_rotor_speed_carries_the_weight() {
    let table = [(0.05, 209.2), (0.1, 218.5), (0.2, 223.1), (0.5, 225.2), (1.0, 225.5)];
    let parameters = Parameters::default();
    for (height_m, expected_rad_s) in table {
        let climbs = |speed: f64| {
            let mut state = hovering(&parameters, height_m);
            state.rotor_speed_rad_s = [speed; 4];
            Plant::new(&parameters).derivative(&state, &inputs([speed; 4]), CALM).acceleration_world_m_s2.z > 0.0
        };
        let (mut low, mut high) = (200.0, 240.0);
        while high - low > 1e-6 {
            let middle = (low + high) / 2.0;
            if climbs(middle) { high = middle } else { low = middle }
        }
        assert!((low - expected_rad_s).abs() < 0.1, "{low} at {height_m} m");
    }
}

#[test]
fn a_higher_speed_of_rotors_1_and_3_turns_the_body_against_their_rotation() {
    let parameters = Parameters::default();
    let mut state = hovering(&parameters, 5.0);
    let hover = parameters.hover_speed_rad_s();
    state.rotor_speed_rad_s = [1.01 * hover, 0.99 * hover, 1.01 * hover, 0.99 * hover];
    let derivative = Plant::new(&parameters).derivative(&state, &inputs(state.rotor_speed_rad_s), CALM);
    assert!(derivative.rate_body_rad_s2.z < 0.0);
    assert_eq!((derivative.rate_body_rad_s2.x, derivative.rate_body_rad_s2.y), (0.0, 0.0));
}

#[test]
fn rolling_with_a_net_rotor_spin_gives_the_gyroscopic_moment() {
    let parameters = Parameters { rotor_model: RotorModel::Kw2, ..Parameters::default() };
    let mut state = hovering(&parameters, 5.0);
    state.rotor_speed_rad_s = [230.0, 220.0, 230.0, 220.0];
    state.body.rate_body_rad_s = Vector3::new(0.8, 0.0, 0.0);
    let moment = Plant::new(&parameters).moment_n_m(&state, [1.0; 4], CALM, [1.0; 4]);
    // M_z of the paper is our -M_y: -J_r ω_x W_s there.
    assert!((moment.y - 6e-5 * 0.8 * 20.0).abs() < 1e-12);
}

#[test]
fn each_rotor_lifts_its_own_side() {
    let parameters = Parameters::default();
    let state = hovering(&parameters, 5.0);
    let moment = |rotor: usize| {
        let mut thrusts = [1.0; 4];
        thrusts[rotor] = 2.0;
        let moment = Plant::new(&parameters).moment_n_m(&state, thrusts, CALM, [1.0; 4]);
        [moment.x, moment.y]
    };
    let arm = parameters.arm_m;
    for (rotor, expected) in [[-arm, 0.0], [0.0, -arm], [arm, 0.0], [0.0, arm]].iter().enumerate() {
        assert!((moment(rotor)[0] - expected[0]).abs() < 1e-15 && (moment(rotor)[1] - expected[1]).abs() < 1e-15);
    }
}

#[test]
fn a_rotor_at_half_effectiveness_has_half_its_thrust_and_half_its_torque() {
    let parameters = Parameters { rotor_model: RotorModel::Kw2, ..Parameters::default() };
    let state = hovering(&parameters, 5.0);
    let plant = Plant::new(&parameters);
    let weakened = Inputs { effectiveness: [0.5, 1.0, 1.0, 1.0], ..inputs(state.rotor_speed_rad_s) };
    let thrusts = plant.thrusts_n(&state, &weakened, CALM);
    assert!((thrusts[0] / thrusts[1] - 0.5).abs() < 1e-15);
    let speed = parameters.hover_speed_rad_s();
    let moment = plant.moment_n_m(&state, thrusts, CALM, weakened.effectiveness);
    assert!((moment.z - 0.5 * 7.5e-7 * speed * speed).abs() < 1e-12);
}

#[test]
fn accelerating_a_rotor_causes_a_reaction_torque_on_the_body() {
    let parameters = Parameters { torque_coefficient_n_m_s2: 0.0, ..Parameters::default() };
    let state = hovering(&parameters, 5.0);
    let moment = Plant::new(&parameters).moment_n_m(&state, [1.0; 4], [100.0, 0.0, 0.0, 0.0], [1.0; 4]);
    assert!((moment.z + 6e-5 * 100.0).abs() < 1e-15);
}

#[test]
fn drag_is_along_the_relative_wind_and_changes_sign_with_it() {
    let parameters = Parameters::default();
    let plant = Plant::new(&parameters);
    let drag = plant.drag_n(Vector3::new(8.0, -3.0, 2.0), 0.9);
    assert!(drag.x > 0.0 && drag.y < 0.0 && drag.z > 0.0);
    assert_eq!(plant.drag_n(Vector3::new(-8.0, 3.0, -2.0), 0.9), -drag);
    let side_on = plant.drag_n(Vector3::new(1.0, 0.0, 0.0), 1.0);
    assert!((side_on.x - 0.5 * 1.225 * 0.015).abs() < 1e-15);
}

#[test]
fn ground_turbulence_changes_the_thrust_below_one_metre_only() {
    let parameters = Parameters { ground_effect: false, ..Parameters::default() };
    let plant = Plant::new(&parameters);
    let thrust = |height_m: f64, fluctuation: f64| {
        let state = hovering(&parameters, height_m);
        plant.thrusts_n(&state, &inputs([0.0; 4]), [fluctuation, 0.0, 0.0, 0.0])[0]
    };
    assert!((thrust(0.25, 0.1) / thrust(0.25, 0.0) - 1.075).abs() < 1e-12);
    assert_eq!(thrust(1.5, 0.1), thrust(1.5, 0.0));
}
