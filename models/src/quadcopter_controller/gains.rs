//! Gains of the four modes of Geng & Chulin (2016): q1 take-off and landing, q2 calm, q3 moderate wind, q4 emergency.
//!
//! The paper names the modes and gives no numbers; these are this project's.

use serde::{Deserialize, Serialize};

/// A mode of the controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Mode {
    /// Take-off and landing: little overshoot.
    Q1,
    /// Flight in calm air and light wind.
    #[default]
    Q2,
    /// Flight in moderate wind.
    Q3,
    /// Emergency termination.
    Q4,
}

/// Gains of a controller with proportional, integral and derivative part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pid {
    /// K_p.
    pub proportional_n_m: f64,
    /// K_i.
    pub integral_n_m_s: f64,
    /// K_d.
    pub derivative_n_s_m: f64,
}

/// Gains of all loops.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gains {
    /// k₁, k₂ of the roll.
    pub roll_per_s: [f64; 2],
    /// k₅, k₆ of the pitch.
    pub pitch_per_s: [f64; 2],
    /// k₃, k₄ of the yaw.
    pub yaw_per_s: [f64; 2],
    /// Position control along z.
    pub vertical: Pid,
    /// Position control along x and y.
    pub horizontal: Pid,
}

impl Gains {
    /// Returns the gains of a mode.
    #[must_use]
    pub fn of(mode: Mode) -> Self {
        let pid = |proportional_n_m, integral_n_m_s, derivative_n_s_m| Pid {
            proportional_n_m,
            integral_n_m_s,
            derivative_n_s_m,
        };
        let (tilt_per_s, yaw_per_s, vertical) = match mode {
            Mode::Q1 => ([6.0, 8.0], [3.0, 3.0], pid(4.1, 0.4, 3.2)),
            Mode::Q2 => ([10.0, 10.0], [3.0, 3.0], pid(8.0, 2.0, 4.5)),
            Mode::Q3 => ([14.0, 14.0], [4.0, 4.0], pid(8.0, 2.0, 4.5)),
            Mode::Q4 => ([8.0, 10.0], [2.0, 2.0], pid(4.1, 0.8, 3.2)),
        };
        Self { roll_per_s: tilt_per_s, pitch_per_s: tilt_per_s, yaw_per_s, vertical, horizontal: pid(0.94, 0.25, 1.5) }
    }
}
