//! Support for tests of the whole program: the `lockstep` binary, the repository's folders, and checks of house style.
#![forbid(unsafe_code)]

pub mod flight;
pub mod foreign;
pub mod program;
pub mod stand_ins;
pub mod tidy;
