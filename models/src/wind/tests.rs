//! Wind at the vehicle: profile, rotation to the mean wind, gusts, counted samples.

use super::*;

fn inputs(mean: [f64; 3], height_m: f64) -> Inputs {
    Inputs {
        mean_world_m_s: Vector3::from(mean),
        vehicle_position_m: Vector3::new(0.0, 0.0, height_m),
        vehicle_velocity_m_s: Vector3::zeros(),
    }
}

fn turbulent() -> Parameters {
    Parameters { turbulence_m_s: 6.0, ..Parameters::default() }
}

#[test]
fn without_turbulence_a_uniform_wind_is_its_mean() {
    let (parameters, inputs) = (Parameters::default(), inputs([3.0, -1.0, 0.5], 20.0));
    let state = State::start(&parameters, &inputs, 1, 0);
    assert_eq!(state.velocity_world_m_s(&parameters, &inputs, &[], 5.0), inputs.mean_world_m_s);
}

#[test]
fn the_log_profile_is_the_mean_at_20_feet_and_grows_with_the_logarithm() {
    let parameters = Parameters { profile: Profile::Log, ..Parameters::default() };
    let speed = |height_m: f64| steady_world_m_s(&parameters, &inputs([5.0, 0.0, 0.0], height_m)).x;
    assert!((speed(6.096) - 5.0).abs() < 1e-12);
    assert!((speed(40.0) - speed(20.0) - (speed(20.0) - speed(10.0))).abs() < 1e-12);
    assert_eq!((speed(0.0), speed(1000.0)), (speed(1.0), speed(300.0)));
}

#[test]
fn turbulence_rotates_with_the_mean_wind() {
    let parameters = turbulent();
    let deviation = |mean: [f64; 3]| {
        let inputs = inputs(mean, 20.0);
        let mut state = State::start(&parameters, &inputs, 1, 0);
        state.draw(&parameters, &inputs, 50);
        state.velocity_world_m_s(&parameters, &inputs, &[], 0.5) - inputs.mean_world_m_s
    };
    let (east, north, calm) = (deviation([6.0, 0.0, 0.0]), deviation([0.0, 6.0, 0.0]), deviation([0.0; 3]));
    assert!((north - Vector3::new(-east.y, east.x, east.z)).norm() < 1e-14);
    assert!(calm.norm() > 0.1, "calm air may be turbulent too");
}

#[test]
fn samples_drawn_at_once_equal_samples_drawn_one_by_one() {
    let (parameters, inputs) = (turbulent(), inputs([6.0, 0.0, 0.0], 20.0));
    let after = |draws: &[u64]| {
        let mut state = State::start(&parameters, &inputs, 1, 0);
        draws.iter().for_each(|&samples| state.draw(&parameters, &inputs, samples));
        state
    };
    assert_eq!(after(&[3]), after(&[1, 0, 1, 1]));
    assert_ne!(after(&[3]), after(&[4]));
}

#[test]
fn the_field_passes_a_hovering_vehicle_at_wind_speed_but_at_least_at_1_m_s() {
    let parameters = turbulent();
    let after = |mean: [f64; 3], velocity: [f64; 3]| {
        let inputs = Inputs { vehicle_velocity_m_s: Vector3::from(velocity), ..inputs(mean, 20.0) };
        let mut state = State::start(&parameters, &inputs, 1, 0);
        state.draw(&parameters, &inputs, 10);
        state
    };
    assert_eq!(after([0.0; 3], [0.0; 3]), after([1.0, 0.0, 0.0], [0.0; 3]));
    assert_eq!(after([6.0, 0.0, 0.0], [0.0; 3]), after([1.0, 0.0, 0.0], [7.0, 0.0, 0.0]));
    assert_ne!(after([6.0, 0.0, 0.0], [0.0; 3]), after([1.0, 0.0, 0.0], [0.0; 3]));
}

#[test]
fn a_gust_rises_to_its_amplitude_and_falls_to_zero() {
    let gust = Gust { start_s: 10.0, duration_s: 4.0, amplitude_m_s: 3.0, direction_rad: core::f64::consts::FRAC_PI_2 };
    assert_eq!(gust.velocity_world_m_s(10.0), Vector3::zeros());
    assert_eq!(gust.velocity_world_m_s(14.0), Vector3::zeros());
    assert!((gust.velocity_world_m_s(12.0) - Vector3::new(0.0, 3.0, 0.0)).norm() < 1e-12);
    assert!((gust.velocity_world_m_s(11.0).y - 1.5).abs() < 1e-12);
    assert_eq!(Gust::default().velocity_world_m_s(0.0), Vector3::zeros());
}

#[test]
fn gusts_add_up() {
    let (parameters, inputs) = (Parameters::default(), inputs([1.0, 0.0, 0.0], 20.0));
    let gust = Gust { start_s: 0.0, duration_s: 2.0, amplitude_m_s: 3.0, direction_rad: 0.0 };
    let state = State::start(&parameters, &inputs, 1, 0);
    assert!((state.velocity_world_m_s(&parameters, &inputs, &[gust, gust], 1.0).x - 7.0).abs() < 1e-12);
}

#[test]
fn a_saved_wind_continues_bit_for_bit() {
    let (parameters, inputs) = (turbulent(), inputs([6.0, 1.0, 0.0], 20.0));
    let mut state = State::start(&parameters, &inputs, 1, 0);
    state.draw(&parameters, &inputs, 7);
    let mut restored: State = serde_json::from_str(&serde_json::to_string(&state).unwrap()).unwrap();
    state.draw(&parameters, &inputs, 43);
    restored.draw(&parameters, &inputs, 43);
    assert_eq!(restored, state);
}
