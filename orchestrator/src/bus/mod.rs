//! The bus: worker processes and live values over zenoh; no other folder names zenoh.
//!
//! ```text
//! lockstep run --isolate: `coordinator/` holds step loop, claims and trace; for each worker a `Remote` (a `Worker`)
//!    │ starts, ends: WorkerProcesses │ orders: lockstep/<run>/do      ▲ replies: lockstep/<run>/done
//!    ▼                               ▼                                │
//! lockstep worker: `worker/` holds instances: sets inputs, steps, gets outputs, nothing else
//! ```
//!
//! The worker listens on a socket in the run's private folder and the coordinator connects to it; neither opens any other
//! connection. A worker knows blocks of values and ticks only. All that the script says is computed in the coordinator, so
//! that results cannot depend on the process that an instance lives in.

mod coordinator;
mod link;
pub mod watch;
pub mod wire;
mod worker;

pub use coordinator::{SUBCOMMAND, WorkerProcesses, WorkerSet, start_isolated};
pub use worker::{Address, serve};
