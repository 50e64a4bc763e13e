//! Which outputs fit which inputs: by name, members and unit of measure.

use super::Loaded;
use crate::groups::parts;
use fmi2::description::{Causality, Kind, ModelDescription, Variable};
use std::collections::{BTreeMap, BTreeSet};

/// A port of one unit, as a script writes it without the unit's name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Port {
    /// Index of the unit.
    pub unit: usize,
    /// The variable, or the group of variables.
    pub name: String,
}

/// What may drive an input, or a group of inputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Match {
    /// The inputs.
    pub target: Port,
    /// What fits them; in a skeleton only a single one that has the name too is connected.
    pub sources: Vec<Port>,
    /// Whether the sources have the name of the inputs, or belong to a unit of that name.
    pub by_name: bool,
}

/// The outputs of a unit by name, and every group that they make up.
struct Outputs<'a> {
    by_name: BTreeMap<&'a str, &'a Variable>,
    groups: BTreeSet<&'a str>,
}

/// For each input or group of inputs that some output fits, what fits it.
pub(super) fn matches(units: &[Loaded]) -> Vec<Match> {
    let outputs: Vec<_> = units.iter().map(|unit| Outputs::of(&unit.description)).collect();
    let mut matches = Vec::new();
    for (index, unit) in units.iter().enumerate() {
        for (group, members) in input_groups(&unit.description) {
            let fitting = units.iter().enumerate().filter(|(other, _)| *other != index).flat_map(|(other, source)| {
                let groups = outputs[other].groups.iter().map(|group| Port { unit: other, name: (*group).to_owned() });
                let fits =
                    |port: &Port| outputs[other].fit(&source.description, &port.name, &unit.description, &members);
                groups.filter(fits).collect::<Vec<_>>()
            });
            let fitting: Vec<_> = fitting.collect();
            let has_name = |port: &&Port| {
                last_part(&port.name) == last_part(group) || same_name(&units[port.unit].name, last_part(group))
            };
            let named: Vec<_> = fitting.iter().filter(has_name).cloned().collect();
            let by_name = !named.is_empty();
            // What fits one value by its unit of measure alone is mostly not meant.
            let sources = if by_name || members.len() < 2 { named } else { fitting };
            if !sources.is_empty() {
                matches.push(Match { target: Port { unit: index, name: group.to_owned() }, sources, by_name });
            }
        }
    }
    matches
}

impl<'a> Outputs<'a> {
    fn of(description: &'a ModelDescription) -> Self {
        let outputs = description.variables.iter().filter(|variable| variable.causality == Causality::Output);
        let by_name: BTreeMap<_, _> = outputs.map(|variable| (variable.name.as_str(), variable)).collect();
        let mut groups = BTreeSet::new();
        for name in by_name.keys() {
            let mut length = 0;
            for part in parts(name) {
                length += part.len();
                groups.insert(&name[..length]);
            }
        }
        Self { by_name, groups }
    }

    /// Whether a group has every member of the inputs, each of the same type and unit of measure.
    fn fit(
        &self,
        own: &ModelDescription,
        group: &str,
        taker: &ModelDescription,
        members: &[(&str, &Variable)],
    ) -> bool {
        members.iter().all(|(suffix, input)| {
            let output = self.by_name.get([group, suffix].concat().as_str());
            output.is_some_and(|output| same_kind(own, output, taker, input))
        })
    }
}

fn same_kind(own: &ModelDescription, output: &Variable, taker: &ModelDescription, input: &Variable) -> bool {
    let base = |description: &ModelDescription, name: Option<&str>| description.unit(name?).and_then(|unit| unit.base);
    match (&output.kind, &input.kind) {
        (Kind::Real(_), Kind::Real(_)) => {
            let (gives, takes) = (own.unit_of(output), taker.unit_of(input));
            match (base(own, gives), base(taker, takes)) {
                (Some(gives), Some(takes)) => gives.dimension == takes.dimension,
                _ => gives == takes,
            }
        }
        (Kind::Enumeration { .. }, Kind::Enumeration { .. }) => own.items_of(output) == taker.items_of(input),
        _ => output.base_type() == input.base_type(),
    }
}

/// The inputs of a unit by their first part, each with what follows it.
fn input_groups(description: &ModelDescription) -> Vec<(&str, Vec<(&str, &Variable)>)> {
    let mut groups: Vec<(&str, Vec<(&str, &Variable)>)> = Vec::new();
    let mut places = BTreeMap::new();
    for variable in description.variables.iter().filter(|variable| variable.causality == Causality::Input) {
        let group = parts(&variable.name)[0];
        let place = *places.entry(group).or_insert(groups.len());
        if place == groups.len() {
            groups.push((group, Vec::new()));
        }
        groups[place].1.push((&variable.name[group.len()..], variable));
    }
    groups
}

fn last_part(name: &str) -> &str {
    parts(name).last().map_or(name, |part| part.trim_start_matches('.'))
}

fn same_name(unit: &str, port: &str) -> bool {
    unit.eq_ignore_ascii_case(port)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description(variables: &[(&str, &str, &str)]) -> ModelDescription {
        let variables = variables.iter().enumerate().map(|(reference, (causality, name, unit))| {
            format!(
                "<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\"><Real unit=\"{unit}\" start=\"0\"/></ScalarVariable>"
            )
        });
        let xml = format!(
            "<fmiModelDescription fmiVersion=\"2.0\" modelName=\"a\" guid=\"g\"><CoSimulation modelIdentifier=\"a\"/>\
             <UnitDefinitions><Unit name=\"m\"><BaseUnit m=\"1\"/></Unit><Unit name=\"s\"><BaseUnit s=\"1\"/></Unit>\
             </UnitDefinitions><ModelVariables>{}</ModelVariables><ModelStructure/></fmiModelDescription>",
            variables.collect::<String>()
        );
        fmi2::description::read::read(xml.as_bytes()).expect("a description").0
    }

    #[test]
    fn groups_match_by_name_members_and_unit_of_measure() {
        let plant = description(&[
            ("input", "wind.x", "m"),
            ("output", "state.x", "m"),
            ("output", "state.y", "m"),
            ("output", "old.state.x", "s"),
            ("output", "level", "m"),
        ]);
        let control = description(&[
            ("input", "state.x", "m"),
            ("input", "level", "s"),
            ("input", "place.x", "m"),
            ("input", "place.y", "m"),
        ]);
        let units = [("plant", plant), ("control", control)].map(|(name, description)| Loaded {
            name: name.to_owned(),
            unit: name.to_owned(),
            description,
        });
        let found = matches(&units);
        let port = |unit, name: &str| Port { unit, name: name.to_owned() };
        let expected = [("state", true), ("place", false)].map(|(target, by_name)| Match {
            target: port(1, target),
            sources: vec![port(0, "state")],
            by_name,
        });
        assert_eq!(found, expected);
    }
}
