//! Steps of roll, altitude and position in closed loop with the plant, and the printed law's failure.

use super::*;
use crate::quadcopter::{self, GroundTurbulence, Inputs, RotorModel};
use crate::vehicle::Setpoint;

const SAMPLE_TIME_S: f64 = 0.005;
const START_M: Vector3<f64> = Vector3::new(0.0, 0.0, 50.0);

fn plant(rotor_model: RotorModel) -> quadcopter::Parameters {
    quadcopter::Parameters { rotor_model, ..quadcopter::Parameters::default() }
}

fn calm(rotor_command_rad_s: [f64; 4]) -> Inputs {
    Inputs { rotor_command_rad_s, wind_world_m_s: Vector3::zeros(), effectiveness: [1.0; 4] }
}

/// Roll in degrees at each sample after a command of 10° with the weight as thrust.
fn roll_step_deg(rotor_model: RotorModel, k: f64, formula_set: FormulaSet, samples: usize) -> Vec<f64> {
    let plant = plant(rotor_model);
    let parameters = Parameters { formula_set, ..Parameters::default() };
    let gains = Gains { roll_per_s: [k; 2], pitch_per_s: [k; 2], ..Gains::of(Mode::Q2) };
    let mut state = quadcopter::State::start(&plant, START_M, Vector3::zeros(), 0.0, true);
    let weight_n = plant.mass_kg * plant.gravity_m_s2;
    let mut trace = Vec::new();
    for _ in 0..samples {
        let angles = state.roll_pitch_yaw_rad();
        let desired = [10.0_f64.to_radians(), 0.0, 0.0];
        let moments = attitude::moments_n_m(&parameters, &gains, angles, desired, state.body.rate_body_rad_s);
        let command = mixer::rotor_speeds_rad_s(&parameters, weight_n, moments);
        state.advance(&plant, &calm(command), SAMPLE_TIME_S, &mut GroundTurbulence::new(1, 4));
        trace.push(state.roll_pitch_yaw_rad()[0].to_degrees());
    }
    trace
}

/// Time in s until 90 % of `goal` are reached.
fn rise_s(trace: &[f64], goal: f64) -> f64 {
    let samples = trace.iter().position(|x| *x >= 0.9 * goal).expect("it rises");
    (samples + 1) as f64 * SAMPLE_TIME_S
}

/// Overshoot beyond `goal` in percent.
fn overshoot_percent(trace: &[f64], goal: f64) -> f64 {
    let largest = trace.iter().copied().fold(0.0, f64::max);
    ((largest / goal - 1.0) * 100.0).max(0.0)
}

/// Time in s from which the trace stays within 5 % of `goal`.
fn settle_s(trace: &[f64], goal: f64) -> f64 {
    let last_outside = trace.iter().rposition(|x| (x - goal).abs() > 0.05 * goal.abs()).expect("it starts outside");
    (last_outside + 2) as f64 * SAMPLE_TIME_S
}

#[test]
fn a_roll_step_has_the_rise_time_of_its_gains() {
    let table = [(6.0, 0.86, 1.0), (10.0, 0.47, 1.0), (14.0, 0.34, 1.0), (20.0, 0.14, 5.0)];
    for (k, expected_s, overshoot_limit) in table {
        let trace = roll_step_deg(RotorModel::Bemt, k, FormulaSet::Corrected, 600);
        let (rise, overshoot) = (rise_s(&trace, 10.0), overshoot_percent(&trace, 10.0));
        assert!((rise / expected_s - 1.0).abs() <= 0.15, "rises in {rise} s with k = {k}");
        assert!(overshoot <= overshoot_limit, "overshoots by {overshoot} % with k = {k}");
    }
}

#[test]
fn with_fixed_thrust_coefficients_a_roll_step_is_less_damped() {
    let table = [(6.0, 0.61, 0.0), (10.0, 0.31, 0.0), (14.0, 0.19, 1.5), (20.0, 0.13, 10.0)];
    for (k, expected_s, expected_overshoot) in table {
        let trace = roll_step_deg(RotorModel::Kw2, k, FormulaSet::Corrected, 600);
        let (rise, overshoot) = (rise_s(&trace, 10.0), overshoot_percent(&trace, 10.0));
        assert!((rise / expected_s - 1.0).abs() <= 0.15, "rises in {rise} s with k = {k}");
        assert!(
            (overshoot - expected_overshoot).abs() <= 0.15 * expected_overshoot + 0.05,
            "{overshoot} % with k = {k}"
        );
    }
}

