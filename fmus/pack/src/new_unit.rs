//! Writes a crate for a unit of the user's own, in a workspace that further units can join.
//!
//! An empty folder becomes a workspace with the unit as its first member; in a workspace the unit becomes a member; in any
//! other folder the crate is its own workspace.

use crate::unit_crate::{UnitCrate, workspace_folder};
use crate::{PackError, cargo_settings};
use fmi2::printable;
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};

/// A message with what the user can do about it.
pub type Refusal = (String, Option<String>);

/// What a package or type of a unit cannot be called: the names of Rust, its libraries, and the dependencies.
const TAKEN: [&str; 61] = [
    "abstract",
    "alloc",
    "as",
    "async",
    "await",
    "become",
    "box",
    "break",
    "const",
    "continue",
    "core",
    "crate",
    "do",
    "dyn",
    "else",
    "enum",
    "extern",
    "false",
    "final",
    "fmi2",
    "fmu",
    "fn",
    "for",
    "gen",
    "if",
    "impl",
    "in",
    "let",
    "libm",
    "loop",
    "macro",
    "match",
    "mod",
    "move",
    "mut",
    "override",
    "priv",
    "proc_macro",
    "pub",
    "ref",
    "return",
    "self",
    "serde",
    "static",
    "std",
    "struct",
    "super",
    "test",
    "trait",
    "true",
    "try",
    "type",
    "typeof",
    "unsafe",
    "unsized",
    "use",
    "virtual",
    "where",
    "while",
    "yield",
    "nalgebra",
];

/// Types that the crate's source or Rust's prelude already names.
const TYPES: [&str; 25] = [
    "Box",
    "Clone",
    "Context",
    "Copy",
    "Default",
    "Deserialize",
    "Drop",
    "Eq",
    "Err",
    "Fault",
    "Fmu",
    "Model",
    "None",
    "Ok",
    "Option",
    "Outcome",
    "Result",
    "Send",
    "Serialize",
    "Some",
    "Step",
    "String",
    "Sync",
    "ToOwned",
    "Vec",
];

/// A new unit as it was written.
#[derive(Debug)]
pub struct NewUnit {
    /// Its crate.
    pub unit: UnitCrate,
    /// What the user still has to do, if anything.
    pub note: Option<String>,
}

/// Writes the crate of a unit into a new folder of `current`; it depends on the crate `fmu` at this path.
///
/// # Errors
/// The name cannot be that of a unit, the folder is already there, or a file cannot be written.
pub fn new_unit(name: &str, fmu: &Path, current: &Path) -> Result<NewUnit, Refusal> {
    check_name(name)?;
    let fmu = fmu_folder(fmu)?;
    let folder = current.join(name);
    if folder.exists() {
        let message = format!("{} is already there", printable::path(Path::new(name)));
        return Err((message, Some("choose another name".to_owned())));
    }
    let around = workspace_folder(current).map_err(|error| (error.to_string(), None))?;
    let workspace = match around {
        Some(workspace) => {
            join_workspace(&workspace, &folder)?;
            Some(workspace)
        }
        None if is_empty(current) => {
            write(&current.join("Cargo.toml"), &format!("[workspace]\nresolver = \"3\"\nmembers = [\"{name}\"]\n"))?;
            Some(current.to_path_buf())
        }
        None => None,
    };
    let own_workspace = "\n# A workspace of its own, wherever the folder lies.\n[workspace]\n";
    let author = std::env::var("USER").ok().filter(|user| !user.is_empty()).unwrap_or_else(|| "the author".to_owned());
    let fill = |template: &str| {
        let workspace = if workspace.is_some() { "" } else { own_workspace };
        let filled = [("{{name}}", name), ("{{Type}}", &type_name(name)), ("{{workspace}}\n", workspace)];
        let filled = filled.iter().fold(template.to_owned(), |text, (mark, value)| text.replace(mark, value));
        filled.replace("{{fmu}}", &toml_text(&fmu)).replace("{{author}}", &toml_text(&printable::line(&author)))
    };
    let files = [
        ("Cargo.toml".to_owned(), include_str!("new_unit/Cargo.toml.in")),
        ("src/lib.rs".to_owned(), include_str!("new_unit/lib.rs.in")),
        ("README.md".to_owned(), include_str!("new_unit/README.md.in")),
        (format!("{name}.scn"), include_str!("new_unit/unit.scn.in")),
    ];
    for (file, template) in files {
        write(&folder.join(file), &fill(template))?;
    }
    let root = workspace.unwrap_or_else(|| folder.clone());
    let unit = UnitCrate { name: name.to_owned(), folder, workspace: root };
    let note = share_builds(&unit, Path::new(&fmu))?;
    Ok(NewUnit { unit, note })
}

