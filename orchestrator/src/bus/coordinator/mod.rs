//! The coordinator's side: worker processes, their initialization, orders to them, and the causes of their failures.

mod hang_monitor;
mod isolated;
mod remote;
mod worker_processes;
mod worker_set;

pub use isolated::start_isolated;
pub use worker_processes::{SUBCOMMAND, WorkerProcesses};
pub use worker_set::WorkerSet;
