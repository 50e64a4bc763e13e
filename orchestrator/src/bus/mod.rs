//! The bus: instances in processes of their own, and whoever watches, over zenoh. The only place that names it.
//!
//! ```text
//! lockstep run --isolate ── coordinator: step loop, claims, trace ── remote (a `Worker` like any other), one for each
//!    │ starts, ends: fleet           │ orders: lockstep/<run>/do      ▲ replies: lockstep/<run>/done
//!    ▼                               ▼                                │
//! lockstep worker ── holds one instance: sets inputs, steps, gets outputs, nothing else ── worker_process
//! ```
//!
//! The worker listens on a socket in the run's private folder, the coordinator dials, and nobody else is spoken to. A
//! worker knows blocks of values and ticks; whatever the script says is computed in the coordinator, so that it cannot
//! differ by where an instance lives.

mod coordinator;
mod link;
pub mod watch;
pub mod wire;
mod worker;

pub use coordinator::{SUBCOMMAND, WorkerProcesses, WorkerSet, start_isolated};
pub use worker::{Address, serve};
