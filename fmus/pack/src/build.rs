//! Builds the library of a unit crate with cargo, so that equal sources give equal bytes whatever their path.
//!
//! One build of the dependencies serves all units of a user: the folder of builds, the profile and the compiler flags do
//! not depend on the unit. [`cargo_settings`] gives the same to `cargo test`.

use crate::{PackError, UnitCrate};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The profile of units, in the place of cargo's `dev`, so that `cargo test` can share its dependencies.
/// Panics must unwind, because the export layer converts them to `fmi2Error`.
const PROFILE: [(&str, &str); 11] = [
    ("opt-level", "3"),
    // Half of the build's time are these two. The first describes the unit, once for each instance; of the second the generic
    // code, which is compiled where it is used, is what counts.
    ("package.fmi2.opt-level", "0"),
    ("package.nalgebra.codegen-units", "16"),
    ("debug", "false"),
    ("strip", "true"),
    ("lto", "\"off\""),
    ("codegen-units", "1"),
    ("incremental", "false"),
    ("debug-assertions", "false"),
    ("overflow-checks", "false"),
    ("panic", "\"unwind\""),
];

/// The folder of that profile's results in a target folder.
const PROFILE_FOLDER: &str = "debug";

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<MetadataPackage>,
}

#[derive(Deserialize)]
struct MetadataPackage {
    name: String,
    manifest_path: PathBuf,
    source: Option<String>,
}

/// A unit's library that cargo has built. Until this value is dropped, no other program builds in its folder.
pub(crate) struct Built {
    /// The library.
    pub library: PathBuf,
    /// cargo's list of the sources that it was built from.
    pub sources: PathBuf,
    _lock: std::fs::File,
}

fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Builds the unit's library. cargo's progress goes to standard error.
pub(crate) fn build(unit: &UnitCrate) -> Result<Built, PackError> {
    let metadata = metadata(unit)?;
    let target = build_folder(unit, &metadata.packages);
    let folder = target.join(PROFILE_FOLDER);
    let lock = lock(&target)?;
    let library = folder.join(library_file(&unit.identifier()));
    claim(unit, &folder, &library)?;
    let mut command = cargo();
    command.args(["build", "--lib", "--manifest-path"]).arg(unit.folder.join("Cargo.toml"));
    for (key, value) in PROFILE {
        command.arg("--config").arg(format!("profile.dev.{key}={value}"));
    }
    command.arg("--target-dir").arg(&target).env_remove("CARGO_INCREMENTAL");
    command.env("CARGO_ENCODED_RUSTFLAGS", flags(unit, &metadata.packages).join("\u{1f}")).env_remove("RUSTFLAGS");
    command.stdin(Stdio::null()).stdout(Stdio::null());
    let status = command.status().map_err(PackError::NoCargo)?;
    if !status.success() {
        return Err(PackError::Build { unit: unit.name.clone() });
    }
    if !library.is_file() {
        return Err(PackError::NoLibrary { unit: unit.name.clone() });
    }
    Ok(Built { library, sources: folder.join(format!("lib{}.d", unit.identifier())), _lock: lock })
}

/// Waits until no other program builds units in this folder. cargo has a lock of its own, but frees it before the library
/// is read.
fn lock(target: &Path) -> Result<std::fs::File, PackError> {
    let path = target.join("lockstep.lock");
    let failed = |source| PackError::File { path: path.clone(), doing: "lock", source };
    std::fs::create_dir_all(target).map_err(failed)?;
    let file = std::fs::File::create(&path).map_err(failed)?;
    file.lock().map_err(failed)?;
    Ok(file)
}

/// Removes a library of the same name that another unit left: cargo names a `cdylib` by its crate alone, and would take
/// that file for the unit's own.
fn claim(unit: &UnitCrate, folder: &Path, library: &Path) -> Result<(), PackError> {
    let owner = folder.join(format!("{}.unit", unit.identifier()));
    let own = unit.folder.to_string_lossy();
    if std::fs::read(&owner).is_ok_and(|written| written == own.as_bytes()) {
        return Ok(());
    }
    let built = folder.join("deps").join(library_file(&unit.identifier()));
    for file in [library, &built] {
        match std::fs::remove_file(file) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(PackError::File { path: file.to_path_buf(), doing: "replace", source: error });
            }
            _ => {}
        }
    }
    let failed = |source| PackError::File { path: owner.clone(), doing: "write", source };
    std::fs::create_dir_all(folder).map_err(failed)?;
    std::fs::write(&owner, own.as_bytes()).map_err(failed)
}

