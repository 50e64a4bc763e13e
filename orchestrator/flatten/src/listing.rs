//! What a script will do, as text that one can read and compare: units, connections, initialization, delays.

use crate::variable_text;
use dsl::groups::{groups, without_shared_members};
use dsl::scenario::{Action, Connection, Drive, InitialStep, Port, RealExpression, Scenario, Value, duration};
use dsl::spelling;
use fmi2::description::{Causality, ModelDescription, Variable};
use fmi2::printable;
use results::{counted, shortest_decimal};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use unit::time::seconds;

/// The plan of a script.
#[must_use]
pub fn text(scenario: &Scenario, descriptions: &[&ModelDescription]) -> String {
    let shown: Vec<_> = descriptions.iter().map(|description| with_printable_names(description)).collect();
    let plan = Plan { scenario, descriptions: &shown };
    let sections =
        [plan.times(), plan.units(), plan.connections(), plan.undriven(), plan.initialization(), plan.delays()];
    sections.into_iter().filter(|section| !section.is_empty()).map(|section| section + "\n").collect()
}

/// The description with names of variables that stay in their line.
fn with_printable_names(description: &ModelDescription) -> ModelDescription {
    let mut shown = description.clone();
    for variable in &mut shown.variables {
        variable.name = printable::line(&variable.name);
    }
    shown
}

struct Plan<'a> {
    scenario: &'a Scenario,
    descriptions: &'a [ModelDescription],
}

/// What one line shows of connections that look alike.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Arrow {
    /// As its only element is written.
    single: (String, String),
    /// As several are written together.
    folded: (String, String),
    direct: bool,
    how: String,
}

