//! Longer flights in closed loop: hover in strong wind, the flight A to H in calm and in turbulent air.

use super::*;
use crate::quadcopter::{self, GroundTurbulence, Inputs};
use crate::vehicle::Setpoint;
use crate::{trajectory, wind};

const SAMPLE_TIME_S: f64 = 0.005;

#[test]
fn a_hover_keeps_its_position_in_8_m_s_of_wind() {
    let plant = quadcopter::Parameters::default();
    let start_m = Vector3::new(0.0, 0.0, 20.0);
    let mut state = quadcopter::State::start(&plant, start_m, Vector3::zeros(), 0.0, true);
    let mut controller = State::default();
    let (mut horizontal_m, mut vertical_m) = (0.0_f64, 0.0_f64);
    for _ in 0..8000 {
        let command = controller.sample(
            &Parameters::default(),
            &Gains::of(Mode::Q2),
            &state.body,
            &Setpoint::hold(start_m),
            SAMPLE_TIME_S,
        );
        let inputs = Inputs {
            rotor_command_rad_s: command.rotor_speed_rad_s,
            wind_world_m_s: Vector3::new(8.0, 0.0, 0.0),
            effectiveness: [1.0; 4],
        };
        state.advance(&plant, &inputs, SAMPLE_TIME_S, &mut GroundTurbulence::new(1, 4));
        let error_m = state.body.position_m - start_m;
        horizontal_m = horizontal_m.max(error_m.xy().norm());
        vertical_m = vertical_m.max(error_m.z.abs());
    }
    let error_m = (state.body.position_m - start_m).norm();
    let tilt_deg = libm::acos((state.body.attitude * Vector3::z()).z).to_degrees();
    let rotor_rad_s = state.rotor_speed_rad_s.iter().sum::<f64>() / 4.0;
    assert!(error_m < 0.02 * 1.2, "error {error_m}");
    assert!((tilt_deg / 7.09 - 1.0).abs() <= 0.2, "tilt {tilt_deg}");
    assert!((rotor_rad_s / 185.8 - 1.0).abs() <= 0.2, "rotors {rotor_rad_s}");
    assert!(horizontal_m <= 0.44 * 1.2 && vertical_m <= 0.21 * 1.2, "transient {horizontal_m} {vertical_m}");
}

/// Largest distance from the setpoint in m over the flight A to H, its largest tilt in degrees, and the final state.
fn fly_a_to_h(mean_m_s: f64, turbulence_m_s: f64) -> (f64, f64, quadcopter::State) {
    let plant = quadcopter::Parameters::default();
    let flight = trajectory::Parameters::default();
    let air = wind::Parameters { turbulence_m_s, ..wind::Parameters::default() };
    let mut state = quadcopter::State::start(&plant, Vector3::zeros(), Vector3::zeros(), 0.0, false);
    let mut turbulence = GroundTurbulence::new(1, 4);
    let mut controller = State::default();
    let around = |body: &vehicle::State| wind::Inputs {
        mean_world_m_s: Vector3::new(mean_m_s, 0.0, 0.0),
        vehicle_position_m: body.position_m,
        vehicle_velocity_m_s: body.velocity_world_m_s,
    };
    let mut field = wind::State::start(&air, &around(&state.body), 1, 0);
    let (mut largest_m, mut largest_tilt_deg) = (0.0_f64, 0.0_f64);
    for n in 0..16_800 {
        let time_s = f64::from(n) * SAMPLE_TIME_S;
        let setpoint = flight.reference(time_s).setpoint;
        let command =
            controller.sample(&Parameters::default(), &Gains::of(Mode::Q2), &state.body, &setpoint, SAMPLE_TIME_S);
        let wind_inputs = around(&state.body);
        let inputs = Inputs {
            rotor_command_rad_s: command.rotor_speed_rad_s,
            wind_world_m_s: field.velocity_world_m_s(&air, &wind_inputs, &[], time_s),
            effectiveness: [1.0; 4],
        };
        field.draw(&air, &wind_inputs, u64::from(n % 2 == 1));
        state.advance(&plant, &inputs, SAMPLE_TIME_S, &mut turbulence);
        let goal_m = flight.reference(time_s + SAMPLE_TIME_S).setpoint.position_m;
        largest_m = largest_m.max((state.body.position_m - goal_m).norm());
        largest_tilt_deg = largest_tilt_deg.max(libm::acos((state.body.attitude * Vector3::z()).z).to_degrees());
    }
    (largest_m, largest_tilt_deg, state)
}

#[test]
fn the_flight_a_to_h_in_calm_air_stays_near_its_setpoint_and_ends_on_the_last_point() {
    let (largest_m, largest_tilt_deg, end) = fly_a_to_h(0.0, 0.0);
    assert!(largest_m < 0.8, "{largest_m}");
    assert!(largest_tilt_deg < 35.0, "{largest_tilt_deg}");
    assert!((end.body.position_m - Vector3::new(33.5, -70.0, 0.0)).norm() < 0.1, "{end:?}");
}

#[test]
fn the_flight_a_to_h_in_light_turbulent_wind_stays_within_80_cm() {
    let (largest_m, largest_tilt_deg, end) = fly_a_to_h(3.5, 3.5);
    assert!(largest_m < 0.8, "{largest_m}");
    assert!(largest_tilt_deg < 35.0, "{largest_tilt_deg}");
    assert!(end.body.position_m.z < 0.1, "{end:?}");
}
