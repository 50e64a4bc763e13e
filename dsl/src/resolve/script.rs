//! Sorts the statements of a script, refuses those that this version does not know, and finds the declaration of a name.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::Request;
use super::findings::Findings;
use super::frame::{FrameId, Frames, Placed};
use super::unit::Unit;
use crate::diagnostic::Diagnostic;
use crate::loader::Problem;
use crate::scenario;
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
    /// `stop when`
    pub stop_when: Option<&'a Statement>,
    /// `param`
    pub parameters: Vec<Placed<&'a Binding>>,
    /// `let`
    pub lets: Vec<Placed<&'a Binding>>,
    /// `fmu`
    pub instances: Vec<Declared<'a>>,
    /// `->` and `=>`
    pub wires: Vec<Placed<Wire<'a>>>,
    /// `at`, `when` and `while`
    pub windows: Vec<Placed<(Opens, &'a Window)>>,
    /// `assert`
    pub claims: Vec<Placed<(&'a Name, &'a Expression)>>,
    /// The paths of `record`.
    pub records: Vec<Placed<&'a Path>>,
    /// Whether there is a `record` line.
    pub has_record: bool,
    /// The declarations of names.
    pub frames: Frames<'a>,
    /// The names of the claims with their places.
    claim_names: BTreeMap<&'a str, Span>,
    /// What was found for each unit, by the text that names it.
    units: BTreeMap<(u32, &'a str), Found>,
}

/// The place of a unit in the order of first use, and what it says about itself.
type Found = (usize, Result<Rc<Unit>, Problem>);

/// The statements that open windows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Opens {
    /// `at`
    At,
    /// `when`
    When,
    /// `while`
    While,
}

/// A unit under a name.
#[derive(Debug)]
pub(super) struct Declared<'a> {
    /// Where the names in its clauses are looked up.
    pub frame: FrameId,
    /// The name.
    pub name: &'a Word,
    /// The unit as written.
    pub unit: &'a Word,
    /// Which unit it is, in order of first use.
    pub unit_index: usize,
    /// `every`
    pub every: Option<&'a Expression>,
    /// The braces.
    pub values: &'a [syntax::Value],
    /// What the unit says about itself, unless it was not found.
    pub description: Option<Rc<Unit>>,
}

/// A connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wire<'a> {
    /// The left side.
    pub source: &'a Expression,
    /// Which arrow.
    pub arrow: Arrow,
    /// The place of the arrow.
    pub arrow_span: Span,
    /// The right sides.
    pub targets: &'a [Path],
}