impl Plan<'_> {
    fn times(&self) -> String {
        let Scenario { step_ns, stop_tick, .. } = self.scenario;
        let stop = shortest_decimal(seconds(*stop_tick, *step_ns));
        format!("step {}, stop {stop} s: {}\n", duration(*step_ns), counted(*stop_tick as usize, "step"))
    }

    fn units(&self) -> String {
        let Scenario { instances, units, .. } = self.scenario;
        let name_width = width(instances.iter().map(|instance| instance.name.as_str()));
        let unit_width = width(units.iter().map(|unit| unit.name.as_str())) + 2;
        let mut in_order: Vec<_> = instances.iter().collect();
        in_order.sort_by_key(|instance| instance.wave);
        let mut text = String::from("units: those of one wave step together, waves one after the other\n");
        for instance in in_order {
            let (unit, period) =
                (format!("\"{}\"", units[instance.unit].name), duration(instance.every * self.scenario.step_ns));
            let _ = writeln!(
                text,
                "  wave {}  {:<name_width$}  {unit:<unit_width$}  every {period}",
                instance.wave, instance.name
            );
        }
        text
    }

    fn connections(&self) -> String {
        let mut lines: Vec<(Arrow, usize)> = Vec::new();
        for connection in &self.scenario.connections {
            let arrow = self.arrow(connection);
            match lines.last_mut().filter(|(last, _)| last.joins(&arrow)) {
                Some((_, count)) => *count += 1,
                None => lines.push((arrow, 1)),
            }
        }
        let written = |(arrow, count): &(Arrow, usize)| {
            let (from, to) = if *count == 1 { &arrow.single } else { &arrow.folded };
            format!("{from} {} {to}", if arrow.direct { "=>" } else { "->" })
        };
        let written: Vec<_> = lines.iter().map(written).collect();
        let arrow_width = width(written.iter().map(String::as_str));
        let mut text = String::from("connections\n");
        for (written, (arrow, count)) in written.iter().zip(&lines) {
            let values = counted(*count, "value");
            let _ = writeln!(text, "  {written:<arrow_width$}  {values:<9}  {}", arrow.how);
        }
        if lines.is_empty() { String::new() } else { text }
    }

    fn arrow(&self, connection: &Connection) -> Arrow {
        let (mut sources, mut known) = (Vec::new(), BTreeSet::new());
        connection.source.reads(self.scenario.slots(), &mut |port| {
            if known.insert(port) {
                sources.push(port);
            }
        });
        let ports: Vec<_> = sources.iter().chain([&connection.target]).copied().collect();
        let names: Vec<_> = ports.iter().map(|&port| self.variable(port).name.as_str()).collect();
        let written = |names: &[String]| {
            let full = names.iter().zip(&ports).map(|(name, port)| format!("{}.{name}", self.instance(port.instance)));
            let mut full: Vec<_> = full.collect();
            let target = full.pop().unwrap_or_default();
            let from = if full.is_empty() { self.alone(&connection.source) } else { full.join(", ") };
            (from, target)
        };
        Arrow {
            single: written(&names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>()),
            folded: written(&without_shared_members(&names)),
            direct: connection.direct,
            how: self.how(&connection.source, connection.target),
        }
    }

    /// What is on the left where no port does.
    fn alone(&self, source: &Drive) -> String {
        match source {
            Drive::Real(RealExpression::Constant(value)) => shortest_decimal(*value),
            Drive::Integer(value) => value.to_string(),
            Drive::String(text) => spelling::text(text),
            Drive::Copy(_) | Drive::Real(_) | Drive::Boolean(_) | Drive::Curve(_) => "time".to_owned(),
        }
    }

    fn how(&self, source: &Drive, target: Port) -> String {
        match source {
            Drive::Copy(_) => "copied bit for bit".to_owned(),
            Drive::Real(RealExpression::Constant(_)) | Drive::Integer(_) | Drive::String(_) => "constant".to_owned(),
            Drive::Real(RealExpression::Signal(_)) => "Integer as Real".to_owned(),
            Drive::Real(expression) => match converted(expression) {
                Some(port) => format!("converted from {} to {}", self.unit(port), self.unit(target)),
                None => "computed".to_owned(),
            },
            Drive::Boolean(_) => "computed".to_owned(),
            Drive::Curve(_) => "from a table".to_owned(),
        }
    }

    /// The inputs that no connection drives, with the value that each keeps and where that comes from.
    fn undriven(&self) -> String {
        let driven: BTreeSet<Port> = self.scenario.connections.iter().map(|connection| connection.target).collect();
        let actions = self.scenario.events.iter().flat_map(|event| &event.actions);
        let set: BTreeSet<Port> = actions
            .filter_map(|action| match action {
                Action::Set(set) => Some(set.target),
                Action::Fault(_) => None,
            })
            .collect();
        let mut lines = Vec::new();
        for (instance, description) in self.descriptions.iter().enumerate() {
            let presets = &self.scenario.instances[instance].presets;
            let preset: BTreeMap<usize, &Value> = presets.iter().map(|it| (it.variable, &it.value)).collect();
            for (index, variable) in description.variables.iter().enumerate() {
                let port = Port { instance, variable: index };
                if variable.causality != Causality::Input || driven.contains(&port) {
                    continue;
                }
                let (value, origin) = match preset.get(&index) {
                    Some(value) => (variable_text::value(description, variable, value), "from the script"),
                    None if variable.has_start() => {
                        (variable_text::start(description, variable), "start value of the unit")
                    }
                    None => (String::new(), "no start value"),
                };
                let measure = description.unit_of(variable).filter(|measure| !value.is_empty() && *measure != "1");
                let value = format!("{value} {}", measure.unwrap_or_default());
                let until = if set.contains(&port) { ", until it is `set`" } else { "" };
                let name = format!("{}.{}", self.instance(instance), spelling::variable(&variable.name));
                lines.push((name, value.trim_end().to_owned(), format!("{origin}{until}")));
            }
        }
        let name_width = width(lines.iter().map(|(name, _, _)| name.as_str()));
        let value_width = width(lines.iter().map(|(_, value, _)| value.as_str()));
        let mut text = String::from("inputs that no connection drives\n");
        for (name, value, origin) in &lines {
            let _ = writeln!(text, "  {name:<name_width$}  {value:<value_width$}  {origin}");
        }
        if lines.is_empty() { String::new() } else { text }
    }

    fn initialization(&self) -> String {
        let mut text = String::from("initialization, in this order\n");
        for step in &self.scenario.initialization {
            let (verb, instance, variables): (_, _, Vec<_>) = match step {
                InitialStep::Set { instance, connections } => {
                    let targets = connections.iter().map(|&index| self.scenario.connections[index].target.variable);
                    ("set", *instance, targets.collect())
                }
                InitialStep::Get { instance, variables } => ("get", *instance, variables.clone()),
            };
            let names = variables.iter().map(|&variable| self.descriptions[instance].variables[variable].name.as_str());
            let _ = writeln!(text, "  {verb} {}: {}", self.instance(instance), groups(names));
        }
        if self.scenario.initialization.is_empty() { String::new() } else { text }
    }

    /// Outputs that depend directly on an input that `->` brings: they show the input held over the last step.
    fn delays(&self) -> String {
        let delayed = self.delayed_inputs();
        let mut lines = String::new();
        for (instance, description) in self.descriptions.iter().enumerate() {
            let port = |variable| Port { instance, variable };
            let name = |port: Port| description.variables[port.variable].name.as_str();
            // An output without declared dependencies depends on every input.
            let all = groups(delayed.range(port(0)..=port(usize::MAX)).copied().map(name));
            let mut by_inputs: Vec<(Cow<'_, str>, Vec<&str>)> = Vec::new();
            let mut places = BTreeMap::new();
            for output in &description.structure.outputs {
                let Some(variable) = description.variables.get(output.index) else { continue };
                let inputs = match &output.dependencies {
                    Some(inputs) => {
                        let ports = inputs.iter().map(|&input| port(input));
                        Cow::Owned(groups(ports.filter(|port| delayed.contains(port)).map(name)))
                    }
                    None => Cow::Borrowed(all.as_str()),
                };
                if !inputs.is_empty() {
                    let place = *places.entry(inputs.clone()).or_insert(by_inputs.len());
                    if place == by_inputs.len() {
                        by_inputs.push((inputs, Vec::new()));
                    }
                    by_inputs[place].1.push(&variable.name);
                }
            }
            for (inputs, outputs) in by_inputs {
                let _ = writeln!(lines, "  {}: {}, from {inputs}", self.instance(instance), groups(outputs));
            }
        }
        let heading = "one step late: outputs that follow directly from an input that `->` brings\n";
        if lines.is_empty() { lines } else { format!("{heading}{lines}") }
    }

    fn delayed_inputs(&self) -> BTreeSet<Port> {
        let delayed = self.scenario.connections.iter().filter(|connection| !connection.direct);
        let is_input = |port: &Port| self.variable(*port).causality == Causality::Input;
        delayed.map(|connection| connection.target).filter(is_input).collect()
    }

    fn variable(&self, port: Port) -> &Variable {
        &self.descriptions[port.instance].variables[port.variable]
    }

    fn instance(&self, instance: usize) -> &str {
        &self.scenario.instances[instance].name
    }

    fn unit(&self, port: Port) -> &str {
        let description = &self.descriptions[port.instance];
        description.unit_of(self.variable(port)).unwrap_or("no unit")
    }
}

impl Arrow {
    fn joins(&self, other: &Self) -> bool {
        self.folded == other.folded && self.direct == other.direct && self.how == other.how
    }
}

/// The port that an expression only brings from one unit of measure to another.
fn converted(expression: &RealExpression) -> Option<Port> {
    match expression {
        RealExpression::Signal(port) => Some(*port),
        RealExpression::Affine { of, .. } | RealExpression::InverseAffine { of, .. } => converted(of),
        _ => None,
    }
}

fn width<'a>(texts: impl Iterator<Item = &'a str>) -> usize {
    texts.map(|text| text.chars().count()).max().unwrap_or(0)
}

#[cfg(test)]
pub(crate) mod tests;
