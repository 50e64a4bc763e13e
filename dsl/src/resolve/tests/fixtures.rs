//! Units for the tests, in one line for each variable, and the way from a script to what a user sees.

use std::fmt::Write;
use std::sync::Arc;

use fmi2::description::ModelDescription;
use fmi2::description::read::read;

use crate::diagnostic::{Diagnostic, render};
use crate::loader::{Loader, Problem, Table, TableColumn};
use crate::parse::{parse, parse_assignment};
use crate::parts::Parts;
use crate::resolve::{Case, Request, Resolved, resolve};
use crate::scenario::Scenario;
use crate::source::{Source, Sources, Span};

const QUADCOPTER: &str = "
    input continuous Real wind.x m/s start=0
    input continuous Real wind.y m/s start=0
    input continuous Real wind.z m/s start=0
    input continuous Real rotor_speed[1] rad/s start=0
    input continuous Real rotor_speed[2] rad/s start=0
    input continuous Real moment N*m start=0
    parameter fixed Real mass kg start=1.6
    parameter fixed Real position0.x m start=0
    parameter fixed Real position0.y m start=0
    parameter fixed Real position0.z m start=0
    parameter tunable Real drag 1 start=0.1
    parameter tunable Real trim rad start=0
    output continuous Real state.position.x m initial=exact start=0
    output continuous Real state.position.y m initial=exact start=0
    output continuous Real state.position.z m initial=exact start=0
    output continuous Real state.attitude.w 1 initial=exact start=1
    output continuous Real roll deg initial=exact start=0
    output continuous Real height ft initial=exact start=0
    output discrete Boolean landed - initial=exact start=true";

const CONTROLLER: &str = "
    input continuous Real state.position.x m start=0
    input continuous Real state.position.y m start=0
    input continuous Real state.position.z m start=0
    input continuous Real setpoint.x m start=0
    input continuous Real setpoint.y m start=0
    input discrete Integer count - start=0
    input discrete Boolean armed - start=false
    input discrete Enumeration mode Mode start=1
    input discrete String note - start=none
    input continuous Real raw - start=0
    input continuous Real unset m
    parameter fixed Real tilt_max rad start=0.4
    parameter fixed Real heading0 - start=0
    parameter fixed Integer levels - start=3
    parameter fixed Enumeration method Mode start=1
    parameter fixed String map - start=none
    parameter fixed Integer seed - start=1
    parameter fixed Integer stream - start=0
    output continuous Real rotor_speed[1] rad/s deps=state.position.z,setpoint.x
    output continuous Real rotor_speed[2] rad/s deps=state.position.z,setpoint.x
    output continuous Real thrust N deps=state.position.z
    output continuous Real bare - deps=
    output continuous Real temperature degC deps=
    output discrete Integer events - initial=exact start=0
    output discrete Enumeration now Mode initial=exact start=1
    output discrete String said - initial=exact start=none
    local continuous Real error m deps=";

const WIND: &str = "
    parameter fixed Real mean.x m/s start=0
    parameter fixed Real mean.y m/s start=0
    parameter fixed Real mean.z m/s start=0
    parameter fixed Integer seed - start=1
    parameter fixed Integer stream - start=0
    output continuous Real velocity.x m/s initial=exact start=0
    output continuous Real velocity.y m/s initial=exact start=0
    output continuous Real velocity.z m/s initial=exact start=0";

/// Temperatures and differences of them, and pressures over the ambient one.
const HEATER: &str = "
    input continuous Real riseK K relative=true start=0
    input continuous Real riseF degF relative=true start=0
    input continuous Real tempK K start=0
    input continuous Real tempC degC start=0
    input continuous Real over barg relative=true start=0
    input continuous Real plain m start=0
    parameter tunable Real dT degC relative=true start=0
    output continuous Real rise degC relative=true deps=
    output continuous Real temp degC deps=
    output continuous Real other degC deps=
    output continuous Real error K deps=
    output continuous Real pressure barg deps=
    output continuous Real gap m relative=true deps=";

/// Units of measure that are declared and not defined.
const UNDEFINED: &str = "
    input continuous Real v km/h start=0
    input continuous Real w fathom start=0
    input continuous Real known m/s start=0
    output continuous Real o cm/s deps=
    output continuous Real p km/h deps=
    output continuous Real q m/s deps=
    output continuous Real bare - deps=";

/// A unit whose `gal` is that of its country.
const TANK: &str = "
    parameter fixed Real v gal start=1
    input continuous Real u gal start=0
    output continuous Real w gal initial=exact start=1";

/// Two inputs of one name, which no valid description has.
const REPEATED: &str = "
    input continuous Real u - start=1
    input continuous Real u - start=2
    input continuous Real u.x - start=3
    output continuous Real y - deps=";

/// Variables with limits.
const LIMITED: &str = "
    parameter tunable Real part - min=0 max=10 start=1
    parameter fixed Real angle deg min=-90 max=90 start=0
    parameter fixed Integer count - min=1 start=1
    parameter fixed Enumeration method Mode max=2 start=1
    input continuous Real level m min=0.5 start=1
    input discrete Enumeration mode Mode start=1
    input discrete Enumeration turned Turned start=1
    input discrete Enumeration moved Moved start=1
    output discrete Integer number - initial=exact start=1
    output discrete Enumeration now Mode initial=exact start=1";

