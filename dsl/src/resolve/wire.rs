//! Connections: one driver for each input element.

use std::collections::BTreeMap;
use std::rc::Rc;

use fmi2::description::{Causality, Kind};

use super::assign::Role;
use super::fit::{Fitted, Meeting};
use super::frame::Placed;
use super::meaning::Meaning;
use super::path::Root;
use super::scope::Scope;
use super::script::{Declaration, Wire};
use super::signal::Signal;
use crate::diagnostic::{Diagnostic, Edit};
use crate::scenario::{Connection, Port, duration};
use crate::source::Span;
use crate::spelling;
use crate::syntax::{Arrow, ExpressionKind, Path};

/// A connection with the place that it comes from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Wired {
    /// The connection.
    pub connection: Connection,
    /// Index of its statement among the wires of the script.
    pub wire: usize,
    /// The target as written.
    pub target: Span,
}

/// The first driver of an input.
struct Driver {
    source: Span,
    target: Span,
}

impl Scope<'_, '_> {
    /// All connections in order of their targets; `periods` are the instances'.
    pub fn connections(&self, periods: Option<&[u64]>) -> Vec<Wired> {
        let mut drivers = BTreeMap::new();
        let mut connections = Vec::new();
        for (index, &Placed { frame, part: wire }) in self.script.wires.iter().enumerate() {
            let scope = self.at(frame);
            let targets: Vec<_> = wire.targets.iter().map(|target| (target, scope.signal(target))).collect();
            if let Some(error) = scope.backwards(&wire, &targets) {
                self.report(error);
                continue;
            }
            let source = scope.evaluate(wire.source);
            for (target, signal) in targets {
                self.note_driver(wire.source.span, signal.as_ref());
                let wired = scope.wired(index, &wire, source.as_ref(), (target, signal), &mut drivers);
                if let (Some(periods), Arrow::Direct) = (periods, wire.arrow) {
                    self.check_periods(&wire, target, &wired, periods);
                }
                connections.extend(wired);
            }
        }
        connections.sort_by_key(|wired| wired.connection.target);
        connections
    }

    /// Notes what drives the inputs of a target, for the help of errors.
    fn note_driver(&self, source: Span, target: Option<&Signal>) {
        let mut driven_by = self.driven_by.borrow_mut();
        for port in target.map(Signal::ports).unwrap_or_default() {
            driven_by.entry(port).or_insert(source);
        }
    }

    /// That an arrow goes from an input to an output.
    fn backwards(&self, wire: &Wire<'_>, targets: &[(&Path, Option<Signal>)]) -> Option<Diagnostic> {
        let (ExpressionKind::Path(source), [(target, Some(target_signal))]) = (&wire.source.kind, targets) else {
            return None;
        };
        let Root::Declared(Placed { part: Declaration::Instance(..), .. }, _) = self.root(source) else { return None };
        let source_signal = self.signal(source)?;
        let are_all =
            |signal: &Signal, causality| signal.ports().iter().all(|port| self.variable(*port).causality == causality);
        if !are_all(&source_signal, Causality::Input) || !are_all(target_signal, Causality::Output) {
            return None;
        }
        let (input, output) = (self.text(source.span), self.text(target.span));
        let arrow = self.text(wire.arrow_span);
        let error = Diagnostic::error("E04", target.span, format!("`{output}` is an output and cannot be a target"));
        let turned = format!("{output} {arrow} {input}");
        let edit = Edit::new(source.span.to(target.span), turned.clone());
        let error = error.label(source.span, "an input").help(format!("turn the arrow: `{turned}`"));
        Some(error.fix("turn the arrow", [edit]))
    }

