//! The outer loop against its vector and its limits.

use super::*;
use crate::frames::{attitude_from_geng_chulin_angles, vector_from_geng_chulin, vector_to_geng_chulin};
use crate::quadcopter_controller::Mode;
use crate::vectors::{assert_all_close, assert_close, get, number, numbers, vector3};
use nalgebra::UnitQuaternion;

fn still_at(position_m: Vector3<f64>) -> vehicle::State {
    vehicle::State {
        position_m,
        attitude: UnitQuaternion::identity(),
        velocity_world_m_s: Vector3::zeros(),
        rate_body_rad_s: Vector3::zeros(),
    }
}

/// Force and integral after one sample of 5 ms from rest at the origin.
fn demand(goal_m: [f64; 3]) -> (Vector3<f64>, Vector3<f64>) {
    let mut integral_n = Vector3::zeros();
    let force_n = demanded_force_n(
        &Parameters::default(),
        &Gains::of(Mode::Q2),
        &still_at(Vector3::zeros()),
        &vehicle::Setpoint::hold(Vector3::from(goal_m)),
        &mut integral_n,
        0.005,
    );
    (force_n, integral_n)
}

#[test]
fn force_angles_and_integral_equal_those_of_the_vector() {
    let expected = get("outer");
    let x = numbers(&get("quad_deriv")["x"]);
    let ours = |from: usize| vector_from_geng_chulin(Vector3::from_column_slice(&x[from..from + 3]));
    let vehicle = vehicle::State {
        position_m: ours(0),
        attitude: attitude_from_geng_chulin_angles([x[6], x[7], x[8]]),
        velocity_world_m_s: ours(3),
        rate_body_rad_s: ours(9),
    };
    let setpoint = vehicle::Setpoint {
        position_m: vector_from_geng_chulin(vector3(&expected["pd"])),
        velocity_m_s: vector_from_geng_chulin(vector3(&expected["vd"])),
        acceleration_m_s2: vector_from_geng_chulin(vector3(&expected["ad"])),
        yaw_rad: 0.0,
    };
    let mut integral_n = vector_from_geng_chulin(vector3(&expected["I0"]));
    let (parameters, gains) = (Parameters::default(), Gains::of(Mode::Q2));
    let force_n = demanded_force_n(&parameters, &gains, &vehicle, &setpoint, &mut integral_n, number(&expected["dt"]));
    let (roll, pitch) = desired_roll_pitch_rad(force_n, x[6]);
    assert_close(force_n.norm(), number(&expected["P"]), 1e-9);
    assert_close(roll, number(&expected["gamma_d"]), 1e-9);
    assert_close(-pitch, number(&expected["theta_d"]), 1e-9);
    assert_all_close(vector_to_geng_chulin(integral_n).as_slice(), &numbers(&expected["I1"]), 1e-9);
}

#[test]
fn the_desired_angles_turn_the_thrust_along_the_force() {
    for yaw in [-2.0, 0.0, 0.4, 3.0] {
        for force in [[0.0, 0.0, 6.0], [2.0, -1.0, 6.0], [-3.0, 2.5, 4.0]] {
            let force_n = Vector3::from(force);
            let (roll, pitch) = desired_roll_pitch_rad(force_n, yaw);
            let up = UnitQuaternion::from_euler_angles(roll, pitch, yaw) * Vector3::z();
            assert!((up * force_n.norm() - force_n).norm() < 1e-12);
        }
    }
}

#[test]
fn the_tilt_of_the_force_is_limited_and_its_heading_kept() {
    let (force_n, integral_n) = demand([30.0, -40.0, 0.0]);
    let tilt = libm::atan2(force_n.xy().norm(), force_n.z);
    assert!((tilt - 25.0_f64.to_radians()).abs() < 1e-12);
    assert!((force_n.x * 4.0 + force_n.y * 3.0).abs() < 1e-12 && force_n.x > 0.0);
    assert_eq!(integral_n, Vector3::zeros());
}

#[test]
fn the_vertical_force_stays_between_0_3_and_1_8_weights() {
    let weight_n = 0.65 * 9.81;
    assert!((demand([0.0, 0.0, 100.0]).0.z - 1.8 * weight_n).abs() < 1e-12);
    assert!((demand([0.0, 0.0, -100.0]).0.z - 0.3 * weight_n).abs() < 1e-12);
}

#[test]
fn integrals_grow_near_the_goal_only() {
    let (_, near) = demand([0.5, 0.0, 0.2]);
    assert!((near - Vector3::new(0.25 * 0.5, 0.0, 2.0 * 0.2) * 0.005).norm() < 1e-15);
    assert_eq!(demand([1.0, 0.0, 0.3]).1, Vector3::zeros());
}

#[test]
fn no_integral_grows_beyond_3_newton() {
    let mut integral_n = Vector3::zeros();
    for _ in 0..10_000 {
        demanded_force_n(
            &Parameters::default(),
            &Gains::of(Mode::Q2),
            &still_at(Vector3::zeros()),
            &vehicle::Setpoint::hold(Vector3::new(0.5, -0.5, 0.2)),
            &mut integral_n,
            0.1,
        );
    }
    assert_eq!((integral_n.x, integral_n.y), (3.0, -3.0));
    assert!(integral_n.z > 2.9 && integral_n.z <= 3.0);
}
