//! The statements of a script by kind, and what its names refer to. `elaborate` fills it.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::Request;
use super::elaborate::CaseValues;
use super::frame::{FrameId, Frames, Placed};
use super::meaning::Meaning;
use super::unit::Unit;
use crate::loader::Problem;
use crate::scenario::{self, Sweep};
use crate::source::Span;
use crate::syntax::{self, Arrow, Axis, Binding, Expression, Path, Statement, StatementKind, Window, Word};

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
    pub claims: Vec<Placed<ClaimLine<'a>>>,
    /// The paths of `record`, each with the `every` of its line.
    pub records: Vec<Placed<(&'a Path, Option<&'a Expression>)>>,
    /// Whether there is a `record` line.
    pub has_record: bool,
    /// `sweep`
    pub sweep: Option<&'a Statement>,
    /// How many cases the sweep has, and which of them this is.
    pub cases: Option<Sweep>,
    /// The values of the swept parameters in that case.
    pub case: CaseValues<'a>,
    /// The declarations of names.
    pub frames: Frames<'a>,
    /// The values of the counters of loops, one for each round.
    pub counters: Vec<Rc<Meaning>>,
    /// The names of the claims with their places.
    pub claim_names: BTreeMap<String, Span>,
    /// The names of the instances with their places.
    pub instance_names: BTreeMap<String, Span>,
    /// What was found for each unit, by the folder that its path is relative to.
    units: BTreeMap<(String, &'a str), Found>,
}

/// The place of a unit in the order of first use, and what it says about itself.
pub(super) type Found = (usize, Result<Rc<Unit>, Problem>);

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
    /// The name in the whole script, as `wing[1].body`.
    pub name: String,
    /// The name where it is declared.
    pub word: &'a Word,
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

/// An `assert`.
#[derive(Clone, Debug)]
pub(super) struct ClaimLine<'a> {
    /// The name in the whole script.
    pub name: String,
    /// The place of the name.
    pub span: Span,
    /// The claim.
    pub claim: &'a Expression,
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
    /// `use`: the frame of the part.
    Part(FrameId, &'a Word),
    /// The counter of a loop in one round: index into [`Script::counters`].
    Counter(usize, &'a Word),
    /// A statement that was refused; uses of its name report nothing.
    Refused(&'a Word),
}

impl<'a> Declaration<'a> {
    /// The name.
    pub fn word(&self) -> &'a Word {
        match self {
            Self::Parameter(binding) | Self::Let(binding) => &binding.name,
            Self::Instance(_, word) | Self::Part(_, word) | Self::Counter(_, word) | Self::Refused(word) => word,
        }
    }

    /// The place of the name.
    pub fn span(&self) -> Span {
        self.word().span
    }
}

/// Names that mean something already.
pub(super) const RESERVED: [&str; 3] = ["time", "pi", "seed"];

impl<'a> Script<'a> {
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

    /// The axes of the sweep.
    pub fn axes(&self) -> &'a [Axis] {
        match self.sweep.map(|statement| &statement.kind) {
            Some(StatementKind::Sweep(axes)) => axes,
            _ => &[],
        }
    }

    /// The units that were found, each once.
    pub fn units(&self) -> impl Iterator<Item = &Unit> {
        self.units.values().filter_map(|(_, unit)| unit.as_deref().ok())
    }

    /// Which unit it is, and what it says about itself; the loader is called once for each name of a text.
    pub fn unit(&mut self, request: &Request<'a>, name: &'a Word) -> Found {
        let load = || {
            let description = request.loader.unit(request.sources.of(name.span), &name.text)?;
            Ok(Rc::new(Unit::new(description)))
        };
        let index = self.units.len();
        // A bare name means the same in all texts, a path is relative to the folder of its text.
        let folder = std::path::Path::new(&request.sources.of(name.span).name).parent().filter(|_| is_path(&name.text));
        let folder = folder.map(|folder| folder.to_string_lossy().into_owned()).unwrap_or_default();
        self.units.entry((folder, &name.text)).or_insert_with(|| (index, load())).clone()
    }
}

/// Whether an `fmu` line names a file.
fn is_path(unit: &str) -> bool {
    unit.to_ascii_lowercase().ends_with(".fmu")
}
