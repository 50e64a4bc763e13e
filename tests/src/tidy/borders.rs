//! Checks of the borders between crates: which dependencies and constructs a crate must not contain.

use std::path::Path;

/// Manifests of crates, each with the dependencies that it may have.
const ALLOWED: [(&str, &[&str]); 3] = [
    ("models/Cargo.toml", &["libm", "nalgebra", "serde"]),
    ("dsl/Cargo.toml", &["annotate-snippets", "fmi2", "libm", "pest", "pest_derive", "serde", "strsim"]),
    ("fmus/fmi2/Cargo.toml", &["roxmltree", "serde", "strsim"]),
];

fn place(path: &Path, index: usize) -> String {
    format!("{}:{}", path.display(), index + 1)
}

/// The code of a line, without comments and without the content of simple string literals.
fn code(line: &str) -> String {
    let without_comment = line.split("//").next().unwrap_or_default();
    without_comment.replace("\\\"", "").split('"').step_by(2).collect::<Vec<_>>().join("\"\"")
}

fn has_word(code: &str, word: &str) -> bool {
    code.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|found| found == word)
}

/// `unsafe` is allowed in the export layer, in the importer, and in the benchmarks' peer loops. The type of a C
/// function is not unsafe code.
pub(super) fn unsafe_code(path: &Path, text: &str) -> Vec<String> {
    let places = ["fmus/fmu/", "fmus/fmu-derive/", "orchestrator/unit/", "orchestrator/benches/"];
    if places.iter().any(|allowed| path.starts_with(allowed)) {
        return Vec::new();
    }
    let is_type = |code: &str| code.contains("unsafe extern \"\" fn(");
    let found = text.lines().enumerate().filter(|(_, line)| has_word(&code(line), "unsafe") && !is_type(&code(line)));
    found.map(|(i, _)| format!("{}: `unsafe` outside fmus/fmu and orchestrator/unit", place(path, i))).collect()
}

/// zenoh is used only by the bus, and by the reference that a benchmark compares the bus with.
pub(super) fn bus(path: &Path, text: &str) -> Vec<String> {
    if path.starts_with("orchestrator/src/bus") || path == Path::new("orchestrator/benches/rounds/echo.rs") {
        return Vec::new();
    }
    let found = text.lines().enumerate().filter(|(_, line)| has_word(&code(line), "zenoh"));
    found.map(|(i, _)| format!("{}: zenoh outside orchestrator/src/bus", place(path, i))).collect()
}

/// `models`, `dsl` and `fmi2` depend only on the crates that the README lists.
pub(super) fn dependencies(root: &Path) -> std::io::Result<Vec<String>> {
    let mut findings = Vec::new();
    for (manifest, allowed) in ALLOWED {
        let Ok(text) = std::fs::read_to_string(root.join(manifest)) else { continue };
        let table: toml::Table = toml::from_str(&text).map_err(std::io::Error::other)?;
        let Some(dependencies) = table.get("dependencies").and_then(toml::Value::as_table) else { continue };
        for name in dependencies.keys().filter(|name| !allowed.contains(&name.as_str())) {
            findings.push(format!("{manifest}: depends on `{name}`, allowed are {}", allowed.join(", ")));
        }
    }
    Ok(findings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_in_comments_and_string_literals_are_not_code() {
        assert!(!has_word(&code("let x = 1; // unsafe"), "unsafe"));
        assert!(!has_word(&code("let x = \"unsafe\";"), "unsafe"));
        assert!(has_word(&code("unsafe { x() }"), "unsafe"));
        assert_eq!(unsafe_code(Path::new("a.rs"), "type F = unsafe extern \"C\" fn(i32);"), Vec::<String>::new());
        assert!(!has_word(&code("#![forbid(unsafe_code)]"), "unsafe"));
    }
}
