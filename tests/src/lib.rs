//! What the whole-program tests stand on: the `lockstep` binary, the repository's folders, and the habits of the house.
#![forbid(unsafe_code)]

pub mod flight;
pub mod foreign;
pub mod program;
pub mod tidy;