#[test]
fn the_printed_law_settles_at_minus_9_6_degrees_for_a_command_of_10() {
    let trace = roll_step_deg(RotorModel::Kw2, 7.0, FormulaSet::Printed, 1000);
    let last = trace[trace.len() - 1];
    assert!((last + 9.60).abs() < 0.005, "{last}");
}

/// Displacement from the start at each sample, with the whole controller and the setpoint `goal_m` from the start.
fn displacements(parameters: &Parameters, gains: &Gains, goal_m: Vector3<f64>, samples: usize) -> Vec<Vector3<f64>> {
    let plant = plant(RotorModel::Bemt);
    let mut state = quadcopter::State::start(&plant, START_M, Vector3::zeros(), 0.0, true);
    let mut controller = State::default();
    let setpoint = Setpoint::hold(START_M + goal_m);
    let mut trace = Vec::new();
    for _ in 0..samples {
        let command = controller.sample(parameters, gains, &state.body, &setpoint, SAMPLE_TIME_S);
        state.advance(&plant, &calm(command.rotor_speed_rad_s), SAMPLE_TIME_S, &mut GroundTurbulence::new(1, 4));
        trace.push(state.body.position_m - START_M);
    }
    trace
}

fn pid(proportional_n_m: f64, integral_n_m_s: f64, derivative_n_s_m: f64) -> Pid {
    Pid { proportional_n_m, integral_n_m_s, derivative_n_s_m }
}

#[test]
fn an_altitude_step_overshoots_little_and_settles() {
    let table = [(pid(4.1, 0.4, 3.2), 4.0, 2.3 * 0.85, 3.0 * 1.15), (pid(8.0, 2.0, 4.5), 5.0, 1.6 * 0.85, 1.6 * 1.15)];
    for (vertical, overshoot_limit, fastest_s, slowest_s) in table {
        let gains = Gains { vertical, ..Gains::of(Mode::Q2) };
        let displacements_m = displacements(&Parameters::default(), &gains, Vector3::z(), 4000);
        let trace: Vec<f64> = displacements_m.iter().map(|p| p.z).collect();
        let (overshoot, settle) = (overshoot_percent(&trace, 1.0), settle_s(&trace, 1.0));
        assert!(overshoot <= overshoot_limit, "overshoots by {overshoot} % with {vertical:?}");
        assert!((fastest_s..=slowest_s).contains(&settle), "settles in {settle} s with {vertical:?}");
    }
}

#[test]
fn a_horizontal_step_overshoots_by_at_most_8_percent() {
    for horizontal in [pid(0.94, 0.25, 1.5), pid(1.5, 0.3, 2.2)] {
        let gains = Gains { horizontal, ..Gains::of(Mode::Q2) };
        for direction in [Vector3::x(), -Vector3::y()] {
            let displacements_m = displacements(&Parameters::default(), &gains, direction * 3.0, 4000);
            let trace: Vec<f64> = displacements_m.iter().map(|p| p.dot(&direction)).collect();
            let (overshoot, settle) = (overshoot_percent(&trace, 3.0), settle_s(&trace, 3.0));
            assert!(overshoot <= 8.0, "overshoots by {overshoot} % with {horizontal:?}");
            assert!(settle < 10.0, "settles in {settle} s with {horizontal:?}");
        }
    }
}

#[test]
fn with_the_printed_law_the_position_loop_is_unstable() {
    let parameters = Parameters { formula_set: FormulaSet::Printed, ..Parameters::default() };
    let gains = Gains { roll_per_s: [7.0; 2], pitch_per_s: [7.0; 2], ..Gains::of(Mode::Q2) };
    let trace = displacements(&parameters, &gains, Vector3::x() * 3.0, 2000);
    assert!(trace[999].x < -20.0 && trace[1999].x < -60.0, "{} {}", trace[999].x, trace[1999].x);
}
