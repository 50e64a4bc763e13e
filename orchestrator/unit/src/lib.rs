//! The importer: archives, libraries and instances of foreign units, and the board that outlives their process.
//!
//! All unsafe code of the importing side stands here. A number comes out of the step loop, crosses a function pointer in
//! [`instance`], and arrives in `fmus/<unit>/src/lib.rs` or in a unit of another origin.
#![allow(unsafe_code, reason = "libraries are foreign code, and the board is memory that another process maps")]

pub mod archive;
pub mod board;
pub mod call_log;
pub mod describe;
pub mod error;
pub mod exit;
pub mod failure;
pub mod instance;
pub mod library;
pub mod logger;
pub mod time;
mod variable_names;
