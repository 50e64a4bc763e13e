//! Goes through the statements of a script in the order in which they act: loops yield their statements once for each
//! round, in a frame of that round, and parts yield their own. Next: the passes of `resolve/mod.rs`.

mod cases;
mod part;
mod round;

use std::borrow::Cow;
use std::collections::BTreeSet;

use super::Request;
use super::findings::Findings;
use super::frame::{FrameId, Placed};
use super::scope::{Scope, Shared};
use super::script::{ClaimLine, Declaration, Declared, Opens, RESERVED, Script, Wire};
use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::syntax::{self, Expression, Name, Statement, StatementKind, Word};

pub(super) use cases::CaseValues;

/// A script of which some statements have been taken.
pub(super) struct Elaboration<'a> {
    request: Request<'a>,
    script: Script<'a>,
    found: Vec<Diagnostic>,
    /// The texts of the parts that the present statement is in.
    open_parts: Vec<u32>,
    /// How many rounds of loops and parts there have been.
    blocks: usize,
    /// The places of the declared names that indices and ranges of loops refer to.
    used: BTreeSet<Span>,
}

/// How many rounds of loops and parts a script may have together: more than anybody means, and little memory.
const MOST_BLOCKS: usize = 100_000;

/// A name that a statement declares.
struct Declares<'a> {
    /// The frame that has it.
    frame: FrameId,
    /// The name in that frame.
    key: Cow<'a, str>,
    /// The name in the whole script.
    full: String,
}

/// The statements of the script, sorted, and the places of the declared names that they have used so far; what is wrong with
/// them goes to `findings`.
pub(super) fn elaborate<'a>(request: &Request<'a>, findings: &mut Findings) -> (Script<'a>, BTreeSet<Span>) {
    let mut elaboration = Elaboration::of(request, CaseValues::new());
    let shape_is_swept = elaboration.shape_is_swept();
    let case = elaboration.sweep();
    match case {
        // Loops have other rounds than with the parameters' own values.
        Some(case) if shape_is_swept => {
            let (cases, used) = (elaboration.script.cases, elaboration.used);
            elaboration = Elaboration::of(request, case);
            elaboration.script.cases = cases;
            elaboration.used.extend(used);
        }
        case => elaboration.script.case = case.unwrap_or_default(),
    }
    elaboration.found.drain(..).for_each(|finding| findings.add(finding, None));
    elaboration.require();
    elaboration.found.into_iter().for_each(|finding| findings.add_of_file(finding));
    (elaboration.script, elaboration.used)
}

impl<'a> Elaboration<'a> {
    /// All statements of the script, with these values of swept parameters.
    fn of(request: &Request<'a>, case: CaseValues<'a>) -> Self {
        let (mut script, found, open_parts, used) = (Script::default(), Vec::new(), Vec::new(), BTreeSet::new());
        script.case = case;
        let mut elaboration = Self { request: *request, script, found, open_parts, blocks: 0, used };
        elaboration.block(FrameId::SCRIPT, &request.file.statements);
        elaboration
    }

    /// Takes the statements of a file or of a round.
    fn block(&mut self, frame: FrameId, statements: &'a [Statement]) {
        // Ranges and indices may use values that are declared after them.
        let is_value = |it: &&Statement| matches!(it.kind, StatementKind::Param(_) | StatementKind::Let(_));
        statements.iter().filter(is_value).for_each(|statement| self.take(frame, statement));
        statements.iter().filter(|statement| !is_value(statement)).for_each(|statement| self.take(frame, statement));
    }

