//! Planted mistakes in variables: every pair of causality and variability, names, starts, types, aliases.

use super::{GOOD, findings, planted};
use crate::description::check::check;
use crate::description::read::read;
use crate::description::{Causality, Initial, Variability};

#[test]
fn mistakes_in_the_element_of_a_variable_are_found() {
    insta::assert_snapshot!(planted(&[
        ("name=\"inflow\"", ""),
        ("name=\"inflow\"", "name=\"height\""),
        ("name=\"inflow\" valueReference=\"1\"", "name=\"inflow\""),
        ("name=\"inflow\" valueReference=\"1\"", "name=\"inflow\" valueReference=\"-1\""),
        ("causality=\"calculatedParameter\"", "causality=\"internal\""),
        ("<Real unit=\"m/s\" start=\"0.25\"/>", ""),
        ("<Real unit=\"m/s\" start=\"0.25\"/>", "<Real unit=\"m/s\" start=\"0.25\"/><Integer/>"),
        ("<Real unit=\"m/s\" start=\"0.25\"/>", "<Float64 start=\"0.25\"/>"),
    ]));
}

#[test]
fn mistakes_in_start_values_are_found() {
    insta::assert_snapshot!(planted(&[
        ("<Real unit=\"m/s\" start=\"0.25\"/>", "<Real unit=\"m/s\"/>"),
        ("<Real unit=\"m\" start=\"0.5\"/>", "<Real unit=\"m\"/>"),
        ("<String start=\"tank\"/>", "<String/>"),
        ("<Real start=\"1\"/>", "<Real/>"),
        ("<Boolean/>", "<Boolean start=\"false\"/>"),
        (
            "causality=\"independent\" variability=\"continuous\">\n      <Real/>",
            "causality=\"independent\"><Real start=\"0\"/>"
        ),
        ("start=\"0.25\"", "start=\"INF\""),
        ("start=\"0.25\"", "start=\"1e999\""),
        ("start=\"0.25\"", "start=\"0.25\" min=\"0.3\" max=\"0.1\""),
        ("start=\"7\"", "start=\"-1\""),
        ("start=\"7\"", "start=\"11\""),
        ("start=\"7\"", "min=\"8\" start=\"7\""),
        ("start=\"3\"", "start=\"10\""),
        ("start=\"3\"", "min=\"4\" start=\"3\""),
        ("start=\"3\"", "start=\"3.0\""),
        ("declaredType=\"Mode\" start=\"1\"", "declaredType=\"Mode\" start=\"2\""),
        ("declaredType=\"Mode\" start=\"1\"", "declaredType=\"Mode\" min=\"1\" max=\"0\" start=\"1\""),
    ]));
}

#[test]
fn mistakes_in_units_and_types_of_variables_are_found() {
    insta::assert_snapshot!(planted(&[
        ("<Real unit=\"m\" start=\"0.5\"/>", "<Real unit=\"km\" start=\"0.5\"/>"),
        ("displayUnit=\"mm\"", "displayUnit=\"cm\""),
        ("<Real start=\"1\"/>", "<Real displayUnit=\"mm\" start=\"1\"/>"),
        ("<Real unit=\"m\" start=\"0.5\"/>", "<Real unit=\"m/s\" displayUnit=\"km/h\" start=\"0.5\"/>"),
        ("nominal=\"2\"", "nominal=\"0\""),
        ("nominal=\"2\"", "min=\"NaN\""),
        ("declaredType=\"Length\"", "declaredType=\"Width\""),
        ("declaredType=\"Count\"", "declaredType=\"Mode\""),
        ("declaredType=\"Mode\" ", ""),
        ("derivative=\"7\"", "derivative=\"0\""),
        ("derivative=\"7\"", "derivative=\"8\""),
        ("derivative=\"7\"", "derivative=\"3\""),
    ]));
}

#[test]
fn attributes_of_model_exchange_need_it_and_their_kind_of_variable() {
    let both = GOOD.replace("<CoSimulation", "<ModelExchange modelIdentifier=\"tank\"/><CoSimulation");
    let multiple = "canHandleMultipleSetPerTimeInstant=\"false\" ";
    let input = ("name=\"inflow\" ", format!("name=\"inflow\" {multiple}"));
    let output = ("name=\"level\" ", format!("name=\"level\" {multiple}"));
    let state = ("<Real unit=\"m\" start=\"0.5\"", "<Real unit=\"m\" reinit=\"false\" start=\"0.5\"".to_owned());
    let other = ("<Real start=\"1\"", "<Real reinit=\"true\" start=\"1\"".to_owned());
    let changed = |xml: &str, (from, to): &(&str, String)| findings(&xml.replace(from, to));
    assert_eq!(changed(&both, &input) + &changed(&both, &state), "");
    let alone = [&input, &output, &state, &other].map(|change| changed(GOOD, change)).concat();
    insta::assert_snapshot!(alone + &changed(&both, &output) + &changed(&both, &other));
}

#[test]
fn annotations_of_a_variable_name_each_tool_once() {
    let alias = "name=\"alias\" valueReference=\"6\" causality=\"local\">\n      <Real/>";
    let twice =
        format!("{alias}<Annotations>\n<Tool name=\"x\"/>\n<Tool name=\"y\"/>\n<Tool name=\"x\"/></Annotations>");
    insta::assert_snapshot!(planted(&[(alias, &twice), (alias, &format!("{alias}<Annotations/>"))]));
}

