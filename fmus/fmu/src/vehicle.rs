//! Groups of ports shared by all vehicles, their controllers, sensors and environments.
//!
//! World frame: east, north, up. Body frame: forward, left, up.

use crate::Group;
use nalgebra::{Quaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Where a vehicle is and how it moves.
#[derive(Group, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Position, world frame
    #[port(unit = "m")]
    pub position: Vector3<f64>,
    /// Attitude, from the body to the world frame
    #[port(unit = "1")]
    pub attitude: Quaternion<f64>,
    /// Velocity, world frame
    #[port(unit = "m/s")]
    pub velocity: Vector3<f64>,
    /// Angular rate, body frame
    #[port(unit = "rad/s")]
    pub rate: Vector3<f64>,
}

/// The part of a vehicle's state that its surroundings need.
#[derive(Group, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Position, world frame
    #[port(unit = "m")]
    pub position: Vector3<f64>,
    /// Velocity, world frame
    #[port(unit = "m/s")]
    pub velocity: Vector3<f64>,
}

/// What a vehicle should do.
#[derive(Group, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setpoint {
    /// Position, world frame
    #[port(unit = "m")]
    pub position: Vector3<f64>,
    /// Velocity, world frame
    #[port(unit = "m/s")]
    pub velocity: Vector3<f64>,
    /// Acceleration, world frame
    #[port(unit = "m/s^2")]
    pub acceleration: Vector3<f64>,
    /// Heading, counter-clockwise from east
    #[port(unit = "rad")]
    pub yaw: f64,
}
