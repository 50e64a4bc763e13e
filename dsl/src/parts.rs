//! Parts: files that `use x = "part.scn"` names, loaded and parsed before names have a meaning.

use std::collections::BTreeMap;

use crate::diagnostic::Diagnostic;
use crate::loader::{Loader, Problem};
use crate::parse::parse;
use crate::source::{Sources, Span};
use crate::syntax::{File, Statement, StatementKind, Word};

/// A file without a `scenario` line.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Index of its text in [`Sources`].
    pub text: u32,
    /// Its statements.
    pub file: File,
}

/// All parts of a script, each file once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    parts: Vec<Part>,
    /// Which part each place of a path means, or why there is none.
    by_place: BTreeMap<Span, Result<usize, Problem>>,
    /// The syntax errors of all parts.
    pub diagnostics: Vec<Diagnostic>,
}

impl Parts {
    /// Loads the parts that a file uses, those that they use, and so on; each text is added to `sources`.
    pub fn load(sources: &mut Sources, file: &File, loader: &dyn Loader) -> Self {
        let mut parts = Self::default();
        let mut by_name: BTreeMap<String, usize> = BTreeMap::new();
        parts.load_used(used_in(&file.statements), sources, loader, &mut by_name);
        let mut next = 0;
        while next < parts.parts.len() {
            let used = used_in(&parts.parts[next].file.statements);
            parts.load_used(used, sources, loader, &mut by_name);
            next += 1;
        }
        parts
    }

    fn load_used(
        &mut self,
        used: Vec<Word>,
        sources: &mut Sources,
        loader: &dyn Loader,
        by_name: &mut BTreeMap<String, usize>,
    ) {
        for path in used {
            let source = match loader.text(sources.of(path.span), &path.text) {
                Ok(source) => source,
                Err(problem) => {
                    self.by_place.insert(path.span, Err(problem));
                    continue;
                }
            };
            let index = *by_name.entry(source.name.clone()).or_insert_with(|| {
                let text = sources.add(source.name, source.text);
                let parsed = parse(sources, text);
                self.diagnostics.extend(parsed.diagnostics);
                self.parts.push(Part { text, file: parsed.file });
                self.parts.len() - 1
            });
            self.by_place.insert(path.span, Ok(index));
        }
    }

    /// The parts in the order in which they were loaded.
    pub fn iter(&self) -> impl Iterator<Item = &Part> {
        self.parts.iter()
    }

    /// The part that a `use` line names at a place, or why there is none; `None` if it was not loaded.
    #[must_use]
    pub fn get(&self, place: Span) -> Option<Result<&Part, &Problem>> {
        self.by_place.get(&place).map(|found| found.as_ref().map(|&index| &self.parts[index]))
    }
}

/// The paths of the `use` lines among statements and in their loops.
fn used_in(statements: &[Statement]) -> Vec<Word> {
    let mut used = Vec::new();
    for statement in statements {
        match &statement.kind {
            StatementKind::Use(part) => used.push(part.unit.clone()),
            StatementKind::For { body, .. } => used.extend(used_in(body)),
            _ => {}
        }
    }
    used
}
