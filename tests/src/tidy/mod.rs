//! Checks of the house style over a source tree: each returns one sentence for each violation.

mod borders;
mod citations;
mod length;

use std::path::{Path, PathBuf};

/// All violations in the tree at `root`, one sentence each.
///
/// # Errors
/// If a file or folder of the tree cannot be read.
pub fn findings(root: &Path) -> std::io::Result<Vec<String>> {
    let mut findings = Vec::new();
    for path in files_below(root, root, "rs")? {
        let text = std::fs::read_to_string(root.join(&path))?;
        findings.extend(opening(&path, &text));
        findings.extend(length::findings(&path, &text));
        findings.extend(borders::unsafe_code(&path, &text));
        findings.extend(borders::bus(&path, &text));
        findings.extend(borders::rooms(&path, &text));
        findings.extend(borders::results(&path, &text));
        findings.extend(borders::calls(&path, &text));
    }
    findings.extend(borders::dependencies(root)?);
    findings.extend(length::of_crates(root)?);
    findings.extend(citations::findings(root)?);
    findings.extend(scenarios_without_golden_trace(root)?);
    Ok(findings)
}

/// Files with one extension below a folder, sorted, relative to the root, without build results and hidden folders.
fn files_below(root: &Path, folder: &Path, extension: &str) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    if !folder.is_dir() {
        return Ok(files);
    }
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() {
            if !(name.starts_with('.') || name == "target" || name == "runs") {
                files.extend(files_below(root, &path, extension)?);
            }
        } else if path.extension().is_some_and(|found| found == extension) {
            files.push(path.strip_prefix(root).unwrap_or(&path).to_path_buf());
        }
    }
    files.sort();
    Ok(files)
}

/// Checks that the first line of a file states its purpose.
fn opening(path: &Path, text: &str) -> Option<String> {
    let first = text.lines().next().unwrap_or_default();
    let sentence = first.strip_prefix("//! ").is_some_and(|rest| rest.len() > 10);
    (!sentence).then(|| format!("{}: the first line is not `//!` and a sentence", path.display()))
}

