//! What the names of a script mean, each computed once, and the findings so far.
//!
//! [`Shared`] holds all of that; a [`Scope`] is a small handle that says in which frame names are looked up.

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Deref;
use std::rc::Rc;
use std::sync::Arc;

use fmi2::description::Variable;
use fmi2::units::BaseUnit;

use super::Request;
use super::curve::Loaded;
use super::elaborate::elaborate;
use super::findings::{Findings, Remedy, Search};
use super::frame::{FrameId, Placed};
use super::grid::Known;
use super::meaning::Meaning;
use super::script::{Declaration, Script};
use super::unit::Unit;
use crate::diagnostic::Diagnostic;
use crate::nearest::nearest;
use crate::parse::symbols;
use crate::scenario::{Condition, Curve, Port};
use crate::source::Span;
use crate::spelling;
use crate::syntax::{Binding, Expression, Word};

/// A script with what is known about it.
pub(super) struct Shared<'a> {
    /// What is resolved.
    pub request: Request<'a>,
    /// The sorted statements.
    pub script: Script<'a>,
    /// The assignments of the command line by name; of several the last one counts.
    pub(super) settings: BTreeMap<&'a str, &'a Binding>,
    pub(super) grid: Cell<Known>,
    findings: RefCell<Findings>,
    /// The meanings of `let` and `param`.
    bindings: RefCell<Meanings<'a>>,
    /// The names whose meanings are being computed.
    open: RefCell<Vec<(FrameId, &'a Word)>>,
    pub(super) conditions: RefCell<Conditions>,
    /// What drives each input, as far as connections have been resolved.
    pub(super) driven_by: RefCell<BTreeMap<Port, Span>>,
    /// The tables of `curve`, by the text that names them and the path.
    pub(super) tables: RefCell<BTreeMap<(u32, String), Loaded>>,
    /// Curves in SI.
    pub(super) si_curves: RefCell<BTreeMap<SiCurve, Arc<Curve>>>,
    /// The places of the declared names that something refers to.
    pub(super) used: RefCell<BTreeSet<Span>>,
    /// The units of measure that loaded units define, each meaning with the first instance whose unit does.
    pub(super) loaded: OnceCell<BTreeMap<String, Vec<(BaseUnit, usize)>>>,
}

/// A curve in SI: what it is converted from, and how.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SiCurve {
    /// The address of the curve that is converted.
    pub of: usize,
    pub factor_bits: u64,
    pub offset_bits: u64,
    /// Whether the conversion subtracts the offset and divides by the factor.
    pub divides: bool,
}

/// The meanings of names, by the frame that declares them; `None` if there is none.
type Meanings<'a> = BTreeMap<(FrameId, &'a str), Option<Rc<Meaning>>>;

/// The conditions that a run follows from sample to sample, each once.
#[derive(Default)]
pub(super) struct Conditions {
    /// The conditions by slot.
    pub by_slot: Vec<Condition>,
    /// The slots by the conditions' text, which is equal where they are.
    slots: BTreeMap<String, usize>,
}

/// The names of one frame, and all that is shared between frames.
#[derive(Clone, Copy)]
pub(super) struct Scope<'s, 'a> {
    /// What all frames share.
    pub shared: &'s Shared<'a>,
    /// Where names are looked up.
    frame: FrameId,
}

impl<'a> Deref for Scope<'_, 'a> {
    type Target = Shared<'a>;

    fn deref(&self) -> &Shared<'a> {
        self.shared
    }
}

impl<'a> Shared<'a> {
    /// Sorts the statements of the script.
    pub fn new(request: Request<'a>) -> Self {
        let mut findings = Findings::default();
        let elaborated = elaborate(&request, &mut findings);
        Self::of(request, elaborated, findings)
    }

