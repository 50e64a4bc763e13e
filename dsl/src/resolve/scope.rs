//! What the names of a script mean, each worked out once, and what was found wrong so far.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use fmi2::description::{ModelDescription, Variable};

use super::Request;
use super::grid::Known;
use super::meaning::Meaning;
use super::script::{Declaration, Script};
use crate::diagnostic::{Diagnostic, Severity};
use crate::nearest::nearest;
use crate::scenario::{BooleanExpression, Port};
use crate::source::Span;
use crate::syntax::{Binding, Word};

/// A script with what is known about it.
pub(super) struct Scope<'a> {
    /// What was handed in.
    pub request: Request<'a>,
    /// The sorted statements.
    pub script: Script<'a>,
    pub(super) grid: Cell<Known>,
    findings: RefCell<Vec<Diagnostic>>,
    bindings: RefCell<BTreeMap<&'a str, Option<Meaning>>>,
    open: RefCell<Vec<&'a Word>>,
    pub(super) rises: RefCell<Vec<BooleanExpression>>,
}

impl<'a> Scope<'a> {
    /// Sorts the statements.
    pub fn new(request: Request<'a>) -> Self {
        let findings = RefCell::default();
        let script = Script::new(&request, &findings);
        Self {
            request,
            script,
            grid: Cell::new(Known::NotYet),
            findings,
            bindings: RefCell::default(),
            open: RefCell::default(),
            rises: RefCell::default(),
        }
    }

    /// Everything that was found, and the conditions of `rises`.
    pub fn finish(self) -> (Vec<Diagnostic>, Vec<BooleanExpression>) {
        (self.findings.into_inner(), self.rises.into_inner())
    }

    /// Notes a finding; that a place meets variables without unit is told once.
    pub fn report(&self, finding: Diagnostic) {
        let mut findings = self.findings.borrow_mut();
        let place = |finding: &Diagnostic| finding.labels.first().map(|label| label.span);
        let is_told = |known: &Diagnostic| known.code == "W01" && place(known) == place(&finding);
        if finding.code != "W01" || !findings.iter().any(is_told) {
            findings.push(finding);
        }
    }

    /// Notes an error; the part it is about has no meaning.
    pub fn refuse<T>(&self, finding: Diagnostic) -> Option<T> {
        self.report(finding);
        None
    }

    /// Whether an error was found so far.
    pub fn failed(&self) -> bool {
        self.findings.borrow().iter().any(|finding| finding.severity == Severity::Error)
    }

    /// Asks something without noting what is found wrong on the way.
    pub fn quietly<T>(&self, ask: impl FnOnce(&Self) -> T) -> T {
        let (known, bindings, grid) = (self.findings.borrow().len(), self.bindings.borrow().clone(), self.grid.get());
        let answer = ask(self);
        self.findings.borrow_mut().truncate(known);
        *self.bindings.borrow_mut() = bindings;
        self.grid.set(grid);
        answer
    }

    /// Keeps a condition of `rises` and returns its slot.
    pub fn rises_slot(&self, condition: BooleanExpression) -> usize {
        let mut rises = self.rises.borrow_mut();
        rises.iter().position(|known| *known == condition).unwrap_or_else(|| {
            rises.push(condition);
            rises.len() - 1
        })
    }

    /// Works out every `let`, so that errors in unused ones are told too.
    pub fn evaluate_lets(&self) {
        for binding in &self.script.lets {
            self.binding(binding, &binding.value);
        }
    }

    /// The meaning of a `let` or `param` whose value is written at `value`, worked out at its first use.
    pub fn binding(&self, binding: &'a Binding, value: &'a crate::syntax::Expression) -> Option<Meaning> {
        let name = binding.name.text.as_str();
        if let Some(known) = self.bindings.borrow().get(name) {
            return known.clone();
        }
        let circle = self.open.borrow().iter().position(|word| word.text == name);
        if let Some(start) = circle {
            return self.refuse(self.circle(&self.open.borrow()[start..]));
        }
        self.open.borrow_mut().push(&binding.name);
        let meaning = if self.open.borrow().len() > NAMES_DEEP {
            self.refuse(too_large(binding, "it depends on names that depend on names, and so on"))
        } else {
            self.evaluate(value)
        };
        let meaning = match meaning {
            Some(meaning) if meaning.size() > PARTS => self.refuse(too_large(binding, "it has too many parts")),
            meaning => meaning,
        };
        self.open.borrow_mut().pop();
        self.bindings.borrow_mut().insert(name, meaning.clone());
        meaning
    }

