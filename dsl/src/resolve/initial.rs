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

/// Tasks of one kind and instance, which one call can do together.
#[derive(Debug, Default)]
struct Together {
    /// Those that wait for nothing.
    ready: Vec<Task>,
    /// How many wait.
    waiting: usize,
}

/// What is left to do.
#[derive(Debug, Default)]
struct Plan {
    /// What each task that is left waits for; empty once it is ready.
    waits: BTreeMap<Task, BTreeSet<Task>>,
    /// Who waits for a task.
    waited_for: BTreeMap<Task, Vec<Task>>,
    /// The tasks by whether they set, and by instance.
    groups: BTreeMap<(bool, usize), Together>,
}

impl Plan {
    fn add(&mut self, task: Task, connections: &[Wired], waits_for: BTreeSet<Task>) {
        let together = self.groups.entry(group(task, connections)).or_default();
        if waits_for.is_empty() {
            together.ready.push(task);
        } else {
            together.waiting += 1;
        }
        for awaited in &waits_for {
            self.waited_for.entry(*awaited).or_default().push(task);
        }
        self.waits.insert(task, waits_for);
    }

    /// One task waits for another no more.
    fn release(&mut self, waiting: Task, awaited: Task, connections: &[Wired]) {
        let Some(waits_for) = self.waits.get_mut(&waiting) else { return };
        if waits_for.remove(&awaited) && waits_for.is_empty() {
            let together = self.groups.entry(group(waiting, connections)).or_default();
            together.ready.push(waiting);
            together.waiting -= 1;
        }
    }

    /// Takes the first group that is ready as a whole, else all that is ready of the first one that has any.
    fn take(&mut self, connections: &[Wired]) -> Option<Vec<Task>> {
        let ready = || self.groups.iter().filter(|(_, together)| !together.ready.is_empty());
        let key = *ready().find(|(_, together)| together.waiting == 0).or_else(|| ready().next())?.0;
        let mut tasks = std::mem::take(&mut self.groups.get_mut(&key)?.ready);
        tasks.sort_unstable();
        for task in &tasks {
            self.waits.remove(task);
            for waiting in self.waited_for.remove(task).unwrap_or_default() {
                self.release(waiting, *task, connections);
            }
        }
        Some(tasks)
    }
}

impl Scope<'_> {
    /// The steps of initialization; `None` if initial values wait for each other.
    pub fn initialization(&self, connections: &[Wired], presets: &[Vec<Preset>]) -> Option<Vec<InitialStep>> {
        let mut plan = self.plan(connections);
        let mut steps = Vec::new();
        while !plan.waits.is_empty() {
            if let Some(tasks) = plan.take(connections) {
                steps.push(step(&tasks, connections));
                continue;
            }
            let circle = circle(&plan.waits);
            let is_preset = |task: &Task| match task {
                Task::Set(index) => {
                    let Port { instance, variable } = connections[*index].connection.target;
                    presets[instance].iter().any(|preset| preset.variable == variable)
                }
                Task::Get(_) => false,
            };
            let Some(known) = circle.iter().position(is_preset) else {
                return self.refuse(self.circle_of_values(&circle, connections));
            };
            plan.release(circle[(known + 1) % circle.len()], circle[known], connections);
        }
        Some(steps)
    }

    fn plan(&self, connections: &[Wired]) -> Plan {
        let index_of: BTreeMap<Port, usize> =
            connections.iter().enumerate().map(|(index, wired)| (wired.connection.target, index)).collect();
        let mut plan = Plan::default();
        for port in self.sources(connections) {
            let inputs = self.initial_dependencies(port);
            let own = Port { variable: 0, ..port }..=Port { variable: usize::MAX, ..port };
            let driven = index_of
                .range(own)
                .filter(|(target, _)| inputs.as_ref().is_none_or(|inputs| inputs.contains(&target.variable)));
            let waits_for = driven.map(|(_, index)| Task::Set(*index)).collect();
            plan.add(Task::Get(port), connections, waits_for);
        }
        for (index, wired) in connections.iter().enumerate() {
            let waits_for = self.read_by(&wired.connection.source).into_iter().map(Task::Get).collect();
            plan.add(Task::Set(index), connections, waits_for);
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

/// Whether a task sets, and the instance that it speaks to.
fn group(task: Task, connections: &[Wired]) -> (bool, usize) {
    match task {
        Task::Get(port) => (false, port.instance),
        Task::Set(index) => (true, connections[index].connection.target.instance),
    }
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
fn circle(waits: &BTreeMap<Task, BTreeSet<Task>>) -> Vec<Task> {
    let mut walked: Vec<Task> = Vec::new();
    let mut at = waits.keys().next().copied();
    while let Some(task) = at {
        if let Some(start) = walked.iter().position(|walked| *walked == task) {
            let mut circle = walked.split_off(start);
            circle.reverse();
            return circle;
        }
        walked.push(task);
        at = waits.get(&task).and_then(|waits_for| waits_for.first().copied());
    }
    unreachable!("every task that is left waits for another one that is left");
}