    /// With these statements, the places of declared names that they use, and findings.
    pub fn of(request: Request<'a>, (script, used): (Script<'a>, BTreeSet<Span>), findings: Findings) -> Self {
        Self {
            request,
            loaded: OnceCell::new(),
            script,
            settings: request.settings.iter().map(|setting| (setting.name.text.as_str(), setting)).collect(),
            grid: Cell::new(Known::NotYet),
            findings: RefCell::new(findings),
            bindings: RefCell::default(),
            open: RefCell::default(),
            conditions: RefCell::default(),
            driven_by: RefCell::default(),
            tables: RefCell::default(),
            si_curves: RefCell::default(),
            used: RefCell::new(used),
        }
    }

    /// The frame of the script.
    pub fn top(&self) -> Scope<'_, 'a> {
        Scope { shared: self, frame: FrameId::SCRIPT }
    }

    /// Everything that was found, and the conditions by slot.
    pub fn finish(&self) -> (Vec<Diagnostic>, Vec<Condition>) {
        let findings = self.findings.take().finish(self.top());
        (findings, self.conditions.take().by_slot)
    }

    /// Passes on the meanings of `let` and `param` that have been computed.
    pub fn of_bindings(&self, visit: impl FnOnce(&mut dyn Iterator<Item = &Meaning>)) {
        visit(&mut self.bindings.borrow().values().filter_map(Option::as_deref));
    }

    /// Notes a finding, once for each code and place.
    pub fn report(&self, finding: Diagnostic) {
        self.findings.borrow_mut().add(finding, None);
    }

    /// Notes an error; the part it is about has no meaning.
    pub fn refuse<T>(&self, finding: Diagnostic) -> Option<T> {
        self.report(finding);
        None
    }

    /// Whether an error was found so far.
    pub fn failed(&self) -> bool {
        self.findings.borrow().has_error()
    }

    /// Keeps a condition that a run follows and returns its slot.
    pub fn condition_slot(&self, condition: Condition) -> usize {
        let Conditions { by_slot, slots } = &mut *self.conditions.borrow_mut();
        *slots.entry(format!("{condition:?}")).or_insert_with(|| {
            by_slot.push(condition);
            by_slot.len() - 1
        })
    }
}

impl<'s, 'a> Scope<'s, 'a> {
    /// The same script, seen from another frame.
    pub fn at(self, frame: FrameId) -> Self {
        Self { frame, ..self }
    }

    /// Notes an error whose help is searched later; what the error says already is the help where nothing is found.
    pub fn refuse_and_search<T, R: Into<Remedy>>(
        self,
        finding: Diagnostic,
        search: impl FnOnce(Scope<'_, '_>) -> Option<R> + 'static,
    ) -> Option<T> {
        let search: Search = Box::new(move |scope| search(scope).map(Into::into));
        self.shared.findings.borrow_mut().add(finding, Some((self.frame, search)));
        None
    }

    /// The frame in which names are looked up.
    pub fn frame(self) -> FrameId {
        self.frame
    }

