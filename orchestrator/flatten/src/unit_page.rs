//! What `lockstep describe` says about a unit: its variables with units of measure, limits, items and dependencies, as a
//! page for people and as values for programs.

use crate::variable_text::start;
use dsl::groups::groups;
use dsl::spelling;
use fmi2::description::{Causality, Kind, ModelDescription, Variability, Variable};
use fmi2::printable;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// A unit as `describe --json` writes it.
#[derive(Debug, Serialize)]
pub struct UnitPage<'a> {
    name: &'a str,
    description: Option<&'a str>,
    version: Option<&'a str>,
    author: Option<&'a str>,
    license: Option<&'a str>,
    copyright: Option<&'a str>,
    generation_tool: Option<&'a str>,
    /// Seconds.
    experiment: Experiment,
    variables: Vec<Line<'a>>,
}

#[derive(Debug, Default, Serialize)]
struct Experiment {
    start: Option<f64>,
    stop: Option<f64>,
    step: Option<f64>,
    tolerance: Option<f64>,
}

/// One variable.
#[derive(Debug, Serialize)]
struct Line<'a> {
    name: &'a str,
    causality: &'static str,
    variability: &'static str,
    #[serde(rename = "type")]
    kind: &'static str,
    unit: Option<&'a str>,
    start: Option<Start<'a>>,
    min: Option<f64>,
    max: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    items: Vec<Item<'a>>,
    /// The inputs on which an output depends at its own instant; absent where the unit does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    depends: Option<Vec<&'a str>>,
    description: Option<&'a str>,
    #[serde(skip)]
    start_text: String,
}

#[derive(Debug, Serialize)]
struct Item<'a> {
    name: &'a str,
    value: i32,
    description: Option<&'a str>,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Start<'a> {
    Real(f64),
    Integer(i32),
    Boolean(bool),
    Text(&'a str),
}

impl<'a> UnitPage<'a> {
    /// The page of a unit.
    #[must_use]
    pub fn new(unit: &'a ModelDescription) -> Self {
        let experiment = unit.default_experiment.map(|experiment| Experiment {
            start: experiment.start_time,
            stop: experiment.stop_time,
            step: experiment.step_size,
            tolerance: experiment.tolerance,
        });
        let outputs: BTreeMap<usize, &Option<Vec<usize>>> =
            unit.structure.outputs.iter().map(|output| (output.index, &output.dependencies)).collect();
        let variables = unit.variables.iter().enumerate().map(|(index, variable)| {
            let name = |&known: &usize| unit.variables.get(known).map(|known| known.name.as_str());
            let depends = outputs.get(&index).and_then(|known| known.as_ref());
            Line { depends: depends.map(|known| known.iter().filter_map(name).collect()), ..Line::of(unit, variable) }
        });
        Self {
            name: &unit.model_name,
            description: unit.description.as_deref(),
            version: unit.version.as_deref(),
            author: unit.author.as_deref(),
            license: unit.license.as_deref(),
            copyright: unit.copyright.as_deref(),
            generation_tool: unit.generation_tool.as_deref(),
            experiment: experiment.unwrap_or_default(),
            variables: variables.collect(),
        }
    }

    /// The page for people.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}\n", printable::line(self.name));
        if let Some(words) = self.description {
            let _ = writeln!(text, "{}", printable::block(words));
        }
        let of_causality = |causality: Causality| {
            self.variables.iter().filter(move |line| line.causality == causality.name()).collect::<Vec<_>>()
        };
        for (title, causality) in [
            ("inputs", Causality::Input),
            ("outputs", Causality::Output),
            ("parameters", Causality::Parameter),
            ("calculated parameters", Causality::CalculatedParameter),
            ("locals", Causality::Local),
        ] {
            let lines = of_causality(causality);
            if lines.is_empty() {
                continue;
            }
            let cells: Vec<[String; 4]> = lines.iter().map(|line| line.cells()).collect();
            let width = |column: usize| cells.iter().map(|cells| cells[column].chars().count()).max().unwrap_or(0);
            let widths = [0, 1, 2, 3].map(width);
            let _ = writeln!(text, "\n{title}");
            for (line, cells) in lines.iter().zip(&cells) {
                let columns: Vec<_> = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
                let words = printable::line(line.description.unwrap_or_default());
                let _ = writeln!(text, "{}", format!("  {}  {words}", columns.join("  ")).trim_end());
                line.write_items(&mut text);
            }
        }
        text + &self.dependencies()
    }

    /// The outputs that follow an input at once, those with the same inputs on one line.
    fn dependencies(&self) -> String {
        let mut by_inputs: Vec<(String, Vec<&str>)> = Vec::new();
        for line in self.variables.iter().filter(|line| line.causality == Causality::Output.name()) {
            let inputs = match &line.depends {
                Some(inputs) if inputs.is_empty() => continue,
                Some(inputs) => groups(inputs.iter().copied()),
                None => "any input, as far as the unit says".to_owned(),
            };
            match by_inputs.iter_mut().find(|(known, _)| *known == inputs) {
                Some((_, outputs)) => outputs.push(line.name),
                None => by_inputs.push((inputs, vec![line.name])),
            }
        }
        let mut text = String::new();
        for (inputs, outputs) in by_inputs {
            let line = format!("  {} from {inputs}", groups(outputs));
            let _ = writeln!(text, "{}", printable::line(&line));
        }
        if text.is_empty() { text } else { format!("\noutputs that follow an input at once\n{text}") }
    }
}

