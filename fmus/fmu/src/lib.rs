//! Write a struct, get an FMI 2.0 co-simulation FMU.
//!
//! The path of a value: an importer's `fmi2SetReal` passes through [`export!`] and [`abi`] to the slots of an instance,
//! the author's [`Model::step`] computes outputs from inputs, `fmi2GetReal` reads them. Next on the path: the model
//! itself, in crate `models`.
#![doc = include_str!("../README.md")]

extern crate self as fmu;

pub mod abi;
mod body;
mod declaration;
mod describe;
mod export;
#[cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64", target_pointer_width = "64"))]
mod glibc;
mod instance;
mod library;
mod log;
mod model;
mod port;
mod port_types;
mod refusal;
mod saved;
mod slots;
mod step;
pub mod testing;
mod values;
pub mod vehicle;
mod visitor;

pub use declaration::{Declaration, Experiment, Ports, Role};
pub use fmi2;
pub use fmu_derive::{FmiEnum, Fmu, Group};
pub use library::{Library, Package};
pub use model::{Context, Fault, Model, Outcome};
pub use models::random;
pub use nalgebra;
pub use port::{FmiEnum, NoBound, Port};
pub use step::{Parts, Samples, Step};
pub use visitor::Visitor;
