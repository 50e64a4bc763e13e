//! Builds the library of a unit crate with cargo, so that equal sources give equal bytes whatever their path.
//!
//! One build of the dependencies serves all units of a user: the folder of builds, the profile and the compiler flags do
//! not depend on the unit. [`cargo_settings`] gives the same to `cargo test`.

use crate::{PackError, Say, UnitCrate};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The profile of units, in the place of cargo's `dev`, so that `cargo test` can share its dependencies.
/// Panics must unwind, because the export layer converts them to `fmi2Error`.
const PROFILE: [(&str, &str); 11] = [
    ("opt-level", "3"),
    // Half of the build's time are these two. The first describes the unit, once for its first instance; of the second the
    // generic code, which is compiled where it is used, is what counts.
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

/// A unit's library that cargo has built. Until this value is dropped, no other Lockstep builds in its folder.
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
pub(crate) fn build(unit: &UnitCrate, say: Say<'_>) -> Result<Built, PackError> {
    let metadata = metadata(unit)?;
    let target = build_folder(unit, &metadata.packages);
    let folder = target.join(PROFILE_FOLDER);
    let lock = lock(&target, say)?;
    let library = folder.join(library_file(&unit.identifier()));
    let owner = Owner { file: folder.join(format!("{}.unit", unit.identifier())), unit: &unit.folder };
    owner.remove_what_others_left(&library)?;
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
    owner.note(&library)?;
    Ok(Built { library, sources: folder.join(format!("lib{}.d", unit.identifier())), _lock: lock })
}

/// Waits until no other Lockstep builds units in this folder. cargo has a lock of its own, but frees it before the library is
/// read.
fn lock(target: &Path, say: Say<'_>) -> Result<std::fs::File, PackError> {
    let path = target.join("lockstep.lock");
    let failed = |source| PackError::File { path: path.clone(), doing: "lock", source };
    std::fs::create_dir_all(target).map_err(failed)?;
    let file = std::fs::File::create(&path).map_err(failed)?;
    if file.try_lock().is_err() {
        say("waiting for another build of units");
        file.lock().map_err(failed)?;
    }
    Ok(file)
}

/// The note beside a library that says which unit it was built from. cargo names a `cdylib` by its crate alone: it would take
/// the library of another unit of the same name for the unit's own.
struct Owner<'a> {
    file: PathBuf,
    unit: &'a Path,
}

impl Owner<'_> {
    /// The unit's folder with the size and time of the library.
    fn text(&self, library: &Path) -> Option<String> {
        let metadata = std::fs::metadata(library).ok()?;
        let modified = metadata.modified().ok()?.duration_since(std::time::UNIX_EPOCH).ok()?;
        Some(format!("{}\n{} bytes\n{} ns\n", self.unit.display(), metadata.len(), modified.as_nanos()))
    }

    /// Removes the library, so that cargo builds it anew, unless the note says that it is this unit's and was left as it is.
    fn remove_what_others_left(&self, library: &Path) -> Result<(), PackError> {
        let noted = std::fs::read_to_string(&self.file).ok();
        if noted.is_some() && noted == self.text(library) {
            return Ok(());
        }
        let name = library.file_name().unwrap_or_default();
        let built = library.parent().map(|folder| folder.join("deps").join(name));
        for file in [Some(library.to_path_buf()), built].into_iter().flatten() {
            match std::fs::remove_file(&file) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    return Err(PackError::File { path: file, doing: "replace", source });
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn note(&self, library: &Path) -> Result<(), PackError> {
        let text = self.text(library).unwrap_or_default();
        std::fs::write(&self.file, text).map_err(|source| PackError::File {
            path: self.file.clone(),
            doing: "write",
            source,
        })
    }
}

fn library_file(identifier: &str) -> String {
    format!("{}{identifier}{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

/// The settings of cargo, `.cargo/config.toml`, with which `cargo test` of a unit shares the dependencies that
/// [`pack`](crate::pack()) has built.
pub(crate) fn cargo_settings(unit: &UnitCrate) -> Result<String, PackError> {
    let metadata = metadata(unit)?;
    let flags = flags(unit, &metadata.packages);
    let flags: Vec<_> = flags.iter().map(|flag| format!("    {},\n", toml_text(flag))).collect();
    let target = build_folder(unit, &metadata.packages);
    let profile: Vec<_> = PROFILE.iter().map(|(key, value)| format!("{key} = {value}\n")).collect();
    Ok(format!(
        "# One build of the dependencies serves `cargo test`, `lockstep run` and `lockstep pack` of all units.\n\
         # These are paths of this machine: keep the file out of version control.\n\
         [build]\ntarget-dir = {}\nrustflags = [\n{}]\n\n[profile.dev]\n{}",
        toml_text(&target.to_string_lossy()),
        flags.concat(),
        profile.concat()
    ))
}

/// A text in TOML, with its quotes.
pub(crate) fn toml_text(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if letter.is_control() => quoted.push_str(&format!("\\u{:04X}", u32::from(letter))),
            letter => quoted.push(letter),
        }
    }
    quoted + "\""
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
    let cache = || folder_in("XDG_CACHE_HOME").or_else(|| Some(folder_in("HOME")?.join(".cache")));
    let shared = if of_workspace || folder_in("CARGO_TARGET_DIR").is_some() { None } else { cache() };
    shared.map_or_else(|| unit.target_folder().join("units"), |cache| cache.join("lockstep/units"))
}

/// The folder that an environment variable names, if any.
pub(crate) fn folder_in(variable: &str) -> Option<PathBuf> {
    std::env::var_os(variable).filter(|folder| !folder.is_empty()).map(PathBuf::from)
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
    fn a_toml_text_is_read_as_it_was() {
        for text in ["plain", r#"a "b" \c"#, "a\u{301}\t", "\u{7f}"] {
            let table: toml::Table = toml::from_str(&format!("key = {}", toml_text(text))).unwrap();
            assert_eq!(table["key"].as_str(), Some(text));
        }
    }

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
