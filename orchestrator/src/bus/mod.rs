//! What goes over zenoh, which nothing outside of this folder names.

pub mod watch;
