//! Names inside a unit: variables, groups, arrays and picked members.

use std::rc::Rc;

use fmi2::description::{Causality, Kind};

use super::findings::Remedy;
use super::meaning::{Group, Meaning, Text};
use super::path::Root;
use super::scope::Scope;
use super::script::Declaration;
use crate::diagnostic::Diagnostic;
use crate::nearest::nearest;
use crate::scenario::{BooleanExpression, Port};
use crate::source::Span;
use crate::spelling;
use crate::syntax::{Expression, Path, Segment, Word};

/// What a path into a unit names.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Signal {
    /// One variable.
    One(Port),
    /// Variables with a common beginning.
    Group(Group),
    /// `{a, b}`, in order.
    Picked(Vec<Signal>),
}

impl Signal {
    /// All ports, in order.
    pub fn ports(&self) -> Vec<Port> {
        match self {
            Self::One(port) => vec![*port],
            Self::Group(group) => group.ports().collect(),
            Self::Picked(signals) => signals.iter().flat_map(Self::ports).collect(),
        }
    }
}

impl Group {
    /// The ports of the members, in order.
    pub fn ports(&self) -> impl Iterator<Item = Port> + '_ {
        self.members.iter().map(|&(_, variable)| Port { instance: self.instance, variable })
    }
}

impl Scope<'_, '_> {
    /// The signal of a path that must begin with the name of an instance; `None` is reported, or follows from what was.
    pub fn signal(&self, path: &Path) -> Option<Signal> {
        let (declaration, tail) = match self.root(path) {
            Root::Declared(found, tail) => (found.part, tail),
            Root::Reported => return None,
            Root::Unknown => {
                if let Some(error) = self.wrong_index(path) {
                    return self.refuse(error);
                }
                let is_meant =
                    |declared: &Declaration<'_>| matches!(declared, Declaration::Instance(..) | Declaration::Part(..));
                return self.refuse_unknown_name(&path.root, is_meant, &[]);
            }
        };
        match declaration {
            Declaration::Instance(instance, _) => self.walk(instance, String::new(), tail, path),
            Declaration::Part(..) | Declaration::Refused(_) => None,
            Declaration::Parameter(_) => self.refuse(not_a_port(&path.root, "a parameter of the script")),
            Declaration::Let(_) => self.refuse(not_a_port(&path.root, "a `let` of the script")),
            Declaration::Counter(..) => self.refuse(not_a_port(&path.root, "the counter of a loop")),
        }
    }

    /// Follows a path's tail from a beginning that exists.
    pub fn walk(&self, instance: usize, mut prefix: String, tail: &[Segment], path: &Path) -> Option<Signal> {
        let unit = self.description(instance)?;
        for (at, segment) in tail.iter().enumerate() {
            match segment {
                Segment::Field(word) => prefix = self.member(instance, &prefix, word)?,
                Segment::Index(index, span) => {
                    let element = format!("{prefix}{}", self.index_text(index)?);
                    if !unit.has(&element) {
                        return self.refuse_element(instance, prefix, &element, *span);
                    }
                    prefix = element;
                }
                Segment::Members(words, _) => {
                    let pick = |word| self.walk(instance, self.member(instance, &prefix, word)?, &tail[at + 1..], path);
                    let picked: Vec<_> = words.iter().map(pick).collect();
                    return picked.into_iter().collect::<Option<_>>().map(Signal::Picked);
                }
                Segment::AllIndices(span) | Segment::All(span) => {
                    let message = format!("`{}` names many variables", self.text(*span));
                    let error = Diagnostic::error("E21", *span, message);
                    return self.refuse(error.help("it stands in `record`, `[*]` also in `min max sum any all`"));
                }
            }
        }
        if prefix.is_empty() {
            let name = &self.script.instances[instance].name;
            let message = format!("`{name}` is a whole unit, and one of its ports is meant here");
            let first = unit.variables.first().map_or("", |first| &first.name);
            let help = format!("for example `{name}.{}`", spelling::variable(first));
            return self.refuse(Diagnostic::error("E01", path.span, message).help(help));
        }
        if let Some(variable) = unit.variable(&prefix) {
            return Some(Signal::One(Port { instance, variable }));
        }
        let members = unit.members(&prefix);
        Some(Signal::Group(Group { instance, prefix, members }))
    }

