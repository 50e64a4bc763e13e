//! The processes of a run on this machine: the parent that supervises it and writes its files, and the child that steps.

pub mod child;
pub mod execution;
pub mod orphan;
pub mod supervise;
pub mod unit_tests;
pub mod watchdog;
