//! What was found wrong with a script: each finding once for each code and place, costly help for the first ones only.

use std::collections::BTreeSet;

use super::frame::FrameId;
use super::scope::Scope;
use crate::diagnostic::{Diagnostic, Edit, Fix, SHOWN};
use crate::source::Span;

/// Help that is searched among all names, which for each of very many findings would take too long.
pub(super) type Search = Box<dyn FnOnce(Scope<'_, '_>) -> Option<Remedy>>;

/// Help that was found, and the fix that it describes if there is one.
pub(super) struct Remedy {
    pub help: String,
    pub fix: Option<Fix>,
}

impl From<String> for Remedy {
    fn from(help: String) -> Self {
        Self { help, fix: None }
    }
}

impl Remedy {
    /// That a name was probably meant, which is spelt `near`, in the place of a span.
    pub fn meant(near: &str, span: Span) -> Self {
        let fix = Fix { text: format!("write `{near}`"), edits: vec![Edit::new(span, near)] };
        Self { help: format!("did you mean `{near}`?"), fix: Some(fix) }
    }

    /// A finding with this remedy.
    pub fn of(self, diagnostic: Diagnostic) -> Diagnostic {
        let mut diagnostic = diagnostic.help(self.help);
        diagnostic.fixes.extend(self.fix);
        diagnostic
    }

    /// The same with more to say.
    pub fn saying(self, more: &str) -> Self {
        Self { help: format!("{} {more}", self.help), ..self }
    }
}

/// A finding, and where its help is searched.
struct Finding {
    diagnostic: Diagnostic,
    search: Option<(FrameId, Search)>,
}

/// Everything that was found so far.
#[derive(Default)]
pub(super) struct Findings {
    found: Vec<Finding>,
    /// The codes and places of what was found, and the messages of warnings, of which one place may have several.
    seen: BTreeSet<(&'static str, Vec<Span>, Option<String>)>,
    has_error: bool,
}

impl Findings {
    /// Adds a finding, unless one of this code and these places is there: a statement that is read several times, as a round
    /// of a loop is, has each of its mistakes once.
    pub fn add(&mut self, diagnostic: Diagnostic, search: Option<(FrameId, Search)>) {
        let places = diagnostic.labels.iter().map(|label| label.span).collect();
        let message = (!diagnostic.is_error()).then(|| diagnostic.message.clone());
        if self.seen.insert((diagnostic.code, places, message)) {
            self.add_always(diagnostic, search);
        }
    }

    fn add_always(&mut self, diagnostic: Diagnostic, search: Option<(FrameId, Search)>) {
        self.has_error |= diagnostic.is_error();
        self.found.push(Finding { diagnostic, search });
    }

    /// Adds a finding about the file as a whole, which several may have as their place.
    pub fn add_of_file(&mut self, diagnostic: Diagnostic) {
        self.add_always(diagnostic, None);
    }

    /// Whether an error was found.
    pub fn has_error(&self) -> bool {
        self.has_error
    }

    /// The diagnostics in the order of their places. Help is searched for as many errors as are shown.
    pub fn finish(mut self, scope: Scope<'_, '_>) -> Vec<Diagnostic> {
        self.found.sort_by_key(|finding| finding.diagnostic.labels.first().map(|label| label.span));
        let mut errors = 0;
        let finish = |Finding { diagnostic, search }: Finding| {
            errors += usize::from(diagnostic.is_error());
            match search.filter(|_| errors <= SHOWN).and_then(|(frame, search)| search(scope.at(frame))) {
                Some(remedy) => remedy.of(diagnostic),
                None => diagnostic,
            }
        };
        self.found.into_iter().map(finish).collect()
    }
}
