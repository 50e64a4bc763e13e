//! Sorts the statements of a script, refuses those that this version does not know, and finds who declares a name.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use fmi2::description::ModelDescription;

use super::Request;
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::syntax::{self, Arrow, Binding, Expression, Name, Path, Statement, StatementKind, Window, Word};

/// The statements of a script by kind, each in the file's order.
#[derive(Debug, Default)]
pub(super) struct Script<'a> {
    /// `scenario`
    pub title: Option<&'a Word>,
    /// `step`
    pub step: Option<&'a Expression>,
    /// `stop`
    pub stop: Option<&'a Expression>,
    /// Whether a `stop` stands there that was refused.
    pub stop_refused: bool,
    /// `param`
    pub parameters: Vec<&'a Binding>,
    /// `let`
    pub lets: Vec<&'a Binding>,
    /// `fmu`
    pub instances: Vec<Declared<'a>>,
    /// `->` and `=>`
    pub wires: Vec<Wire<'a>>,
    /// `at`
    pub windows: Vec<&'a Window>,
    /// `assert`
    pub claims: Vec<(&'a Name, &'a Expression)>,
    /// The paths of `record`.
    pub records: Vec<&'a Path>,
    /// Whether a `record` line stands there.
    pub has_record: bool,
    /// Who declares which name.
    pub names: BTreeMap<&'a str, Declaration<'a>>,
    /// The names of the claims with their places.
    claim_names: BTreeMap<&'a str, Span>,
}

/// A unit under a name.
#[derive(Debug)]
pub(super) struct Declared<'a> {
    /// The name.
    pub name: &'a Word,
    /// The unit as written.
    pub unit: &'a Word,
    /// `every`
    pub every: Option<&'a Expression>,
    /// The braces.
    pub values: &'a [syntax::Value],
    /// What the unit says about itself, unless it was not found.
    pub description: Option<&'a Arc<ModelDescription>>,
}

/// A connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wire<'a> {
    /// The left side.
    pub source: &'a Expression,
    /// Which arrow.
    pub arrow: Arrow,
    /// Where the arrow stands.
    pub arrow_span: Span,
    /// The right sides.
    pub targets: &'a [Path],
}

