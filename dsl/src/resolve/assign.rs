//! Pairs values with the ports that take them: groups by the names of their members, lists and picked members by order.

use std::collections::BTreeMap;
use std::rc::Rc;

use fmi2::description::{Causality, Initial, Variability};

use super::fit::{Fitted, Meeting};
use super::meaning::{Group, Meaning};
use super::scope::Scope;
use super::signal::Signal;
use crate::diagnostic::Diagnostic;
use crate::nearest::listed;
use crate::scenario::Port;
use crate::spelling;

/// Values with the ports that take them.
type Pairs = Vec<(Rc<Meaning>, Port)>;

/// What an assignment may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// An arrow: inputs.
    Wire,
    /// `set`: inputs and tunable parameters.
    Set,
    /// `fault`: inputs.
    Fault,
    /// The braces of `fmu`: also parameters and start values.
    Preset,
}

impl Scope<'_, '_> {
    /// Whether an assignment of this role may touch a variable.
    pub fn may(&self, role: Role, port: Port) -> bool {
        let variable = self.variable(port);
        match (variable.causality, role) {
            (Causality::Input, _) => true,
            (Causality::Parameter, Role::Set) => variable.variability == Variability::Tunable,
            (Causality::Independent, Role::Preset) => false,
            (_, Role::Preset) => {
                variable.variability != Variability::Constant
                    && matches!(variable.initial_or_default(), Some(Initial::Exact | Initial::Approx))
            }
            _ => false,
        }
    }

    /// The part of a target that may be touched; a refusal names the first variable that may not.
    pub fn touchable(&self, role: Role, signal: Signal, at: Meeting<'_>) -> Option<Signal> {
        match signal {
            Signal::One(port) if self.may(role, port) => Some(signal),
            Signal::One(port) => self.refuse(self.untouchable(role, port, at)),
            Signal::Group(group) => {
                let port = |variable| Port { instance: group.instance, variable };
                let members: Vec<_> =
                    group.members.iter().filter(|(_, variable)| self.may(role, port(*variable))).cloned().collect();
                let first = group.ports().next();
                match first {
                    Some(first) if members.is_empty() => self.refuse(self.untouchable(role, first, at)),
                    _ => Some(Signal::Group(Group { members, ..group })),
                }
            }
            Signal::Picked(signals) => {
                let parts = signals.into_iter().map(|signal| self.touchable(role, signal, at));
                parts.collect::<Option<_>>().map(Signal::Picked)
            }
        }
    }

    fn untouchable(&self, role: Role, port: Port, at: Meeting<'_>) -> Diagnostic {
        let variable = self.variable(port);
        let (name, causality) = (self.text(at.target), variable.causality);
        let is_parameter = matches!(causality, Causality::Parameter | Causality::CalculatedParameter);
        if role == Role::Preset {
            let why =
                if variable.variability == Variability::Constant { "is constant" } else { "is computed by the unit" };
            let error =
                Diagnostic::error("E05", at.target, format!("`{}` cannot be set: it {why}", self.port_name(port)));
            return error
                .help("before the run parameters, inputs and start values can be set that the unit does not compute");
        }
        if is_parameter && role == Role::Fault {
            let message = format!("`{name}` is a parameter, and a fault acts on a connection");
            let help = "name the input of the connection; `set` changes tunable parameters";
            return Diagnostic::error("E04", at.target, message).help(help);
        }
        if is_parameter {
            let said = variable.variability.name();
            let message = format!("`{name}` cannot change during the run: its FMU says variability=\"{said}\"");
            return Diagnostic::error("E05", at.target, message).help(self.tunable_help(role, port));
        }
        let what = match causality {
            Causality::Output => "an output",
            Causality::Independent => "the unit's time",
            _ => "a local variable",
        };
        let error = Diagnostic::error("E04", at.target, format!("`{name}` is {what} and cannot be a target"));
        error.help(match role {
            Role::Wire => "an arrow ends in an input",
            Role::Fault => "a fault acts on a connection: name the input that the connection drives",
            Role::Set | Role::Preset => "`set` takes inputs and tunable parameters",
        })
    }

    fn tunable_help(&self, role: Role, port: Port) -> String {
        let variables = self.known(port.instance).variables.iter();
        let tunable = variables.filter(|variable| {
            variable.causality == Causality::Parameter && variable.variability == Variability::Tunable
        });
        let names: Vec<_> = tunable.map(|variable| spelling::variable(&variable.name)).take(8).collect();
        match (role, names.as_slice()) {
            (Role::Wire, _) => "an arrow ends in an input; set it in the fmu line".to_owned(),
            (_, []) => "set it in the fmu line".to_owned(),
            (_, names) => format!("set it in the fmu line, or `set` a tunable parameter: {}", names.join(", ")),
        }
    }

