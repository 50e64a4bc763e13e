//! The order of initialization: a source is read when the inputs that its initial value depends on are set.

use std::collections::{BTreeMap, BTreeSet};

use fmi2::description::{Causality, Initial, Variability};

use super::scope::Scope;
use super::wire::Wired;
use crate::diagnostic::Diagnostic;
use crate::scenario::{InitialStep, Port, Preset};
use crate::spelling;

/// One thing to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Task {
    /// Read a port.
    Get(Port),
    /// Set the target of a connection, by its index.
    Set(usize),
    /// Wait until all connections into an instance are set. It is between them and the ports that depend on all inputs,
    /// so that n inputs and m such ports make n + m waits.
    AllSet(usize),
}

/// Tasks of one kind and instance, which one call can do together.
#[derive(Debug, Default)]
struct Together {
    /// Those that wait for nothing.
    ready: Vec<Task>,
    /// How many wait.
    waiting: usize,
}

/// Whether the tasks of a group set, and their instance.
type Group = (bool, usize);

/// What is left to do.
#[derive(Debug, Default)]
struct Plan {
    /// What each task that is left waits for; empty once it is ready.
    waits: BTreeMap<Task, BTreeSet<Task>>,
    /// The tasks that wait for a task.
    waited_for: BTreeMap<Task, Vec<Task>>,
    /// The tasks by kind and instance.
    groups: BTreeMap<Group, Together>,
    /// The groups that are ready as a whole.
    whole: BTreeSet<Group>,
    /// The groups of which some tasks are ready.
    partly: BTreeSet<Group>,
}

impl Plan {
    fn add(&mut self, task: Task, connections: &[Wired], waits_for: BTreeSet<Task>) {
        for awaited in &waits_for {
            self.waited_for.entry(*awaited).or_default().push(task);
        }
        if let Some(group) = group(task, connections) {
            let together = self.groups.entry(group).or_default();
            if waits_for.is_empty() {
                together.ready.push(task);
            } else {
                together.waiting += 1;
            }
            self.sort(group);
        }
        self.waits.insert(task, waits_for);
    }

    /// Notes whether a group is ready after one of its tasks has changed.
    fn sort(&mut self, group: Group) {
        self.whole.remove(&group);
        self.partly.remove(&group);
        match self.groups.get(&group) {
            Some(Together { ready, .. }) if ready.is_empty() => {}
            Some(Together { waiting: 0, .. }) => {
                self.whole.insert(group);
            }
            Some(_) => {
                self.partly.insert(group);
            }
            None => {}
        }
    }

    /// One task no longer waits for another.
    fn release(&mut self, waiting: Task, awaited: Task, connections: &[Wired]) {
        let Some(waits_for) = self.waits.get_mut(&waiting) else { return };
        if !waits_for.remove(&awaited) || !waits_for.is_empty() {
            return;
        }
        match group(waiting, connections) {
            Some(group) => {
                let together = self.groups.entry(group).or_default();
                together.ready.push(waiting);
                together.waiting -= 1;
                self.sort(group);
            }
            None => self.done(waiting, connections),
        }
    }

    fn done(&mut self, task: Task, connections: &[Wired]) {
        self.waits.remove(&task);
        for waiting in self.waited_for.remove(&task).unwrap_or_default() {
            self.release(waiting, task, connections);
        }
    }

    /// Takes the first group that is ready as a whole, else all that is ready of the first one that has any.
    fn take(&mut self, connections: &[Wired]) -> Option<Vec<Task>> {
        let group = *self.whole.first().or_else(|| self.partly.first())?;
        let mut tasks = std::mem::take(&mut self.groups.get_mut(&group)?.ready);
        self.sort(group);
        tasks.sort_unstable();
        for task in &tasks {
            self.done(*task, connections);
        }
        Some(tasks)
    }

    /// One port no longer waits for this input of its instance, but still for the others.
    fn release_from_one(&mut self, port: Task, awaited: Task, connections: &[Wired]) {
        let waits_for = self.waits.get(&port);
        let all_set = waits_for.and_then(|waits_for| waits_for.iter().find(|task| matches!(task, Task::AllSet(_))));
        if let Some(all_set) = all_set.copied() {
            let inputs = self.waits.get(&all_set).cloned().unwrap_or_default();
            for input in &inputs {
                self.waited_for.entry(*input).or_default().push(port);
            }
            if let Some(waits_for) = self.waits.get_mut(&port) {
                waits_for.extend(inputs);
                waits_for.remove(&all_set);
            }
        }
        self.release(port, awaited, connections);
    }
}

impl Scope<'_, '_> {
    /// The steps of initialization; `None` if initial values wait for each other.
    pub fn initialization(&self, connections: &[Wired], presets: &[Vec<Preset>]) -> Option<Vec<InitialStep>> {
        let mut plan = self.plan(connections);
        let has_value: BTreeSet<Port> = presets
            .iter()
            .enumerate()
            .flat_map(|(instance, presets)| {
                presets.iter().map(move |preset| Port { instance, variable: preset.variable })
            })
            .collect();
        let mut steps = Vec::new();
        loop {
            if let Some(tasks) = plan.take(connections) {
                steps.push(step(&tasks, connections));
                continue;
            }
            if plan.waits.is_empty() {
                return Some(steps);
            }
            let circle = circle(&plan.waits);
            let is_preset = |task: &Task| matches!(task, Task::Set(set) if has_value.contains(&connections[*set].connection.target));
            let Some(known) = circle.iter().position(is_preset) else {
                return self.refuse(self.circle_of_values(&circle, connections));
            };
            plan.release_from_one(circle[(known + 1) % circle.len()], circle[known], connections);
        }
    }

