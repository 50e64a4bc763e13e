//! The places of a unit's files (section 2.3 of the standard), checked by their names.

use fmi2::description::{Finding, Position, Severity};
use fmi2::platform::FOLDERS;
use std::collections::{BTreeMap, BTreeSet};

const RULE: &str = "2.3";
/// The files and folders that the root of an archive may contain.
const AT_ROOT: [&str; 8] = [
    "modelDescription.xml",
    "model.png",
    "binaries",
    "documentation",
    "extra",
    "resources",
    "sources",
    "terminalsAndIcons",
];

/// Findings about the places of files, given their names and the unit's `modelIdentifier`.
pub(super) fn check(files: &[&str], identifier: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    let roots: BTreeSet<_> = files.iter().map(|name| name.split('/').next().unwrap_or(name)).collect();
    for root in roots.iter().filter(|root| !AT_ROOT.contains(root)) {
        let root = root.escape_debug();
        let text = format!("`{root}` is none of the files and folders that belong at the root; put it into `extra/`");
        findings.push(finding(Severity::Warning, text));
    }
    let platforms = platforms(files);
    for (platform, libraries) in &platforms {
        let wanted = library(platform, identifier);
        if !libraries.contains(&wanted) {
            let text = format!("`binaries/{platform}` has no `{wanted}`, the library named by modelIdentifier");
            findings.push(finding(Severity::Error, text));
        }
    }
    if platforms.is_empty() && !roots.contains("sources") {
        findings.push(finding(Severity::Error, "neither `binaries/` nor `sources/` hold anything".to_owned()));
    } else if !FOLDERS.iter().any(|here| platforms.contains_key(here)) {
        let present: Vec<_> = platforms.keys().copied().collect();
        let text = format!("nothing for this platform, `{}`; there is: {}", FOLDERS[0], listed(&present));
        findings.push(finding(Severity::Warning, text));
    }
    findings
}

/// The files directly in each folder of `binaries/`.
fn platforms<'a>(files: &[&'a str]) -> BTreeMap<&'a str, BTreeSet<String>> {
    let mut platforms = BTreeMap::<_, BTreeSet<_>>::new();
    for (platform, file) in files.iter().filter_map(|name| name.strip_prefix("binaries/")?.split_once('/')) {
        platforms.entry(platform).or_default().insert(file.to_owned());
    }
    platforms
}

fn library(platform: &str, identifier: &str) -> String {
    let ending = match platform {
        _ if platform.contains("win") && !platform.contains("darwin") => "dll",
        _ if platform.contains("darwin") => "dylib",
        _ => "so",
    };
    format!("{identifier}.{ending}")
}

fn listed(names: &[&str]) -> String {
    if names.is_empty() { "sources only".to_owned() } else { names.join(", ") }
}

fn finding(severity: Severity, message: String) -> Finding {
    Finding { severity, rule: RULE, position: Position::default(), message }
}

#[test]
fn a_library_has_the_file_extension_of_its_platform() {
    for (platform, name) in
        [("win64", "a.dll"), ("x86_64-windows", "a.dll"), ("darwin64", "a.dylib"), ("aarch64-darwin", "a.dylib")]
    {
        assert_eq!(library(platform, "a"), name);
    }
    assert_eq!(library("linux64", "a"), "a.so");
}

#[test]
fn a_unit_with_sources_only_is_valid_but_does_not_run_on_this_platform() {
    let findings = check(&["modelDescription.xml", "sources/a.c"], "a");
    let texts: Vec<_> = findings.iter().map(|finding| (finding.severity, finding.message.as_str())).collect();
    let expected = format!("nothing for this platform, `{}`; there is: sources only", FOLDERS[0]);
    assert_eq!(texts, [(Severity::Warning, expected.as_str())]);
}

#[test]
fn a_unit_without_binaries_and_sources_is_an_error() {
    let findings = check(&["modelDescription.xml"], "a");
    assert_eq!(findings.iter().map(|finding| finding.severity).collect::<Vec<_>>(), [Severity::Error]);
}

#[test]
fn control_characters_of_a_name_are_escaped_in_a_message() {
    let findings = check(&["\x1b[2J/a\nb", "sources/a.c"], "a");
    assert!(findings[0].message.starts_with(r"`\u{1b}[2J` is none"), "{}", findings[0].message);
}
