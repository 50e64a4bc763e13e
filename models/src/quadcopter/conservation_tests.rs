//! Invariants of the quadcopter's motion: energy, angular momentum, symmetry, continuation of a saved state.

use super::*;
use core::f64::consts::PI;

fn dead_rotors(command: [f64; 4]) -> Inputs {
    Inputs { rotor_command_rad_s: command, wind_world_m_s: Vector3::zeros(), effectiveness: [0.0; 4] }
}

fn tumbling(parameters: &Parameters) -> State {
    let mut state = State::start(parameters, Vector3::new(0.0, 0.0, 100.0), Vector3::new(3.0, -2.0, 5.0), 0.4, true);
    state.body.rate_body_rad_s = Vector3::new(2.0, -1.5, 3.0);
    state
}

fn without_drag() -> Parameters {
    Parameters { drag_coefficient: 0.0, ..Parameters::default() }
}

#[test]
fn free_fall_without_drag_conserves_energy_and_follows_the_parabola() {
    let parameters = without_drag();
    let mut state = tumbling(&parameters);
    let start = state.body;
    let energy = |body: &vehicle::State| {
        body.velocity_world_m_s.norm_squared() / 2.0 + parameters.gravity_m_s2 * body.position_m.z
    };
    state.advance(&parameters, &dead_rotors([226.0; 4]), 2.0, &mut GroundTurbulence::new(1, 4));
    assert!((energy(&state.body) - energy(&start)).abs() < 1e-9);
    let fallen = start.position_m + start.velocity_world_m_s * 2.0 - Vector3::new(0.0, 0.0, 9.81 * 2.0);
    assert!((state.body.position_m - fallen).norm() < 1e-10);
}

#[test]
fn torque_free_rotation_conserves_angular_momentum_in_the_world_and_rotational_energy() {
    let parameters = without_drag();
    let mut state = tumbling(&parameters);
    state.rotor_speed_rad_s = [300.0, 100.0, 300.0, 100.0];
    let momentum = |state: &State| {
        let rotors = Vector3::new(0.0, 0.0, parameters.rotor_inertia_kg_m2 * 400.0);
        let body = state.body.rate_body_rad_s.component_mul(&parameters.inertia_kg_m2);
        state.body.attitude * (body + rotors)
    };
    let energy = |state: &State| {
        let rate = state.body.rate_body_rad_s;
        rate.dot(&rate.component_mul(&parameters.inertia_kg_m2)) / 2.0
    };
    let (momentum_before, energy_before) = (momentum(&state), energy(&state));
    state.advance(&parameters, &dead_rotors([300.0, 100.0, 300.0, 100.0]), 3.0, &mut GroundTurbulence::new(1, 4));
    assert!((momentum(&state) - momentum_before).norm() < 1e-9 * momentum_before.norm());
    assert!((energy(&state) - energy_before).abs() < 1e-9 * energy_before);
}

#[test]
fn accelerating_rotors_conserves_the_angular_momentum_of_body_and_rotors() {
    let parameters = without_drag();
    let mut state = tumbling(&parameters);
    state.body.rate_body_rad_s = Vector3::zeros();
    let before = state.rotor_speed_rad_s[0];
    let inputs = dead_rotors([300.0, before, 300.0, before]);
    state.advance(&parameters, &inputs, 1.0, &mut GroundTurbulence::new(1, 4));
    let rotors = 2.0 * parameters.rotor_inertia_kg_m2 * (state.rotor_speed_rad_s[0] - before);
    assert!((parameters.inertia_kg_m2.z * state.body.rate_body_rad_s.z + rotors).abs() < 1e-12);
}

#[test]
fn rotors_follow_their_command_as_a_first_order_lag_within_their_limits() {
    let parameters = Parameters::default();
    let mut state = tumbling(&parameters);
    let before = state.rotor_speed_rad_s[0];
    state.advance(&parameters, &dead_rotors([300.0, 1000.0, 0.0, before]), 0.05, &mut GroundTurbulence::new(1, 4));
    let reached = |command: f64| command + (before - command) * libm::exp(-1.0);
    // Truncation of the integration: twenty steps of x⁵/120 with x = 2.5 ms / 50 ms, times a change of 186 rad/s.
    let truncation_rad_s = 20.0 * (0.05 * 0.05 * 0.05 * 0.05 * 0.05 / 120.0) * 186.0;
    for (speed, command) in state.rotor_speed_rad_s.iter().zip([300.0, 340.0, 40.0, before]) {
        assert!((speed - reached(command)).abs() <= truncation_rad_s);
    }
}

#[test]
fn a_half_turn_about_the_vertical_commutes_with_the_motion() {
    let parameters = Parameters::default();
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI);
    let mut state = tumbling(&parameters);
    state.body.position_m.z = 1.5;
    state.rotor_speed_rad_s = [210.0, 220.0, 230.0, 240.0];
    let inputs = Inputs {
        rotor_command_rad_s: [250.0, 190.0, 220.0, 230.0],
        wind_world_m_s: Vector3::new(4.0, -2.0, 0.5),
        effectiveness: [1.0, 0.9, 1.0, 0.7],
    };
    let mut turned = state;
    turned.body.position_m = turn * state.body.position_m;
    turned.body.velocity_world_m_s = turn * state.body.velocity_world_m_s;
    turned.body.attitude = turn * state.body.attitude;
    let turned_inputs = Inputs { wind_world_m_s: turn * inputs.wind_world_m_s, ..inputs };
    state.advance(&parameters, &inputs, 0.2, &mut GroundTurbulence::new(1, 4));
    turned.advance(&parameters, &turned_inputs, 0.2, &mut GroundTurbulence::new(1, 4));
    assert!((turn * state.body.position_m - turned.body.position_m).norm() < 1e-12);
    assert!((turn * state.body.attitude).angle_to(&turned.body.attitude) < 1e-7);
    assert!((state.body.rate_body_rad_s - turned.body.rate_body_rad_s).norm() < 1e-11);
}

