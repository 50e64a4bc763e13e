//! Writes a crate for a unit of the user's own, in a workspace that further units can join.
//!
//! An empty folder becomes a workspace with the unit as its first member; in a workspace the unit becomes a member; in any
//! other folder the crate is its own workspace.

use crate::PackError;
use crate::build::{cargo_settings, toml_text};
use crate::unit_crate::{UnitCrate, workspace_folder};
use fmi2::printable;
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};

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

/// Where a new crate stands.
enum Place {
    /// In a workspace that was there.
    Joined(PathBuf),
    /// In a workspace that is made with it.
    Made(PathBuf),
    /// In a workspace of its own.
    Alone,
}

/// Writes the crate of a unit into a new folder of `current`; it depends on the crate `fmu` at this path.
///
/// # Errors
/// The name cannot be that of a unit, the folder is already there, or a file cannot be written.
pub fn new_unit(name: &str, fmu: &Path, current: &Path) -> Result<NewUnit, PackError> {
    check_name(name)?;
    let fmu = fmu_folder(fmu)?;
    let folder = current.join(name);
    if folder.exists() {
        let message = format!("{} is already there", printable::path(Path::new(name)));
        return Err(refusal(message, Some("choose another name".to_owned())));
    }
    let place = match workspace_folder(current)? {
        Some(workspace) => Place::Joined(workspace),
        None if is_empty(current) => Place::Made(current.to_path_buf()),
        None => Place::Alone,
    };
    let joined = match &place {
        Place::Joined(workspace) => with_member(workspace, &folder)?,
        _ => None,
    };
    write_crate(name, &fmu, &folder, matches!(place, Place::Alone))?;
    let (workspace, note) = match place {
        Place::Joined(workspace) => {
            if let Some(manifest) = joined {
                write(&workspace.join("Cargo.toml"), &manifest)?;
            }
            (workspace, None)
        }
        Place::Made(workspace) => {
            let manifest = format!("[workspace]\nresolver = \"3\"\nmembers = [{}]\n", toml_text(name));
            write(&workspace.join("Cargo.toml"), &manifest)?;
            let unit = UnitCrate { name: name.to_owned(), folder: folder.clone(), workspace: workspace.clone() };
            (workspace, share_builds(&unit, Path::new(&fmu))?)
        }
        Place::Alone => {
            let unit = UnitCrate { name: name.to_owned(), folder: folder.clone(), workspace: folder.clone() };
            (folder.clone(), share_builds(&unit, Path::new(&fmu))?)
        }
    };
    Ok(NewUnit { unit: UnitCrate { name: name.to_owned(), folder, workspace }, note })
}

fn write_crate(name: &str, fmu: &str, folder: &Path, alone: bool) -> Result<(), PackError> {
    let own_workspace = "\n# A workspace of its own, wherever the folder lies.\n[workspace]\n";
    let author = std::env::var("USER").ok().filter(|user| !user.is_empty()).unwrap_or_else(|| "the author".to_owned());
    let marks = [
        ("{{name}}", name),
        ("{{Type}}", &type_name(name)),
        ("{{workspace}}\n", if alone { own_workspace } else { "" }),
        ("{{fmu}}", &toml_text(fmu)),
        ("{{author}}", &toml_text(&printable::line(&author))),
    ];
    let fill = |template: &str| marks.iter().fold(template.to_owned(), |text, (mark, value)| text.replace(mark, value));
    let files = [
        ("Cargo.toml".to_owned(), include_str!("new_unit/Cargo.toml.in")),
        ("src/lib.rs".to_owned(), include_str!("new_unit/lib.rs.in")),
        ("README.md".to_owned(), include_str!("new_unit/README.md.in")),
        (format!("{name}.scn"), include_str!("new_unit/unit.scn.in")),
    ];
    files.iter().try_for_each(|(file, template)| write(&folder.join(file), &fill(template)))
}

