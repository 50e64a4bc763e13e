//! Unit crates and their workspace, read from `Cargo.toml` files without starting cargo.

use crate::PackError;
use crate::build::folder_in;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A package with `[package.metadata.fmu]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitCrate {
    /// The package's name, which is the name of the unit.
    pub name: String,
    /// The package's folder.
    pub folder: PathBuf,
    /// The folder of the workspace's `Cargo.toml`; the package's own if it is in none.
    pub workspace: PathBuf,
}

/// The cargo workspace that a folder is in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Workspace {
    /// The folder of its `Cargo.toml`.
    pub folder: PathBuf,
    /// Its unit crates, sorted by name.
    pub units: Vec<UnitCrate>,
}

#[derive(Deserialize)]
struct Manifest {
    package: Option<Package>,
    workspace: Option<WorkspaceTable>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    metadata: Option<toml::Table>,
}

#[derive(Deserialize)]
struct WorkspaceTable {
    #[serde(default)]
    members: Vec<String>,
}

fn read(manifest: &Path) -> Result<Manifest, PackError> {
    let text = std::fs::read_to_string(manifest).map_err(|source| PackError::File {
        path: manifest.to_path_buf(),
        doing: "read",
        source,
    })?;
    toml::from_str(&text)
        .map_err(|error| PackError::NoUnit { manifest: manifest.to_path_buf(), reason: error.message().to_owned() })
}

impl UnitCrate {
    /// Reads the unit crate in a folder.
    ///
    /// # Errors
    /// If there is no `Cargo.toml`, or it has no `[package.metadata.fmu]` table.
    pub fn at(folder: &Path) -> Result<Self, PackError> {
        let folder = &absolute(folder);
        let manifest = folder.join("Cargo.toml");
        let workspace = workspace_folder(folder)?.unwrap_or_else(|| folder.to_path_buf());
        Self::of(read(&manifest)?, folder, &workspace).ok_or_else(|| PackError::NoUnit {
            manifest,
            reason: "it needs a [package] with a [package.metadata.fmu] table".to_owned(),
        })
    }

    fn of(manifest: Manifest, folder: &Path, workspace: &Path) -> Option<Self> {
        let package = manifest.package?;
        package.metadata?.contains_key("fmu").then(|| Self {
            name: package.name,
            folder: folder.to_path_buf(),
            workspace: workspace.to_path_buf(),
        })
    }

    /// The target folder of builds of this unit: `CARGO_TARGET_DIR`, else `target` in the workspace.
    #[must_use]
    pub fn target_folder(&self) -> PathBuf {
        folder_in("CARGO_TARGET_DIR").unwrap_or_else(|| self.workspace.join("target"))
    }

    /// The default path of the packed unit.
    #[must_use]
    pub fn archive(&self) -> PathBuf {
        self.target_folder().join("fmus").join(format!("{}.fmu", self.name))
    }

    /// The name of the library, which is the model identifier.
    #[must_use]
    pub fn identifier(&self) -> String {
        self.name.replace('-', "_")
    }
}

impl Workspace {
    /// The workspace or single package that a folder is in; `None` outside of any.
    ///
    /// # Errors
    /// If a `Cargo.toml` in the folder or above it cannot be read.
    pub fn around(folder: &Path) -> Result<Option<Self>, PackError> {
        let folder = &absolute(folder);
        let Some(root) = workspace_folder(folder)? else { return Ok(None) };
        let manifest = read(&root.join("Cargo.toml"))?;
        let members = manifest.workspace.as_ref().map(|table| table.members.clone()).unwrap_or_default();
        let mut units: Vec<_> = UnitCrate::of(manifest, &root, &root).into_iter().collect();
        for folder in members.iter().flat_map(|member| member_folders(&root, member)) {
            if folder.join("Cargo.toml").is_file() {
                units.extend(UnitCrate::of(read(&folder.join("Cargo.toml"))?, &folder, &root));
            }
        }
        units.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(Some(Self { folder: root, units }))
    }
}

/// The folder by one path, so that two ways to write it are not taken for two folders.
fn absolute(folder: &Path) -> PathBuf {
    folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf())
}

/// The folder of the workspace's manifest above `folder`: the nearest `[workspace]`, else the nearest package.
pub(crate) fn workspace_folder(folder: &Path) -> Result<Option<PathBuf>, PackError> {
    let mut nearest = None;
    for above in folder.ancestors().filter(|above| above.join("Cargo.toml").is_file()) {
        if read(&above.join("Cargo.toml"))?.workspace.is_some() {
            return Ok(Some(above.to_path_buf()));
        }
        nearest.get_or_insert_with(|| above.to_path_buf());
    }
    Ok(nearest)
}

/// The folder of a workspace member, or all folders that a trailing `*` matches, in order of name.
fn member_folders(root: &Path, member: &str) -> Vec<PathBuf> {
    let Some(parent) = member.strip_suffix("/*") else { return vec![root.join(member)] };
    let entries = std::fs::read_dir(root.join(parent)).into_iter().flatten().flatten();
    let mut folders: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    folders
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(path: &Path, text: &str) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    fn example() -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        write(&root.path().join("Cargo.toml"), "[workspace]\nmembers = [\"tank\", \"more/*\"]\n");
        write(&root.path().join("tank/Cargo.toml"), "[package]\nname = \"tank\"\n[package.metadata.fmu]\n");
        write(&root.path().join("more/pump/Cargo.toml"), "[package]\nname = \"pump\"\n[package.metadata.fmu]\n");
        write(&root.path().join("more/plain/Cargo.toml"), "[package]\nname = \"plain\"\n");
        root
    }

    #[test]
    fn a_workspace_lists_the_members_that_are_units() {
        let root = example();
        let workspace = Workspace::around(&root.path().join("more/plain")).unwrap().unwrap();
        let names: Vec<_> = workspace.units.iter().map(|unit| unit.name.as_str()).collect();
        assert_eq!(names, ["pump", "tank"]);
        assert_eq!(workspace.folder, root.path());
    }

    #[test]
    fn a_package_without_the_table_is_not_a_unit() {
        let root = example();
        let error = UnitCrate::at(&root.path().join("more/plain")).unwrap_err().to_string();
        assert!(error.ends_with("it needs a [package] with a [package.metadata.fmu] table"), "{error}");
    }

    #[test]
    fn a_package_without_a_workspace_is_its_own_workspace() {
        let root = tempfile::tempdir().unwrap();
        write(&root.path().join("Cargo.toml"), "[package]\nname = \"solo\"\n[package.metadata.fmu]\n");
        let unit = UnitCrate::at(root.path()).unwrap();
        assert_eq!((unit.name.as_str(), unit.workspace.as_path()), ("solo", root.path()));
    }
}