const UNITS: &str = r#"<UnitDefinitions>
    <Unit name="m"><BaseUnit m="1"/></Unit> <Unit name="1"><BaseUnit/></Unit>
    <Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit> <Unit name="kg"><BaseUnit kg="1"/></Unit>
    <Unit name="rad"><BaseUnit rad="1"/></Unit> <Unit name="rad/s"><BaseUnit rad="1" s="-1"/></Unit>
    <Unit name="deg"><BaseUnit rad="1" factor="0.017453292519943295"/></Unit>
    <Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit> <Unit name="N*m"><BaseUnit kg="1" m="2" s="-2"/></Unit>
    <Unit name="ft"><BaseUnit m="1" factor="0.3048"/></Unit>
    <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit> <Unit name="K"><BaseUnit K="1"/></Unit>
    <Unit name="degF"><BaseUnit K="1" factor="0.5555555555555556" offset="255.3722222222222"/></Unit>
    <Unit name="barg"><BaseUnit kg="1" m="-1" s="-2" factor="100000" offset="101325"/></Unit>
    <Unit name="slug"><BaseUnit kg="1" factor="14.593903"/></Unit>
    <Unit name="lm"><BaseUnit m="1" factor="9.461e15"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions><SimpleType name="Mode"><Enumeration>
    <Item name="idle" value="1"/><Item name="hover" value="2"/><Item name="land" value="5"/>
  </Enumeration></SimpleType><SimpleType name="Turned"><Enumeration>
    <Item name="land" value="5"/><Item name="idle" value="1"/><Item name="hover" value="2"/>
  </Enumeration></SimpleType><SimpleType name="Moved"><Enumeration>
    <Item name="idle" value="1"/><Item name="hover" value="3"/><Item name="land" value="5"/>
  </Enumeration></SimpleType></TypeDefinitions>"#;

/// A description out of one line for each variable: causality, variability, type, name, unit or type name, and
/// `start=`, `min=`, `max=`, `relative=`, `initial=`, `deps=` (names; an output without is free of inputs).
pub(in crate::resolve) fn description(name: &str, lines: &str) -> ModelDescription {
    description_with(name, "", lines)
}

/// The same with further definitions of units of measure.
fn description_with(name: &str, units: &str, lines: &str) -> ModelDescription {
    let all_units = UNITS.replacen("<UnitDefinitions>", &format!("<UnitDefinitions>{units}"), 1);
    let lines: Vec<Vec<&str>> = lines
        .lines()
        .map(|line| line.split_whitespace().collect())
        .filter(|words: &Vec<_>| !words.is_empty())
        .collect();
    let (mut variables, mut outputs, mut unknowns) = (String::new(), String::new(), String::new());
    for (index, words) in lines.iter().enumerate() {
        let [causality, variability, kind, variable, unit, rest @ ..] = words.as_slice() else { panic!("{words:?}") };
        let value = |key: &str| rest.iter().find_map(|word| word.strip_prefix(key));
        let initial = value("initial=").map(|initial| format!(" initial='{initial}'")).unwrap_or_default();
        let attribute =
            |key: &str, name: &str| value(key).map(|value| format!(" {name}='{value}'")).unwrap_or_default();
        let start = attribute("start=", "start") + &attribute("min=", "min") + &attribute("max=", "max");
        let start = start + &attribute("relative=", "relativeQuantity");
        let declared = match (*kind, *unit) {
            (_, "-") => String::new(),
            ("Enumeration", name) => format!(" declaredType='{name}'"),
            (_, unit) => format!(" unit='{unit}'"),
        };
        write!(variables, "<ScalarVariable name='{variable}' valueReference='{index}' causality='{causality}' variability='{variability}'{initial}><{kind}{declared}{start}/></ScalarVariable>").unwrap();
        let position = |name: &str| 1 + lines.iter().position(|words| words[3] == name).expect("a declared variable");
        let places = value("deps=").unwrap_or_default().split(',').filter(|name| !name.is_empty()).map(position);
        let places = places.map(|place| place.to_string()).collect::<Vec<_>>().join(" ");
        let unknown = format!("<Unknown index='{}' dependencies='{places}'/>", index + 1);
        outputs += if *causality == "output" { &unknown } else { "" };
        unknowns += if value("deps=").is_some() { &unknown } else { "" };
    }
    let xml = format!(
        "<?xml version='1.0' encoding='UTF-8'?><fmiModelDescription fmiVersion='2.0' modelName='{name}' guid='{name}'>
         <CoSimulation modelIdentifier='{name}'/>{all_units}<ModelVariables>{variables}</ModelVariables>
         <ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns></ModelStructure>
         </fmiModelDescription>"
    );
    read(xml.as_bytes()).map_or_else(|finding| panic!("{name}: {finding:?}"), |(description, _)| description)
}

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
        Case { number, place: Span { text: sources.add("--case", written), start: 0, end } }
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
