//! Builds a unit crate with cargo and packs it as an `.fmu` file, reproducibly; writes new unit crates.
//!
//! ```text
//! new_unit ─▶ Cargo.toml ─ unit_crate ─▶ build (cargo, profile of our own) ─▶ describe (the caller loads the library) ─▶ portability ─▶ archive
//! ```
//!
//! A unit crate is a package with a `[package.metadata.fmu]` table and a `cdylib` target. Two clones at different paths
//! give the same bytes: paths are remapped, entries are sorted, dates are fixed.
//!
//! This crate runs no code of a unit: the caller of [`pack`] passes a function that reads the description of a library.
#![forbid(unsafe_code)]

mod archive;
mod build;
mod error;
mod new_unit;
mod portability;
mod stale;
mod unit_crate;

pub use error::PackError;
pub use new_unit::{NewUnit, new_unit};
pub use stale::is_stale;
pub use unit_crate::{UnitCrate, Workspace};

use std::path::Path;

/// Reads `modelDescription.xml` from a unit's library.
pub type Describe<'a> = &'a dyn Fn(&Path) -> Result<String, String>;

/// Tells the user something while a unit is packed: that it waits, or what the unit needs of a system.
pub type Say<'a> = &'a dyn Fn(&str);

/// Builds a unit and packs it into `archive`.
///
/// # Errors
/// If cargo, the library's description, a rule of the standard, or writing the file fails.
pub fn pack(unit: &UnitCrate, describe: Describe<'_>, archive: &Path, say: Say<'_>) -> Result<(), PackError> {
    let built = build::build(unit, say)?;
    let library = std::fs::read(&built.library).map_err(|source| PackError::File {
        path: built.library.clone(),
        doing: "read",
        source,
    })?;
    let description =
        describe(&built.library).map_err(|reason| PackError::Describe { unit: unit.name.clone(), reason })?;
    let newer =
        portability::newer_glibc(&library).map_err(|reason| PackError::Library { unit: unit.name.clone(), reason })?;
    archive::write(unit, &library, &description, archive)?;
    if archive == unit.archive() {
        let list = stale::source_list(archive);
        std::fs::copy(&built.sources, &list).map_err(|source| PackError::File {
            path: list,
            doing: "write",
            source,
        })?;
    }
    portability::warning(&unit.name, &newer).iter().for_each(|warning| say(warning));
    Ok(())
}
