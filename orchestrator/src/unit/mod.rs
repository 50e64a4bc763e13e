//! Foreign units: their archives, their libraries, their instances, and the board that survives them.
//!
//! The importer's only unsafe code stands here. A number comes out of the step loop, crosses a function pointer in
//! [`instance`], and arrives in `fmus/<unit>/src/lib.rs` or in anybody else's unit.
#![allow(unsafe_code, reason = "libraries are foreign code, and the board is memory that another process maps")]

#[cfg(test)]
pub mod allocations;
pub mod archive;
pub mod board;
pub mod call_log;
pub mod describe;
pub mod error;
pub mod exit;
pub mod instance;
pub mod library;
pub mod logger;
mod variable_names;