fn library_file(identifier: &str) -> String {
    format!("{}{identifier}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

/// The settings of cargo, `.cargo/config.toml`, with which `cargo test` of a unit shares the dependencies that
/// [`pack`](crate::pack()) has built.
///
/// # Errors
/// If cargo cannot be started or cannot read the unit's manifest.
pub fn cargo_settings(unit: &UnitCrate) -> Result<String, PackError> {
    let metadata = metadata(unit)?;
    let quoted = |text: &str| format!("{text:?}");
    let flags: Vec<_> = flags(unit, &metadata.packages).iter().map(|flag| format!("    {},\n", quoted(flag))).collect();
    let target = build_folder(unit, &metadata.packages);
    let profile: Vec<_> = PROFILE.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
    Ok(format!(
        "# One build of the dependencies serves `cargo test`, `lockstep run` and `lockstep pack` of all units.\n\
         # These are paths of this machine: keep the file out of version control.\n\
         [build]\ntarget-dir = {}\nrustflags = [\n{}]\n\n[profile.dev]\n{}",
        quoted(&target.to_string_lossy()),
        flags.concat(),
        profile.concat()
    ))
}

fn metadata(unit: &UnitCrate) -> Result<Metadata, PackError> {
    let output = cargo()
        .args(["metadata", "--format-version", "1", "--manifest-path"])
        .arg(unit.folder.join("Cargo.toml"))
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .map_err(PackError::NoCargo)?;
    serde_json::from_slice(&output.stdout).map_err(|_| PackError::Build { unit: unit.name.clone() })
}

/// Where cargo builds the unit: in its workspace if that has the crate `fmu` too, as Lockstep's own has; else in a folder
/// that all workspaces of the user share.
fn build_folder(unit: &UnitCrate, packages: &[MetadataPackage]) -> PathBuf {
    let of_workspace = packages.iter().any(|package| {
        package.name == "fmu" && package.source.is_none() && package.manifest_path.starts_with(&unit.workspace)
    });
    let not_empty = |name: &str| std::env::var_os(name).filter(|folder| !folder.is_empty()).map(PathBuf::from);
    let cache = || not_empty("XDG_CACHE_HOME").or_else(|| Some(not_empty("HOME")?.join(".cache")));
    let shared = if of_workspace || not_empty("CARGO_TARGET_DIR").is_some() { None } else { cache() };
    shared.map_or_else(|| unit.target_folder().join("units"), |cache| cache.join("lockstep/units"))
}

/// Compiler flags that keep this machine's paths out of the library. They do not depend on the unit: cargo passes the
/// sources of its own workspace by relative paths.
fn flags(unit: &UnitCrate, packages: &[MetadataPackage]) -> Vec<String> {
    let mut flags = remaps(&unit.workspace, packages);
    if cfg!(target_os = "linux") {
        flags.push("-Clink-arg=-Wl,--build-id=none".to_owned());
    }
    if cfg!(all(target_os = "linux", target_env = "gnu")) {
        // Before glibc 2.34 functions of threads were in a library of their own, which a program without threads has not
        // loaded.
        flags.push("-Clink-arg=-Wl,--push-state,--no-as-needed,-l:libpthread.so.0,--pop-state".to_owned());
    }
    flags
}

/// One remap for each folder of sources outside of the workspace. rustc applies the last one that matches, so the longest
/// are last.
fn remaps(workspace: &Path, packages: &[MetadataPackage]) -> Vec<String> {
    let mut folders = Vec::new();
    for package in packages {
        let Some(folder) = package.manifest_path.parent() else { continue };
        match package.source {
            None if !folder.starts_with(workspace) => folders.push((folder.to_path_buf(), package.name.clone())),
            Some(_) => {
                if let Some(registry) = folder.parent() {
                    folders.push((registry.to_path_buf(), "registry".to_owned()));
                }
            }
            None => {}
        }
    }
    folders.sort();
    folders.dedup();
    let remap = |(from, to): (PathBuf, String)| format!("--remap-path-prefix={}={to}", from.display());
    folders.into_iter().map(remap).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_sources_are_remapped() {
        let package = |name: &str, path: &str, source: Option<&str>| MetadataPackage {
            name: name.to_owned(),
            manifest_path: PathBuf::from(path),
            source: source.map(str::to_owned),
        };
        let flags = remaps(
            Path::new("/home/a/unit"),
            &[
                package("tank", "/home/a/unit/Cargo.toml", None),
                package("fmu", "/opt/lockstep/fmus/fmu/Cargo.toml", None),
                package("serde", "/home/a/.cargo/registry/src/index/serde-1.0.0/Cargo.toml", Some("registry")),
            ],
        );
        assert_eq!(
            flags,
            [
                "--remap-path-prefix=/home/a/.cargo/registry/src/index=registry",
                "--remap-path-prefix=/opt/lockstep/fmus/fmu=fmu",
            ],
            "nothing of the unit's own workspace"
        );
    }
}
