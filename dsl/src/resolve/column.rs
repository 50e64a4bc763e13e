//! What is recorded, in which order.

use std::collections::BTreeMap;

use fmi2::description::{BaseType, Causality};

use super::frame::Placed;
use super::grid::Least;
use super::meaning::{Meaning, Real};
use super::path::Root;
use super::real;
use super::running::latest_start;
use super::scope::Scope;
use super::script::Declaration;
use super::signal::Signal;
use super::wire::Wired;
use crate::diagnostic::Diagnostic;
use crate::scenario::{Claim, Column, ColumnSource, Port};
use crate::source::Span;
use crate::syntax::{Expression, ExpressionKind, Path, Segment, Word};

/// The columns so far, each name once.
#[derive(Default)]
struct Columns {
    all: Vec<Column>,
    /// Index and place of each column by its name.
    by_name: BTreeMap<String, (usize, Span)>,
}

impl<'a> Scope<'_, 'a> {
    /// The columns of `record`, each once, in the script's order. Without `record`: every port at either end of a connection
    /// or in a claim, in order of instances and their variables.
    pub fn columns(self, connections: &[Wired], claims: &[Claim]) -> Vec<Column> {
        if self.script.has_record {
            let mut columns = Columns::default();
            for record in &self.shared.script.records {
                let (path, every) = record.part;
                self.at(record.frame).record(path, every, &mut columns);
            }
            return columns.all;
        }
        let mut all = self.sources(connections);
        all.extend(connections.iter().map(|wired| wired.connection.target));
        claims.iter().for_each(|claim| self.of_formula(&claim.formula, &mut all));
        let numbers = all.into_iter().filter(|port| self.variable(*port).base_type() != BaseType::String);
        numbers.map(|port| Column::of_port(self.column_name(port), port)).collect()
    }

    fn column_name(self, port: Port) -> String {
        format!("{}.{}", self.script.instances[port.instance].name, self.variable(port).name)
    }

    fn record(self, path: &'a Path, every: Option<&'a Expression>, columns: &mut Columns) {
        let every = match every {
            Some(every) => self.ticks(every, Least::OneTick),
            None => Some(1),
        };
        for (name, source) in self.expanded(path).iter().flat_map(|path| self.recorded(path)) {
            let Some(every) = every else { continue };
            let from_tick = match &source {
                ColumnSource::Real { value, .. } => latest_start(value).map_or(0, |(tick, _)| tick),
                ColumnSource::Port(_) | ColumnSource::Condition(_) => 0,
            };
            let column = Column { name, source, every, from_tick };
            match columns.by_name.get(&column.name) {
                None => {
                    columns.by_name.insert(column.name.clone(), (columns.all.len(), path.span));
                    columns.all.push(column);
                }
                Some(&(first, _)) if columns.all[first] == column => {}
                Some(&(first, place)) if columns.all[first].every == every => {
                    let name = column.name;
                    let error = Diagnostic::error("E24", path.span, format!("two columns are called `{name}`"));
                    self.report(error.label(place, "recorded here first").help("rename one of the `let`s"));
                }
                Some(&(_, first)) => {
                    let message = format!("`{}` is recorded with two periods", column.name);
                    let error = Diagnostic::error("E25", path.span, message).label(first, "recorded here first");
                    self.report(error.help("record it in one line"));
                }
            }
        }
    }

    /// The names and sources of the columns of a path.
    fn recorded(self, path: &Path) -> Vec<(String, ColumnSource)> {
        let ports = |ports: Vec<Port>| {
            ports.into_iter().map(|port| (self.column_name(port), ColumnSource::Port(port))).collect()
        };
        match path.tail.split_last() {
            Some((Segment::All(_), before)) => {
                let whole = Path { tail: before.to_vec(), ..path.clone() };
                ports(self.all_of(&whole).unwrap_or_default())
            }
            _ => match self.root(path) {
                Root::Declared(Placed { frame, part: Declaration::Let(binding) }, tail) => {
                    let name = self.script.frames.full_name(frame, &binding.name.text);
                    self.value_columns(path, &name, tail)
                }
                Root::Declared(Placed { part: Declaration::Parameter(_) | Declaration::Counter(..), .. }, _) => {
                    let message = format!("`{}` is known before the run", self.text(path.span));
                    self.report(
                        Diagnostic::error("E21", path.span, message).help("record what changes: ports and `let`s"),
                    );
                    Vec::new()
                }
                _ => ports(self.signal(path).map(|signal| self.recordable(&signal, path.span)).unwrap_or_default()),
            },
        }
    }

    /// The ports of a signal, which must be no texts.
    fn recordable(self, signal: &Signal, span: Span) -> Vec<Port> {
        let ports = signal.ports();
        match ports.iter().find(|port| self.variable(**port).base_type() == BaseType::String) {
            Some(text) => {
                let message = format!("`{}` is a String, and a trace holds numbers", self.port_name(*text));
                self.report(Diagnostic::error("E21", span, message).help("record the other members by name"));
                Vec::new()
            }
            None => ports,
        }
    }

    /// All inputs and outputs of an instance or of the instances of a part, and all of a group, but texts.
    fn all_of(self, path: &Path) -> Option<Vec<Port>> {
        let is_number = |port: &Port| self.variable(*port).base_type() != BaseType::String;
        let ports = match self.root_or_part(path) {
            Root::Declared(Placed { part: Declaration::Instance(instance, _), .. }, []) => self.ends_of(instance),
            Root::Declared(Placed { part: Declaration::Part(part, _), .. }, _) => {
                let instances = self.script.instances.iter().enumerate();
                let below = instances.filter(|(_, it)| it.name.starts_with(self.script.frames.prefix(part)));
                below.flat_map(|(instance, _)| self.ends_of(instance)).collect()
            }
            Root::Declared(..) | Root::Unknown => self.signal(path)?.ports(),
            Root::Reported => return None,
        };
        Some(ports.into_iter().filter(is_number).collect())
    }

    /// The inputs and outputs of an instance.
    fn ends_of(self, instance: usize) -> Vec<Port> {
        let Some(unit) = self.description(instance) else { return Vec::new() };
        let variables = unit.variables.iter().enumerate();
        let ends = variables.filter(|(_, it)| matches!(it.causality, Causality::Input | Causality::Output));
        ends.map(|(variable, _)| Port { instance, variable }).collect()
    }

    /// The columns of a `let` or, by the tail behind its name, of a part of it; picked members are recorded one by one.
    fn value_columns(self, path: &Path, name: &str, tail: &[Segment]) -> Vec<(String, ColumnSource)> {
        let mut name = name.to_owned();
        for (at, segment) in tail.iter().enumerate() {
            match segment {
                Segment::Field(word) => name = format!("{name}.{}", word.text),
                Segment::Index(index, _) => name += &self.index_text(index).unwrap_or_default(),
                Segment::Members(words, _) => {
                    let before = path.tail.len() - tail.len() + at;
                    let one = |word: &Word| {
                        let mut picked = path.clone();
                        picked.tail[before] = Segment::Field(word.clone());
                        self.recorded(&picked)
                    };
                    return words.iter().flat_map(one).collect();
                }
                Segment::AllIndices(_) | Segment::All(_) => {}
            }
        }
        let kind = ExpressionKind::Path(path.clone());
        let expression = Expression { kind, span: path.span, parenthesised: false };
        let meaning = self.evaluate(&expression);
        meaning.map(|meaning| self.columns_of(&meaning, &name, path.span)).unwrap_or_default()
    }

    fn columns_of(self, meaning: &Meaning, name: &str, span: Span) -> Vec<(String, ColumnSource)> {
        match meaning {
            Meaning::Real(value) => vec![(name.to_owned(), shown(value))],
            Meaning::Integer(port) => vec![(name.to_owned(), ColumnSource::Port(*port))],
            Meaning::Item(port) => vec![(name.to_owned(), ColumnSource::Port(*port))],
            Meaning::Condition(condition) => match condition.boolean() {
                Ok(condition) => vec![(name.to_owned(), ColumnSource::Condition(condition))],
                Err(word) => {
                    let error =
                        Diagnostic::error("E30", span, format!("`{name}` looks ahead, and a row shows one time"));
                    self.report(error.label(word, "this word").help("record what it judges"));
                    Vec::new()
                }
            },
            Meaning::List(elements) => {
                let numbered = elements.iter().zip(1..);
                numbered.flat_map(|(element, at)| self.columns_of(element, &format!("{name}[{at}]"), span)).collect()
            }
            Meaning::Group(group) => {
                let column = |port: Port, member: &str| (format!("{name}{member}"), ColumnSource::Port(port));
                group.ports().zip(&group.members).map(|(port, (member, _))| column(port, member)).collect()
            }
            Meaning::Text(_) => {
                let error = Diagnostic::error("E21", span, format!("`{name}` is a text, and a trace holds numbers"));
                self.report(error.help("record numbers and Booleans"));
                Vec::new()
            }
        }
    }
}

/// A real number in the unit of measure in which it is shown.
fn shown(value: &Real) -> ColumnSource {
    let unit = value.unit.as_ref().map(|unit| &unit.unit);
    let expression = value.expression.clone();
    match unit {
        Some(unit) if unit.factor != 1.0 => {
            let base = fmi2::units::BaseUnit { factor: unit.factor, ..Default::default() };
            ColumnSource::Real { value: real::from_si(expression, base), unit: unit.name.clone() }
        }
        _ => {
            let unit = unit.map(|unit| unit.name.clone()).or_else(|| match value.measure {
                super::meaning::Measure::Known(dimension) => Some(super::measure::si_name(dimension)),
                super::meaning::Measure::Undeclared => None,
            });
            ColumnSource::Real { value: expression, unit: unit.unwrap_or_default() }
        }
    }
}