impl<'a> Line<'a> {
    /// A variable without its dependencies.
    fn of(unit: &'a ModelDescription, variable: &'a Variable) -> Self {
        let limits = unit.limits_of(variable);
        let items = unit.items_of(variable);
        let start_value = match &variable.kind {
            Kind::Real(real) => real.start.map(Start::Real),
            Kind::Enumeration { start, .. } => {
                let named = items.iter().find(|item| Some(item.value) == *start).map(|item| Start::Text(&item.name));
                named.or(start.map(Start::Integer))
            }
            Kind::Integer { start, .. } => start.map(Start::Integer),
            Kind::Boolean { start } => start.map(Start::Boolean),
            Kind::String { start } => start.as_deref().map(Start::Text),
        };
        let kind = match &variable.kind {
            Kind::Real(_) => "Real",
            Kind::Integer { .. } => "Integer",
            Kind::Boolean { .. } => "Boolean",
            Kind::String { .. } => "String",
            Kind::Enumeration { .. } => "Enumeration",
        };
        Self {
            name: &variable.name,
            causality: variable.causality.name(),
            variability: variable.variability.name(),
            kind,
            unit: unit.unit_of(variable),
            start: start_value,
            min: limits.min,
            max: limits.max,
            items: items
                .iter()
                .map(|item| Item { name: &item.name, value: item.value, description: item.description.as_deref() })
                .collect(),
            depends: None,
            description: variable.description.as_deref(),
            start_text: start(unit, variable),
        }
    }

    /// Name, unit or type, limits, and start value.
    fn cells(&self) -> [String; 4] {
        let is_real = self.kind == "Real";
        let kind = if is_real { self.unit.unwrap_or("Real") } else { self.kind };
        let decimal = results::shortest_decimal;
        let mut limits = match (self.min, self.max) {
            (Some(min), Some(max)) => format!("{} to {}", decimal(min), decimal(max)),
            (Some(min), None) => format!("at least {}", decimal(min)),
            (None, Some(max)) => format!("at most {}", decimal(max)),
            (None, None) => String::new(),
        };
        if self.variability == Variability::Tunable.name() {
            limits = if limits.is_empty() { "tunable".to_owned() } else { format!("{limits}, tunable") };
        }
        [spelling::variable(self.name).into_owned(), kind.to_owned(), limits, self.start_text.clone()]
            .map(|cell| printable::line(&cell))
    }

    fn write_items(&self, text: &mut String) {
        let width = self.items.iter().map(|item| spelling::text(item.name).chars().count()).max().unwrap_or(0);
        for item in &self.items {
            let line = format!("      {:<width$}  {}", spelling::text(item.name), item.description.unwrap_or_default());
            let _ = writeln!(text, "{}", printable::line(line.trim_end()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TANK: &[u8] = br#"<?xml version="1.0"?>
<fmiModelDescription fmiVersion="2.0" modelName="Tank" guid="g" description="A tank." author="A. Author">
  <CoSimulation modelIdentifier="tank"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>
  <TypeDefinitions><SimpleType name="Valve"><Enumeration><Item name="shut" value="1" description="Nothing flows"/>
    <Item name="open" value="2"/></Enumeration></SimpleType></TypeDefinitions>
  <DefaultExperiment stopTime="10" stepSize="0.1"/>
  <ModelVariables>
    <ScalarVariable name="valve" valueReference="0" causality="input" variability="discrete" description="Outlet"><Enumeration declaredType="Valve" start="2"/></ScalarVariable>
    <ScalarVariable name="level" valueReference="0" causality="output" description="Height of the water."><Real unit="m"/></ScalarVariable>
    <ScalarVariable name="area" valueReference="1" causality="parameter" variability="tunable"><Real start="1.5" min="0" max="9"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="2" dependencies="1"/></Outputs></ModelStructure>
</fmiModelDescription>"#;

    #[test]
    fn a_page_shows_units_limits_items_start_values_and_dependencies() {
        let (description, _) = fmi2::description::read::read(TANK).unwrap();
        insta::assert_snapshot!(UnitPage::new(&description).text(), @r#"
        Tank
        A tank.

        inputs
          valve  Enumeration    "open"  Outlet
              "shut"  Nothing flows
              "open"

        outputs
          level  m      Height of the water.

        parameters
          area  Real  0 to 9, tunable  1.5

        outputs that follow an input at once
          level from valve
        "#);
    }
}
