//! The order of initialization: a source is read when the inputs that its initial value depends on are set.

use std::collections::{BTreeMap, BTreeSet};

use fmi2::description::{Causality, Initial, Variability};

use super::scope::Scope;
use super::wire::Wired;
use crate::diagnostic::Diagnostic;
use crate::scenario::{InitialStep, Port, Preset};

/// One thing to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Task {
    /// Read a port.
    Get(Port),
    /// Set the target of a connection, by its index.
    Set(usize),
}

/// What has to be done before what.
type Plan = BTreeMap<Task, BTreeSet<Task>>;

impl Scope<'_> {
    /// The steps of initialization; `None` if initial values wait for each other.
    pub fn initialization(&self, connections: &[Wired], presets: &[Vec<Preset>]) -> Option<Vec<InitialStep>> {
        let mut open = self.plan(connections);
        let mut steps = Vec::new();
        while !open.is_empty() {
            let Some(next) = largest_ready(&open, connections) else {
                let circle = circle(&open);
                let is_preset = |task: &Task| match task {
                    Task::Set(index) => {
                        let Port { instance, variable } = connections[*index].connection.target;
                        presets[instance].iter().any(|preset| preset.variable == variable)
                    }
                    Task::Get(_) => false,
                };
                let Some(known) = circle.iter().copied().find(is_preset) else {
                    return self.refuse(self.circle_of_values(&circle, connections));
                };
                for waits_for in open.values_mut() {
                    waits_for.remove(&known);
                }
                continue;
            };
            for task in &next {
                open.remove(task);
            }
            for waits_for in open.values_mut() {
                waits_for.retain(|task| !next.contains(task));
            }
            steps.push(step(&next, connections));
        }
        Some(steps)
    }

    fn plan(&self, connections: &[Wired]) -> Plan {
        let index_of: BTreeMap<Port, usize> =
            connections.iter().enumerate().map(|(index, wired)| (wired.connection.target, index)).collect();
        let mut plan = Plan::new();
        for port in self.sources(connections) {
            let inputs = self.initial_dependencies(port);
            let driven = index_of.iter().filter(|(target, _)| {
                target.instance == port.instance
                    && inputs.as_ref().is_none_or(|inputs| inputs.contains(&target.variable))
            });
            plan.insert(Task::Get(port), driven.map(|(_, index)| Task::Set(*index)).collect());
        }
        for (index, wired) in connections.iter().enumerate() {
            plan.insert(Task::Set(index), self.read_by(&wired.connection.source).into_iter().map(Task::Get).collect());
        }
        plan
    }

    /// The variables that the initial value of a variable depends on; `None` for all.
    fn initial_dependencies(&self, port: Port) -> Option<Vec<usize>> {
        let (description, variable) = (self.known(port.instance), self.variable(port));
        let is_given = matches!(variable.causality, Causality::Parameter | Causality::Independent)
            || variable.variability == Variability::Constant
            || variable.initial_or_default() == Some(Initial::Exact);
        if is_given {
            return Some(Vec::new());
        }
        let unknowns = &description.structure.initial_unknowns;
        unknowns.iter().find(|unknown| unknown.index == port.variable)?.dependencies.clone()
    }

    fn circle_of_values(&self, circle: &[Task], connections: &[Wired]) -> Diagnostic {
        let name = |task: &Task| match task {
            Task::Get(port) => self.port_name(*port),
            Task::Set(index) => self.port_name(connections[*index].connection.target),
        };
        let names: Vec<_> = circle.iter().chain(circle.first()).map(name).collect();
        let message = format!("these initial values wait for each other: {}", names.join(" -> "));
        let sets = circle.iter().filter_map(|task| match task {
            Task::Set(index) => Some(*index),
            Task::Get(_) => None,
        });
        let sets: Vec<usize> = sets.collect();
        let Some((&first, rest)) = sets.split_first() else {
            unreachable!("a circle of initial values has a connection")
        };
        let target = connections[first].connection.target;
        let help = format!(
            "give one input of the circle a start value: `fmu {} = … {{ {} = … }}`",
            self.script.instances[target.instance].name.text,
            self.variable(target).name
        );
        let error = Diagnostic::error("E36", connections[first].target, message);
        rest.iter().fold(error, |error, &index| error.label(connections[index].target, "")).help(help)
    }
}

/// The kind and instance that tasks are grouped by.
fn group(task: &Task, connections: &[Wired]) -> (bool, usize) {
    match task {
        Task::Get(port) => (false, port.instance),
        Task::Set(index) => (true, connections[*index].connection.target.instance),
    }
}

/// The tasks of one group that wait for nothing: the first group that is ready as a whole, else the first that has any.
fn largest_ready(open: &Plan, connections: &[Wired]) -> Option<Vec<Task>> {
    let mut groups: BTreeMap<(bool, usize), (Vec<Task>, bool)> = BTreeMap::new();
    for (task, waits_for) in open {
        let (ready, is_whole) = groups.entry(group(task, connections)).or_insert((Vec::new(), true));
        if waits_for.is_empty() {
            ready.push(*task);
        } else {
            *is_whole = false;
        }
    }
    let mut ready: Vec<_> = groups.into_values().filter(|(ready, _)| !ready.is_empty()).collect();
    ready.sort_by_key(|(_, is_whole)| !is_whole);
    ready.into_iter().next().map(|(tasks, _)| tasks)
}

fn step(tasks: &[Task], connections: &[Wired]) -> InitialStep {
    let (mut variables, mut indices, mut instance) = (Vec::new(), Vec::new(), 0);
    for task in tasks {
        match task {
            Task::Get(port) => {
                instance = port.instance;
                variables.push(port.variable);
            }
            Task::Set(index) => {
                instance = connections[*index].connection.target.instance;
                indices.push(*index);
            }
        }
    }
    if indices.is_empty() {
        InitialStep::Get { instance, variables }
    } else {
        InitialStep::Set { instance, connections: indices }
    }
}

/// A circle among tasks of which none is ready, in the direction in which values travel.
fn circle(open: &Plan) -> Vec<Task> {
    let mut walked: Vec<Task> = Vec::new();
    let mut at = open.keys().next().copied();
    while let Some(task) = at {
        if let Some(start) = walked.iter().position(|walked| *walked == task) {
            let mut circle = walked.split_off(start);
            circle.reverse();
            return circle;
        }
        walked.push(task);
        at = open.get(&task).and_then(|waits_for| waits_for.first().copied());
    }
    unreachable!("every task that is left waits for another one that is left");
}
