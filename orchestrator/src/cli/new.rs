//! `lockstep new`: a crate for one's own unit, a script for units.

mod scenario;

use fmi2::printable;
use results::report;
use std::fs;
use std::path::{Path, PathBuf};

/// Writes something new to start from.
#[derive(Debug, clap::Args)]
pub struct New {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, clap::Subcommand)]
enum What {
    /// Writes a crate for a unit of one's own, with a test and a script that runs it
    Unit(Unit),
    /// Writes a script that loads units and connects what fits by name, members and unit of measure
    Scenario(scenario::Scenario),
}

/// A crate for a unit.
#[derive(Debug, clap::Args)]
struct Unit {
    /// The unit's name, which becomes the folder's, for example my_tank
    name: String,
    /// The folder of the crate `fmu` [default: the one this program was built beside]
    #[arg(long, value_name = "PATH")]
    fmu: Option<PathBuf>,
}

impl New {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        let unit = match &self.what {
            What::Unit(unit) => unit,
            What::Scenario(scenario) => return scenario.run(),
        };
        match unit.write() {
            Ok(()) => {
                let name = &unit.name;
                let (unit, script) = (format!("{name}/src/lib.rs"), format!("{name}/{name}.scn"));
                let width = unit.len().max(script.len());
                report::result(&format!(
                    "{unit:<width$}  the unit, with a test\n{script:<width$}  a script that runs it\n\n\
                     cd {name}\ncargo test\nlockstep run {name}.scn\nlockstep pack .\n"
                ));
                0
            }
            Err((message, help)) => {
                report::error(&message, help);
                2
            }
        }
    }
}

type Refusal = (String, Option<&'static str>);

impl Unit {
    fn write(&self) -> Result<(), Refusal> {
        if !is_identifier(&self.name) {
            let help = "small letters, digits and `_`, a letter first, for example my_tank";
            return Err((format!("`{}` cannot be the name of a unit", self.name), Some(help)));
        }
        let fmu = self.fmu_folder()?;
        let folder = Path::new(&self.name);
        if folder.exists() {
            return Err((format!("{} is already there", printable::path(folder)), Some("choose another name")));
        }
        let type_name = camel_case(&self.name);
        let fill = |template: &str| {
            template
                .replace("{{name}}", &self.name)
                .replace("{{Type}}", &type_name)
                .replace("{{fmu}}", &toml_text(&fmu))
        };
        let files = [
            ("Cargo.toml".to_owned(), include_str!("new/Cargo.toml.in")),
            ("src/lib.rs".to_owned(), include_str!("new/lib.rs.in")),
            ("README.md".to_owned(), include_str!("new/README.md.in")),
            (format!("{}.scn", self.name), include_str!("new/unit.scn.in")),
            (".gitignore".to_owned(), "/target\n/runs\n"),
        ];
        for (file, template) in files {
            let path = folder.join(file);
            let written =
                path.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(&path, fill(template)));
            written.map_err(|error| (format!("cannot write {}: {error}", printable::path(&path)), None))?;
        }
        Ok(())
    }

    /// An absolute path, so that the new crate may be moved.
    fn fmu_folder(&self) -> Result<String, Refusal> {
        let beside_this = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fmus/fmu");
        let folder = self.fmu.clone().unwrap_or(beside_this);
        let found = folder.canonicalize().ok().filter(|folder| folder.join("Cargo.toml").is_file());
        let help = "name the folder fmus/fmu of a Lockstep checkout: --fmu PATH";
        let found =
            found.ok_or_else(|| (format!("there is no crate `fmu` in {}", printable::path(&folder)), Some(help)))?;
        let text = found.to_str().filter(|text| printable::line(text) == *text).map(str::to_owned);
        text.ok_or_else(|| (format!("a Cargo.toml cannot name {}", printable::path(&found)), Some("rename the folder")))
    }
}

fn is_identifier(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_lowercase()) && name.chars().all(allowed)
}

fn camel_case(name: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters.next().map_or_else(String::new, |first| first.to_ascii_uppercase().to_string() + letters.as_str())
    };
    name.split('_').map(capital).collect()
}

/// A printable path between the quotes of a TOML text.
fn toml_text(path: &str) -> String {
    path.replace('\\', "\\\\").replace('"', "\\\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_becomes_a_type() {
        assert_eq!(camel_case("my_tank2"), "MyTank2");
    }

    #[test]
    fn names_that_no_crate_can_have_are_refused() {
        for name in ["", "My", "2tanks", "a-b", "../up"] {
            assert!(!is_identifier(name), "{name}");
        }
        assert!(is_identifier("my_tank2"));
    }
}
