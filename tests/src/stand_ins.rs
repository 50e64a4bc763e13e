//! Builds units from short C files whose comments name the ports: stand-ins for the units that a script names.
//!
//! A line `// input vehicle.position.{x,y,z} m` declares three Real inputs with their unit of measure, and the constant
//! `vehicle_position`: where the first of them stands in `R` of `tests/foreign/generic.c`. Its first word is `parameter`,
//! `input`, `output`, or `local` for what has a place but is no variable. In place of the unit of measure stands `Integer`,
//! `Boolean`, `String`, or the items of an enumeration as `slow|fast`; a number at the end is the start value. `begin(unit)`
//! computes the initial outputs from the parameters, `advance(unit)` makes a step. All files of a folder see its `points.h`.

use crate::foreign::Generic;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Units of measure and their exponents.
const UNITS: [(&str, &str); 8] = [
    ("1", ""),
    ("m", "m=\"1\""),
    ("s", "s=\"1\""),
    ("m/s", "m=\"1\" s=\"-1\""),
    ("m/s^2", "m=\"1\" s=\"-2\""),
    ("rad", "rad=\"1\""),
    ("rad/s", "rad=\"1\" s=\"-1\""),
    ("N", "kg=\"1\" m=\"1\" s=\"-2\""),
];

/// What the port lines of a C file declare.
#[derive(Default)]
struct Ports {
    /// The number of values in each array of `generic.c`.
    counts: BTreeMap<&'static str, usize>,
    /// C code: constants, and statements that set the start values.
    constants: String,
    starts: String,
    /// Elements of `modelDescription.xml`.
    variables: String,
    types: String,
}

#[allow(clippy::unwrap_used, reason = "a test that cannot build its unit has failed")]
impl Ports {
    fn of(source: &str) -> Self {
        let mut ports = Self::default();
        for line in source.lines() {
            let words: Vec<_> = line.split_whitespace().collect();
            if let ["//", role @ ("parameter" | "input" | "output" | "local"), name, kind, start @ ..] = &words[..]
                && start.len() < 2
            {
                ports.add(role, name, kind, start.first().copied());
            }
        }
        ports
    }

    /// Adds a port, or what is only `local`.
    fn add(&mut self, role: &str, name: &str, kind: &str, start: Option<&str>) {
        let (array, element) = match kind {
            "Integer" => ("I", "Integer".to_owned()),
            "Boolean" => ("B", "Boolean".to_owned()),
            "String" => ("S", "String".to_owned()),
            items if items.contains('|') => {
                let items = items.split('|').enumerate();
                let items: String =
                    items.map(|(i, item)| format!("<Item name=\"{item}\" value=\"{}\"/>", i + 1)).collect();
                write!(self.types, "<SimpleType name=\"{name} type\"><Enumeration>{items}</Enumeration></SimpleType>")
                    .unwrap();
                ("I", format!("Enumeration declaredType=\"{name} type\""))
            }
            unit => {
                assert!(UNITS.iter().any(|(known, _)| *known == unit), "{name}: no unit of measure is called {unit}");
                ("R", format!("Real unit=\"{unit}\""))
            }
        };
        let count = self.counts.entry(array).or_default();
        let constant = name.split(['[', ']']).step_by(2).collect::<String>();
        let constant = constant.split(".{").next().unwrap_or_default().replace('.', "_");
        writeln!(self.constants, "enum {{ {constant} = {count} }};").unwrap();
        let variability = match (role, array) {
            ("parameter", _) => "fixed",
            (_, "R") => "continuous",
            _ => "discrete",
        };
        for variable in elements(name) {
            let place = *count;
            *count += 1;
            let start = match (role, array) {
                ("output" | "local", _) => String::new(),
                (_, "S") => " start=\"\"".to_owned(),
                (_, "B") => " start=\"false\"".to_owned(),
                _ => {
                    let start = start.unwrap_or("0");
                    writeln!(self.starts, "{array}[{place}] = {start};").unwrap();
                    format!(" start=\"{start}\"")
                }
            };
            if role != "local" {
                write!(
                    self.variables,
                    "<ScalarVariable name=\"{variable}\" valueReference=\"{place}\" causality=\"{role}\" \
                     variability=\"{variability}\"><{element}{start}/></ScalarVariable>"
                )
                .unwrap();
            }
        }
    }
}

