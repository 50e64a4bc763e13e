//! From a scenario to what the step loop works on: values in flat arrays, programs, the order of steps, claims.

pub mod claims;
pub mod columns;
pub mod expression;
pub mod values;
pub mod wiring;
