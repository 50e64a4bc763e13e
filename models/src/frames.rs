//! Conversions between the frames of the papers and ours, one function for each kind of quantity.
//!
//! ```text
//! Geng & Chulin (2016): x forward, y up, z right      ours = (x, -z, y)
//! roll = γ, pitch = -θ, yaw = ψ                        R = Ry(ψ) Rz(θ) Rx(γ) there, Rz(yaw) Ry(pitch) Rx(roll) here
//! ```
//!
//! | Symbol | Here        | Unit | Meaning                                        |
//! |--------|-------------|------|------------------------------------------------|
//! | ψ      | `angles[0]` | rad  | about y (up), positive to the left             |
//! | θ      | `angles[1]` | rad  | about z, positive nose up                      |
//! | γ      | `angles[2]` | rad  | about x, positive right side down              |
//!
//! Both frames are right-handed and share x, so one quarter turn about x converts world and body vectors: positions,
//! velocities, rates, moments, and the vector part of quaternions. Source: Geng & Chulin (2016), eq. 10. There the
//! element in row 2, column 3 is printed `+cos θ sin γ`; that matrix is not orthogonal, and `-cos θ sin γ` is meant.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Converts a vector of Geng & Chulin (2016) to our axes, world to world or body to body.
#[must_use]
pub fn vector_from_geng_chulin(theirs: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(theirs.x, -theirs.z, theirs.y)
}

/// Converts a vector in our axes to those of Geng & Chulin (2016), world to world or body to body.
#[must_use]
pub fn vector_to_geng_chulin(ours: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(ours.x, ours.z, -ours.y)
}

/// Converts the attitude (body to world) of Geng & Chulin (2016) to ours.
#[must_use]
pub fn attitude_from_geng_chulin(theirs: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let imaginary = vector_from_geng_chulin(theirs.imag());
    UnitQuaternion::new_unchecked(Quaternion::from_parts(theirs.w, imaginary))
}

/// Converts the angles (ψ, θ, γ) of Geng & Chulin (2016) to our attitude.
#[must_use]
pub fn attitude_from_geng_chulin_angles(angles: [f64; 3]) -> UnitQuaternion<f64> {
    let [psi, theta, gamma] = angles;
    UnitQuaternion::from_euler_angles(gamma, -theta, psi)
}

/// Converts our attitude to the angles (ψ, θ, γ) of Geng & Chulin (2016).
#[must_use]
pub fn angles_to_geng_chulin(attitude: &UnitQuaternion<f64>) -> [f64; 3] {
    let (roll, pitch, yaw) = attitude.euler_angles();
    [yaw, -pitch, roll]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vectors::{assert_all_close, get, numbers, vector3};
    use nalgebra::{Matrix3, Rotation3};

    fn angles() -> [f64; 3] {
        numbers(&get("frames")["paper_q"]["psi_theta_gamma"]).try_into().unwrap()
    }

    #[test]
    fn a_vector_keeps_its_direction_in_space() {
        let frames = &get("frames")["paper_q"];
        let (theirs, ours) = (vector3(&frames["vector"]), vector3(&frames["vector_ours"]));
        assert_eq!(vector_from_geng_chulin(theirs), ours);
        assert_eq!(vector_to_geng_chulin(ours), theirs);
    }

    #[test]
    fn angles_convert_to_the_attitude_of_the_vectors_and_back() {
        let frames = &get("frames")["paper_q"];
        let attitude = attitude_from_geng_chulin_angles(angles());
        let (roll, pitch, yaw) = attitude.euler_angles();
        assert_all_close(&[roll, pitch, yaw], &numbers(&frames["roll_pitch_yaw_ours"]), 1e-14);
        assert_all_close(&angles_to_geng_chulin(&attitude), &angles(), 1e-14);
        let wxyz = [attitude.w, attitude.i, attitude.j, attitude.k];
        assert_all_close(&wxyz, &numbers(&frames["q_wxyz_ours"]), 1e-14);
        let rotation = attitude.to_rotation_matrix();
        for row in 0..3 {
            let expected = numbers(&frames["R_world_from_body_ours"][row]);
            assert_all_close(rotation.matrix().row(row).transpose().as_slice(), &expected, 1e-14);
        }
    }

    #[test]
    fn the_rotation_equals_that_of_the_corrected_equation_10() {
        let to_ours = Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(vector_from_geng_chulin));
        let ours = attitude_from_geng_chulin_angles(angles()).to_rotation_matrix();
        let theirs = to_ours.transpose() * ours.matrix() * to_ours;
        for row in 0..3 {
            let expected = numbers(&get("R_psi.3_theta-.2_gamma.5")[row]);
            assert_all_close(theirs.row(row).transpose().as_slice(), &expected, 1e-14);
        }
    }

    #[test]
    fn the_quaternion_and_the_angles_of_the_paper_convert_to_the_same_attitude() {
        let [psi, theta, gamma] = angles();
        let theirs = Rotation3::from_axis_angle(&Vector3::y_axis(), psi)
            * Rotation3::from_axis_angle(&Vector3::z_axis(), theta)
            * Rotation3::from_axis_angle(&Vector3::x_axis(), gamma);
        let from_quaternion = attitude_from_geng_chulin(UnitQuaternion::from_rotation_matrix(&theirs));
        assert!(from_quaternion.angle_to(&attitude_from_geng_chulin_angles(angles())) < 1e-14);
    }
}
