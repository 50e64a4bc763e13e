//! State and setpoint of any vehicle at one instant.

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Position, attitude and motion of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// Centre of gravity, world axes.
    pub position_m: Vector3<f64>,
    /// Rotation of body vectors into world vectors.
    pub attitude: UnitQuaternion<f64>,
    /// Velocity over the ground, world axes.
    pub velocity_world_m_s: Vector3<f64>,
    /// Angular velocity, body axes.
    pub rate_body_rad_s: Vector3<f64>,
}

/// Desired position, motion and heading of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Setpoint {
    /// Position, world axes.
    pub position_m: Vector3<f64>,
    /// Velocity, world axes.
    pub velocity_m_s: Vector3<f64>,
    /// Acceleration, world axes.
    pub acceleration_m_s2: Vector3<f64>,
    /// Heading, counter-clockwise from x.
    pub yaw_rad: f64,
}

impl Setpoint {
    /// Returns the setpoint at rest at `position_m` with the heading along x.
    #[must_use]
    pub fn hold(position_m: Vector3<f64>) -> Self {
        Self { position_m, velocity_m_s: Vector3::zeros(), acceleration_m_s2: Vector3::zeros(), yaw_rad: 0.0 }
    }
}
