//! Names inside a unit: variables, groups, arrays and picked members.

use fmi2::description::{Causality, Kind};

use super::meaning::{Condition, Group, Meaning, Text};
use super::scope::Scope;
use super::script::{Declaration, not_yet};
use crate::diagnostic::Diagnostic;
use crate::nearest::nearest;
use crate::scenario::{BooleanExpression, Port};
use crate::source::Span;
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

impl Scope<'_> {
    /// The signal of a path that must begin with the name of an instance; `None` is reported, or follows from what was.
    pub fn signal(&self, path: &Path) -> Option<Signal> {
        match self.script.names.get(path.root.text.as_str()) {
            Some(&Declaration::Instance(instance, _)) => self.walk(instance, String::new(), &path.tail, path),
            Some(Declaration::Refused(_)) => None,
            Some(Declaration::Parameter(_)) => self.refuse(not_a_port(&path.root, "a parameter of the script")),
            Some(Declaration::Let(_)) => self.refuse(not_a_port(&path.root, "a `let` of the script")),
            None => {
                let is_instance = |declaration: &Declaration<'_>| matches!(declaration, Declaration::Instance(..));
                self.refuse(self.unknown_name(&path.root, is_instance, &[]))
            }
        }
    }

    /// Follows a path's tail from a beginning that exists.
    pub fn walk(&self, instance: usize, mut prefix: String, tail: &[Segment], path: &Path) -> Option<Signal> {
        let variables = &self.description(instance)?.variables;
        for (at, segment) in tail.iter().enumerate() {
            match segment {
                Segment::Field(word) => prefix = self.member(instance, &prefix, word)?,
                Segment::Index(index, span) => {
                    let element = format!("{prefix}{}", self.index_text(index)?);
                    if !self.exists(instance, &element) {
                        return self.refuse(self.no_element(instance, &prefix, &element, *span));
                    }
                    prefix = element;
                }
                Segment::Members(words, _) => {
                    let pick = |word| self.walk(instance, self.member(instance, &prefix, word)?, &tail[at + 1..], path);
                    let picked: Vec<_> = words.iter().map(pick).collect();
                    return picked.into_iter().collect::<Option<_>>().map(Signal::Picked);
                }
                Segment::AllIndices(span) => return self.refuse(not_yet(*span, "`[*]`")),
                Segment::All(span) => return self.refuse(not_yet(*span, "`.*`")),
            }
        }
        if prefix.is_empty() {
            let message = format!("`{}` is a whole unit, and one of its ports is meant here", path.root.text);
            let help =
                format!("for example `{}.{}`", path.root.text, variables.first().map_or("", |first| &first.name));
            return self.refuse(Diagnostic::error("E01", path.span, message).help(help));
        }
        if let Some(variable) = variables.iter().position(|variable| variable.name == prefix) {
            return Some(Signal::One(Port { instance, variable }));
        }
        let members = variables.iter().enumerate().filter_map(|(variable, declared)| {
            Some((
                declared.name.strip_prefix(&prefix).filter(|rest| rest.starts_with(['.', '[']))?.to_owned(),
                variable,
            ))
        });
        let members = members.collect();
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

    fn exists(&self, instance: usize, name: &str) -> bool {
        let is_beginning = |variable: &str| {
            variable.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        self.known(instance).variables.iter().any(|variable| is_beginning(&variable.name))
    }

    /// The name of a member, if there is one.
    fn member(&self, instance: usize, prefix: &str, word: &Word) -> Option<String> {
        let dotted = if prefix.is_empty() { String::new() } else { format!("{prefix}.") };
        let name = format!("{dotted}{}", word.text);
        if self.exists(instance, &name) {
            return Some(name);
        }
        let variables = &self.known(instance).variables;
        let next = |name: &'_ str| name.strip_prefix(&dotted).map(|rest| rest.find(['.', '[']).unwrap_or(rest.len()));
        let names = variables.iter().filter_map(|variable| {
            let end = next(&variable.name)?;
            variable.name.get(dotted.len()..dotted.len() + end)
        });
        let near = nearest(&word.text, names).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        let declared = &self.script.instances[instance];
        let owner =
            if prefix.is_empty() { declared.name.text.clone() } else { format!("{}.{prefix}", declared.name.text) };
        let count = variables.len();
        let help = format!("{near}All {count}: lockstep describe {}", declared.unit.text);
        let message = format!("`{owner}` has no variable `{}`", word.text);
        self.refuse(Diagnostic::error("E01", word.span, message).help(help))
    }

    fn no_element(&self, instance: usize, prefix: &str, element: &str, span: Span) -> Diagnostic {
        let name = format!("{}.{prefix}", self.script.instances[instance].name.text);
        let index = element.strip_prefix(prefix).unwrap_or(element);
        let error = Diagnostic::error("E01", span, format!("`{name}` has no element `{index}`"));
        let mut elements: Vec<&str> = Vec::new();
        for variable in &self.known(instance).variables {
            let rest = variable.name.strip_prefix(prefix).filter(|rest| rest.starts_with('['));
            let index = rest.and_then(|rest| Some(&rest[..=rest.find(']')?]));
            elements.extend(index.filter(|index| elements.last() != Some(index)));
        }
        match elements.as_slice() {
            [] => error.help("it is not an array"),
            [only] => error.help(format!("it has the element `{only}`")),
            [first, .., last] => error.help(format!("its elements go from `{first}` to `{last}`")),
        }
    }

    /// What a signal gives as a source; inputs give nothing.
    pub fn source(&self, signal: Signal, span: Span) -> Option<Meaning> {
        let is_input = |port| self.variable(port).causality == Causality::Input;
        match signal {
            Signal::One(port) if is_input(port) => self.refuse(self.input_as_source(port, span)),
            Signal::One(port) => Some(self.port_meaning(port)),
            Signal::Picked(signals) => {
                let picked: Vec<_> = signals.into_iter().map(|signal| self.source(signal, span)).collect();
                picked.into_iter().collect::<Option<_>>().map(Meaning::List)
            }
            Signal::Group(group) => {
                let first = group.ports().next();
                let port = |variable| Port { instance: group.instance, variable };
                let members: Vec<_> =
                    group.members.iter().filter(|(_, variable)| !is_input(port(*variable))).cloned().collect();
                match first {
                    Some(first) if members.is_empty() => self.refuse(self.input_as_source(first, span)),
                    _ => Some(Meaning::Group(Group { members, ..group })),
                }
            }
        }
    }

    fn input_as_source(&self, port: Port, span: Span) -> Diagnostic {
        let error = Diagnostic::error("E04", span, format!("`{}` is an input and gives no value", self.text(span)));
        let drives =
            |path: &Path| self.quietly(|scope| scope.signal(path)).is_some_and(|it| it.ports().contains(&port));
        match self.script.wires.iter().find(|wire| wire.targets.iter().any(drives)).map(|wire| wire.source.span) {
            Some(driver) => error.help(format!("read what drives it: `{}`", self.text(driver))),
            None => error.help("read an output, or what drives this input"),
        }
    }

    /// The meaning of one variable as a source.
    pub fn port_meaning(&self, port: Port) -> Meaning {
        match self.variable(port).kind {
            Kind::Real(_) => Meaning::Real(self.real_port(port)),
            Kind::Integer { .. } => Meaning::Integer(port),
            Kind::Enumeration { .. } => Meaning::Item(port),
            Kind::Boolean { .. } => Meaning::Condition(Condition::Plain(BooleanExpression::Signal(port))),
            Kind::String { .. } => Meaning::Text(Text::Port(port)),
        }
    }
}

fn not_a_port(root: &Word, what: &str) -> Diagnostic {
    Diagnostic::error("E04", root.span, format!("`{}` is {what} and cannot be a target", root.text))
        .help("an input of a unit is meant here, for example `quad.wind`")
}
