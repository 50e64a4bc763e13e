//! The command line of Lockstep.
fn main() {}
