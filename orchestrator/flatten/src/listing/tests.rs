//! Tests of the plan of a script, from its text.

use super::text;
use dsl::loader::{Loader, Problem, Table};
use dsl::parse::parse;
use dsl::parts::Parts;
use dsl::resolve::{Request, resolve};
use dsl::scenario::Scenario;
use dsl::source::{Source, Sources};
use fmi2::description::ModelDescription;
use fmi2::description::read::read;
use std::sync::Arc;

pub(crate) const TANK: &str = r#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="Tank" guid="g">
  <CoSimulation modelIdentifier="tank" canHandleVariableCommunicationStepSize="true"/>
  <UnitDefinitions>
    <Unit name="m"><BaseUnit m="1"/></Unit>
    <Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>
  </UnitDefinitions>
  <ModelVariables>
    <ScalarVariable name="inflow.x" valueReference="0" causality="input"><Real unit="m" start="0"/></ScalarVariable>
    <ScalarVariable name="inflow.y" valueReference="1" causality="input"><Real unit="m" start="0"/></ScalarVariable>
    <ScalarVariable name="fine" valueReference="2" causality="input"><Real unit="mm" start="0"/></ScalarVariable>
    <ScalarVariable name="mode" valueReference="3" causality="input" variability="discrete"><Integer start="0"/></ScalarVariable>
    <ScalarVariable name="level.x" valueReference="4" causality="output"><Real unit="m"/></ScalarVariable>
    <ScalarVariable name="level.y" valueReference="5" causality="output"><Real unit="m"/></ScalarVariable>
    <ScalarVariable name="spill" valueReference="6" causality="output"><Real unit="m"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs>
      <Unknown index="5" dependencies=""/><Unknown index="6" dependencies=""/><Unknown index="7" dependencies="1 2"/>
    </Outputs>
    <InitialUnknowns>
      <Unknown index="5" dependencies=""/><Unknown index="6" dependencies=""/><Unknown index="7" dependencies="1 2"/>
    </InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>"#;

const SCRIPT: &str = "\
scenario \"Three tanks\"
step 10 ms
stop 2 s
fmu first = \"tank\"
fmu second = \"tank\" every 20 ms
fmu third = \"tank\"
1 m * sin(2 rad/s * time) -> first.inflow.x
first.level -> second.inflow
first.spill => third.fine
first.level.x + second.level.x -> third.inflow.x
2 -> third.mode
assert low: always first.spill < 3 m
";

/// The one unit of the script.
struct Tank(Arc<ModelDescription>);

impl Loader for Tank {
    fn unit(&self, _: &Source, _: &str) -> Result<Arc<ModelDescription>, Problem> {
        Ok(Arc::clone(&self.0))
    }

    fn text(&self, _: &Source, path: &str) -> Result<Source, Problem> {
        unreachable!("the script names no text, but `{path}` was asked for")
    }

    fn file(&self, _: &Source, path: &str) -> Result<(), Problem> {
        unreachable!("the script names no file, but `{path}` was asked for")
    }

    fn table(&self, _: &Source, path: &str) -> Result<Table, Problem> {
        unreachable!("the script names no table, but `{path}` was asked for")
    }
}

/// The plan of a script whose instances all have the unit of this description.
fn plan(script: &str, description: &str) -> String {
    let (scenario, description) = resolved(script, description);
    text(&scenario, &vec![description.as_ref(); scenario.instances.len()])
}

/// A script whose instances all have the unit of this description, with that.
pub(crate) fn resolved(script: &str, description: &str) -> (Scenario, Arc<ModelDescription>) {
    let mut sources = Sources::default();
    let file = sources.add("three.scn", script);
    let parsed = parse(&sources, file);
    let (description, _) = read(description.as_bytes()).unwrap();
    let description = Arc::new(description);
    let tank = Tank(Arc::clone(&description));
    let resolved = resolve(&Request {
        sources: &sources,
        file: &parsed.file,
        parts: &Parts::default(),
        loader: &tank,
        settings: &[],
        case: None,
        isolated: false,
    });
    let scenario = resolved.scenario.unwrap_or_else(|| panic!("{:?}", resolved.diagnostics));
    (scenario, description)
}

#[test]
fn a_plan_shows_periods_waves_conversions_initialization_and_delays() {
    insta::assert_snapshot!(plan(SCRIPT, TANK));
}

/// Takes well below a second, and hours where the cost grows with a power of the number of connections.
#[test]
fn a_plan_costs_as_much_as_its_connections() {
    const PORTS: usize = 5_000;
    let each = |line: fn(usize) -> String| (1..=PORTS).map(line).collect::<String>();
    let variables = each(|n| {
        let variable = |name: &str, causality: &str, start: &str| {
            let head = format!(r#"<ScalarVariable name="{name}{n}" valueReference="{n}" causality="{causality}">"#);
            format!("{head}<Real{start}/></ScalarVariable>")
        };
        variable("u", "input", r#" start="0""#) + &variable("y", "output", "")
    });
    let outputs = each(|n| format!(r#"<Unknown index="{}"/>"#, 2 * n));
    let (before, behind) = TANK.split_once("<ModelVariables>").unwrap();
    let (_, behind) = behind.split_once("</ModelStructure>").unwrap();
    let structure = format!("<ModelStructure><Outputs>{outputs}</Outputs></ModelStructure>");
    let large = format!("{before}<ModelVariables>{variables}</ModelVariables>{structure}{behind}");
    let wires = each(|n| format!("{n} -> a.u{n}\na.y{n} -> b.u{n}\n"));
    let script = format!("scenario \"Large\"\nstep 1 s\nstop 2 s\nfmu a = \"tank\"\nfmu b = \"tank\"\n{wires}");
    let plan = plan(&script, &large);
    assert_eq!(plan.matches(" -> ").count(), 2 * PORTS, "{}", &plan[..1000]);
    assert!(plan.trim_end().ends_with(&format!("u{PORTS}")), "every output depends on every input");
}