/// What a name stands for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Declaration<'a> {
    /// `param`
    Parameter(&'a Binding),
    /// `let`
    Let(&'a Binding),
    /// `fmu`: index into [`Script::instances`].
    Instance(usize, &'a Word),
    /// A statement that was refused; the name is silent.
    Refused(&'a Word),
}

impl Declaration<'_> {
    fn span(&self) -> Span {
        match self {
            Self::Parameter(binding) | Self::Let(binding) => binding.name.span,
            Self::Instance(_, word) | Self::Refused(word) => word.span,
        }
    }
}

/// Names that mean something already.
const RESERVED: [&str; 3] = ["time", "pi", "seed"];

/// That this version does not know something; `what` reads as the subject of the sentence.
pub(super) fn not_yet(span: Span, what: &str) -> Diagnostic {
    Diagnostic::error("E20", span, format!("{what} is not known to this version of lockstep yet"))
        .help("leave it out for now")
}

impl<'a> Script<'a> {
    /// Sorts the statements; whatever is wrong with them goes to `findings`.
    pub fn new(request: &Request<'a>, findings: &RefCell<Vec<Diagnostic>>) -> Self {
        let mut script = Self::default();
        let mut found = Vec::new();
        for statement in &request.file.statements {
            script.take(request, statement, &mut found);
        }
        script.require(request, &mut found);
        findings.borrow_mut().append(&mut found);
        script
    }

    fn take(&mut self, request: &Request<'a>, statement: &'a Statement, found: &mut Vec<Diagnostic>) {
        let span = statement.span;
        match &statement.kind {
            StatementKind::Scenario(title) => once(&mut self.title, title, |word| word.span, "scenario", found),
            StatementKind::Step(step) => once(&mut self.step, step, |value| value.span, "step", found),
            StatementKind::Stop(stop) => once(&mut self.stop, stop, |value| value.span, "stop", found),
            StatementKind::Param(binding) => {
                self.parameters.push(binding);
                self.declare(&binding.name, Declaration::Parameter(binding), &RESERVED[..2], found);
            }
            StatementKind::Let(binding) => {
                self.lets.push(binding);
                self.declare(&binding.name, Declaration::Let(binding), &RESERVED, found);
            }
            StatementKind::Fmu(instance) => self.instance(request, instance, found),
            StatementKind::At(window) => self.windows.push(window),
            StatementKind::Assert { name, claim } => self.claim(name, claim, found),
            StatementKind::Record { signals, every } => {
                self.has_record = true;
                self.records.extend(signals);
                if let Some(every) = every {
                    found.push(not_yet(every.span, "`record` with `every`"));
                }
            }
            StatementKind::Wire { source, arrow, arrow_span, targets } => {
                self.wires.push(Wire { source, arrow: *arrow, arrow_span: *arrow_span, targets });
            }
            StatementKind::StopWhen { .. } => {
                self.stop_refused = true;
                found.push(not_yet(span, "`stop when`"));
            }
            StatementKind::Use(part) => {
                self.names.entry(&part.name.word.text).or_insert(Declaration::Refused(&part.name.word));
                found.push(not_yet(span, "`use`"));
            }
            StatementKind::For { .. } => found.push(not_yet(span, "`for`")),
            StatementKind::When(_) => found.push(not_yet(span, "`when`")),
            StatementKind::While(_) => found.push(not_yet(span, "`while`")),
            StatementKind::Sweep(_) => found.push(not_yet(span, "`sweep`")),
        }
    }

    fn claim(&mut self, name: &'a Name, claim: &'a Expression, found: &mut Vec<Diagnostic>) {
        if !name.index.is_empty() {
            found.push(not_yet(name.span, "an index in a claim's name"));
        } else if let Some(&first) = self.claim_names.get(name.word.text.as_str()) {
            let message = format!("two claims are called `{}`", name.word.text);
            found.push(
                Diagnostic::error("E24", name.span, message).label(first, "the first").help("rename one of them"),
            );
        } else {
            self.claim_names.insert(&name.word.text, name.span);
        }
        self.claims.push((name, claim));
    }

    fn instance(&mut self, request: &Request<'a>, instance: &'a syntax::Instance, found: &mut Vec<Diagnostic>) {
        let name = &instance.name.word;
        if !instance.name.index.is_empty() {
            found.push(not_yet(instance.name.span, "an index in an `fmu` name"));
            self.names.entry(&name.text).or_insert(Declaration::Refused(name));
            return;
        }
        if let Some(host) = instance.on.first() {
            found.push(not_yet(host.span, "`on`"));
        }
        if let [first, second, ..] = instance.every.as_slice() {
            let message = format!("`{}` has two periods", name.text);
            let twice = Diagnostic::error("E25", second.span, message).label(first.span, "the first");
            found.push(twice.help("write one `every`"));
        }
        let unit = request.units.get(&instance.unit.text);
        if let Some(Err(problem)) = unit {
            let error = Diagnostic::error("E26", instance.unit.span, problem.message.clone());
            found.push(Diagnostic { help: problem.help.clone(), ..error });
        }
        assert!(unit.is_some(), "an entry was handed in for every unit that `units` names");
        let declared = Declared {
            name,
            unit: &instance.unit,
            every: instance.every.first(),
            values: &instance.values,
            description: unit.and_then(|unit| unit.as_ref().ok()),
        };
        self.declare(name, Declaration::Instance(self.instances.len(), name), &RESERVED, found);
        self.instances.push(declared);
    }

    fn declare(
        &mut self,
        name: &'a Word,
        declaration: Declaration<'a>,
        reserved: &[&str],
        found: &mut Vec<Diagnostic>,
    ) {
        if reserved.contains(&name.text.as_str()) {
            let meaning = match name.text.as_str() {
                "time" => "the seconds since the start",
                "pi" => "3.14159…",
                _ => "the parameter of all random numbers",
            };
            let error = Diagnostic::error("E24", name.span, format!("`{}` has a meaning already", name.text));
            let help = if name.text == "seed" { "write `param seed = …`" } else { "choose another name" };
            found.push(error.saying(meaning).help(help));
            return;
        }
        if let Some(first) = self.names.get(name.text.as_str()) {
            let message = format!("`{}` is declared twice", name.text);
            let error = Diagnostic::error("E24", name.span, message).label(first.span(), "declared here first");
            found.push(error.help("rename one of them"));
            return;
        }
        self.names.insert(&name.text, declaration);
    }

    fn require(&self, request: &Request<'a>, found: &mut Vec<Diagnostic>) {
        let top = request.file.statements.first().map_or(Span::default(), |statement| statement.span);
        let mut missing = |is_there: bool, message: &str, help: &str| {
            if !is_there {
                found.push(Diagnostic::error("E25", top, message).help(help));
            }
        };
        missing(
            self.title.is_some(),
            "this file has no `scenario` line",
            "a script begins like `scenario \"Quadcopter in wind\"`; a file without that line is a part of others",
        );
        missing(self.step.is_some(), "this script does not say its `step`", "write for example `step 10 ms`");
        missing(
            self.stop.is_some() || self.stop_refused,
            "this script does not say when to stop",
            "write for example `stop 60 s`",
        );
    }
}

/// Takes a statement that may stand once.
fn once<'a, T: ?Sized>(
    place: &mut Option<&'a T>,
    value: &'a T,
    span: fn(&T) -> Span,
    word: &str,
    found: &mut Vec<Diagnostic>,
) {
    match place {
        Some(first) => found.push(
            Diagnostic::error("E25", span(value), format!("`{word}` stands twice"))
                .label(span(first), "the first")
                .help("a script has one of it"),
        ),
        None => *place = Some(value),
    }
}