    fn circle(&self, words: &[&Word]) -> Diagnostic {
        let names = words.iter().chain(words.first()).map(|word| word.text.as_str());
        let message = format!("these names define each other: {}", names.collect::<Vec<_>>().join(" from "));
        let span = words.first().map_or(Span::default(), |word| word.span);
        let error = Diagnostic::error("E28", span, message).help("give one of them a value of its own");
        words.iter().skip(1).fold(error, |error, word| error.label(word.span, ""))
    }

    /// What a unit says about itself; `None` if it was not found.
    pub fn description(&self, instance: usize) -> Option<&'a ModelDescription> {
        self.script.instances[instance].description.map(AsRef::as_ref)
    }

    /// The variable of a port.
    pub fn variable(&self, port: Port) -> &'a Variable {
        &self.known(port.instance).variables[port.variable]
    }

    /// The description of an instance that a port was found in.
    pub fn known(&self, instance: usize) -> &'a ModelDescription {
        let Some(description) = self.description(instance) else {
            unreachable!("a port was found, so its unit is known");
        };
        description
    }

    /// `quad.position.x`
    pub fn port_name(&self, port: Port) -> String {
        format!("{}.{}", self.script.instances[port.instance].name.text, self.variable(port).name)
    }

    /// The words of the script at a place, on one line.
    pub fn text(&self, span: Span) -> String {
        one_line(self.request.sources.slice(span))
    }

    /// The line of a place, from 1.
    pub fn line(&self, span: Span) -> usize {
        self.request.sources.line_and_column(span).0
    }

    /// That a name of the script is unknown, with the nearest that is meant.
    pub fn unknown_name(&self, word: &Word, is_meant: impl Fn(&Declaration<'_>) -> bool, also: &[&str]) -> Diagnostic {
        let names = self.script.names.iter().filter(|(_, declaration)| is_meant(declaration));
        let near = nearest(&word.text, names.map(|(name, _)| *name).chain(also.iter().copied()));
        let error = Diagnostic::error("E01", word.span, format!("`{}` is not declared in this script", word.text));
        match near {
            Some(near) => error.help(format!("did you mean `{near}`?")),
            None => error.help("a name comes from a `fmu`, `param` or `let` line"),
        }
    }
}

/// How many names may stand behind each other; far more than anyone writes, far less than the stack carries.
const NAMES_DEEP: usize = 64;

/// How many parts the value of a name may have; a few names that double each other would fill the memory otherwise.
const PARTS: usize = 4096;

fn too_large(binding: &Binding, why: &str) -> Diagnostic {
    let message = format!("the value of `{}` is too large", binding.name.text);
    Diagnostic::error("E39", binding.name.span, message).saying(why).help("compute it in fewer steps, or inside a unit")
}

/// Line breaks and comments become single blanks.
fn one_line(text: &str) -> String {
    let bare = text.lines().map(|line| {
        let mut quote = None;
        let end = line.char_indices().find(|&(_, letter)| {
            match quote {
                None if letter == '#' => return true,
                None if letter == '"' || letter == '\'' => quote = Some(letter),
                Some(open) if open == letter => quote = None,
                _ => {}
            }
            false
        });
        line[..end.map_or(line.len(), |(at, _)| at)].trim()
    });
    bare.filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

#[test]
fn a_claim_over_several_lines_is_told_on_one() {
    assert_eq!(one_line("always min(\n  a,   # the first\n  b['#'],\n) > 3 m"), "always min( a, b['#'], ) > 3 m");
}
