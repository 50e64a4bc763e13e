//! Writes an `.fmu` file: sorted entries, one fixed date, one compression level.

use crate::{PackError, UnitCrate};
use std::collections::BTreeMap;
use std::io::{Cursor, Write};
use std::path::Path;
use zip::write::SimpleFileOptions;

/// Writes the archive of a unit; the file appears only when it is complete.
pub(crate) fn write(unit: &UnitCrate, library: &[u8], xml: &str, archive: &Path) -> Result<(), PackError> {
    check(unit, xml)?;
    let bytes = zipped(unit, &entries(unit, library, xml)?)?;
    let folder = archive.parent().unwrap_or(Path::new("."));
    let failed = |source| PackError::File { path: archive.to_path_buf(), doing: "write", source };
    std::fs::create_dir_all(folder).map_err(failed)?;
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed)?;
    file.write_all(&bytes).map_err(failed)?;
    make_readable(file.as_file()).map_err(failed)?;
    file.persist(archive).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Makes the file readable for all users; temporary files are private by default.
#[cfg(unix)]
fn make_readable(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}

/// Checks that the description breaks no rule of the standard.
fn check(unit: &UnitCrate, xml: &str) -> Result<(), PackError> {
    let rules = |findings: Vec<String>| PackError::Rules { unit: unit.name.clone(), findings: findings.join("\n") };
    let (description, mut findings) =
        fmi2::description::read::read(xml.as_bytes()).map_err(|finding| rules(vec![finding.to_string()]))?;
    findings.extend(fmi2::description::check::check(&description));
    if findings.is_empty() { Ok(()) } else { Err(rules(findings.iter().map(ToString::to_string).collect())) }
}

fn entries(unit: &UnitCrate, library: &[u8], xml: &str) -> Result<BTreeMap<String, Vec<u8>>, PackError> {
    let platform = fmi2::platform::FOLDERS.first().ok_or_else(|| PackError::Archive {
        unit: unit.name.clone(),
        reason: "FMI 2.0 names no folder for this platform".to_owned(),
    })?;
    let read = |path: &Path| {
        std::fs::read(path).map_err(|source| PackError::File { path: path.into(), doing: "read", source })
    };
    let mut entries = BTreeMap::new();
    entries.insert("modelDescription.xml".to_owned(), xml.as_bytes().to_vec());
    let binary = format!("binaries/{platform}/{}{}", unit.identifier(), std::env::consts::DLL_SUFFIX);
    entries.insert(binary, library.to_vec());
    let readme = unit.folder.join("README.md");
    if readme.is_file() {
        let text = String::from_utf8_lossy(&read(&readme)?).into_owned();
        entries.insert("documentation/index.html".to_owned(), page(&unit.name, &text).into_bytes());
    }
    for file in ["reference_in.csv", "reference.csv"] {
        let path = unit.folder.join(file);
        if path.is_file() {
            entries.insert(format!("documentation/{file}"), read(&path)?);
        }
    }
    for file in ["LICENSE", "LICENSE-MIT", "LICENSE-APACHE"] {
        let found = [&unit.folder, &unit.workspace].map(|folder| folder.join(file)).into_iter().find(|p| p.is_file());
        if let Some(path) = found {
            entries.insert(format!("documentation/licenses/{file}.txt"), read(&path)?);
        }
    }
    Ok(entries)
}

/// The README as an HTML page.
fn page(title: &str, markdown: &str) -> String {
    let mut body = String::new();
    let options = pulldown_cmark::Options::ENABLE_TABLES;
    pulldown_cmark::html::push_html(&mut body, pulldown_cmark::Parser::new_ext(markdown, options));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{title}</title></head>\n<body>\n{body}</body>\n</html>\n"
    )
}

fn zipped(unit: &UnitCrate, entries: &BTreeMap<String, Vec<u8>>) -> Result<Vec<u8>, PackError> {
    let failed = |reason: String| PackError::Archive { unit: unit.name.clone(), reason };
    let options = SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated)
        .compression_level(Some(6))
        .last_modified_time(zip::DateTime::default())
        .unix_permissions(0o644);
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        writer.start_file(name.as_str(), options).map_err(|error| failed(error.to_string()))?;
        writer.write_all(bytes).map_err(|error| failed(error.to_string()))?;
    }
    Ok(writer.finish().map_err(|error| failed(error.to_string()))?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_entries_give_equal_bytes_and_no_date() {
        let unit = UnitCrate { name: "x".into(), folder: ".".into(), workspace: ".".into() };
        let entries = BTreeMap::from([("b".to_owned(), vec![1; 1000]), ("a".to_owned(), vec![2; 10])]);
        let bytes = zipped(&unit, &entries).unwrap();
        assert_eq!(bytes, zipped(&unit, &entries).unwrap());
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let names: Vec<_> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
        assert_eq!(names, ["a", "b"]);
        assert_eq!(archive.by_index(0).unwrap().last_modified(), Some(zip::DateTime::default()));
    }

    #[test]
    fn a_table_of_the_readme_becomes_a_table_of_the_page() {
        assert!(page("x", "| a | b |\n|---|---|\n| 1 | 2 |\n").contains("<td>1</td>"));
    }

    #[test]
    fn a_description_that_breaks_a_rule_is_not_packed() {
        let unit = UnitCrate { name: "x".into(), folder: ".".into(), workspace: ".".into() };
        let error = check(&unit, "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"x\" guid=\"g\"/>").unwrap_err();
        assert!(error.to_string().starts_with("the description of unit `x` breaks rules of FMI 2.0.5:\n"), "{error}");
    }
}