    /// What a name means here, with the frame that declares it.
    pub fn look_up(self, name: &str) -> Option<Placed<Declaration<'a>>> {
        self.shared.script.frames.look_up(self.frame, name)
    }

    /// Evaluates every `let`, so that errors in unused ones are reported too.
    pub fn evaluate_lets(self) {
        for binding in &self.shared.script.lets {
            let value = Placed { frame: binding.frame, part: &binding.part.value };
            self.at(binding.frame).binding(binding.part, value);
        }
    }

    /// The meaning of a `let` or `param` of this frame whose value is written at `value`, computed at its first use.
    pub fn binding(self, binding: &'a Binding, value: Placed<&'a Expression>) -> Option<Rc<Meaning>> {
        let name = binding.name.text.as_str();
        if let Some(known) = self.bindings.borrow().get(&(self.frame, name)) {
            return known.clone();
        }
        if let (FrameId::SCRIPT, Some(value)) = (self.frame, self.script.case.get(name)) {
            return Some(Rc::clone(value));
        }
        let is_open = |(frame, word): &(FrameId, &Word)| *frame == self.frame && word.text == name;
        let circle = self.open.borrow().iter().position(is_open);
        if let Some(start) = circle {
            return self.refuse(circle_of_names(&self.open.borrow()[start..]));
        }
        self.open.borrow_mut().push((self.frame, &binding.name));
        let meaning = if self.open.borrow().len() > NAMES_DEEP {
            self.refuse(too_large(binding, "it depends on names that depend on names, and so on"))
        } else {
            self.at(value.frame).evaluate(value.part)
        };
        let meaning = match meaning {
            Some(meaning) if meaning.size() > PARTS => self.refuse(too_large(binding, "it has too many parts")),
            meaning => meaning,
        };
        self.open.borrow_mut().pop();
        self.bindings.borrow_mut().insert((self.frame, name), meaning.clone());
        meaning
    }

    /// Takes the meaning of a name of this frame away: what depends on it reports nothing.
    pub fn forget(self, binding: &'a Binding) {
        self.bindings.borrow_mut().insert((self.frame, &binding.name.text), None);
    }

    /// What a unit says about itself; `None` if it was not found.
    pub fn description(self, instance: usize) -> Option<&'s Unit> {
        self.shared.script.instances[instance].description.as_deref()
    }

    /// The variable of a port.
    pub fn variable(self, port: Port) -> &'s Variable {
        &self.known(port.instance).variables[port.variable]
    }

    /// The description of an instance that a port was found in.
    pub fn known(self, instance: usize) -> &'s Unit {
        let Some(description) = self.description(instance) else {
            unreachable!("a port was found, so its unit is known");
        };
        description
    }

    /// `quad.position.x`, `plant.'der(x)'`: as scripts write it.
    pub fn port_name(&self, port: Port) -> String {
        let instance = &self.script.instances[port.instance].name;
        format!("{instance}.{}", spelling::variable(&self.variable(port).name))
    }

    /// The text of the script at a place, on one line.
    pub fn text(&self, span: Span) -> String {
        one_line(self.request.sources.slice(span))
    }

    /// The file of a place without its folders, so that results are the same wherever the script is.
    pub fn file_name(&self, span: Span) -> &str {
        let name = self.shared.request.sources.of(span).name.as_str();
        name.rsplit('/').next().unwrap_or(name)
    }

    /// The line of a place, from 1.
    pub fn line(&self, span: Span) -> usize {
        self.request.sources.line_and_column(span).0
    }

    /// That a name of the script is unknown, with the nearest that `is_meant`.
    pub fn refuse_unknown_name<T>(
        self,
        word: &Word,
        is_meant: fn(&Declaration<'_>) -> bool,
        also: &'static [&'static str],
    ) -> Option<T> {
        let (written, span) = (word.text.clone(), word.span);
        let error = Diagnostic::error("E01", word.span, format!("`{written}` is not declared in this script"));
        self.refuse_and_search(error.help("a name comes from a `fmu`, `param` or `let` line"), move |scope| {
            let names = scope.script.frames.known(scope.frame).filter(|(_, declaration)| is_meant(declaration));
            let near = nearest(&written, names.map(|(name, _)| name).chain(also.iter().copied()))?;
            Some(Remedy::meant(near, span))
        })
    }
}

fn circle_of_names(words: &[(FrameId, &Word)]) -> Diagnostic {
    let names = words.iter().chain(words.first()).map(|(_, word)| word.text.as_str());
    let message = format!("these names define each other: {}", names.collect::<Vec<_>>().join(" from "));
    let span = words.first().map_or(Span::default(), |(_, word)| word.span);
    let error = Diagnostic::error("E28", span, message).help("give one of them a value of its own");
    words.iter().skip(1).fold(error, |error, (_, word)| error.label(word.span, ""))
}

/// How deep names may refer to names; far more than scripts need, far less than the stack allows.
const NAMES_DEEP: usize = 64;

/// How many parts the value of a name may have; otherwise a few names that double each other would fill the memory.
const PARTS: usize = 4096;

fn too_large(binding: &Binding, why: &str) -> Diagnostic {
    let message = format!("the value of `{}` is too large", binding.name.text);
    Diagnostic::error("E39", binding.name.span, message).saying(why).help("compute it in fewer steps, or inside a unit")
}

/// Line breaks and comments become single blanks.
fn one_line(text: &str) -> String {
    let bare = text.lines().map(|line| {
        let comment = symbols(line).find(|&(_, symbol)| symbol == '#');
        line[..comment.map_or(line.len(), |(at, _)| at)].trim()
    });
    bare.filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

#[test]
fn a_claim_over_several_lines_is_shown_on_one() {
    assert_eq!(one_line("always min(\n  a,   # the first\n  b['#'],\n) > 3 m"), "always min( a, b['#'], ) > 3 m");
}
