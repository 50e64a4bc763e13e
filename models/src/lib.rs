//! The mathematics of Lockstep's units as pure functions: no FMI, file, clock, thread or network.
//!
//! **Frames.** The world is x east, y north, z up; the body is x forward, y left, z up (ROS REP 103). All frames are
//! right-handed. An attitude is the unit quaternion that rotates body vectors into world vectors,
//! `v_world = attitude * v_body`; it is shown as roll, pitch, yaw with `R = Rz(yaw) Ry(pitch) Rx(roll)`, so positive
//! pitch is nose down. The models compute in these frames; [`frames`] converts from and to the frame of a paper.
//!
//! **Units.** SI and radians. The unit is part of the name: `velocity_world_m_s`, `rate_body_rad_s`, `mass_kg`.
//!
//! **Time and randomness.** Time is an argument. Random numbers come from a seeded [`random::Generator`] that is part
//! of a model's state, so that a saved state continues with the same numbers. Transcendental functions are those of
//! `libm`, which give the same bits on every machine.
//!
//! Every source that a comment cites has its entry in `REFERENCES.md` beside `src/`.
#![forbid(unsafe_code)]

pub mod frames;
pub mod random;

pub mod vehicle;

pub mod quadcopter;
pub mod quadcopter_controller;
pub mod trajectory;
pub mod wind;

#[cfg(test)]
mod vectors;
