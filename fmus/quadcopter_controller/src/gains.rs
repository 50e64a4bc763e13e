//! The gains of one mode as ports.

use fmu::Group;
use models::quadcopter_controller::Mode;
use serde::{Deserialize, Serialize};

/// Gains of one mode
#[derive(Group, Clone, Copy, Serialize, Deserialize)]
pub(crate) struct Gains {
    /// Roll: gains of the angle's and of the rate's error
    #[port(unit = "1/s", min = 0.0)]
    roll: [f64; 2],
    /// Pitch: gains of the angle's and of the rate's error
    #[port(unit = "1/s", min = 0.0)]
    pitch: [f64; 2],
    /// Yaw: gains of the angle's and of the rate's error
    #[port(unit = "1/s", min = 0.0)]
    yaw: [f64; 2],
    /// Along z
    #[port]
    vertical: Pid,
    /// Along x and y
    #[port]
    horizontal: Pid,
}

/// Gains of a position loop
#[derive(Group, Clone, Copy, Serialize, Deserialize)]
struct Pid {
    /// Force for each metre of error
    #[port(unit = "N/m", min = 0.0)]
    proportional: f64,
    /// Force for each metre of error that lasts a second
    #[port(unit = "N/m/s", min = 0.0)]
    integral: f64,
    /// Force for each metre per second of error
    #[port(unit = "N*s/m", min = 0.0)]
    derivative: f64,
}

impl Gains {
    /// The gains that a mode starts with.
    pub(crate) fn of(mode: Mode) -> Self {
        let gains = models::quadcopter_controller::Gains::of(mode);
        let pid = |pid: models::quadcopter_controller::Pid| Pid {
            proportional: pid.proportional_n_m,
            integral: pid.integral_n_m_s,
            derivative: pid.derivative_n_s_m,
        };
        Self {
            roll: gains.roll_per_s,
            pitch: gains.pitch_per_s,
            yaw: gains.yaw_per_s,
            vertical: pid(gains.vertical),
            horizontal: pid(gains.horizontal),
        }
    }
}

impl From<Gains> for models::quadcopter_controller::Gains {
    fn from(gains: Gains) -> Self {
        let pid = |pid: Pid| models::quadcopter_controller::Pid {
            proportional_n_m: pid.proportional,
            integral_n_m_s: pid.integral,
            derivative_n_s_m: pid.derivative,
        };
        Self {
            roll_per_s: gains.roll,
            pitch_per_s: gains.pitch,
            yaw_per_s: gains.yaw,
            vertical: pid(gains.vertical),
            horizontal: pid(gains.horizontal),
        }
    }
}