fn check_name(name: &str) -> Result<(), PackError> {
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    let help = "small letters, digits and `_`, a letter first, for example my_tank".to_owned();
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.chars().all(allowed) {
        return Err(refusal(format!("`{}` cannot be the name of a unit", printable::line(name)), Some(help)));
    }
    if TAKEN.contains(&name) {
        let message = format!("`{name}` cannot be the name of a unit: it is a word of Rust or the name of a library");
        return Err(refusal(message, Some(format!("for example my_{name}"))));
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
fn fmu_folder(folder: &Path) -> Result<String, PackError> {
    let found = folder.canonicalize().ok().filter(|folder| folder.join("Cargo.toml").is_file());
    let found = found.ok_or_else(|| {
        let help = "name the folder fmus/fmu of a Lockstep checkout: --fmu PATH".to_owned();
        refusal(format!("there is no crate `fmu` in {}", printable::path(folder)), Some(help))
    })?;
    let text = found.to_str().filter(|text| printable::line(text) == *text).map(str::to_owned);
    text.ok_or_else(|| {
        refusal(format!("a Cargo.toml cannot name {}", printable::path(&found)), Some("rename the folder".to_owned()))
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

/// The manifest of a workspace with a folder among its members; `None` if they include it by a pattern.
fn with_member(workspace: &Path, folder: &Path) -> Result<Option<String>, PackError> {
    let path = workspace.join("Cargo.toml");
    let member = folder.strip_prefix(workspace).unwrap_or(folder).to_string_lossy().replace('\\', "/");
    let entry = toml_text(&member);
    let text =
        fs::read_to_string(&path).map_err(|source| PackError::File { path: path.clone(), doing: "read", source })?;
    let by_hand = || {
        let message = format!("the members of {} cannot be read", printable::path(&path));
        refusal(message, Some(format!("add {entry} to the members of its [workspace], then try again")))
    };
    let Some(table) = root_of(&text).ok_or_else(by_hand)?.workspace else {
        let message = format!("{} is the manifest of one package", printable::path(&path));
        let help = "start the unit in another folder, or make this one a workspace: write [workspace] there".to_owned();
        return Err(refusal(message, Some(help)));
    };
    let parent = Path::new(&member).parent().map(|parent| parent.join("*").to_string_lossy().into_owned());
    let changed = match &table.members {
        Some(members) if members.get_ref().iter().any(|known| *known == member || Some(known) == parent.as_ref()) => {
            return Ok(None);
        }
        Some(members) => {
            let (before, after) = text.split_at_checked(members.span().start + 1).ok_or_else(by_hand)?;
            let gap = if members.get_ref().is_empty() { "" } else { ", " };
            format!("{before}{entry}{gap}{}", if gap.is_empty() { after } else { after.trim_start_matches(' ') })
        }
        None => text.replacen("[workspace]", &format!("[workspace]\nmembers = [{entry}]"), 1),
    };
    let members = root_of(&changed).and_then(|root| root.workspace?.members);
    let has_member = members.is_some_and(|members| members.get_ref().contains(&member));
    if has_member { Ok(Some(changed)) } else { Err(by_hand()) }
}

fn root_of(manifest: &str) -> Option<RootManifest> {
    toml::from_str(manifest).ok()
}

/// Lets `cargo test` share the dependencies that `lockstep pack` builds, in the versions of the checkout that `fmu` is in.
/// Without cargo this is left out; the note says so.
fn share_builds(unit: &UnitCrate, fmu: &Path) -> Result<Option<String>, PackError> {
    let lock = unit.workspace.join("Cargo.lock");
    if !lock.exists()
        && let Some(tested) = fmu.ancestors().map(|folder| folder.join("Cargo.lock")).find(|file| file.is_file())
    {
        fs::copy(tested, &lock).map_err(|source| PackError::File { path: lock.clone(), doing: "write", source })?;
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

fn write(path: &Path, text: &str) -> Result<(), PackError> {
    let written = path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(path, text));
    written.map_err(|source| PackError::File { path: path.to_path_buf(), doing: "write", source })
}

fn refusal(message: String, help: Option<String>) -> PackError {
    PackError::NewUnit { message, help }
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

    fn joined(manifest: &str, folder: &str) -> Result<Option<String>, PackError> {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("Cargo.toml"), manifest).unwrap();
        with_member(root.path(), &root.path().join(folder))
    }

    #[test]
    fn a_unit_joins_the_members_of_its_workspace() {
        for (before, after) in [
            ("[workspace]\nmembers = [\"a\"]\n", "[workspace]\nmembers = [\"b\", \"a\"]\n"),
            (
                "[workspace]\nmembers = [ # all\n    \"a\", # first\n]\n",
                "[workspace]\nmembers = [\"b\", # all\n    \"a\", # first\n]\n",
            ),
            ("[workspace]\nmembers = []\n", "[workspace]\nmembers = [\"b\"]\n"),
            ("[workspace]\n", "[workspace]\nmembers = [\"b\"]\n"),
        ] {
            assert_eq!(joined(before, "b").unwrap().as_deref(), Some(after));
        }
        assert_eq!(joined("[workspace]\nmembers = [\"*\"]\n", "b").unwrap(), None);
        let below = joined("[workspace]\nmembers = []\n", "units/b").unwrap();
        assert_eq!(below.as_deref(), Some("[workspace]\nmembers = [\"units/b\"]\n"));
    }

    #[test]
    fn a_manifest_that_cannot_be_changed_safely_is_left_to_the_user() {
        let only_words = joined("# the [workspace] table\n[workspace]\n", "b").unwrap_err();
        assert!(only_words.help().is_some_and(|help| help.starts_with("add \"b\" to the members")), "{only_words}");
        let error = joined("[package]\nname = \"a\"\n", "b").unwrap_err();
        assert!(error.to_string().ends_with("is the manifest of one package"), "{error}");
    }

    #[test]
    fn a_workspace_that_was_there_gets_a_member_and_nothing_else() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().canonicalize().unwrap();
        fs::write(path.join("Cargo.toml"), "[workspace]\nmembers = []\n").unwrap();
        let fmu = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fmu");
        let new = new_unit("tank", &fmu, &path).unwrap();
        assert_eq!((new.unit.workspace, new.note), (path.clone(), None));
        let mut names: Vec<_> = fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["Cargo.toml", "tank"]);
        assert!(new_unit("tank", &fmu, &path).is_err(), "the folder is there");
    }
}