#[test]
fn without_reaction_torques_the_mirrored_vehicle_flies_the_mirrored_path() {
    let parameters = Parameters { torque_coefficient_n_m_s2: 0.0, rotor_inertia_kg_m2: 0.0, ..Parameters::default() };
    let mirror = |v: Vector3<f64>| Vector3::new(v.x, -v.y, v.z);
    let mirror_rate = |w: Vector3<f64>| Vector3::new(-w.x, w.y, -w.z);
    let start = |sign: f64| {
        let mut state = tumbling(&parameters);
        state.body.attitude = UnitQuaternion::from_euler_angles(sign * 0.2, 0.1, sign * 0.5);
        state
    };
    let (mut state, mut mirrored) = (start(1.0), start(-1.0));
    mirrored.body.velocity_world_m_s = mirror(state.body.velocity_world_m_s);
    mirrored.body.rate_body_rad_s = mirror_rate(state.body.rate_body_rad_s);
    let inputs = Inputs {
        rotor_command_rad_s: [250.0, 190.0, 220.0, 230.0],
        wind_world_m_s: Vector3::new(4.0, -2.0, 0.5),
        effectiveness: [1.0; 4],
    };
    let mirrored_inputs = Inputs {
        rotor_command_rad_s: [220.0, 190.0, 250.0, 230.0],
        wind_world_m_s: mirror(inputs.wind_world_m_s),
        ..inputs
    };
    state.advance(&parameters, &inputs, 0.2, &mut GroundTurbulence::new(1, 4));
    mirrored.advance(&parameters, &mirrored_inputs, 0.2, &mut GroundTurbulence::new(1, 4));
    assert!((mirror(state.body.position_m) - mirrored.body.position_m).norm() < 1e-12);
    assert!((mirror_rate(state.body.rate_body_rad_s) - mirrored.body.rate_body_rad_s).norm() < 1e-11);
}

#[test]
fn drag_dissipates_energy_of_a_falling_vehicle_until_its_speed_is_constant() {
    let parameters = Parameters::default();
    let mut state = State::start(&parameters, Vector3::new(0.0, 0.0, 2000.0), Vector3::zeros(), 0.0, false);
    state.advance(&parameters, &dead_rotors([40.0; 4]), 30.0, &mut GroundTurbulence::new(1, 4));
    let area = 4.0 * 0.15 * parameters.disc_area_m2() + 0.015;
    let terminal = -(0.65 * 9.81 / (0.5 * 1.225 * area)).sqrt();
    assert!((state.body.velocity_world_m_s.z - terminal).abs() < 1e-6);
}

#[test]
fn a_vehicle_on_the_ground_stays_there_until_it_has_thrust() {
    let parameters = Parameters::default();
    let mut turbulence = GroundTurbulence::new(1, 4);
    let mut state = State::start(&parameters, Vector3::zeros(), Vector3::zeros(), 0.0, false);
    let idle = Inputs { effectiveness: [1.0; 4], ..dead_rotors([0.0; 4]) };
    state.advance(&parameters, &idle, 1.0, &mut turbulence);
    assert!(state.contact() && state.body.position_m.norm() < 1e-6);
    let lift = Inputs { rotor_command_rad_s: [240.0; 4], ..idle };
    state.advance(&parameters, &lift, 1.0, &mut turbulence);
    assert!(!state.contact() && state.body.position_m.z > 0.1);
}

#[test]
fn several_inner_steps_in_one_call_equal_as_many_calls_of_one_step() {
    let parameters = Parameters::default();
    let inputs = Inputs { effectiveness: [1.0; 4], ..dead_rotors([230.0, 220.0, 210.0, 240.0]) };
    let fly = |steps: u32, duration_s: f64| {
        let mut turbulence = GroundTurbulence::new(1, 4);
        let mut state = State::start(&parameters, Vector3::new(0.0, 0.0, 0.5), Vector3::zeros(), 0.0, true);
        for _ in 0..steps {
            state.advance(&parameters, &inputs, duration_s, &mut turbulence);
        }
        state
    };
    assert_eq!(fly(1, 0.02), fly(8, 0.0025));
}

#[test]
fn a_saved_state_continues_bit_for_bit() {
    let parameters = Parameters::default();
    let inputs = Inputs { effectiveness: [1.0; 4], ..dead_rotors([230.0, 220.0, 210.0, 240.0]) };
    let mut turbulence = GroundTurbulence::new(1, 4);
    let mut state = State::start(&parameters, Vector3::new(0.0, 0.0, 0.5), Vector3::zeros(), 0.3, true);
    state.advance(&parameters, &inputs, 0.0125, &mut turbulence);
    let saved = serde_json::to_string(&(state, &turbulence)).unwrap();
    let (mut restored, mut same_turbulence): (State, GroundTurbulence) = serde_json::from_str(&saved).unwrap();
    state.advance(&parameters, &inputs, 0.1, &mut turbulence);
    restored.advance(&parameters, &inputs, 0.1, &mut same_turbulence);
    assert_eq!((restored, same_turbulence), (state, turbulence));
}
