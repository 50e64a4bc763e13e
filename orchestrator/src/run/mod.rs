//! A run: from initialization over each tick to verdicts, on workers that hold the instances.

pub mod board_observer;
pub mod exercise;
pub mod home;
pub mod instantiate;
pub mod interruption;
pub mod message;
mod pace;
pub mod prepared_run;
pub mod run_options;
pub mod run_spec;
pub mod start_values;
pub mod step_loop;
pub mod stepping;
pub mod worker;
