//! Tests of the resolver: what scripts mean, and every error as a user sees it.
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod broken;
mod claims;
mod columns;
mod completeness;
mod connections;
mod curves;
mod differences;
mod elaborate;
mod events;
mod fixtures;
mod gates;
mod initial;
mod limits;
mod loader;
mod meaning;
mod measures;
mod mutations;
mod names;
mod running;
mod shared;
mod sweeps;
mod times;
mod types;
mod undeclared;
mod unit_names;
mod units;
mod whole;