    fn take(&mut self, frame: FrameId, statement: &'a Statement) {
        let file = self.script.frames.file_of(frame);
        if let Some(word) = word_of_script(&statement.kind)
            && (file != FrameId::SCRIPT || frame != file)
        {
            return self.refuse_in_block(word, statement.span, file == FrameId::SCRIPT);
        }
        let Self { script, found, .. } = self;
        match &statement.kind {
            StatementKind::Scenario(title) => once(&mut script.title, title, |word| word.span, "scenario", found),
            StatementKind::Step(step) => once(&mut script.step, step, |value| value.span, "step", found),
            StatementKind::Stop(stop) => once(&mut script.stop, stop, |value| value.span, "stop", found),
            StatementKind::StopWhen { .. } => {
                once(&mut script.stop_when, statement, |statement| statement.span, "stop when", found);
            }
            StatementKind::Param(part) => {
                if frame != file {
                    return self.refuse_in_block("param", statement.span, true);
                }
                script.parameters.push(Placed { frame, part });
                let name = Cow::Borrowed(part.name.text.as_str());
                self.declare(frame, name, &part.name, Declaration::Parameter(part), &RESERVED[..2]);
            }
            StatementKind::Let(part) => {
                script.lets.push(Placed { frame, part });
                let name = Cow::Borrowed(part.name.text.as_str());
                self.declare(frame, name, &part.name, Declaration::Let(part), &RESERVED);
            }
            StatementKind::Fmu(part) => self.instance(frame, part),
            StatementKind::Use(part) => self.part(frame, part),
            StatementKind::For { variable, range, body } => self.rounds(frame, variable, range, body),
            StatementKind::At(window) => script.windows.push(Placed { frame, part: (Opens::At, window) }),
            StatementKind::When(window) => script.windows.push(Placed { frame, part: (Opens::When, window) }),
            StatementKind::While(window) => script.windows.push(Placed { frame, part: (Opens::While, window) }),
            StatementKind::Assert { name, claim } => self.claim(frame, name, claim),
            StatementKind::Record { signals, every } => {
                script.has_record = true;
                let recorded = signals.iter().map(|path| Placed { frame, part: (path, every.as_ref()) });
                script.records.extend(recorded);
            }
            StatementKind::Wire { source, arrow, arrow_span, targets } => {
                let part = Wire { source, arrow: *arrow, arrow_span: *arrow_span, targets };
                script.wires.push(Placed { frame, part });
            }
            StatementKind::Sweep(_) => once(&mut script.sweep, statement, |statement| statement.span, "sweep", found),
        }
    }

    /// Counts rounds or parts; false if there are too many, which is reported.
    fn has_room(&mut self, count: usize, span: Span) -> bool {
        let has_room = self.blocks.saturating_add(count) <= MOST_BLOCKS;
        if has_room {
            self.blocks += count;
        } else {
            let message = format!("this script has more than {MOST_BLOCKS} rounds of loops and parts");
            self.found.push(Diagnostic::error("E39", span, message).help("count to less"));
        }
        has_room
    }

    /// That a statement about the whole run is in a loop or a part.
    fn refuse_in_block(&mut self, word: &str, span: Span, is_loop: bool) {
        let (place, help) = match is_loop {
            true => ("a loop", "write it outside of the loop"),
            false => ("a part", "write it in the script that uses the part"),
        };
        let message = format!("`{word}` cannot be in {place}");
        self.found.push(Diagnostic::error("E25", span, message).help(help));
    }

    /// Evaluates something with the names that have been declared so far; what is wrong with it is kept.
    fn with_scope<T>(&mut self, frame: FrameId, work: impl FnOnce(Scope<'_, 'a>) -> T) -> T {
        let (script, used) = (std::mem::take(&mut self.script), std::mem::take(&mut self.used));
        let shared = Shared::of(self.request, (script, used), Findings::default());
        let value = work(shared.top().at(frame));
        self.found.extend(shared.finish().0);
        self.used = shared.used.take();
        self.script = shared.script;
        value
    }

