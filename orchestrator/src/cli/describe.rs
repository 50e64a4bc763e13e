//! `lockstep describe`: a unit's variables, and all units that a script could name.

use crate::find::catalogue::{Catalogue, Origin, is_archive};
use dsl::spelling;
use flatten::unit_page::UnitPage;
use fmi2::printable;
use results::report;
use std::ffi::{OsStr, OsString};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Shows the variables of a unit with units of measure, limits, items and dependencies, or all units that would be found.
#[derive(Debug, clap::Args)]
pub struct Describe {
    /// A unit as scripts name it, or an .fmu file
    unit: Option<OsString>,
    /// A folder of units, looked up before those of LOCKSTEP_UNITS and the workspace
    #[arg(long, value_name = "DIR")]
    units: Vec<PathBuf>,
    /// Never build a unit
    #[arg(long)]
    no_build: bool,
    /// Writes the page as JSON: each variable with type, unit, start value, limits, items and dependencies
    #[arg(long, requires = "unit")]
    json: bool,
}

impl Describe {
    /// Runs the command and returns its exit code.
    #[must_use]
    pub fn run(&self) -> u8 {
        let text = match &self.unit {
            Some(unit) => self.one(unit),
            None => self.all(),
        };
        match text {
            Ok(text) => {
                report::result(&text);
                0
            }
            Err((message, help)) => {
                report::error(&message, help.as_deref());
                2
            }
        }
    }

    fn catalogue(&self) -> Result<(Catalogue, PathBuf), (String, Option<String>)> {
        let current = std::env::current_dir().map_err(|error| (format!("no current folder: {error}"), None))?;
        let catalogue = Catalogue::with_environment(self.units.clone(), &current, !self.no_build);
        Ok((catalogue.map_err(|error| (error.to_string(), None))?, current))
    }

    fn one(&self, unit: &OsStr) -> Result<String, (String, Option<String>)> {
        let (mut catalogue, current) = self.catalogue()?;
        let name = catalogue.name_of(unit);
        let archive = catalogue.find(&name, &current).map_err(|problem| (problem.message, problem.help))?;
        let (description, _) = unit::archive::read_description(&archive).map_err(|error| (error.to_string(), None))?;
        let page = UnitPage::new(&description);
        if self.json {
            let text = serde_json::to_string_pretty(&page).map_err(|error| (error.to_string(), None))?;
            return Ok(text + "\n");
        }
        Ok(page.text() + &to_paste(unit))
    }

    fn all(&self) -> Result<String, (String, Option<String>)> {
        let (catalogue, current) = self.catalogue()?;
        let mut text = String::new();
        for entry in catalogue.entries() {
            let packed = match &entry.origin {
                Origin::Archive(path) => Some(path.clone()),
                Origin::Crate(unit) => Some(unit.archive()).filter(|archive| archive.is_file()),
            };
            let description = packed.and_then(|archive| unit::archive::read_description(&archive).ok());
            let words = description.and_then(|(description, _)| description.description);
            let origin = match &entry.origin {
                Origin::Archive(path) => path.clone(),
                Origin::Crate(unit) => unit.folder.clone(),
            };
            let origin = match origin.strip_prefix(&current) {
                Ok(inside) if inside.as_os_str().is_empty() => ".".to_owned(),
                Ok(inside) => printable::path(inside),
                Err(_) => printable::path(origin),
            };
            let _ = writeln!(
                text,
                "{:<22}  {origin:<26}  {}",
                printable::line(&entry.name),
                printable::line(&words.unwrap_or_default())
            );
        }
        if text.is_empty() {
            let help = "run it in a workspace with units, or name a folder of .fmu files: --units DIR".to_owned();
            return Err(("no units here".to_owned(), Some(help)));
        }
        Ok(text)
    }
}

/// The line of a script that names the unit. A path that a script cannot name gets the line for a script beside it, if its
/// file can be named.
fn to_paste(unit: &OsStr) -> String {
    let is_writable = |name: &&str| printable::line(name) == **name;
    let path = Path::new(unit);
    let file = path.file_name().unwrap_or(unit);
    let stem = if is_archive(path) { path.file_stem().unwrap_or(file) } else { file };
    let line = |name: &str| format!("  fmu {} = {}\n", scenario_name(&stem.to_string_lossy()), spelling::text(name));
    match (unit.to_str().filter(is_writable), file.to_str().filter(is_writable)) {
        (Some(name), _) => format!("\nto paste\n{}", line(name)),
        (None, Some(file)) => format!("\nto paste into a script beside it\n{}", line(file)),
        (None, None) => "\na script cannot name this file; rename it\n".to_owned(),
    }
}

/// A name that a script can declare.
fn scenario_name(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.starts_with(|c: char| c.is_ascii_digit()) { format!("u{plain}") } else { plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_json_has_limits_items_and_dependencies() {
        let xml = br#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="Tank" guid="g">
  <CoSimulation modelIdentifier="tank"/>
  <TypeDefinitions><SimpleType name="Valve"><Enumeration><Item name="shut" value="1"/><Item name="open" value="2"/></Enumeration>
  </SimpleType></TypeDefinitions>
  <ModelVariables>
    <ScalarVariable name="valve" valueReference="0" causality="input" variability="discrete"><Enumeration declaredType="Valve" start="2"/></ScalarVariable>
    <ScalarVariable name="level" valueReference="0" causality="output"><Real min="0"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2" dependencies="1"/></Outputs></ModelStructure>
</fmiModelDescription>"#;
        let (description, _) = fmi2::description::read::read(xml).unwrap();
        let json = serde_json::to_value(UnitPage::new(&description)).unwrap();
        let [valve, level] = [&json["variables"][0], &json["variables"][1]];
        assert_eq!((&valve["type"], &valve["start"]), (&"Enumeration".into(), &"open".into()));
        assert_eq!((&valve["items"][1]["name"], &valve["items"][1]["value"]), (&"open".into(), &2.into()));
        assert_eq!((&level["min"], &level["depends"]), (&0.0.into(), &serde_json::json!(["valve"])));
    }

    #[test]
    fn the_line_to_paste_names_the_unit_and_declares_a_name() {
        assert_eq!(to_paste(OsStr::new("units/my-tank.fmu")), "\nto paste\n  fmu my_tank = \"units/my-tank.fmu\"\n");
        assert_eq!(to_paste(OsStr::new("wind")), "\nto paste\n  fmu wind = \"wind\"\n");
    }
}
