//! Inputs that no connection drives and to which the script gives no value: what is often a forgotten connection.

use std::collections::{BTreeMap, BTreeSet};
use std::mem::discriminant;

use fmi2::description::{Causality, Kind, Variable};
use fmi2::units::BaseUnit;

use super::assign::Role;
use super::scope::Scope;
use super::unit::Unit;
use super::wire::Wired;
use crate::diagnostic::Diagnostic;
use crate::scenario::{Action, Event, Port, Preset};
use crate::spelling;

/// How many values the help of a warning spells out.
const VALUES_SHOWN: usize = 64;

impl Scope<'_, '_> {
    /// Warns of inputs without driver and without a value in the script, once for each group. Instances that are used
    /// nowhere are left out: their warning is about all of them.
    pub fn warn_of_undriven_inputs(&self, connections: &[Wired], presets: &[Vec<Preset>], events: &[Event]) {
        let mut given: BTreeSet<Port> = connections.iter().map(|wired| wired.connection.target).collect();
        for (instance, presets) in presets.iter().enumerate() {
            given.extend(presets.iter().map(|preset| Port { instance, variable: preset.variable }));
        }
        for action in events.iter().flat_map(|event| &event.actions) {
            if let Action::Set(set) = action {
                given.insert(set.target);
            }
        }
        for (instance, declared) in self.script.instances.iter().enumerate() {
            let Some(unit) = self.description(instance).filter(|_| self.is_used(declared.word.span)) else { continue };
            for (group, inputs) in groups(unit) {
                let is_open = |variable: &usize| !given.contains(&Port { instance, variable: *variable });
                let open: Vec<usize> = inputs.iter().copied().filter(is_open).collect();
                if !open.is_empty() {
                    self.report(self.undriven(instance, group, &open, inputs.len()));
                }
            }
        }
    }

    fn undriven(&self, instance: usize, group: &str, open: &[usize], all: usize) -> Diagnostic {
        let name = &self.script.instances[instance].name;
        let unit = self.known(instance);
        let named = match open {
            &[one] => unit.variables[one].name.as_str(),
            _ => group,
        };
        let port = format!("`{name}.{}`", spelling::variable(named));
        let has_start = open.iter().all(|&variable| unit.variables[variable].has_start());
        let (what, them, keeps) = match open.len() {
            1 => (port, "it", "it keeps its start value"),
            count if count == all => (format!("the {count} inputs {port}"), "them", "they keep their start values"),
            count => (format!("{count} of the {all} inputs {port}"), "them", "they keep their start values"),
        };
        let message = format!("nothing drives {what}, and the script gives {them} no value");
        let keeps = if has_start { keeps } else { "the description of the unit gives no start value either" };
        let help = if open.len() > VALUES_SHOWN {
            format!("connect {them}, or write values into the braces of this line; `lockstep check -v` lists {them}")
        } else {
            let mut values = Vec::new();
            self.values(instance, group, open, &mut values);
            format!("connect {them}, or write into the braces of this line: `{{ {} }}`", values.join(", "))
        };
        Diagnostic::warning("W02", self.script.instances[instance].word.span, message).saying(keeps).help(help)
    }

    /// The start values of inputs as the braces of an `fmu` line take them: `wind = [0, 0, 0] m/s`. A group becomes a list
    /// where all that the braces may set of it is open and of one type and unit of measure.
    fn values(&self, instance: usize, prefix: &str, open: &[usize], into: &mut Vec<String>) {
        let unit = self.known(instance);
        let name = |variable: usize| unit.variables[variable].name.as_str();
        let members = unit.members(prefix).into_iter().map(|(_, variable)| variable);
        let settable = members.filter(|&variable| self.may(Role::Preset, Port { instance, variable }));
        let behind = |variable: usize| behind(unit, variable);
        let kind = |variable: usize| (discriminant(&unit.variables[variable].kind), behind(variable));
        if spelling::variable(prefix) == prefix
            && open.iter().all(|&variable| kind(variable) == kind(open[0]))
            && settable.eq(open.iter().copied())
        {
            let numbers: Vec<_> = open.iter().map(|&variable| start(unit, variable)).collect();
            into.push(format!("{prefix} = [{}]{}", numbers.join(", "), behind(open[0])));
            return;
        }
        let mut parts: Vec<(&str, Vec<usize>)> = Vec::new();
        for &variable in open {
            let part = next_part(name(variable), prefix.len());
            match parts.iter_mut().find(|(known, _)| *known == part) {
                Some((_, variables)) => variables.push(variable),
                None => parts.push((part, vec![variable])),
            }
        }
        for (part, variables) in parts {
            match variables.as_slice() {
                // Of variables of one name, which no valid description has, a script can set the first.
                &[one, ..] if variables.iter().all(|&variable| name(variable) == part) => {
                    into.push(format!("{} = {}{}", spelling::variable(part), start(unit, one), behind(one)));
                }
                _ => self.values(instance, part, &variables, into),
            }
        }
    }
}

/// The inputs of a unit by the first part of their names, in the description's order.
fn groups(unit: &Unit) -> impl Iterator<Item = (&str, Vec<usize>)> {
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut groups: Vec<(&str, Vec<usize>)> = Vec::new();
    let is_input = |(_, variable): &(usize, &Variable)| variable.causality == Causality::Input;
    for (index, variable) in unit.variables.iter().enumerate().filter(is_input) {
        let group = next_part(&variable.name, 0);
        let place = *places.entry(group).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, inputs)) => inputs.push(index),
            None => groups.push((group, vec![index])),
        }
    }
    groups.into_iter()
}

/// A name up to the end of the part that begins at a byte; a name that scripts write in quotes has one part.
fn next_part(name: &str, from: usize) -> &str {
    if spelling::variable(name) != name {
        return name;
    }
    let mut is_quoted = false;
    let end = name.char_indices().find(|&(at, letter)| {
        is_quoted ^= letter == '\'';
        at > from && !is_quoted && matches!(letter, '.' | '[')
    });
    &name[..end.map_or(name.len(), |(at, _)| at)]
}

/// What follows the number or list of a variable in a script: a blank and a unit of measure, or nothing.
fn behind(unit: &Unit, variable: usize) -> String {
    match (unit.unit_of(variable), unit.base_of(variable)) {
        (Some(name), Some(base)) if base != BaseUnit::default() => format!(" {}", spelling::unit(name)),
        _ => String::new(),
    }
}

/// The start value as scripts write it, without its unit of measure; without one, what a variable of its type mostly has.
fn start(unit: &Unit, variable: usize) -> String {
    match &unit.variables[variable].kind {
        Kind::Real(real) => real.start.filter(|start| start.is_finite()).unwrap_or_default().to_string(),
        Kind::Integer { start, .. } => start.unwrap_or_default().to_string(),
        Kind::Boolean { start } => start.unwrap_or_default().to_string(),
        Kind::String { start } => spelling::text(start.as_deref().unwrap_or_default()),
        Kind::Enumeration { start, .. } => {
            let items = unit.items_of(variable);
            let item = items.iter().find(|item| Some(item.value) == *start).or_else(|| items.first());
            spelling::text(item.map_or("", |item| item.name.as_str()))
        }
    }
}