    fn wired(
        &self,
        index: usize,
        wire: &Wire<'_>,
        source: Option<&Rc<Meaning>>,
        (target, signal): (&Path, Option<Signal>),
        drivers: &mut BTreeMap<Port, Driver>,
    ) -> Vec<Wired> {
        let direct = wire.arrow == Arrow::Direct;
        let at =
            Meeting { source: wire.source.span, target: target.span, arrow: Some(if direct { "=>" } else { "->" }) };
        let signal = signal.and_then(|signal| self.touchable(Role::Wire, signal, at));
        let Some(signal) = signal else { return Vec::new() };
        let ports = signal.ports();
        if let Some((port, first)) = ports.iter().find_map(|port| Some((*port, drivers.get(port)?))) {
            self.report(self.two_drivers(at, port, first));
            return Vec::new();
        }
        drivers.extend(ports.iter().map(|port| (*port, Driver { source: at.source, target: at.target })));
        let Some(assigned) = source.and_then(|source| self.assigned_ports(source, &signal, at)) else {
            return Vec::new();
        };
        let mut wired = Vec::new();
        for (port, fitted) in assigned {
            let Fitted::Drive(source) = fitted else {
                let error = Diagnostic::error("E21", at.source, "a file is given to a unit before the run");
                let name = spelling::variable(&self.variable(port).name);
                self.report(error.help(format!("write it in the braces: `fmu … {{ {name} = … }}`")));
                return Vec::new();
            };
            if direct && source.rises() {
                self.report(rises_within_a_step(at.source));
                return Vec::new();
            }
            let connection = Connection { target: port, source, direct };
            wired.push(Wired { connection, wire: index, target: target.span });
        }
        wired
    }

    fn two_drivers(&self, at: Meeting<'_>, port: Port, first: &Driver) -> Diagnostic {
        let (sink, driver, second) = (self.text(at.target), self.text(first.source), self.text(at.source));
        let message = format!("`{sink}` already gets its value from `{driver}` (line {})", self.line(first.source));
        if first.target == at.target {
            let error = Diagnostic::error("E03", at.target, format!("`{sink}` gets a value in several rounds"));
            return error.help("an input has one driver: give the target the counter of the loop as its index");
        }
        let error = Diagnostic::error("E03", at.target, message).label(first.target, "driven here first");
        let arrow = at.arrow.unwrap_or("->");
        let adds = matches!(self.variable(port).kind, Kind::Real(_)) && self.text(first.target) == sink;
        if adds {
            error.help(format!("an input has one driver; to combine two write `{driver} + {second} {arrow} {sink}`"))
        } else {
            error.help("an input has one driver; drive the members of a group together or one by one")
        }
    }

    fn check_periods(&self, wire: &Wire<'_>, target: &Path, wired: &[Wired], periods: &[u64]) {
        let Some(first) = wired.first() else { return };
        let taker = first.connection.target.instance;
        let mut givers: Vec<_> =
            wired.iter().flat_map(|wired| self.read_by(&wired.connection.source)).map(|port| port.instance).collect();
        givers.sort_unstable();
        givers.dedup();
        let (source, sink) = (self.text(wire.source.span), self.text(target.span));
        if givers.is_empty() {
            let error =
                Diagnostic::error("E07", wire.arrow_span, "`=>` lets a unit step first, and none stands on its left");
            self.report(held(error, wire, &format!("{source} -> {sink}")));
        }
        let divides = |giver: usize| {
            periods[giver].is_multiple_of(periods[taker]) || periods[taker].is_multiple_of(periods[giver])
        };
        for giver in givers.into_iter().filter(|&giver| !divides(giver)) {
            let period = |instance: usize| {
                let step_ns = self.grid().map_or(0, |grid| grid.step_ns);
                duration(periods[instance].saturating_mul(step_ns))
            };
            let name = |instance: usize| &self.script.instances[instance].name;
            let message = format!(
                "`=>` needs periods of which one divides the other, but `{}` steps every {} and `{}` every {}",
                name(giver),
                period(giver),
                name(taker),
                period(taker)
            );
            let error = Diagnostic::error("E07", wire.arrow_span, message);
            self.report(held(error, wire, &format!("{source} -> {sink}")));
        }
    }
}

/// The error with `->` as its remedy.
fn held(error: Diagnostic, wire: &Wire<'_>, written: &str) -> Diagnostic {
    let text = format!("write `{written}`");
    error.help(text.clone()).fix(text, [Edit::new(wire.arrow_span, "->")])
}

/// `rises` compares two samples, and `=>` passes a value that is in no sample yet.
fn rises_within_a_step(source: Span) -> Diagnostic {
    Diagnostic::error("E07", source, "`rises` compares two samples, and `=>` brings what is in no sample yet")
        .help("write `->`: what rises is seen at the next sample")
}