    /// What a statement declares under this name; `None` if its index is wrong.
    fn name(&mut self, frame: FrameId, name: &'a Name) -> Option<Declares<'a>> {
        if name.index.is_empty() {
            let full = self.script.frames.full_name(frame, &name.word.text);
            return Some(Declares { frame, key: Cow::Borrowed(&name.word.text), full });
        }
        let index = self.with_scope(frame, |scope| scope.index_text(&name.index));
        let Some(index) = index else {
            self.refuse_name(frame, &name.word);
            return None;
        };
        let (frame, key) = (self.script.frames.file_of(frame), format!("{}{index}", name.word.text));
        let full = self.script.frames.full_name(frame, &key);
        Some(Declares { frame, key: Cow::Owned(key), full })
    }

    /// A name whose statement was refused: its uses report nothing. A declared name keeps its declaration.
    fn refuse_name(&mut self, frame: FrameId, name: &'a Word) {
        let _ = self.script.frames.declare(frame, name.text.as_str(), Declaration::Refused(name));
    }

    fn claim(&mut self, frame: FrameId, name: &'a Name, claim: &'a Expression) {
        let Some(Declares { full, .. }) = self.name(frame, name) else { return };
        if let Some(&first) = self.script.claim_names.get(&full) {
            self.found.push(called_twice("claims", &full, name.span, first));
        }
        self.script.claim_names.entry(full.clone()).or_insert(name.span);
        self.script.claims.push(Placed { frame, part: ClaimLine { name: full, span: name.span, claim } });
    }

    fn instance(&mut self, frame: FrameId, instance: &'a syntax::Instance) {
        let Some(Declares { frame: home, key, full }) = self.name(frame, &instance.name) else { return };
        let word = &instance.name.word;
        if let [first, second, ..] = instance.every.as_slice() {
            let error = Diagnostic::error("E25", second.span, format!("`{full}` has two periods"));
            self.found.push(error.label(first.span, "the first").help("write one `every`"));
        }
        self.check_hosts(instance);
        let (unit_index, unit) = self.script.unit(&self.request, &instance.unit);
        if let Err(problem) = &unit {
            let error = Diagnostic::error("E26", instance.unit.span, problem.message.clone());
            self.found.push(Diagnostic { help: problem.help.clone(), ..error });
        }
        let declared = Declared {
            frame,
            name: full.clone(),
            word,
            unit: &instance.unit,
            unit_index,
            every: instance.every.first(),
            values: &instance.values,
            description: unit.ok(),
        };
        self.declare(home, key, word, Declaration::Instance(self.script.instances.len(), word), &RESERVED);
        // Names without rounds and parts were compared when they were declared.
        if let Some(first) = self.script.instance_names.insert(full.clone(), instance.name.span)
            && word.text != full
            && instance.name.index.is_empty()
        {
            self.found.push(called_twice("units", &full, instance.name.span, first));
        }
        self.script.instances.push(declared);
    }

    /// The host that `on` names is any name; which machine it is belongs to the command line.
    fn check_hosts(&mut self, instance: &'a syntax::Instance) {
        if let [first, second, ..] = instance.on.as_slice() {
            let error = Diagnostic::error("E25", second.span, format!("`{}` is on two hosts", instance.name.word.text));
            self.found.push(error.label(first.span, "the first").help("write one `on`"));
        }
    }

    fn declare(
        &mut self,
        frame: FrameId,
        key: Cow<'a, str>,
        name: &'a Word,
        declaration: Declaration<'a>,
        reserved: &[&str],
    ) {
        if reserved.contains(&name.text.as_str()) {
            let meaning = match name.text.as_str() {
                "time" => "the seconds since the start",
                "pi" => "3.14159…",
                _ => "the parameter of all random numbers",
            };
            let error = Diagnostic::error("E24", name.span, format!("`{}` has a meaning already", name.text));
            let help = if name.text == "seed" { "write `param seed = …`" } else { "choose another name" };
            self.found.push(error.saying(meaning).help(help));
            self.refuse_name(frame, name);
            return;
        }
        if let Err(first) = self.script.frames.declare(frame, key.clone(), declaration) {
            // Values are taken first, wherever they are written.
            let (first, second) = (first.min(name.span), first.max(name.span));
            let again = |how| Diagnostic::error("E24", second, format!("`{key}` is declared {how}"));
            self.found.push(if first == second {
                again("in several rounds").help("give it the counters of all loops around it as its index")
            } else {
                again("twice").label(first, "declared here first").help("rename one of them")
            });
            self.script.frames.refuse_if_unlike(frame, &key, declaration);
        }
    }

    fn require(&mut self) {
        let top = self.request.file.statements.first().map_or(Span::default(), |statement| statement.span);
        let Self { script, found, .. } = self;
        let mut missing = |is_there: bool, message: &str, help: &str| {
            if !is_there {
                found.push(Diagnostic::error("E25", top, message).help(help));
            }
        };
        missing(
            script.title.is_some(),
            "this file has no `scenario` line",
            "a script begins like `scenario \"Quadcopter in wind\"`; a file without that line is a part of others",
        );
        let is_part = script.title.is_none() && script.step.is_none() && script.stop.is_none();
        if is_part && !self.request.file.statements.is_empty() {
            return;
        }
        missing(script.step.is_some(), "this script does not say its `step`", "write for example `step 10 ms`");
        missing(
            script.stop.is_some(),
            "this script does not say when to stop",
            match script.stop_when {
                None => "write for example `stop 60 s`",
                Some(_) => {
                    "`stop when` alone may never end the run: write the latest time too, for example `stop 60 s`"
                }
            },
        );
    }
}

/// That two claims or units have one name, which one statement may give them in several rounds.
fn called_twice(what: &str, name: &str, span: Span, first: Span) -> Diagnostic {
    let error = Diagnostic::error("E24", span, format!("two {what} are called `{name}`"));
    if first == span {
        return error.help("give the name the counters of all loops around it as its index");
    }
    error.label(first, "the first").help("rename one of them")
}

/// The first word of a statement that is about the whole run.
fn word_of_script(kind: &StatementKind) -> Option<&'static str> {
    Some(match kind {
        StatementKind::Scenario(_) => "scenario",
        StatementKind::Step(_) => "step",
        StatementKind::Stop(_) | StatementKind::StopWhen { .. } => "stop",
        StatementKind::Sweep(_) => "sweep",
        _ => return None,
    })
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