fn check_name(name: &str) -> Result<(), Refusal> {
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let help = "small letters, digits and `_`, a letter first, for example my_tank".to_owned();
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.chars().all(allowed) {
        return Err((format!("`{}` cannot be the name of a unit", printable::line(name)), Some(help)));
    }
    if TAKEN.contains(&name) {
        let message = format!("`{name}` cannot be the name of a unit: it is a word of Rust or the name of a library");
        return Err((message, Some(format!("for example my_{name}"))));
    }
    Ok(())
}

/// The unit's struct: the name in camel case, which must not hide another type.
fn type_name(name: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters.next().map_or_else(String::new, |first| first.to_ascii_uppercase().to_string() + letters.as_str())
    };
    let camel: String = name.split('_').map(capital).collect();
    if TYPES.contains(&camel.as_str()) { format!("{camel}Unit") } else { camel }
}

/// An absolute path, so that the new crate may be moved.
fn fmu_folder(folder: &Path) -> Result<String, Refusal> {
    let found = folder.canonicalize().ok().filter(|folder| folder.join("Cargo.toml").is_file());
    let found = found.ok_or_else(|| {
        let help = "name the folder fmus/fmu of a Lockstep checkout: --fmu PATH".to_owned();
        (format!("there is no crate `fmu` in {}", printable::path(folder)), Some(help))
    })?;
    let text = found.to_str().filter(|text| printable::line(text) == *text).map(str::to_owned);
    text.ok_or_else(|| {
        (format!("a Cargo.toml cannot name {}", printable::path(&found)), Some("rename the folder".to_owned()))
    })
}

/// Whether a folder has nothing that a user made; what begins with a dot does not count.
fn is_empty(folder: &Path) -> bool {
    let hidden = |name: &std::ffi::OsStr| name.to_string_lossy().starts_with('.');
    fs::read_dir(folder)
        .is_ok_and(|mut entries| entries.all(|entry| entry.is_ok_and(|entry| hidden(&entry.file_name()))))
}

#[derive(Deserialize)]
struct RootManifest {
    workspace: Option<WorkspaceTable>,
}

#[derive(Deserialize)]
struct WorkspaceTable {
    members: Option<toml::Spanned<Vec<String>>>,
}

/// Adds a folder to the members of a workspace, unless they include it by a pattern.
fn join_workspace(workspace: &Path, folder: &Path) -> Result<(), Refusal> {
    let path = workspace.join("Cargo.toml");
    let member = folder.strip_prefix(workspace).unwrap_or(folder).to_string_lossy().replace('\\', "/");
    let by_hand = || {
        let help = format!("add {member:?} to the members of its [workspace], then try again");
        (format!("{} does not say which members it has", printable::path(&path)), Some(help))
    };
    let text = fs::read_to_string(&path).map_err(|error| cannot("read", &path, &error))?;
    let manifest: RootManifest = toml::from_str(&text).map_err(|_| by_hand())?;
    let Some(table) = manifest.workspace else {
        let message = format!("{} is the manifest of one package", printable::path(&path));
        let help = "start the unit in another folder, or make this one a workspace: write [workspace] there".to_owned();
        return Err((message, Some(help)));
    };
    let Some(members) = table.members else {
        let with_members = text.replacen("[workspace]", &format!("[workspace]\nmembers = [{member:?}]"), 1);
        return if with_members == text { Err(by_hand()) } else { write(&path, &with_members) };
    };
    let parent = Path::new(&member).parent().map(|parent| parent.join("*").to_string_lossy().into_owned());
    if members.get_ref().iter().any(|known| *known == member || Some(known) == parent.as_ref()) {
        return Ok(());
    }
    let end = members.span().end.saturating_sub(1);
    let (before, after) = text.split_at_checked(end).ok_or_else(by_hand)?;
    let before = before.trim_end();
    let comma = if before.ends_with(['[', ',']) { "" } else { "," };
    let gap = if before.ends_with('[') { "" } else { " " };
    write(&path, &format!("{before}{comma}{gap}{member:?}{after}"))
}

