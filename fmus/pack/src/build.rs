//! Builds the library of a unit crate with cargo, so that equal sources give equal bytes whatever their path.

use crate::{PackError, UnitCrate};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The profile of units; passed on cargo's command line, so that a unit outside this repository needs none of its own.
/// Panics must unwind, because the export layer converts them to `fmi2Error`.
const PROFILE: [&str; 6] = [
    r#"profile.unit.inherits="release""#,
    "profile.unit.debug=false",
    r#"profile.unit.lto="thin""#,
    "profile.unit.codegen-units=1",
    "profile.unit.strip=true",
    r#"profile.unit.panic="unwind""#,
];

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

fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Builds the unit's library and returns its path. cargo's progress goes to standard error.
///
/// # Errors
/// If cargo cannot be started, the unit does not build, or it has no `cdylib` target.
pub fn build(unit: &UnitCrate) -> Result<PathBuf, PackError> {
    let mut command = cargo();
    command.args(["build", "--lib", "--profile", "unit", "--manifest-path"]).arg(unit.folder.join("Cargo.toml"));
    for setting in PROFILE {
        command.args(["--config", setting]);
    }
    command.arg("--target-dir").arg(unit.target_folder());
    command.env("CARGO_ENCODED_RUSTFLAGS", flags(unit)?.join("\u{1f}")).env_remove("RUSTFLAGS");
    command.stdin(Stdio::null()).stdout(Stdio::null());
    let status = command.status().map_err(PackError::NoCargo)?;
    if !status.success() {
        return Err(PackError::Build { unit: unit.name.clone() });
    }
    let library = unit.target_folder().join("unit").join(library_file(&unit.identifier()));
    library.is_file().then_some(library).ok_or_else(|| PackError::NoLibrary { unit: unit.name.clone() })
}

fn library_file(identifier: &str) -> String {
    format!("{}{identifier}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

/// Compiler flags that keep this machine's paths out of the library.
fn flags(unit: &UnitCrate) -> Result<Vec<String>, PackError> {
    let output = cargo()
        .args(["metadata", "--format-version", "1", "--manifest-path"])
        .arg(unit.folder.join("Cargo.toml"))
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .map_err(PackError::NoCargo)?;
    let metadata: Metadata =
        serde_json::from_slice(&output.stdout).map_err(|_| PackError::Build { unit: unit.name.clone() })?;
    Ok(remaps(&unit.workspace, &metadata.packages))
}

/// One remap for each folder of sources. rustc applies the last one that matches, so the longest are last.
fn remaps(workspace: &Path, packages: &[MetadataPackage]) -> Vec<String> {
    let mut folders = vec![(workspace.to_path_buf(), "workspace".to_owned())];
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
    let mut flags: Vec<_> = folders.into_iter().map(remap).collect();
    if cfg!(target_os = "linux") {
        flags.push("-Clink-arg=-Wl,--build-id=none".to_owned());
    }
    flags
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
            flags[..3],
            [
                "--remap-path-prefix=/home/a/.cargo/registry/src/index=registry",
                "--remap-path-prefix=/home/a/unit=workspace",
                "--remap-path-prefix=/opt/lockstep/fmus/fmu=fmu",
            ]
        );
    }
}
