//! Converts a scenario to what the step loop works on: flat arrays of values, programs, the order of steps, claims.

#![forbid(unsafe_code)]

pub mod claims;
pub mod columns;
pub mod event_words;
pub mod expression;
pub mod graph;
pub mod listing;
pub mod running;
pub mod unit_page;
pub mod values;
pub mod variable_text;
pub mod wiring;
