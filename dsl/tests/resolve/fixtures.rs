//! What the tests' scripts name, and the way from a script to what a user sees.

use std::sync::Arc;

use fmi2::description::ModelDescription;

use super::units::{
    CONTROLLER, HEATER, LIMITED, QUADCOPTER, REPEATED, TANK, UNDEFINED, WIND, description, description_with,
};
use dsl::diagnostic::{Diagnostic, render};
use dsl::loader::{Loader, Problem, Table, TableColumn};
use dsl::parse::{parse, parse_assignment};
use dsl::parts::Parts;
use dsl::resolve::{AskedCase, Request, Resolved, resolve};
use dsl::scenario::Scenario;
use dsl::source::{Source, Sources, Span};

/// A part with a value, units and a claim.
const UAV: &str = "param speed = 3 m/s
fmu air = \"wind\" every 20 ms { mean = [speed, 0 m/s, 0 m/s], seed = seed, stream = 7 }
fmu body = \"quadcopter\"
let double = 2 * speed
let ways = [body.roll, 2 * body.roll]
air.velocity -> body.wind
assert low: always body.state.position.z < 100 m
";

/// The units of the tests, parts and a table.
pub(super) struct Memory;

fn missing(what: &str, name: &str) -> Problem {
    let help = Some("units of this workspace: quadcopter, wind".to_owned());
    Problem { message: format!("there is no {what} `{name}`"), help }
}

impl Loader for Memory {
    fn unit(&self, _: &Source, name: &str) -> Result<Arc<ModelDescription>, Problem> {
        let lines = match name {
            "quadcopter" => QUADCOPTER,
            "quadcopter_controller" => CONTROLLER,
            "wind" => WIND,
            "heater" => HEATER,
            "undefined" => UNDEFINED,
            "repeated" => REPEATED,
            "limited" => LIMITED,
            "us" | "uk" => {
                let factor = if name == "us" { "0.003785411784" } else { "0.00454609" };
                let gallon = format!("<Unit name='gal'><BaseUnit m='3' factor='{factor}'/></Unit>");
                return Ok(Arc::new(description_with(name, &gallon, TANK)));
            }
            _ => return Err(missing("unit", name)),
        };
        Ok(Arc::new(description(name, lines)))
    }

    fn text(&self, _: &Source, path: &str) -> Result<Source, Problem> {
        let text = match path {
            "part.scn" => "param slot = 1 m\n",
            "uav.scn" => UAV,
            "pair.scn" => "use left = \"uav.scn\"\nfor k in 1..2 { use more[k] = \"uav.scn\" { speed = k * 2 m/s } }",
            "circle.scn" => "use again = \"circle.scn\"",
            "run.scn" => "scenario \"A run\"\nstep 1 s\nstop 2 s\nstop when true\nsweep { seed in 1..2 }",
            "broken.scn" => "param = 3 m\n",
            _ => return Err(missing("file", path)),
        };
        Ok(Source::new(path, text))
    }

    fn file(&self, _: &Source, path: &str) -> Result<(), Problem> {
        if path.starts_with("..") {
            return Err(Problem { message: format!("there is no file `{path}`"), help: None });
        }
        Ok(())
    }

    fn table(&self, _: &Source, path: &str) -> Result<Table, Problem> {
        let column = |name: &str, unit: Option<&str>, values: [f64; 2]| TableColumn {
            name: name.to_owned(),
            unit: unit.map(str::to_owned),
            values: values.to_vec(),
            held: name == "on",
        };
        let columns = vec![
            column("u", Some("m/s"), [1.5, 2.5]),
            column("place.x", Some("ft"), [0.0, 1.0]),
            column("place.y", Some("m"), [0.0, 1.0]),
            column("place.z", None, [0.0, 1.0]),
            column("on", None, [0.0, 1.0]),
            column("bad", Some("mph/h"), [0.0, 1.0]),
        ];
        match path {
            "in.csv" => Ok(Table { time_s: vec![0.0, 10.0], columns }),
            _ => Err(missing("file", path)),
        }
    }
}

/// A script with its meaning.
pub(super) struct Outcome {
    sources: Sources,
    /// The result.
    pub resolved: Resolved,
}

/// Resolves a script with settings of the command line.
pub(super) fn run_with(script: &str, settings: &[&str]) -> Outcome {
    attempt(script, settings, None).unwrap_or_else(|syntax| panic!("{syntax}"))
}

/// The same for a case of the script's sweep.
pub(super) fn run_case(script: &str, settings: &[&str], case: u64) -> Outcome {
    attempt(script, settings, Some(case)).unwrap_or_else(|syntax| panic!("{syntax}"))
}

/// Resolves a script if it parses.
pub(super) fn try_run(script: &str) -> Option<Outcome> {
    attempt(script, &[], None).ok()
}

