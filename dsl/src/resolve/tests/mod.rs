//! Tests of the resolver: what scripts mean, and every error as a user sees it.

mod claims;
mod completeness;
mod connections;
mod differences;
mod events;
mod fixtures;
mod initial;
mod limits;
mod loader;
mod meaning;
mod measures;
mod names;
mod shared;
mod times;
mod types;
mod undeclared;
mod unit_names;
mod whole;

pub(in crate::resolve) use fixtures::description;