    /// `[1,2]`, as names of variables spell it.
    pub fn index_text(&self, index: &[Expression]) -> Option<String> {
        let numbers: Vec<_> = index.iter().map(|number| self.whole_number(number)).collect();
        let numbers = numbers.into_iter().collect::<Option<Vec<_>>>()?;
        Some(format!("[{}]", numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")))
    }

    /// A plain whole number that is known before the run.
    pub fn whole_number(&self, expression: &Expression) -> Option<i64> {
        let meaning = self.evaluate(expression)?;
        let real = self.real(&meaning, expression.span)?;
        let Some(value) = real.constant() else { return self.refuse(self.must_be_known(expression.span)) };
        if real.measure != super::meaning::Measure::PLAIN || value.fract() != 0.0 || value.abs() > 1e9 {
            let message = format!("expected a whole number, found `{}`", self.text(expression.span));
            return self
                .refuse(Diagnostic::error("E38", expression.span, message).help("an index is a number such as `2`"));
        }
        Some(value as i64)
    }

    /// The name of a member, if there is one.
    fn member(&self, instance: usize, prefix: &str, word: &Word) -> Option<String> {
        let dotted = if prefix.is_empty() { String::new() } else { format!("{prefix}.") };
        let name = format!("{dotted}{}", word.text);
        let unit = self.known(instance);
        if unit.has(&name) {
            return Some(name);
        }
        // Names of structured variables may have single quotes of their own.
        let quoted = format!("{dotted}'{}'", word.text);
        if unit.has(&quoted) {
            return Some(quoted);
        }
        let declared = &self.script.instances[instance];
        let owner = if prefix.is_empty() { declared.name.clone() } else { format!("{}.{prefix}", declared.name) };
        let all = format!("All {}: lockstep describe {}", unit.variables.len(), declared.unit.text);
        let message = format!("`{owner}` has no variable `{}`", word.text);
        let error = Diagnostic::error("E01", word.span, message).help(all.clone());
        let (written, span) = (word.text.clone(), word.span);
        self.refuse_and_search(error, move |scope| {
            let unit = scope.known(instance);
            let names = unit.beginning(&dotted).iter().filter_map(|&variable| {
                let rest = unit.variables[variable].name.get(dotted.len()..)?;
                rest.get(..rest.find(['.', '[']).unwrap_or(rest.len()))
            });
            Some(Remedy::meant(&spelling::variable(nearest(&written, names)?), span).saying(&all))
        })
    }

    fn refuse_element<T>(&self, instance: usize, prefix: String, element: &str, span: Span) -> Option<T> {
        let name = format!("{}.{prefix}", self.script.instances[instance].name);
        let index = element.strip_prefix(&prefix).unwrap_or(element);
        let error = Diagnostic::error("E01", span, format!("`{name}` has no element `{index}`"));
        self.refuse_and_search(error, move |scope| {
            let unit = scope.known(instance);
            let mut elements: Vec<&str> = Vec::new();
            let mut variables = unit.beginning(&format!("{prefix}[")).to_vec();
            variables.sort_unstable();
            for variable in variables {
                let rest = &unit.variables[variable].name[prefix.len()..];
                let index = rest.find(']').map(|end| &rest[..=end]);
                elements.extend(index.filter(|index| elements.last() != Some(index)));
            }
            Some(match elements.as_slice() {
                [] => "it is not an array".to_owned(),
                [only] => format!("it has the element `{only}`"),
                [first, .., last] => format!("its elements go from `{first}` to `{last}`"),
            })
        })
    }

    /// What a signal gives as a source; inputs give nothing.
    pub fn source(&self, signal: Signal, span: Span) -> Option<Meaning> {
        let is_input = |port| self.variable(port).causality == Causality::Input;
        match signal {
            Signal::One(port) if is_input(port) => self.refuse_input(port, span),
            Signal::One(port) => Some(self.port_meaning(port)),
            Signal::Picked(signals) => {
                let picked = signals.into_iter().map(|signal| self.source(signal, span).map(Rc::new));
                let picked: Vec<_> = picked.collect();
                picked.into_iter().collect::<Option<_>>().map(Meaning::List)
            }
            Signal::Group(group) => {
                let first = group.ports().next();
                let port = |variable| Port { instance: group.instance, variable };
                let members: Vec<_> =
                    group.members.iter().filter(|(_, variable)| !is_input(port(*variable))).cloned().collect();
                match first {
                    Some(first) if members.is_empty() => self.refuse_input(first, span),
                    _ => Some(Meaning::Group(Group { members, ..group })),
                }
            }
        }
    }

    fn refuse_input<T>(&self, port: Port, span: Span) -> Option<T> {
        let error = Diagnostic::error("E04", span, format!("`{}` is an input and gives no value", self.text(span)));
        self.refuse_and_search(error.help("read an output, or what drives this input"), move |scope| {
            let driver = *scope.driven_by.borrow().get(&port)?;
            Some(format!("read what drives it: `{}`", scope.text(driver)))
        })
    }

    /// The meaning of one variable as a source.
    pub fn port_meaning(&self, port: Port) -> Meaning {
        match self.variable(port).kind {
            Kind::Real(_) => Meaning::Real(self.real_port(port)),
            Kind::Integer { .. } => Meaning::Integer(port),
            Kind::Enumeration { .. } => Meaning::Item(port),
            Kind::Boolean { .. } => Meaning::plain(BooleanExpression::Signal(port), None),
            Kind::String { .. } => Meaning::Text(Text::Port(port)),
        }
    }
}

fn not_a_port(root: &Word, what: &str) -> Diagnostic {
    Diagnostic::error("E04", root.span, format!("`{}` is {what} and cannot be a target", root.text))
        .help("an input of a unit is meant here, for example `quad.wind`")
}