/// What a name refers to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Declaration<'a> {
    /// `param`
    Parameter(&'a Binding),
    /// `let`
    Let(&'a Binding),
    /// `fmu`: index into [`Script::instances`].
    Instance(usize, &'a Word),
    /// A statement that was refused; uses of its name report nothing.
    Refused(&'a Word),
}

impl<'a> Declaration<'a> {
    /// The name.
    pub fn word(&self) -> &'a Word {
        match self {
            Self::Parameter(binding) | Self::Let(binding) => &binding.name,
            Self::Instance(_, word) | Self::Refused(word) => word,
        }
    }

    /// The place of the name.
    pub fn span(&self) -> Span {
        self.word().span
    }
}

/// Names that mean something already.
pub(super) const RESERVED: [&str; 3] = ["time", "pi", "seed"];

/// That this version does not know something; `what` reads as the subject of the sentence.
pub(super) fn not_yet(span: Span, what: &str) -> Diagnostic {
    Diagnostic::error("E20", span, format!("{what} is not known to this version of lockstep yet"))
        .help("leave it out for now")
}

/// The statements of a file in the order in which they act, each with the frame in which its names are looked up. This is
/// where a loop yields its statements once for each round, in a frame of that round, and a part yields its own.
fn elaborated(statements: &[Statement]) -> impl Iterator<Item = Placed<&Statement>> {
    statements.iter().map(|part| Placed { frame: FrameId::SCRIPT, part })
}

impl<'a> Script<'a> {
    /// Sorts the statements; whatever is wrong with them goes to `findings`.
    pub fn new(request: &Request<'a>, findings: &mut Findings) -> Self {
        let mut script = Self::default();
        let mut found = Vec::new();
        for statement in elaborated(&request.file.statements) {
            script.take(request, statement, &mut found);
        }
        found.drain(..).for_each(|finding| findings.add(finding, None));
        script.require(request, &mut found);
        found.into_iter().for_each(|finding| findings.add_of_file(finding));
        script
    }

    fn take(&mut self, request: &Request<'a>, statement: Placed<&'a Statement>, found: &mut Vec<Diagnostic>) {
        let (frame, span) = (statement.frame, statement.part.span);
        match &statement.part.kind {
            StatementKind::Scenario(title) => once(&mut self.title, title, |word| word.span, "scenario", found),
            StatementKind::Step(step) => once(&mut self.step, step, |value| value.span, "step", found),
            StatementKind::Stop(stop) => once(&mut self.stop, stop, |value| value.span, "stop", found),
            StatementKind::Param(part) => {
                self.parameters.push(Placed { frame, part });
                self.declare(frame, &part.name, Declaration::Parameter(part), &RESERVED[..2], found);
            }
            StatementKind::Let(part) => {
                self.lets.push(Placed { frame, part });
                self.declare(frame, &part.name, Declaration::Let(part), &RESERVED, found);
            }
            StatementKind::Fmu(part) => self.instance(request, Placed { frame, part }, found),
            StatementKind::At(window) => self.windows.push(Placed { frame, part: (Opens::At, window) }),
            StatementKind::When(window) => self.windows.push(Placed { frame, part: (Opens::When, window) }),
            StatementKind::While(window) => self.windows.push(Placed { frame, part: (Opens::While, window) }),
            StatementKind::Assert { name, claim } => self.claim(Placed { frame, part: (name, claim) }, found),
            StatementKind::Record { signals, every } => {
                self.has_record = true;
                self.records.extend(signals.iter().map(|part| Placed { frame, part }));
                if let Some(every) = every {
                    found.push(not_yet(every.span, "`record` with `every`"));
                }
            }
            StatementKind::Wire { source, arrow, arrow_span, targets } => {
                let part = Wire { source, arrow: *arrow, arrow_span: *arrow_span, targets };
                self.wires.push(Placed { frame, part });
            }
            StatementKind::StopWhen { .. } => {
                once(&mut self.stop_when, statement.part, |statement| statement.span, "stop when", found);
            }
            StatementKind::Use(part) => {
                self.refuse_name(frame, &part.name.word);
                found.push(not_yet(span, "`use`"));
            }
            StatementKind::For { body, .. } => {
                self.refuse_names(frame, body);
                found.push(not_yet(span, "`for`"));
            }
            StatementKind::Sweep(_) => found.push(not_yet(span, "`sweep`")),
        }
    }

    /// A name whose statement was refused: its uses report nothing. A declared name keeps its declaration.
    fn refuse_name(&mut self, frame: FrameId, name: &'a Word) {
        let _ = self.frames.declare(frame, &name.text, Declaration::Refused(name));
    }

    /// The instances that refused statements declare for the statements around them.
    fn refuse_names(&mut self, frame: FrameId, statements: &'a [Statement]) {
        for statement in statements {
            match &statement.kind {
                StatementKind::Fmu(part) | StatementKind::Use(part) => self.refuse_name(frame, &part.name.word),
                StatementKind::For { body, .. } => self.refuse_names(frame, body),
                _ => {}
            }
        }
    }

    fn claim(&mut self, claim: Placed<(&'a Name, &'a Expression)>, found: &mut Vec<Diagnostic>) {
        let (name, _) = claim.part;
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
        self.claims.push(claim);
    }

    fn instance(
        &mut self,
        request: &Request<'a>,
        Placed { frame, part: instance }: Placed<&'a syntax::Instance>,
        found: &mut Vec<Diagnostic>,
    ) {
        let name = &instance.name.word;
        if !instance.name.index.is_empty() {
            found.push(not_yet(instance.name.span, "an index in an `fmu` name"));
            self.refuse_name(frame, name);
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
        let (unit_index, unit) = self.unit(request, &instance.unit);
        if let Err(problem) = &unit {
            let error = Diagnostic::error("E26", instance.unit.span, problem.message.clone());
            found.push(Diagnostic { help: problem.help.clone(), ..error });
        }
        let declared = Declared {
            frame,
            name,
            unit: &instance.unit,
            unit_index,
            every: instance.every.first(),
            values: &instance.values,
            description: unit.ok(),
        };
        self.declare(frame, name, Declaration::Instance(self.instances.len(), name), &RESERVED, found);
        self.instances.push(declared);
    }

    /// The units of the instances, each once, in order of first use.
    pub fn units_by_index(&self) -> Vec<scenario::Unit> {
        let mut units = Vec::new();
        for instance in &self.instances {
            if instance.unit_index == units.len() {
                units.push(scenario::Unit { name: instance.unit.text.clone() });
            }
        }
        units
    }

    /// The units that were found, each once.
    pub fn units(&self) -> impl Iterator<Item = &Unit> {
        self.units.values().filter_map(|(_, unit)| unit.as_deref().ok())
    }

    /// Which unit it is, and what it says about itself; the loader is called once for each name of a text.
    fn unit(&mut self, request: &Request<'a>, name: &'a Word) -> Found {
        let load = || {
            let description = request.loader.unit(request.sources.of(name.span), &name.text)?;
            Ok(Rc::new(Unit::new(description)))
        };
        let index = self.units.len();
        self.units.entry((name.span.text, &name.text)).or_insert_with(|| (index, load())).clone()
    }

    fn declare(
        &mut self,
        frame: FrameId,
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
            self.refuse_name(frame, name);
            return;
        }
        if let Err(first) = self.frames.declare(frame, &name.text, declaration) {
            let message = format!("`{}` is declared twice", name.text);
            let error = Diagnostic::error("E24", name.span, message).label(first, "declared here first");
            found.push(error.help("rename one of them"));
            self.frames.refuse_if_unlike(frame, name, declaration);
        }
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
            self.stop.is_some(),
            "this script does not say when to stop",
            match self.stop_when {
                None => "write for example `stop 60 s`",
                Some(_) => {
                    "`stop when` alone may never end the run: write the latest time too, for example `stop 60 s`"
                }
            },
        );
    }
}

/// Takes a statement that may occur once.
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
