//! `lockstep new scenario`: a script that loads units and connects what fits.

use super::matching::{Match, Named, Port, matches};
use crate::cli::describe::scenario_name;
use crate::find::catalogue::{Catalogue, is_archive};
use crate::find::preparation::{self, Refusal};
use crate::find::script::Script;
use dsl::format::format;
use dsl::parse::parse_assignment;
use dsl::scenario::duration;
use dsl::source::Sources;
use dsl::spelling;
use fmi2::description::{Causality, Kind, ModelDescription};
use fmi2::printable;
use results::report;
use std::ffi::OsString;
use std::fmt::Write;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A script for units.
#[derive(Debug, clap::Args)]
pub(super) struct Scenario {
    /// Units as scripts name them, and .fmu files; one that is named twice is loaded twice
    #[arg(value_name = "UNIT", required = true)]
    units: Vec<OsString>,
    /// The script to write, which must not exist [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Where units are looked for before the workspace
    #[arg(long = "units", value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Never build a unit
    #[arg(long)]
    no_build: bool,
}

/// A unit with its names.
struct Loaded {
    name: String,
    /// The text of its `fmu` line.
    unit: String,
    description: ModelDescription,
}

impl Scenario {
    /// Runs the command and returns its exit code.
    pub fn run(&self) -> u8 {
        let mut catalogue = match preparation::catalogue(&self.folders, !self.no_build) {
            Ok(catalogue) => catalogue,
            Err(refusal) => return refused(&refusal),
        };
        let text = self.loaded(&mut catalogue).map(|loaded| checked(&loaded, self.folder(), &catalogue));
        let written = text.and_then(|text| match &self.out {
            None => {
                report::result(&text);
                Ok(())
            }
            Some(out) => {
                let written = fs::File::create_new(out).and_then(|mut file| file.write_all(text.as_bytes()));
                let problem = |error| Refusal::new(&format!("cannot write {}: {error}", printable::path(out)), None);
                written.map_err(problem).map(|()| report::result(&format!("{}\n", printable::path(out))))
            }
        });
        written.map_or_else(|refusal| refused(&refusal), |()| 0)
    }

    /// The folder that paths in the script are relative to.
    fn folder(&self) -> &Path {
        let folder = self.out.as_deref().and_then(Path::parent);
        folder.filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
    }

    fn loaded(&self, catalogue: &mut Catalogue) -> Result<Vec<Loaded>, Refusal> {
        let mut loaded: Vec<Loaded> = Vec::new();
        for given in &self.units {
            let unit = catalogue.name_of(given);
            let problem = |problem: dsl::loader::Problem| Refusal::new(&problem.message, problem.help.as_deref());
            let archive = catalogue.find(&unit, Path::new(".")).map_err(problem)?;
            let (description, _) =
                unit::archive::read_description(&archive).map_err(|error| Refusal::new(&error.of_unit(&unit), None))?;
            let name = name_of(&unit, &loaded);
            loaded.push(Loaded { name, unit: self.written(&unit)?, description });
        }
        Ok(loaded)
    }

    /// A unit as the script names it: a path is relative to the script, or absolute where that is in another folder.
    fn written(&self, unit: &str) -> Result<String, Refusal> {
        if !is_archive(Path::new(unit)) || self.folder() == Path::new(".") {
            return Ok(unit.to_owned());
        }
        let path = Path::new(unit).canonicalize().ok().and_then(|path| path.to_str().map(str::to_owned));
        path.ok_or_else(|| Refusal::new(&format!("a script cannot name {unit}"), Some("rename the file")))
    }
}

fn refused(refusal: &Refusal) -> u8 {
    report::status(refusal.0.trim_end());
    2
}

/// The name of a unit in the script, which no other has.
fn name_of(unit: &str, others: &[Loaded]) -> String {
    let path = Path::new(unit);
    let stem = if is_archive(path) { path.file_stem() } else { path.file_name() };
    let plain = scenario_name(&stem.unwrap_or_default().to_string_lossy());
    let is_free = |name: &str| {
        let mut sources = Sources::default();
        let text = sources.add("name", format!("{name} = 1"));
        let is_declared = others.iter().any(|other| other.name == name);
        !is_declared && !matches!(name, "time" | "pi" | "seed") && parse_assignment(&sources, text).is_ok()
    };
    let numbered = (2..).map(|number| format!("{plain}_{number}"));
    std::iter::once(plain.clone()).chain(numbered).find(|name| is_free(name)).unwrap_or(plain)
}