/// The names of the elements of `a[1..2].{x,y}`: `a[1].x`, `a[1].y`, `a[2].x`, `a[2].y`.
fn elements(name: &str) -> Vec<String> {
    let Some((before, rest)) = name.split_once(['[', '{']) else { return vec![name.to_owned()] };
    let (inside, after) = rest.split_once([']', '}']).unwrap_or_default();
    let choices = if inside.contains("..") { indices(inside) } else { inside.split(',').map(str::to_owned).collect() };
    let endings = elements(after);
    choices.iter().flat_map(|choice| endings.iter().map(move |ending| format!("{before}{choice}{ending}"))).collect()
}

/// All indices of ranges: `1..2,1..2` gives `[1,1]`, `[1,2]`, `[2,1]`, `[2,2]`.
#[allow(clippy::unwrap_used, reason = "a test that cannot build its unit has failed")]
fn indices(ranges: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    for range in ranges.split(',') {
        let last: usize = range.strip_prefix("1..").unwrap().parse().unwrap();
        all = all.iter().flat_map(|before| (1..=last).map(move |index| format!("{before},{index}"))).collect();
    }
    all.iter().map(|index| format!("[{}]", &index[1..])).collect()
}

/// Builds a C file to a unit of its name in a folder.
///
/// # Panics
/// If the file cannot be read, declares a port of an unknown unit of measure, or does not compile.
#[allow(clippy::unwrap_used, reason = "a test that cannot build its unit has failed")]
pub fn pack(source: &Path, folder: &Path) {
    let text = fs::read_to_string(source).unwrap();
    let ports = Ports::of(&text);
    let scratch = tempfile::tempdir().unwrap();
    let functions = scratch.path().join("functions.h");
    let Ports { constants, starts, .. } = &ports;
    let starts = format!("static void set_starts(struct unit *unit) {{\n{starts}}}\n");
    fs::write(&functions, format!("{constants}{starts}#include \"{}\"\n", source.display())).unwrap();
    let units: String =
        UNITS.iter().map(|(name, base)| format!("<Unit name=\"{name}\"><BaseUnit {base}/></Unit>")).collect();
    let types = if ports.types.is_empty() {
        String::new()
    } else {
        format!("<TypeDefinitions>{}</TypeDefinitions>", ports.types)
    };
    let quoted = |path: &Path| format!("\"{}\"", path.display());
    let generic = Generic {
        definitions: &format!("<UnitDefinitions>{units}</UnitDefinitions>{types}"),
        variables: &ports.variables,
        code: &[
            ("COUNT", &ports.counts.values().max().unwrap().to_string()),
            ("INCLUDES", &quoted(&source.with_file_name("points.h"))),
            ("FUNCTIONS", &quoted(&functions)),
            ("INSTANTIATE_CODE", "set_starts(unit)"),
            ("GET_CODE", "if (MODE == 1) begin(unit)"),
            ("STEP_CODE", "advance(unit)"),
        ],
        ..Generic::default()
    };
    generic.pack(folder, &source.file_stem().unwrap().to_string_lossy());
}

#[cfg(test)]
mod tests {
    use super::elements;

    #[test]
    fn names_of_elements_run_through_their_last_part_first() {
        assert_eq!(elements("a[1..2].{x,y}.b"), ["a[1].x.b", "a[1].y.b", "a[2].x.b", "a[2].y.b"]);
        assert_eq!(elements("m[1..2,1..2]"), ["m[1,1]", "m[1,2]", "m[2,1]", "m[2,2]"]);
        assert_eq!(elements("time"), ["time"]);
    }
}