fn scenarios_without_golden_trace(root: &Path) -> std::io::Result<Vec<String>> {
    let scenarios = files_below(root, &root.join("scenarios"), "scn")?;
    let runnable = scenarios.iter().filter(|path| path.parent() == Some(Path::new("scenarios")));
    let golden =
        |path: &Path| root.join("tests/golden").join(path.file_stem().unwrap_or_default()).with_extension("csv");
    Ok(runnable
        .filter(|path| !golden(path).is_file())
        .map(|path| format!("{}: no golden trace {}", path.display(), golden(path).display()))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(root: &Path, path: &str, text: &str) {
        let path = root.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// A tree without violations.
    fn tidy_tree() -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        write(
            root.path(),
            "models/src/lib.rs",
            "//! The mathematics of one thing.\n#![forbid(unsafe_code)]\n\n/// Adds.\nfn add() {}\n",
        );
        write(root.path(), "models/Cargo.toml", "[dependencies]\nlibm.workspace = true\n");
        write(root.path(), "models/REFERENCES.md", "- Geng & Chulin (2016): a paper.\n");
        write(root.path(), "scenarios/a.scn", "");
        write(root.path(), "tests/golden/a.csv", "");
        root
    }

    fn after(path: &str, text: &str) -> Vec<String> {
        let root = tidy_tree();
        assert_eq!(findings(root.path()).unwrap(), Vec::<String>::new(), "the tree is tidy before the mistake");
        write(root.path(), path, text);
        findings(root.path()).unwrap()
    }

    #[test]
    fn a_file_without_a_statement_of_its_purpose_is_found() {
        assert_eq!(after("dsl/src/x.rs", "fn f() {}\n"), ["dsl/src/x.rs: the first line is not `//!` and a sentence"]);
    }

    #[test]
    fn a_file_of_over_400_lines_is_found() {
        let text = format!("//! Something that is long.\n{}", "\n".repeat(400));
        assert_eq!(after("dsl/src/x.rs", &text), ["dsl/src/x.rs: 401 lines, more than 400"]);
    }

    #[test]
    fn a_function_of_over_60_lines_is_found() {
        let text = format!(
            "//! Something that is long.\nimpl X {{\n    pub(crate) const fn long() {{\n{}    }}\n}}\n",
            "        a();\n".repeat(59)
        );
        assert_eq!(after("dsl/src/x.rs", &text), ["dsl/src/x.rs:3: function `long` has 61 lines, more than 60"]);
    }

    #[test]
    fn unsafe_code_outside_the_allowed_folders_is_found() {
        let found = after("dsl/src/x.rs", "//! Something that is unsafe.\nfn f() { unsafe { g() } }\n");
        assert_eq!(found, ["dsl/src/x.rs:2: `unsafe` outside fmus/fmu/, fmus/fmu-derive/, orchestrator/unit/"]);
    }

    #[test]
    fn a_long_function_with_a_function_inside_is_found() {
        let inner = "    fn inner() {\n        b();\n    }\n";
        let text = format!("//! Something that is long.\nfn outer() {{\n{inner}{}}}\n", "    a();\n".repeat(60));
        assert_eq!(after("dsl/src/x.rs", &text), ["dsl/src/x.rs:2: function `outer` has 65 lines, more than 60"]);
    }

    #[test]
    fn a_crate_that_does_not_forbid_unsafe_code_is_found() {
        let found = after("dsl/src/lib.rs", "//! The language of scenarios.\n");
        assert_eq!(found, ["dsl/src/lib.rs: no `#![forbid(unsafe_code)]`"]);
    }

    #[test]
    fn a_folder_that_uses_one_before_it_is_found() {
        let found = after("orchestrator/src/run/x.rs", "//! Something that steps.\nuse crate::host::child;\n");
        assert_eq!(found, ["orchestrator/src/run/x.rs:2: `run` uses `host`, allowed are run"]);
        assert_eq!(
            after("orchestrator/src/run/x.rs", "//! Something that steps.\nuse crate::run::stepping;\n"),
            Vec::<String>::new()
        );
    }

    #[test]
    fn calls_and_value_references_outside_of_the_importer_are_found() {
        let expected = |line| {
            format!("orchestrator/src/run/x.rs:{line}: FMI calls and value references belong to orchestrator/unit")
        };
        let text = "//! Something that steps.\nuse fmi2::calls::Call;\nlet x = v.value_reference;\n";
        assert_eq!(after("orchestrator/src/run/x.rs", text), [expected(2), expected(3)]);
        let text = "//! Something that steps.\n#[cfg(test)]\nmod tests {\n    use fmi2::calls::Call;\n}\n";
        assert_eq!(after("orchestrator/src/run/x.rs", text), Vec::<String>::new());
    }

    #[test]
    fn results_that_use_more_of_a_unit_than_failure_and_time_are_found() {
        let text = "//! Something that is written.\nuse unit::time::seconds;\nuse unit::instance::Instance;\n";
        let found = after("orchestrator/results/src/x.rs", text);
        assert_eq!(found, ["orchestrator/results/src/x.rs:3: results use more of `unit` than `failure` and `time`"]);
    }

    #[test]
    fn a_crate_of_over_14000_lines_is_found() {
        let root = tidy_tree();
        write(root.path(), "dsl/Cargo.toml", "[package]\nname = \"dsl\"\n");
        for file in 0..36 {
            write(
                root.path(),
                &format!("dsl/src/x{file}.rs"),
                &format!("//! Something that is long.\n{}", "\n".repeat(399)),
            );
        }
        assert_eq!(findings(root.path()).unwrap(), ["dsl: 14400 lines below src, more than 14000"]);
    }

    #[test]
    fn a_citation_without_an_entry_is_found() {
        let found = after("models/src/x.rs", "//! A law, after Nobody & Noone (1999), eq. 3.\n");
        assert_eq!(found, ["models/src/x.rs:1: `Nobody & Noone (1999)` has no entry in models/REFERENCES.md"]);
    }

    #[test]
    fn a_dependency_that_crosses_a_border_is_found() {
        let found = after("models/Cargo.toml", "[dependencies]\nlibm.workspace = true\nserde_json = \"1\"\n");
        assert_eq!(found, ["models/Cargo.toml: depends on `serde_json`, allowed are libm, nalgebra, serde"]);
    }

    #[test]
    fn zenoh_outside_the_bus_is_found() {
        let found = after("orchestrator/src/x.rs", "//! Something that talks.\nuse zenoh::Session;\n");
        assert_eq!(found, ["orchestrator/src/x.rs:2: zenoh outside orchestrator/src/bus"]);
    }

    #[test]
    fn a_scenario_without_a_golden_trace_is_found() {
        let found = after("scenarios/b.scn", "");
        assert_eq!(found.len(), 1);
        assert!(found[0].starts_with("scenarios/b.scn: no golden trace "), "{found:?}");
    }
}
