//! A script to start from: it loads units and connects what fits.

mod matching;

use std::fmt::Write;

use fmi2::description::{Causality, Kind, ModelDescription};
use fmi2::printable;

use crate::parse::parse_assignment;
use crate::scenario::duration;
use crate::source::Sources;
use crate::spelling;
use matching::{Match, Port, matches};

/// A unit with its names.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The name in the script.
    pub name: String,
    /// The text of its `fmu` line.
    pub unit: String,
    /// What it says of itself.
    pub description: ModelDescription,
}

/// A script for units, with the connections that its reader refuses left out.
#[derive(Debug)]
pub struct Skeleton<'a> {
    units: &'a [Loaded],
    matches: Vec<Match>,
    refused: Vec<bool>,
}

impl<'a> Skeleton<'a> {
    /// A script for units, with every connection that fits.
    #[must_use]
    pub fn of(units: &'a [Loaded]) -> Self {
        let matches = matches(units);
        Self { units, refused: vec![false; matches.len()], matches }
    }

    /// Makes a comment of a connection of [`Skeleton::text`].
    pub fn refuse(&mut self, connection: usize) {
        self.refused[connection] = true;
    }

    /// The script, and its lines, from 1, that are connections, each with the number of the connection.
    #[must_use]
    pub fn text(&self) -> (String, Vec<(usize, usize)>) {
        let (step, stop) = times(self.units);
        let names: Vec<_> = self.units.iter().map(|unit| unit.name.as_str()).collect();
        let title = spelling::text(&format!("A first run of {}", names.join(", ")));
        let mut text = format!("scenario {title}\nstep {step}\nstop {stop}\n\n");
        for unit in self.units {
            let _ = writeln!(text, "fmu {} = {}", unit.name, spelling::text(&unit.unit));
        }
        text.push('\n');
        let mut lines = Vec::new();
        for (index, found) in self.matches.iter().enumerate() {
            let is_connected = found.by_name && found.sources.len() == 1 && !self.refused[index];
            for source in &found.sources {
                let sign = if is_connected { "" } else { "# " };
                let line = format!("{sign}{} -> {}", written(self.units, source), written(self.units, &found.target));
                let why = match (is_connected, self.refused[index], found.by_name) {
                    (true, ..) => "",
                    (_, true, _) => "  # the units do not allow it together with the others",
                    (_, _, true) => "  # several fit",
                    (_, _, false) => "  # fits by its members",
                };
                let _ = writeln!(text, "{line}{why}");
            }
            if is_connected {
                lines.push((text.lines().count(), index));
            }
        }
        text.push('\n');
        text.push_str(&examples(self.units));
        (text, lines)
    }
}

/// A name for a unit in the script that no other has, from the name of its file or crate.
#[must_use]
pub fn name_of(stem: &str, others: &[Loaded]) -> String {
    let plain: String = stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let plain = if plain.starts_with(|c: char| c.is_ascii_digit()) { format!("u{plain}") } else { plain };
    let is_free = |name: &str| {
        let mut sources = Sources::default();
        let text = sources.add("name", format!("{name} = 1"));
        let is_declared = others.iter().any(|other| other.name == name);
        !is_declared && !matches!(name, "time" | "pi" | "seed") && parse_assignment(&sources, text).is_ok()
    };
    let numbered = (2..).map(|number| format!("{plain}_{number}"));
    std::iter::once(plain.clone()).chain(numbered).find(|name| is_free(name)).unwrap_or(plain)
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
            unit => format!(" {}", spelling::unit(unit)),
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
