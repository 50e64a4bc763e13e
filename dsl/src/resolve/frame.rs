//! Frames: which names are known where. A frame is what a file or a round of a loop declares.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::script::Declaration;
use crate::source::Span;
use crate::syntax::Expression;

/// A frame, by its index in [`Frames`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FrameId(usize);

impl FrameId {
    /// The frame of the script.
    pub const SCRIPT: Self = Self(0);
}

/// A statement or a part of one with the frame in which its names are looked up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<T> {
    /// The frame.
    pub frame: FrameId,
    /// The part.
    pub part: T,
}

/// The names of one frame.
#[derive(Debug, Default)]
struct Frame<'a> {
    /// Where a name is looked up that is not declared here; `None` for a file.
    outer: Option<FrameId>,
    /// What instances of the file are called besides their names: of a part `wing[1].`
    prefix: String,
    /// What follows the names that a round of a loop declares: `[2]`.
    suffix: String,
    /// The values that `use` gives to parameters of a part, in the braces.
    values: BTreeMap<&'a str, Placed<&'a Expression>>,
    /// The names; those with an index, as `wing[1]`, are declared in the frame of their file.
    names: BTreeMap<Cow<'a, str>, Declaration<'a>>,
}

/// All frames of a script.
#[derive(Debug)]
pub(super) struct Frames<'a>(Vec<Frame<'a>>);

impl Default for Frames<'_> {
    fn default() -> Self {
        Self(vec![Frame::default()])
    }
}

impl<'a> Frames<'a> {
    /// Declares a name in a frame; a name that the frame has already keeps its first declaration.
    ///
    /// # Errors
    /// The place of the first declaration.
    pub fn declare(
        &mut self,
        frame: FrameId,
        name: impl Into<Cow<'a, str>>,
        declaration: Declaration<'a>,
    ) -> Result<(), Span> {
        let (names, name) = (&mut self.0[frame.0].names, name.into());
        if let Some(first) = names.get(&name) {
            return Err(first.span());
        }
        names.insert(name, declaration);
        Ok(())
    }

    /// A frame for a round of a loop in a frame.
    pub fn add_round(&mut self, outer: FrameId, index: &str) -> FrameId {
        let Frame { prefix, suffix, .. } = &self.0[outer.0];
        let (prefix, suffix) = (prefix.clone(), format!("{suffix}{index}"));
        self.add(Frame { outer: Some(outer), prefix, suffix, ..Frame::default() })
    }

    /// A frame for a part that is called so, with the values in its braces.
    pub fn add_part(&mut self, name: &str, values: BTreeMap<&'a str, Placed<&'a Expression>>) -> FrameId {
        self.add(Frame { prefix: format!("{name}."), values, ..Frame::default() })
    }

    fn add(&mut self, frame: Frame<'a>) -> FrameId {
        self.0.push(frame);
        FrameId(self.0.len() - 1)
    }

    /// The frame of the file that a frame is in.
    pub fn file_of(&self, frame: FrameId) -> FrameId {
        self.outward(frame).last().map_or(frame, |(file, _)| file)
    }

    /// What a name that a frame declares is called in the whole script.
    pub fn full_name(&self, frame: FrameId, name: &str) -> String {
        let Frame { prefix, suffix, .. } = &self.0[frame.0];
        format!("{prefix}{name}{suffix}")
    }

    /// How the names of all instances of a part begin.
    pub fn prefix(&self, part: FrameId) -> &str {
        &self.0[part.0].prefix
    }

    /// Whether a frame is in a part.
    pub fn is_in_part(&self, frame: FrameId) -> bool {
        self.file_of(frame) != FrameId::SCRIPT
    }

    /// The value that `use` gives to a parameter of a part.
    pub fn given(&self, frame: FrameId, parameter: &str) -> Option<Placed<&'a Expression>> {
        self.0[frame.0].values.get(parameter).copied()
    }

    /// What a name means that the frame itself declares.
    pub fn own(&self, frame: FrameId, name: &str) -> Option<Placed<Declaration<'a>>> {
        Some(Placed { frame, part: *self.0[frame.0].names.get(name)? })
    }

    /// The names of a frame itself, in order.
    pub fn names(&self, frame: FrameId) -> impl Iterator<Item = (&str, &Declaration<'a>)> {
        self.0[frame.0].names.iter().map(|(name, declaration)| (name.as_ref(), declaration))
    }

    /// After a second declaration of a name: if one is an instance and the other is none, uses of the name report nothing,
    /// because it is not known which of them is meant.
    pub fn refuse_if_unlike(&mut self, frame: FrameId, name: &str, second: Declaration<'a>) {
        let is_instance = |declaration: &Declaration<'_>| matches!(declaration, Declaration::Instance(..));
        if let Some(first) = self.0[frame.0].names.get_mut(name)
            && is_instance(first) != is_instance(&second)
        {
            *first = Declaration::Refused(first.word());
        }
    }

    /// The frame itself, then those around it.
    fn outward(&self, frame: FrameId) -> impl Iterator<Item = (FrameId, &Frame<'a>)> {
        std::iter::successors(Some(frame), |frame| self.0[frame.0].outer).map(|frame| (frame, &self.0[frame.0]))
    }

    /// What a name means in a frame, with the frame that declares it. A part has the script's `seed`.
    pub fn look_up(&self, frame: FrameId, name: &str) -> Option<Placed<Declaration<'a>>> {
        let seed = (name == "seed").then_some((FrameId::SCRIPT, &self.0[0]));
        let mut frames = self.outward(frame).chain(seed);
        frames.find_map(|(frame, at)| Some(Placed { frame, part: *at.names.get(name)? }))
    }

    /// The names that are known in a frame.
    pub fn known(&self, frame: FrameId) -> impl Iterator<Item = (&str, &Declaration<'a>)> {
        self.outward(frame).flat_map(|(frame, _)| self.names(frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::Word;

    fn word(text: &str, start: u32) -> Word {
        Word { text: text.to_owned(), span: Span { text: 0, start, end: start + 1 } }
    }

    #[test]
    fn a_name_is_looked_up_from_the_innermost_frame_outward() {
        let words = [word("a", 0), word("b", 2), word("a", 4)];
        let mut frames = Frames::default();
        let inner = frames.add_round(FrameId::SCRIPT, "[1]");
        for (frame, word) in [(FrameId::SCRIPT, &words[0]), (FrameId::SCRIPT, &words[1]), (inner, &words[2])] {
            assert_eq!(frames.declare(frame, word.text.as_str(), Declaration::Refused(word)), Ok(()));
        }
        let found = |frame, name| frames.look_up(frame, name).map(|found| (found.frame, found.part.span().start));
        assert_eq!(found(inner, "a"), Some((inner, 4)));
        assert_eq!(found(inner, "b"), Some((FrameId::SCRIPT, 2)));
        assert_eq!(found(FrameId::SCRIPT, "a"), Some((FrameId::SCRIPT, 0)));
        assert_eq!(found(inner, "c"), None);
    }

    #[test]
    fn a_second_declaration_of_a_frame_leaves_the_first() {
        let words = [word("a", 0), word("a", 4)];
        let mut frames = Frames::default();
        let mut declare = |word| frames.declare(FrameId::SCRIPT, "a", Declaration::Refused(word));
        assert_eq!(declare(&words[0]), Ok(()));
        assert_eq!(declare(&words[1]), Err(words[0].span));
        assert_eq!(frames.look_up(FrameId::SCRIPT, "a").map(|found| found.part.span()), Some(words[0].span));
    }
}
