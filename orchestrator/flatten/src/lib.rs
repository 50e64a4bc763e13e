//! Converts a scenario to what the step loop works on: flat arrays of values, programs, the order of steps, claims.

#![forbid(unsafe_code)]

pub mod claims;
pub mod columns;
pub mod expression;
pub mod graph;
pub mod running;
pub mod values;
pub mod wiring;
