//! The types and rules of FMI 2.0.5 for co-simulation, shared by the exporter and the importer.
//!
//! - [`c`]: the C types of the three header files, and the status values.
//! - [`calls`]: which call is allowed in which state, as one table.
//! - [`description`]: `modelDescription.xml` as a data structure, with a reader, a writer and a checker.
//! - [`platform`]: the folders of an archive with the libraries of this platform.
//! - [`printable`]: names, paths and messages from outside, safe to print.
//! - [`units`]: units of measure as exponents of the SI base units, factor and offset.
//!
//! Next on the path of a value: `dsl/src/resolve`, which looks names up in the [`description`].
#![forbid(unsafe_code)]

#[cfg(feature = "description")]
pub mod c;
#[cfg(feature = "description")]
pub mod calls;
#[cfg(feature = "description")]
pub mod description;
pub mod platform;
pub mod printable;
pub mod units;
