//! The beginning of a path: which declared name it means, also through parts and with an index, as `wing[1].body`.

use super::frame::{FrameId, Placed};
use super::scope::Scope;
use super::script::Declaration;
use crate::diagnostic::Diagnostic;
use crate::nearest::nearest;
use crate::syntax::{Path, Segment, Word};

/// What the beginning of a path means.
pub(super) enum Root<'p, 'a> {
    /// A declared name, with the frame that declares it and the rest of the path.
    Declared(Placed<Declaration<'a>>, &'p [Segment]),
    /// No declared name.
    Unknown,
    /// What is wrong was reported.
    Reported,
}

/// A declared name, with the rest of the path.
type Onward<'p, 'a> = (Placed<Declaration<'a>>, &'p [Segment]);

impl<'a> Scope<'_, 'a> {
    /// What the beginning of a path that a statement refers to means; the names on the way are used then. A path to a whole
    /// part is refused.
    pub fn root<'p>(self, path: &'p Path) -> Root<'p, 'a> {
        match self.root_or_part(path) {
            Root::Declared(Placed { part: Declaration::Part(part, _), .. }, _) => {
                self.report(self.whole_part(part, path));
                Root::Reported
            }
            root => root,
        }
    }

    /// The same for a path that may name a whole part, which leaves nothing of it.
    pub fn root_or_part<'p>(self, path: &'p Path) -> Root<'p, 'a> {
        let Some((mut found, mut tail)) = (match self.look_up(&path.root.text) {
            Some(found) => Some((found, &path.tail[..])),
            None => match self.indexed(&path.root, &path.tail, |scope, name| scope.look_up(name)) {
                Ok(indexed) => indexed,
                Err(Reported) => return Root::Reported,
            },
        }) else {
            return Root::Unknown;
        };
        self.note_use(&found);
        while let (Declaration::Part(inner, word), false) = (found.part, tail.is_empty()) {
            match self.within(inner, word, tail, path) {
                Some((next, rest)) => (found, tail) = (next, rest),
                None => return Root::Reported,
            }
            self.note_use(&found);
        }
        Root::Declared(found, tail)
    }

    /// That a name has no such index, if it has others.
    pub fn wrong_index(self, path: &Path) -> Option<Diagnostic> {
        let Some((Segment::Index(index, span), _)) = path.tail.split_first() else { return None };
        let begins = format!("{}[", path.root.text);
        let known = self.script.frames.known(self.frame()).map(|(name, _)| name);
        let mut indices: Vec<_> = known.filter(|name| name.starts_with(&begins)).collect();
        indices.sort_by_key(|name| (name.len(), *name));
        let message = format!("there is no `{}{}`", path.root.text, self.index_text(index)?);
        let error = Diagnostic::error("E01", *span, message);
        Some(match indices.as_slice() {
            [] => return None,
            [only] => error.help(format!("there is `{only}`")),
            [first, .., last] => error.help(format!("there are {} of them, from `{first}` to `{last}`", indices.len())),
        })
    }

    /// A name with the index behind it, if there is one.
    fn indexed<'p>(
        self,
        word: &Word,
        tail: &'p [Segment],
        look_up: impl FnOnce(Self, &str) -> Option<Placed<Declaration<'a>>>,
    ) -> Result<Option<Onward<'p, 'a>>, Reported> {
        let Some((Segment::Index(index, _), rest)) = tail.split_first() else { return Ok(None) };
        let index = self.index_text(index).ok_or(Reported)?;
        Ok(look_up(self, &format!("{}{index}", word.text)).map(|found| (found, rest)))
    }

    /// The name in a part that a path goes on with.
    fn within<'p>(self, part: FrameId, name: &Word, tail: &'p [Segment], path: &Path) -> Option<Onward<'p, 'a>> {
        let Some((Segment::Field(word), rest)) = tail.split_first() else {
            return self.refuse(self.whole_part(part, path));
        };
        let own = move |scope: Self, name: &str| scope.script.frames.own(part, name);
        if let Some(found) = own(self, &word.text) {
            return Some((found, rest));
        }
        if let Some(found) = self.indexed(word, rest, own).ok()? {
            return Some(found);
        }
        let message = format!("the part `{}` has no name `{}`", name.text, word.text);
        let names = self.script.frames.names(part).map(|(name, _)| name);
        let help = match nearest(&word.text, names) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "a name of a part comes from a `fmu`, `use`, `param` or `let` line of its file".to_owned(),
        };
        self.refuse(Diagnostic::error("E01", word.span, message).help(help))
    }

    fn whole_part(self, part: FrameId, path: &Path) -> Diagnostic {
        let message = format!("`{}` is a whole part, and one of its units is meant here", self.text(path.span));
        let first = self.script.frames.names(part).find(|(_, it)| matches!(it, Declaration::Instance(..)));
        let help = first.map_or("a part without units has nothing to name".to_owned(), |(first, _)| {
            format!("for example `{}.{first}`", self.text(path.span))
        });
        Diagnostic::error("E01", path.span, message).help(help)
    }

    fn note_use(self, found: &Placed<Declaration<'a>>) {
        self.shared.used.borrow_mut().insert(found.part.span());
    }
}

/// That what is wrong was reported.
struct Reported;