/// The script in the style of the language. A connection that the units do not allow becomes a comment.
fn checked(units: &[Loaded], folder: &Path, catalogue: &Catalogue) -> String {
    let named: Vec<_> =
        units.iter().map(|unit| Named { name: unit.name.clone(), description: &unit.description }).collect();
    let matches = matches(&named);
    let mut refused = vec![false; matches.len()];
    loop {
        let (text, lines) = skeleton(units, &matches, &refused);
        let script = Script::of_text("script".to_owned(), folder.to_owned(), text, &[], catalogue, false);
        let errors = script.diagnostics.iter().filter(|diagnostic| diagnostic.is_error());
        let places = errors.flat_map(|error| &error.labels);
        let wrong: Vec<_> = places.map(|label| script.sources.line_and_column(label.span).0).collect();
        // The last connection of a circle gives way.
        match lines.iter().rfind(|(line, _)| wrong.contains(line)) {
            Some(&(_, index)) => refused[index] = true,
            None => return format(&script.sources, 0).unwrap_or(script.text),
        }
    }
}

/// A script, and which of its lines is which connection.
fn skeleton(units: &[Loaded], matches: &[Match], refused: &[bool]) -> (String, Vec<(usize, usize)>) {
    let (step, stop) = times(units);
    let names: Vec<_> = units.iter().map(|unit| unit.name.as_str()).collect();
    let title = spelling::text(&format!("A first run of {}", names.join(", ")));
    let mut text = format!("scenario {title}\nstep {step}\nstop {stop}\n\n");
    for unit in units {
        let _ = writeln!(text, "fmu {} = {}", unit.name, spelling::text(&unit.unit));
    }
    text.push('\n');
    let mut lines = Vec::new();
    for (index, found) in matches.iter().enumerate() {
        let is_connected = found.by_name && found.sources.len() == 1 && !refused[index];
        for source in &found.sources {
            let sign = if is_connected { "" } else { "# " };
            let line = format!("{sign}{} -> {}", written(units, source), written(units, &found.target));
            let why = match (is_connected, refused[index], found.by_name) {
                (true, ..) => "",
                (_, true, _) => "  (the units do not allow it together with the others)",
                (_, _, true) => "  (several fit)",
                (_, _, false) => "  (fits by its members)",
            };
            let _ = writeln!(text, "{line}{why}");
        }
        if is_connected {
            lines.push((text.lines().count(), index));
        }
    }
    text.push('\n');
    text.push_str(&examples(units));
    (text, lines)
}

fn written(units: &[Loaded], port: &Port) -> String {
    format!("{}.{}", units[port.unit].name, spelling::variable(&port.name))
}

/// An `assert` and a `record` line as comments.
fn examples(units: &[Loaded]) -> String {
    let outputs = units.iter().flat_map(|unit| {
        let outputs = unit.description.variables.iter().filter(|variable| variable.causality == Causality::Output);
        outputs.map(move |variable| (unit, variable))
    });
    let outputs: Vec<_> = outputs.collect();
    let name = |unit: &Loaded, name: &str| format!("{}.{}", unit.name, spelling::variable(name));
    let mut text = String::new();
    if let Some((unit, variable)) = outputs.iter().find(|(_, variable)| matches!(variable.kind, Kind::Real(_))) {
        let measure = unit.description.unit_of(variable).filter(|measure| *measure != "1").unwrap_or_default();
        let measure = match measure {
            "" => String::new(),
            plain if fmi2::units::parse(plain).is_ok() => format!(" {plain}"),
            own => format!(" '{own}'"),
        };
        let _ = writeln!(text, "# assert small: always abs({}) < 1{measure}", name(unit, &variable.name));
    }
    let first: Vec<_> = outputs.iter().take(3).map(|(unit, variable)| name(unit, &variable.name)).collect();
    if !first.is_empty() {
        let _ = writeln!(text, "# record {}", first.join(", "));
    }
    printable::lines(&text)
}

/// Step and stop time: the least step and the last stop time that a unit proposes.
fn times(units: &[Loaded]) -> (String, String) {
    const STEP_NS: u64 = 10_000_000;
    const STOP_S: f64 = 10.0;
    let experiments = || units.iter().filter_map(|unit| unit.description.default_experiment.as_ref());
    let whole_ns = |seconds: f64| Some((seconds * 1e9).round()).filter(|ns| (1.0..=1e15).contains(ns));
    let step_ns = experiments().filter_map(|experiment| whole_ns(experiment.step_size?)).map(|ns| ns as u64).min();
    let step_ns = step_ns.unwrap_or(STEP_NS);
    let stop_s = experiments().filter_map(|experiment| experiment.stop_time).filter(|stop| *stop > 0.0);
    let stop_ns = stop_s.fold(None, |last: Option<f64>, stop| Some(last.map_or(stop, |last| last.max(stop))));
    let stop_ns = whole_ns(stop_ns.unwrap_or(STOP_S)).unwrap_or(STOP_S * 1e9) as u64;
    (duration(step_ns), duration(stop_ns.div_ceil(step_ns) * step_ns))
}
