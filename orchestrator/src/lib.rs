//! Runs scenarios: loads units, steps them in lockstep, judges claims and writes the results.
//!
//! ```text
//! lockstep run ── parent: finds units, checks the script, writes every file, prints everything ── supervise
//!    │  specification (standard input) ▲ rows, messages, claims, the call in progress (board, mapped by both)
//!    ▼                                 │
//! lockstep step-loop ── child: worker ── units ── step loop ── claims
//! ```
//!
//! With `--isolate` the loop is a thread of the parent and each unit has a worker process, see [`bus`]. Whatever a unit does
//! to its process, the parent still has the rows, the log messages and the call in progress.

#![forbid(unsafe_code)]

#[cfg(feature = "bus")]
pub mod bus;
pub mod cli;
#[cfg(test)]
mod example;
pub mod find;
pub mod host;
pub mod run;
