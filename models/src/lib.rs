//! The mathematics of Lockstep's units as pure functions: no FMI, file, clock, thread or network.
//!
//! **Frames.** The world is x east, y north, z up; the body is x forward, y left, z up (ROS REP 103). All frames are
//! right-handed. An attitude is the unit quaternion that turns body vectors into world vectors,
//! `v_world = attitude * v_body`; for people it is roll, pitch, yaw with `R = Rz(yaw) Ry(pitch) Rx(roll)`, so positive
//! pitch is nose down. The models compute in these frames; [`frames`] says how a paper's frame is laid upon them.
//!
//! **Units.** SI and radians. The unit stands in the name: `velocity_world_m_s`, `rate_body_rad_s`, `mass_kg`.
//!
//! **Time and chance.** Time comes in as an argument. Randomness comes from a seeded [`random::Generator`] that is part
//! of a model's state, so that a saved state continues with the same numbers. Transcendental functions are `libm`'s:
//! the same bits on every machine.
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
