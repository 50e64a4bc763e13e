//! Tests of the plan of a script, from its text.

use super::{duration, text};
use dsl::parse::parse;
use dsl::resolve::{Request, Units, resolve};
use dsl::source::Sources;
use fmi2::description::read::read;
use std::sync::Arc;

const TANK: &str = r#"<?xml version="1.0"?>
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

#[test]
fn a_plan_shows_periods_waves_conversions_initialization_and_delays() {
    let mut sources = Sources::default();
    let file = sources.add("three.scn", SCRIPT);
    let parsed = parse(&sources, file);
    let (description, _) = read(TANK.as_bytes()).unwrap();
    let description = Arc::new(description);
    let units = Units::from([("tank".to_owned(), Ok(Arc::clone(&description)))]);
    let resolved = resolve(&Request { sources: &sources, file: &parsed.file, units: &units, settings: &[] });
    let scenario = resolved.scenario.unwrap_or_else(|| panic!("{:?}", resolved.diagnostics));
    insta::assert_snapshot!(text(&scenario, &[description.as_ref(); 3]));
}

#[test]
fn a_period_is_told_in_the_largest_unit_that_fits() {
    let told = [2_000_000_000, 5_000_000, 1_500, 7].map(duration);
    assert_eq!(told, ["2 s", "5 ms", "1500 ns", "7 ns"]);
}
