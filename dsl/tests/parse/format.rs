//! The style of scripts: it changes no meaning, and what has it stays as it is.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use dsl::format::format;
use dsl::source::Sources;
use proptest::prelude::*;

use super::scripts::kinds;
use super::tree;

/// A script in the style of the language; `None` if it has syntax errors.
fn formatted(script: &str) -> Option<String> {
    let mut sources = Sources::default();
    let text = sources.add("a.scn", script);
    format(&sources, text).ok()
}

/// The files of a folder that are scripts or templates of scripts, with their texts.
fn scripts_in(folder: &str) -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let files = entries.flatten().map(|entry| entry.path());
    let mut scripts: Vec<_> = files.filter(|file| file.to_string_lossy().contains(".scn")).collect();
    scripts.sort();
    // Some files of the corpus are not UTF-8 on purpose.
    let read = |file: PathBuf| Some((std::fs::read_to_string(&file).ok()?, file));
    scripts.into_iter().filter_map(read).map(|(text, file)| (file, text)).collect()
}

/// Every script of the repository that has no syntax error.
fn good_scripts() -> &'static [(PathBuf, String)] {
    static SCRIPTS: OnceLock<Vec<(PathBuf, String)>> = OnceLock::new();
    SCRIPTS.get_or_init(|| {
        let folders = ["corpus/parse", "../scenarios", "../fmus/pack/src/new_unit"];
        let scripts = folders.iter().flat_map(|folder| scripts_in(folder));
        scripts.filter(|(_, text)| formatted(text).is_some()).collect()
    })
}

/// What a script says, without places; powers of units have no sign.
fn meaning(script: &str) -> String {
    kinds(&tree(script)).replace('^', "")
}

/// The script without what the style may change.
fn bare(script: &str) -> String {
    script.chars().filter(|letter| !letter.is_whitespace() && *letter != '^').collect()
}

#[test]
fn the_examples_of_the_reference_are_formatted() {
    let names = ["quadcopter_among_obstacles", "auv_with_range_finder", "uav", "formation"];
    for name in names {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/parse").join(name).with_extension("scn");
        let script = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{name}: {error}"));
        insta::assert_snapshot!(name, formatted(&script).unwrap_or_default());
    }
}

#[test]
fn no_script_changes_its_meaning_or_changes_twice() {
    let scripts = good_scripts();
    assert!(scripts.len() >= 7, "the scripts are there");
    for (file, script) in scripts {
        let once = formatted(script).unwrap_or_default();
        assert_eq!(bare(&once), bare(script), "{}", file.display());
        assert_eq!(meaning(&once), meaning(script), "{}", file.display());
        assert_eq!(formatted(&once).as_deref(), Some(&*once), "{}", file.display());
    }
}

#[test]
fn the_scripts_that_users_read_first_have_the_style() {
    for (file, script) in ["../scenarios", "../fmus/pack/src/new_unit"].into_iter().flat_map(scripts_in) {
        assert_eq!(formatted(&script), Some(script), "{}: lockstep fmt", file.display());
    }
}

#[test]
fn a_script_with_syntax_errors_is_not_formatted() {
    let mut refused = 0;
    for (file, script) in scripts_in("corpus/parse") {
        let mut sources = Sources::default();
        let text = sources.add("a.scn", &*script);
        let errors = dsl::parse::parse(&sources, text).diagnostics;
        refused += usize::from(!errors.is_empty());
        assert_eq!(format(&sources, text).err().unwrap_or_default(), errors, "{}", file.display());
    }
    assert!(refused >= 3);
}

/// The places of blanks that mean nothing: outside of texts and comments.
fn blanks(script: &str) -> Vec<usize> {
    let (mut places, mut quote) = (Vec::new(), None);
    for (at, letter) in script.char_indices() {
        match (quote, letter) {
            (_, '\n') => quote = None,
            (None, '"' | '\'' | '#') => quote = Some(letter),
            (Some(open), letter) if letter == open && open != '#' => quote = None,
            (None, ' ' | '\t') => places.push(at),
            _ => {}
        }
    }
    places
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn other_blanks_give_the_same_text(
        script in any::<prop::sample::Index>(),
        widths in prop::collection::vec(1_usize..5, 1..40),
        breaks in prop::collection::vec(0_usize..3, 1..40),
    ) {
        let (_, script) = script.get(good_scripts());
        let is_blank = blanks(script);
        let mut other = String::new();
        for (at, letter) in script.char_indices() {
            if is_blank.binary_search(&at).is_ok() {
                let width = widths[at % widths.len()];
                other.push_str(&if width == 4 { "\t".to_owned() } else { " ".repeat(width) });
                continue;
            }
            other.push(letter);
            // More than one empty line is one.
            if other.ends_with("\n\n") {
                other.push_str(&"\n".repeat(breaks[at % breaks.len()]));
            }
        }
        prop_assert_eq!(formatted(&other), formatted(script));
    }

    #[test]
    fn joined_and_parted_tokens_keep_their_meaning(
        script in any::<prop::sample::Index>(),
        cuts in prop::collection::vec((any::<prop::sample::Index>(), any::<bool>()), 1..30),
    ) {
        let mut other = script.get(good_scripts()).1.clone();
        for (at, adds) in cuts {
            let at = other.floor_char_boundary(at.index(other.len()));
            match other[at..].chars().next() {
                Some(' ') if !adds => drop(other.remove(at)),
                Some(_) if adds => other.insert(at, if at % 3 == 0 { '\n' } else { ' ' }),
                _ => {}
            }
        }
        if let Some(once) = formatted(&other) {
            prop_assert_eq!(bare(&once), bare(&other));
            prop_assert_eq!(meaning(&once), meaning(&other));
            prop_assert_eq!(formatted(&once), Some(once));
        }
    }
}
