//! What the standard has against a unit's file, a line for each finding.

use super::Checked;
use fmi2::description::{Finding, ModelDescription, Severity};
use fmi2::printable;
use std::path::Path;
use unit::archive::examine;
use unit::error::UnitError;

/// Checks an archive by every rule of the standard, without running anything in it.
///
/// # Errors
/// If the file cannot be read at all.
pub(super) fn check(file: &Path) -> Result<Checked, UnitError> {
    let name = printable::path(file);
    match examine(file) {
        Ok((description, findings)) => Ok(Checked { facts: facts(&description), ..checked(&name, &findings) }),
        Err(UnitError::Description { finding, .. }) => Ok(checked(&name, &[finding])),
        Err(UnitError::Archive { entry, problem, .. }) => {
            let entry = entry.map_or_else(String::new, |entry| format!("entry `{}` ", entry.escape_debug()));
            let findings = format!("{name}: error[2.3]: {entry}{problem}\n");
            Ok(Checked { findings, errors: 1, ..Checked::default() })
        }
        Err(error) => Err(error),
    }
}

fn checked(name: &str, findings: &[Finding]) -> Checked {
    let count = |severity| findings.iter().filter(|finding| finding.severity == severity).count();
    Checked {
        findings: findings.iter().map(|finding| line(name, finding) + "\n").collect(),
        errors: count(Severity::Error),
        warnings: count(Severity::Warning),
        ..Checked::default()
    }
}

/// `tank.fmu/modelDescription.xml:12:5: error[2.2.7]: …`; what is about the archive has no line and column.
fn line(name: &str, finding: &Finding) -> String {
    let place = if finding.position.line > 0 { "/modelDescription.xml:" } else { ": " };
    format!("{name}{place}{finding}")
}

fn facts(description: &ModelDescription) -> String {
    format!("{}, {}", description.model_name, results::counted(description.variables.len(), "variable"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use zip::write::SimpleFileOptions;

    /// An archive with these files.
    fn archive(folder: &Path, files: &[(&str, &str)]) -> std::path::PathBuf {
        let path = folder.join("tank.fmu");
        let mut writer = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
        for (name, text) in files {
            writer.start_file(*name, SimpleFileOptions::default()).unwrap();
            writer.write_all(text.as_bytes()).unwrap();
        }
        writer.finish().unwrap();
        path
    }

    fn text(files: &[(&str, &str)]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = archive(folder.path(), files);
        let checked = check(&path).unwrap();
        let text = checked.findings.clone() + &checked.summary(&path.display().to_string(), false);
        text.replace(&format!("{}/", folder.path().display()), "")
    }

    const GOOD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Tank" guid="g">
  <CoSimulation modelIdentifier="tank"/>
  <ModelVariables>
    <ScalarVariable name="level" valueReference="0" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="1" dependencies=""/></Outputs>
    <InitialUnknowns><Unknown index="1" dependencies=""/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"#;

    #[test]
    fn a_sound_unit_is_summed_up_in_one_line() {
        let files = [("modelDescription.xml", GOOD), (LIBRARY, ""), ("documentation/index.html", "")];
        assert_eq!(text(&files), "tank.fmu: ok  Tank, 1 variable");
    }

    #[test]
    fn every_finding_has_its_line_and_rule_and_those_of_the_archive_come_first() {
        let bad = GOOD.replace("causality=\"output\"", "causality=\"input\"").replace("guid=\"g\"", "");
        insta::assert_snapshot!(text(&[
            ("modelDescription.xml", &bad),
            ("binaries\\win64\\tank.dll", ""),
            ("binaries/linux32/libtank.so", ""),
            ("notes.txt", ""),
        ]));
    }

    #[test]
    fn what_is_no_archive_or_no_xml_is_one_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tank.fmu");
        std::fs::write(&path, "no zip").unwrap();
        let checked = check(&path).unwrap();
        assert_eq!(checked.errors, 1);
        assert!(checked.findings.contains("tank.fmu: error[2.3]: no readable zip archive"), "{}", checked.findings);
        let torn = text(&[("modelDescription.xml", "<fmiModelDescription")]);
        assert!(torn.starts_with("tank.fmu/modelDescription.xml:1:") && torn.contains("error[XML]"), "{torn}");
    }

    const LIBRARY: &str = if cfg!(target_os = "macos") {
        "binaries/darwin64/tank.dylib"
    } else if cfg!(target_arch = "x86_64") {
        "binaries/linux64/tank.so"
    } else {
        "binaries/aarch64-linux/tank.so"
    };
}