#[test]
fn mistakes_in_names_are_found() {
    insta::assert_snapshot!(planted(&[
        ("name=\"alias\"", "name=\"an alias\""),
        ("name=\"alias\"", "name=\"2nd\""),
        ("name=\"alias\"", "name=\"a..b\""),
        ("name=\"alias\"", "name=\"a[1\""),
        ("name=\"alias\"", "name=\"a[x]\""),
        ("name=\"alias\"", "name=\"der(a,)\""),
        ("name=\"alias\"", "name=\"'odd\""),
        ("name=\"alias\"", "name=\"''\""),
        ("name=\"alias\"", "name=\"größe\""),
        ("name=\"row[2]\"", "name=\"row[0]\""),
        ("name=\"full\"", "name=\"der(level,2)\""),
    ]));
}

#[test]
fn structured_names_may_be_nested_indexed_quoted_and_derivatives() {
    for name in ["a.b_1[2,3].c", "der(a.b[1])", "der(x,2)", "'odd name %'.y", r"'it\'s'[1]", "_x", "a.'#1'.b"] {
        assert_eq!(findings(&GOOD.replace("name=\"alias\"", &format!("name=\"{name}\""))), "", "{name}");
    }
    let flat = GOOD.replace("\"structured\"", "\"flat\"");
    assert_eq!(findings(&flat.replace("name=\"alias\"", "name=\"any thing\"")), "");
    let broken = findings(&flat.replace("name=\"alias\"", "name=\"any&#10;thing\""));
    assert_eq!(broken, "85:5: error[2.2.9]: `any\\nthing` has a line break or a tab in its name\n");
}

#[test]
fn mistakes_in_aliases_are_found() {
    let alias = "name=\"alias\" valueReference=\"6\" causality=\"local\">\n      <Real/>";
    insta::assert_snapshot!(planted(&[
        (alias, "name=\"alias\" valueReference=\"4\" causality=\"local\"><Real/>"),
        (alias, "name=\"alias\" valueReference=\"4\" initial=\"exact\"><Real unit=\"m\" start=\"1\"/>"),
        (alias, "name=\"alias\" valueReference=\"6\" variability=\"constant\"><Real start=\"1\"/>"),
        (alias, "name=\"alias\" valueReference=\"0\" variability=\"constant\"><String start=\"tub\"/>"),
        (alias, "name=\"alias\" valueReference=\"1\" variability=\"discrete\"><Integer/>"),
    ]));
}

#[test]
fn there_is_one_independent_variable_and_it_is_real() {
    let alias = "causality=\"local\">\n      <Real/>\n    </ScalarVariable>\n  </ModelVariables>";
    let second = "causality=\"independent\"><Real/></ScalarVariable></ModelVariables>";
    let whole = "causality=\"independent\" variability=\"discrete\"><Integer/></ScalarVariable></ModelVariables>";
    insta::assert_snapshot!(planted(&[(alias, second), (alias, whole)]));
}

#[test]
fn a_type_that_is_not_real_is_never_continuous() {
    insta::assert_snapshot!(planted(&[
        ("causality=\"output\" variability=\"discrete\"", "causality=\"output\""),
        ("causality=\"parameter\" variability=\"tunable\"", "causality=\"parameter\""),
        ("causality=\"input\" variability=\"discrete\"", "causality=\"input\" variability=\"continuous\""),
    ]));
}

/// The whole table of section 2.2.7: for each pair the accepted values of `initial` (exact, approx, calculated, or
/// absent), each with whether it needs a start value.
#[test]
fn every_entry_of_the_table_of_causality_variability_and_initial_is_checked() {
    let mut walked = String::from("\n");
    for causality in Causality::ALL {
        for variability in Variability::ALL {
            let accepted = [None, Some(Initial::Exact), Some(Initial::Approx), Some(Initial::Calculated)]
                .map(|initial| letter(causality, variability, initial));
            walked += &format!("{:19} {:10} {}\n", causality.name(), variability.name(), accepted.join(" "));
        }
    }
    assert_eq!(walked, TABLE);
}

/// `+` with a start value, `0` without one, `.` never; columns: no `initial`, exact, approx, calculated.
const TABLE: &str = "
parameter           constant   . . . .
parameter           fixed      + + . .
parameter           tunable    + + . .
parameter           discrete   . . . .
parameter           continuous . . . .
calculatedParameter constant   . . . .
calculatedParameter fixed      0 . + 0
calculatedParameter tunable    0 . + 0
calculatedParameter discrete   . . . .
calculatedParameter continuous . . . .
input               constant   . . . .
input               fixed      . . . .
input               tunable    . . . .
input               discrete   + . . .
input               continuous + . . .
output              constant   + + . .
output              fixed      . . . .
output              tunable    . . . .
output              discrete   0 + + 0
output              continuous 0 + + 0
local               constant   + + . .
local               fixed      0 . + 0
local               tunable    0 . + 0
local               discrete   0 + + 0
local               continuous 0 + + 0
independent         constant   . . . .
independent         fixed      . . . .
independent         tunable    . . . .
independent         discrete   . . . .
independent         continuous 0 . . .
";

fn letter(causality: Causality, variability: Variability, initial: Option<Initial>) -> &'static str {
    let accepts = |start: &str| {
        let initial = initial.map_or(String::new(), |initial| format!("initial='{}'", initial.name()));
        let xml = format!(
            "<fmiModelDescription fmiVersion='2.0' modelName='M' guid='1'><CoSimulation modelIdentifier='m'/>
             <ModelVariables><ScalarVariable name='x' valueReference='0' causality='{}' variability='{}' {initial}>
             <Real {start}/></ScalarVariable></ModelVariables><ModelStructure/></fmiModelDescription>",
            causality.name(),
            variability.name()
        );
        let (model, _) = read(xml.as_bytes()).expect("the description is readable");
        check(&model).iter().all(|finding| finding.rule != "2.2.7")
    };
    match (accepts("start='1'"), accepts("")) {
        (true, false) => "+",
        (false, true) => "0",
        (false, false) => ".",
        (true, true) => "?",
    }
}