    fn plan(&self, connections: &[Wired]) -> Plan {
        let index_of: BTreeMap<Port, usize> =
            connections.iter().enumerate().map(|(index, wired)| (wired.connection.target, index)).collect();
        let driven = |instance: usize| {
            let inputs = Port { instance, variable: 0 }..=Port { instance, variable: usize::MAX };
            index_of.range(inputs).map(|(_, index)| Task::Set(*index)).collect::<BTreeSet<_>>()
        };
        let mut plan = Plan::default();
        for port in self.sources(connections) {
            let waits_for = match self.initial_dependencies(port) {
                Some(inputs) => {
                    let targets = inputs.iter().map(|&variable| Port { variable, ..port });
                    targets.filter_map(|target| index_of.get(&target)).map(|index| Task::Set(*index)).collect()
                }
                None => {
                    let all_set = Task::AllSet(port.instance);
                    if !plan.waits.contains_key(&all_set) {
                        plan.add(all_set, connections, driven(port.instance));
                    }
                    let is_driven = plan.waits.get(&all_set).is_some_and(|inputs| !inputs.is_empty());
                    if is_driven { BTreeSet::from([all_set]) } else { BTreeSet::new() }
                }
            };
            plan.add(Task::Get(port), connections, waits_for);
        }
        plan.waits.retain(|task, waits_for| !(matches!(task, Task::AllSet(_)) && waits_for.is_empty()));
        for (index, wired) in connections.iter().enumerate() {
            let waits_for = self.read_by(&wired.connection.source).into_iter().map(Task::Get).collect();
            plan.add(Task::Set(index), connections, waits_for);
        }
        plan
    }

    /// The variables that the initial value of a variable depends on; `None` for all.
    fn initial_dependencies(&self, port: Port) -> Option<&[usize]> {
        let (unit, variable) = (self.known(port.instance), self.variable(port));
        let is_given = matches!(variable.causality, Causality::Parameter | Causality::Independent)
            || variable.variability == Variability::Constant
            || variable.initial_or_default() == Some(Initial::Exact);
        if is_given {
            return Some(&[]);
        }
        unit.initial_unknown(port.variable)?.dependencies.as_deref()
    }

    fn circle_of_values(&self, circle: &[Task], connections: &[Wired]) -> Diagnostic {
        let name = |task: &Task| match task {
            Task::Get(port) => self.port_name(*port),
            Task::Set(index) => self.port_name(connections[*index].connection.target),
            Task::AllSet(instance) => self.script.instances[*instance].name.clone(),
        };
        let names: Vec<_> = circle.iter().chain(circle.first()).map(name).collect();
        let message = format!("these initial values wait for each other: {}", names.join(" -> "));
        let sets = circle.iter().filter_map(|task| match task {
            Task::Set(index) => Some(*index),
            Task::Get(_) | Task::AllSet(_) => None,
        });
        let sets: Vec<usize> = sets.collect();
        let Some((&first, rest)) = sets.split_first() else {
            unreachable!("a circle of initial values has a connection")
        };
        let target = connections[first].connection.target;
        let help = format!(
            "give one input of the circle a start value: `fmu {} = … {{ {} = … }}`",
            self.script.instances[target.instance].name,
            spelling::variable(&self.variable(target).name)
        );
        let error = Diagnostic::error("E36", connections[first].target, message);
        rest.iter().fold(error, |error, &index| error.label(connections[index].target, "")).help(help)
    }
}

/// The group of a task; what only waits has none.
fn group(task: Task, connections: &[Wired]) -> Option<Group> {
    match task {
        Task::Get(port) => Some((false, port.instance)),
        Task::Set(index) => Some((true, connections[index].connection.target.instance)),
        Task::AllSet(_) => None,
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
            Task::AllSet(_) => unreachable!("what only waits is in no group"),
        }
    }
    if indices.is_empty() {
        InitialStep::Get { instance, variables }
    } else {
        InitialStep::Set { instance, connections: indices }
    }
}

/// A circle among tasks that all wait, in the direction in which values travel.
fn circle(waits: &BTreeMap<Task, BTreeSet<Task>>) -> Vec<Task> {
    let mut walked: Vec<Task> = Vec::new();
    let mut steps: BTreeMap<Task, usize> = BTreeMap::new();
    let mut at = waits.keys().next().copied();
    while let Some(task) = at {
        if let Some(&start) = steps.get(&task) {
            let mut circle = walked.split_off(start);
            circle.reverse();
            circle.retain(|task| !matches!(task, Task::AllSet(_)));
            return circle;
        }
        steps.insert(task, walked.len());
        walked.push(task);
        at = waits.get(&task).and_then(|waits_for| waits_for.first().copied());
    }
    unreachable!("every task that is left waits for another one that is left");
}