fn attempt(script: &str, settings: &[&str], case: Option<u64>) -> Result<Outcome, String> {
    let mut sources = Sources::default();
    let text = sources.add("test.scn", script);
    let settings: Vec<_> = settings.iter().map(|setting| sources.add("--set", *setting)).collect();
    let parsed = parse(&sources, text);
    if !parsed.diagnostics.is_empty() {
        return Err(render(&sources, &parsed.diagnostics, false));
    }
    let settings: Vec<_> = settings
        .into_iter()
        .map(|setting| parse_assignment(&sources, setting).expect("a setting that parses"))
        .collect();
    let case = case.map(|number| {
        let written = number.to_string();
        let end = u32::try_from(written.len()).expect("a short text");
        AskedCase { number, place: Span { text: sources.add("--case", written), start: 0, end } }
    });
    let (file, loader) = (&parsed.file, &Memory);
    let parts = Parts::load(&mut sources, file, loader);
    if !parts.diagnostics.is_empty() {
        return Err(render(&sources, &parts.diagnostics, false));
    }
    let request =
        Request { sources: &sources, file, parts: &parts, loader, settings: &settings, case, isolated: false };
    let resolved = resolve(&request);
    Ok(Outcome { sources, resolved })
}

/// What is wrong with a script, whether it parses or not, without findings about forgotten connections; and its text.
pub(super) fn findings(script: &str) -> (Sources, Vec<Diagnostic>) {
    let mut sources = Sources::default();
    let text = sources.add("test.scn", script);
    let parsed = parse(&sources, text);
    if !parsed.diagnostics.is_empty() {
        return (sources, parsed.diagnostics);
    }
    let parts = Parts::load(&mut sources, &parsed.file, &Memory);
    let request = Request {
        sources: &sources,
        file: &parsed.file,
        parts: &parts,
        loader: &Memory,
        settings: &[],
        case: None,
        isolated: false,
    };
    let mut found = resolve(&request).diagnostics;
    found.retain(|finding| !is_about_completeness(finding));
    (sources, found)
}

/// Whether a finding is about what the scripts of most tests have on purpose: units that are not connected.
fn is_about_completeness(finding: &Diagnostic) -> bool {
    matches!(finding.code, "W02" | "W06")
}

impl Outcome {
    /// Its findings as a user sees them, without those about forgotten connections.
    pub fn shown(mut self) -> String {
        self.resolved.diagnostics.retain(|finding| !is_about_completeness(finding));
        render(&self.sources, &self.resolved.diagnostics, false)
    }
}

/// What a user sees of all errors and warnings of a script, those about forgotten connections included.
pub(super) fn all_shown(script: &str) -> String {
    let outcome = run_with(script, &[]);
    render(&outcome.sources, &outcome.resolved.diagnostics, false)
}

/// What a user sees of a script's errors and warnings, without those about forgotten connections.
pub(super) fn shown(script: &str) -> String {
    shown_with(script, &[])
}

/// The first line of each of a script's errors and warnings, and its help.
pub(super) fn headings(script: &str) -> String {
    let is_heading = |line: &&str| line.starts_with(['e', 'w']) || line.trim_start().starts_with("= help");
    shown(script).lines().filter(is_heading).map(str::trim_start).collect::<Vec<_>>().join("\n")
}

/// The same, with settings of the command line.
pub(super) fn shown_with(script: &str, settings: &[&str]) -> String {
    run_with(script, settings).shown()
}

/// The lines every script has, three units, and then `lines`.
pub(super) fn flight(lines: &str) -> String {
    let head = "scenario \"Test\"\nstep 10 ms\nstop 60 s\n";
    let units =
        "fmu wind = \"wind\"\nfmu quad = \"quadcopter\"\nfmu ctrl = \"quadcopter_controller\" { unset = 0 m }\n";
    format!("{head}{units}{lines}\n")
}

/// The scenario of a script without errors or warnings, apart from those about forgotten connections.
pub(super) fn scenario(script: &str) -> Scenario {
    scenario_with(script, &[])
}

/// The same, with settings of the command line.
pub(super) fn scenario_with(script: &str, settings: &[&str]) -> Scenario {
    let outcome = run_with(script, settings);
    assert!(
        outcome.resolved.diagnostics.iter().all(is_about_completeness),
        "{}",
        render(&outcome.sources, &outcome.resolved.diagnostics, false)
    );
    outcome.resolved.scenario.expect("a script without errors has a meaning")
}

/// The warnings about a script without errors, and its scenario.
pub(super) fn scenario_with_warnings(script: &str) -> (String, Scenario) {
    let Outcome { sources, mut resolved } = run_with(script, &[]);
    resolved.diagnostics.retain(|finding| !is_about_completeness(finding));
    let warnings = render(&sources, &resolved.diagnostics, false);
    (warnings, resolved.scenario.expect("a script without errors has a meaning"))
}