/// Lets `cargo test` share the dependencies that `lockstep pack` builds, in the versions of the checkout that `fmu` is in.
/// Without cargo this is left out; the note says so.
fn share_builds(unit: &UnitCrate, fmu: &Path) -> Result<Option<String>, Refusal> {
    let lock = unit.workspace.join("Cargo.lock");
    if !lock.exists()
        && let Some(tested) = fmu.ancestors().map(|folder| folder.join("Cargo.lock")).find(|file| file.is_file())
    {
        fs::copy(tested, &lock).map_err(|error| cannot("write", &lock, &error))?;
    }
    let ignored = unit.workspace.join(".gitignore");
    if !ignored.exists() {
        write(&ignored, "/target\n/runs\n/.cargo/config.toml\n")?;
    }
    let settings = unit.workspace.join(".cargo/config.toml");
    if settings.exists() {
        return Ok(None);
    }
    match cargo_settings(unit) {
        Ok(text) => write(&settings, &text).map(|()| None),
        Err(error) => {
            let help = error.help().map_or_else(String::new, |help| format!("\nhelp: {help}"));
            Ok(Some(format!("the unit is written, but it cannot be built yet: {error}{help}")))
        }
    }
}

fn write(path: &Path, text: &str) -> Result<(), Refusal> {
    let written = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(path, text));
    written.map_err(|error| cannot("write", path, &error))
}

fn cannot(doing: &'static str, path: &Path, source: &std::io::Error) -> Refusal {
    let source = std::io::Error::new(source.kind(), source.to_string());
    (PackError::File { path: path.to_path_buf(), doing, source }.to_string(), None)
}

/// A printable path between the quotes of a TOML text.
fn toml_text(path: &str) -> String {
    path.replace('\\', "\\\\").replace('"', "\\\"")
}

/// The files of a new unit that a user opens first, relative to the folder in which it was begun.
#[must_use]
pub fn first_files(name: &str) -> [PathBuf; 2] {
    [format!("{name}/src/lib.rs"), format!("{name}/{name}.scn")].map(PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_becomes_a_type_that_hides_no_other() {
        assert_eq!(type_name("my_tank2"), "MyTank2");
        assert_eq!(type_name("result"), "ResultUnit");
    }

    #[test]
    fn names_that_no_crate_can_have_are_refused() {
        for name in ["", "My", "2tanks", "a-b", "../up", "struct", "self", "fmu", "std"] {
            assert!(check_name(name).is_err(), "{name}");
        }
        assert!(check_name("my_tank2").is_ok());
    }

    fn joined(manifest: &str, folder: &str) -> Result<String, Refusal> {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("Cargo.toml");
        fs::write(&path, manifest).unwrap();
        join_workspace(root.path(), &root.path().join(folder)).map(|()| fs::read_to_string(&path).unwrap())
    }

    #[test]
    fn a_unit_joins_the_members_of_its_workspace() {
        for (before, after) in [
            ("[workspace]\nmembers = [\"a\"]\n", "[workspace]\nmembers = [\"a\", \"b\"]\n"),
            ("[workspace]\nmembers = [\n    \"a\",\n]\n", "[workspace]\nmembers = [\n    \"a\", \"b\"]\n"),
            ("[workspace]\nmembers = []\n", "[workspace]\nmembers = [\"b\"]\n"),
            ("[workspace]\n", "[workspace]\nmembers = [\"b\"]\n"),
            ("[workspace]\nmembers = [\"*\"]\n", "[workspace]\nmembers = [\"*\"]\n"),
        ] {
            assert_eq!(joined(before, "b").unwrap(), after);
        }
        assert_eq!(joined("[workspace]\nmembers = []\n", "units/b").unwrap(), "[workspace]\nmembers = [\"units/b\"]\n");
    }

    #[test]
    fn the_manifest_of_one_package_is_not_changed() {
        let (message, help) = joined("[package]\nname = \"a\"\n", "b").unwrap_err();
        assert!(message.ends_with("is the manifest of one package"), "{message}");
        assert!(help.is_some());
    }
}