    /// The value for each port of a target, in the ports' own types and units. Shapes are checked first, and the first
    /// member that does not fit is reported for all of them.
    pub fn assigned_ports(&self, value: &Rc<Meaning>, target: &Signal, at: Meeting<'_>) -> Option<Vec<(Port, Fitted)>> {
        let mut pairs = Vec::new();
        self.pair(value, target, at, &mut pairs)?;
        pairs.into_iter().map(|(value, port)| Some((port, self.fit(&value, port, at)?))).collect()
    }

    fn pair(&self, value: &Rc<Meaning>, target: &Signal, at: Meeting<'_>, pairs: &mut Pairs) -> Option<()> {
        match (&**value, target) {
            (Meaning::Group(source), Signal::Group(target)) => self.by_name(source, target, at, pairs),
            (Meaning::List(elements), Signal::Picked(targets)) if elements.len() == targets.len() => {
                elements.iter().zip(targets).try_for_each(|(element, target)| self.pair(element, target, at, pairs))
            }
            (Meaning::List(_) | Meaning::Group(_), Signal::Group(_) | Signal::Picked(_)) => {
                let (leaves, ports) = (self.leaves(value), target.ports());
                if leaves.len() != ports.len() {
                    let message = format!("{} values meet {} inputs", leaves.len(), ports.len());
                    let error = Diagnostic::error("E22", at.source, message).saying(format!("gives {}", leaves.len()));
                    let error = error.label(at.target, format!("takes {}", ports.len()));
                    return self.refuse(error.help("pick the members that belong together, for example `.{x, y}`"));
                }
                pairs.extend(leaves.into_iter().zip(ports));
                Some(())
            }
            (Meaning::List(_) | Meaning::Group(_), Signal::One(_)) => {
                let message = format!("`{}` takes one value", self.text(at.target));
                let error = Diagnostic::error("E22", at.source, message).saying(value.kind());
                self.refuse(error.help("take one part, for example `.x` or `[1]`"))
            }
            (_, Signal::Group(_) | Signal::Picked(_)) => {
                let count = target.ports().len();
                let message = format!("one value cannot fill `{}`", self.text(at.target));
                let error = Diagnostic::error("E22", at.source, message).saying("one value");
                let error = error.label(at.target, format!("takes {count}"));
                self.refuse(error.help("write a list, for example `[1, 2, 3] m`"))
            }
            (_, Signal::One(port)) => {
                pairs.push((Rc::clone(value), *port));
                Some(())
            }
        }
    }

    fn by_name(&self, source: &Group, target: &Group, at: Meeting<'_>, pairs: &mut Pairs) -> Option<()> {
        // Of equal names the first one counts.
        let given: BTreeMap<&str, usize> =
            source.members.iter().rev().map(|(name, variable)| (name.as_str(), *variable)).collect();
        let missing: Vec<_> = target
            .members
            .iter()
            .map(|(suffix, _)| suffix.as_str())
            .filter(|suffix| !given.contains_key(suffix))
            .collect();
        if !missing.is_empty() {
            let gives = source.members.iter().map(|(suffix, _)| suffix.trim_start_matches('.'));
            let list = listed(missing.iter().take(6).map(|suffix| suffix.trim_start_matches('.')));
            let message = format!("`{}` has no member {list} for `{}`", self.text(at.source), self.text(at.target));
            let error = Diagnostic::error("E22", at.source, message);
            let error = error.saying(format!("gives {}", gives.take(8).collect::<Vec<_>>().join(", ")));
            let error = error.label(at.target, format!("takes {} members", target.members.len()));
            return self.refuse(error.help("name the members on both sides, for example `a.{x, y} -> b.{u, v}`"));
        }
        for (suffix, variable) in &target.members {
            if let Some(&from) = given.get(suffix.as_str()) {
                let value = self.port_meaning(Port { instance: source.instance, variable: from });
                pairs.push((Rc::new(value), Port { instance: target.instance, variable: *variable }));
            }
        }
        Some(())
    }

    /// The single values of a list or group, in order.
    pub fn leaves(&self, value: &Rc<Meaning>) -> Vec<Rc<Meaning>> {
        match &**value {
            Meaning::List(elements) => elements.iter().flat_map(|element| self.leaves(element)).collect(),
            Meaning::Group(group) => group.ports().map(|port| Rc::new(self.port_meaning(port))).collect(),
            _ => vec![Rc::clone(value)],
        }
    }
}
