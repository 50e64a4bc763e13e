//! Ground contact: a vehicle below z = 0 is put back to z = 0, stops sinking, slides to a stop and levels out.
//!
//! ```text
//! z < 0:  z ← 0,  v_z ← max(v_z, 0),  (v_x, v_y, ω) ← 0.9ⁿ (v_x, v_y, ω),  (roll, pitch) ← 0.98ⁿ (roll, pitch)
//! ```
//!
//! | Symbol | Here          | Unit | Meaning                              |
//! |--------|---------------|------|--------------------------------------|
//! | n      | `duration_s`  | 1    | inner step in units of 2.5 ms        |
//!
//! The ground is the plane z = 0; contact is that of the centre of gravity. It replaces landing gear and friction and
//! does not model them; the powers make it independent of the inner step. The formula is this project's.

use nalgebra::UnitQuaternion;

use crate::vehicle;

const REFERENCE_STEP_S: f64 = 0.0025;

/// Applies the contact after an inner step of `duration_s`.
pub fn settle(body: &mut vehicle::State, duration_s: f64) {
    if body.position_m.z >= 0.0 {
        return;
    }
    let exponent = duration_s / REFERENCE_STEP_S;
    let (friction, levelling) = (libm::pow(0.9, exponent), libm::pow(0.98, exponent));
    body.position_m.z = 0.0;
    let velocity = &mut body.velocity_world_m_s;
    velocity.x *= friction;
    velocity.y *= friction;
    velocity.z = velocity.z.max(0.0);
    body.rate_body_rad_s *= friction;
    let (roll, pitch, yaw) = body.attitude.euler_angles();
    body.attitude = UnitQuaternion::from_euler_angles(levelling * roll, levelling * pitch, yaw);
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    fn sunk() -> vehicle::State {
        vehicle::State {
            position_m: Vector3::new(1.0, 2.0, -0.01),
            attitude: UnitQuaternion::from_euler_angles(0.1, -0.2, 0.7),
            velocity_world_m_s: Vector3::new(1.0, -1.0, -2.0),
            rate_body_rad_s: Vector3::new(0.1, 0.2, 0.3),
        }
    }

    #[test]
    fn contact_stops_the_fall_and_keeps_the_heading() {
        let mut body = sunk();
        settle(&mut body, 0.0025);
        assert_eq!(body.position_m, Vector3::new(1.0, 2.0, 0.0));
        assert_eq!(body.velocity_world_m_s, Vector3::new(0.9, -0.9, 0.0));
        let (roll, pitch, yaw) = body.attitude.euler_angles();
        assert!((roll - 0.098).abs() < 1e-12 && (pitch + 0.196).abs() < 1e-12 && (yaw - 0.7).abs() < 1e-12);
    }

    #[test]
    fn two_half_steps_brake_like_one_whole_step() {
        let (mut once, mut twice) = (sunk(), sunk());
        settle(&mut once, 0.0025);
        for _ in 0..2 {
            twice.position_m.z = -0.01;
            settle(&mut twice, 0.00125);
        }
        assert!((once.velocity_world_m_s - twice.velocity_world_m_s).norm() < 1e-15);
        assert!(once.attitude.angle_to(&twice.attitude) < 1e-7);
    }

    #[test]
    fn above_the_ground_the_state_is_unchanged() {
        let mut body = sunk();
        body.position_m.z = 0.0;
        let before = body;
        settle(&mut body, 0.0025);
        assert_eq!(body, before);
    }
}
