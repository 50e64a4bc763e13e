//! The importer: archives, libraries and instances of units, and the board that outlives their process.
//!
//! All unsafe code of the importing side is in this crate, also that which concerns processes. A value leaves the step
//! loop, passes through a function pointer in [`instance`], and arrives in `fmus/<unit>/src/lib.rs` or in a unit of another
//! vendor.
#![allow(unsafe_code, reason = "libraries are foreign code, and the board is memory that another process maps")]

pub mod archive;
pub mod board;
pub mod call_log;
pub mod describe;
pub mod descriptors;
pub mod error;
pub mod exit;
pub mod failure;
pub mod handles;
pub mod instance;
pub mod library;
pub mod logger;
pub mod process;
pub mod process_state;
pub mod time;
mod variable_names;
