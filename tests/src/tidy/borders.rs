//! Checks of the borders between crates: which dependencies and constructs a crate must not contain.

use std::path::Path;

/// Manifests of crates, each with the dependencies that it may have.
const ALLOWED: [(&str, &[&str]); 7] = [
    ("models/Cargo.toml", &["libm", "nalgebra", "serde"]),
    ("dsl/Cargo.toml", &["fmi2", "libm", "scn", "serde", "twox-hash"]),
    ("dsl/scn/Cargo.toml", &["annotate-snippets", "fmi2", "pest", "pest_derive", "serde", "strsim"]),
    ("fmus/fmi2/Cargo.toml", &["roxmltree", "serde", "strsim"]),
    ("orchestrator/flatten/Cargo.toml", &["dsl", "fmi2", "libm", "results", "serde", "unit"]),
    ("orchestrator/unit/Cargo.toml", &["fmi2", "libc", "libloading", "serde", "sha2", "zip", "zmij"]),
    (
        "orchestrator/results/Cargo.toml",
        &[
            "base64",
            "fmi2",
            "humantime",
            "libm",
            "parquet",
            "postcard",
            "serde",
            "serde_json",
            "sha2",
            "tiny-skia",
            "ttf-parser",
            "unit",
            "zmij",
        ],
    ),
];

/// The folders of the crate `orchestrator`, each with the folders that it may use. All of them may use the crates
/// `unit`, `flatten` and `results`.
const ROOMS: [(&str, &[&str]); 5] = [
    ("run", &["run"]),
    ("host", &["host", "run"]),
    ("find", &["find", "run"]),
    ("bus", &["bus", "host", "run"]),
    ("cli", &["cli", "bus", "find", "host", "run"]),
];

/// Crates whose purpose needs unsafe code; every other crate forbids it.
const UNSAFE: [&str; 3] = ["fmus/fmu/", "fmus/fmu-derive/", "orchestrator/unit/"];

fn place(path: &Path, index: usize) -> String {
    format!("{}:{}", path.display(), index + 1)
}

/// The code of a line, without comments and without the content of string literals.
fn code(line: &str) -> String {
    let mut code = String::new();
    let (mut quoted, mut escaped) = (false, false);
    for letter in line.chars() {
        match letter {
            _ if escaped => escaped = false,
            '\\' if quoted => escaped = true,
            '"' => {
                quoted = !quoted;
                code.push('"');
            }
            '/' if !quoted && code.ends_with('/') => {
                code.pop();
                break;
            }
            letter if !quoted => code.push(letter),
            _ => {}
        }
    }
    code
}

fn has_word(code: &str, word: &str) -> bool {
    code.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|found| found == word)
}

/// `unsafe` is allowed in the export layer, in the importer, and in the benchmarks' peer loops. The type of a C
/// function is not unsafe code.
pub(super) fn unsafe_code(path: &Path, text: &str) -> Vec<String> {
    if UNSAFE.iter().any(|allowed| path.starts_with(allowed)) || path.starts_with("orchestrator/benches") {
        return Vec::new();
    }
    let is_type = |code: &str| code.contains("unsafe extern \"\" fn(");
    let found = text.lines().enumerate().filter(|(_, line)| has_word(&code(line), "unsafe") && !is_type(&code(line)));
    let mut findings: Vec<_> =
        found.map(|(i, _)| format!("{}: `unsafe` outside {}", place(path, i), UNSAFE.join(", "))).collect();
    let is_root = path.ends_with("src/lib.rs") || path.ends_with("src/main.rs");
    if is_root && !text.lines().any(|line| line == "#![forbid(unsafe_code)]") {
        findings.push(format!("{}: no `#![forbid(unsafe_code)]`", path.display()));
    }
    findings
}

/// A folder of the orchestrator uses only those that come after it on the way from the command line to a unit.
pub(super) fn rooms(path: &Path, text: &str) -> Vec<String> {
    let Some((room, allowed)) = ROOMS.iter().find(|(room, _)| path.starts_with(format!("orchestrator/src/{room}")))
    else {
        return Vec::new();
    };
    let mut findings = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let code = code(line);
        let used = code.split("crate::").skip(1).map(|rest| rest.split(|c: char| !c.is_alphanumeric()).next());
        // A small scenario that tests share belongs to no folder.
        for used in used.flatten().filter(|used| !allowed.contains(used) && !["example", ""].contains(used)) {
            let allowed = allowed.join(", ");
            findings.push(format!("{}: `{room}` uses `{used}`, allowed are {allowed}", place(path, index)));
        }
    }
    findings
}

/// Value references and the calls of FMI 2.0 are known to the importer and the exporter only: units of another standard
/// have others. Tests may name a call to make a failure of it.
pub(super) fn calls(path: &Path, text: &str) -> Vec<String> {
    let places = ["dsl/src", "dsl/scn/src", "orchestrator/src", "orchestrator/flatten/src", "orchestrator/results/src"];
    let is_test = path.ends_with("example.rs") || path.iter().any(|part| part == "tests" || part == "tests.rs");
    if is_test || !places.iter().any(|place| path.starts_with(place)) {
        return Vec::new();
    }
    let product = text.lines().enumerate().take_while(|(_, line)| !line.starts_with("#[cfg(test)]"));
    let knows = |line: &str| {
        let code = code(line);
        has_word(&code, "value_reference") || code.contains("fmi2::c::") || code.contains("fmi2::calls")
    };
    let found = product.filter(|(_, line)| knows(line));
    found
        .map(|(i, _)| format!("{}: FMI calls and value references belong to orchestrator/unit", place(path, i)))
        .collect()
}

/// Results know of a unit only why it failed and how time is counted.
pub(super) fn results(path: &Path, text: &str) -> Vec<String> {
    if !path.starts_with("orchestrator/results") {
        return Vec::new();
    }
    let allowed = |rest: &str| rest.starts_with("failure") || rest.starts_with("time");
    let uses_more =
        |line: &str| code(line).split(' ').any(|word| word.strip_prefix("unit::").is_some_and(|rest| !allowed(rest)));
    let found = text.lines().enumerate().filter(|(_, line)| uses_more(line));
    found.map(|(i, _)| format!("{}: results use more of `unit` than `failure` and `time`", place(path, i))).collect()
}

/// zenoh is used only by the bus, and by the reference that a benchmark compares the bus with.
pub(super) fn bus(path: &Path, text: &str) -> Vec<String> {
    if path.starts_with("orchestrator/src/bus") || path == Path::new("orchestrator/benches/rounds/echo.rs") {
        return Vec::new();
    }
    let found = text.lines().enumerate().filter(|(_, line)| has_word(&code(line), "zenoh"));
    found.map(|(i, _)| format!("{}: zenoh outside orchestrator/src/bus", place(path, i))).collect()
}

/// The crates of [`ALLOWED`] depend on nothing else.
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
        assert!(has_word(&code("let url = \"https://x\"; unsafe { f() }"), "unsafe"));
        assert!(!has_word(&code("let x = \"a \\\" unsafe\";"), "unsafe"));
    }
}
