//! Checks that files have at most 400 lines, functions at most 60 and crates at most 14,000.

use std::path::Path;

const FILE_LINES: usize = 400;
const FUNCTION_LINES: usize = 60;
const CRATE_LINES: usize = 14_000;

pub(super) fn findings(path: &Path, text: &str) -> Vec<String> {
    let lines: Vec<_> = text.lines().collect();
    let mut findings = Vec::new();
    if lines.len() > FILE_LINES {
        findings.push(format!("{}: {} lines, more than {FILE_LINES}", path.display(), lines.len()));
    }
    // Functions that are open, the innermost last.
    let mut open: Vec<(usize, &str, &str)> = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        if let Some((indent, name)) = function_start(line) {
            open.push((index, indent, name));
        } else if let Some(&(start, indent, name)) = open.last()
            && line.strip_prefix(indent).is_some_and(|rest| rest.starts_with('}'))
        {
            let length = index - start + 1;
            if length > FUNCTION_LINES {
                let place = format!("{}:{}", path.display(), start + 1);
                findings.push(format!("{place}: function `{name}` has {length} lines, more than {FUNCTION_LINES}"));
            }
            open.pop();
        }
    }
    findings
}

/// Crates that have grown too long: each folder with a `Cargo.toml`, counted below its `src`.
///
/// # Errors
/// If a file or folder of the tree cannot be read.
pub(super) fn of_crates(root: &Path) -> std::io::Result<Vec<String>> {
    let mut findings = Vec::new();
    for manifest in super::files_below(root, root, "toml")?.iter().filter(|path| path.ends_with("Cargo.toml")) {
        let folder = manifest.parent().unwrap_or(Path::new(""));
        let mut lines = 0;
        for path in super::files_below(root, &root.join(folder).join("src"), "rs")? {
            lines += std::fs::read_to_string(root.join(path))?.lines().count();
        }
        if lines > CRATE_LINES {
            findings.push(format!("{}: {lines} lines below src, more than {CRATE_LINES}", folder.display()));
        }
    }
    Ok(findings)
}

/// Indentation and name of a function that starts on this line and whose body is not complete on it.
fn function_start(line: &str) -> Option<(&str, &str)> {
    let trimmed = line.trim_start();
    let indent = &line[..line.len() - trimmed.len()];
    let (before, after) = trimmed.split_once("fn ").filter(|_| !trimmed.starts_with("//"))?;
    let qualifiers = ["pub", "const", "async", "unsafe", "extern", "\"C\"", "crate", "super", "(", ")", "in", "self"];
    let mut rest = before.trim();
    while !rest.is_empty() {
        rest = qualifiers.iter().find_map(|word| rest.strip_prefix(word))?.trim_start();
    }
    let name = after.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().filter(|name| !name.is_empty())?;
    (!line.trim_end().ends_with(';') && !line.trim_end().ends_with('}')).then_some((indent, name))
}
