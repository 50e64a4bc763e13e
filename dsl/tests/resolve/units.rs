//! Descriptions of units for the tests, in one line for each variable.

use std::fmt::Write;

use fmi2::description::ModelDescription;
use fmi2::description::read::read;

pub(super) const QUADCOPTER: &str = "
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

pub(super) const CONTROLLER: &str = "
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

pub(super) const WIND: &str = "
    parameter fixed Real mean.x m/s start=0
    parameter fixed Real mean.y m/s start=0
    parameter fixed Real mean.z m/s start=0
    parameter fixed Integer seed - start=1
    parameter fixed Integer stream - start=0
    output continuous Real velocity.x m/s initial=exact start=0
    output continuous Real velocity.y m/s initial=exact start=0
    output continuous Real velocity.z m/s initial=exact start=0";

/// Temperatures and differences of them, and pressures over the ambient one.
pub(super) const HEATER: &str = "
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
pub(super) const UNDEFINED: &str = "
    input continuous Real v km/h start=0
    input continuous Real w fathom start=0
    input continuous Real known m/s start=0
    output continuous Real o cm/s deps=
    output continuous Real p km/h deps=
    output continuous Real q m/s deps=
    output continuous Real bare - deps=";

/// A unit whose `gal` is that of its country.
pub(super) const TANK: &str = "
    parameter fixed Real v gal start=1
    input continuous Real u gal start=0
    output continuous Real w gal initial=exact start=1";

/// Two inputs of one name, which no valid description has.
pub(super) const REPEATED: &str = "
    input continuous Real u - start=1
    input continuous Real u - start=2
    input continuous Real u.x - start=3
    output continuous Real y - deps=";

/// Variables with limits.
pub(super) const LIMITED: &str = "
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

pub(super) const UNITS: &str = r#"<UnitDefinitions>
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
pub(super) fn description(name: &str, lines: &str) -> ModelDescription {
    description_with(name, "", lines)
}

/// The same with further definitions of units of measure.
pub(super) fn description_with(name: &str, units: &str, lines: &str) -> ModelDescription {
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
