//! Frames: which names are known where. A frame is what a file, a block or a round of a loop declares.

use std::collections::BTreeMap;

use super::script::Declaration;
use crate::source::Span;
use crate::syntax::Word;

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
    /// Where a name is looked up that is not declared here.
    outer: Option<FrameId>,
    names: BTreeMap<&'a str, Declaration<'a>>,
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
    pub fn declare(&mut self, frame: FrameId, name: &'a str, declaration: Declaration<'a>) -> Result<(), Span> {
        let names = &mut self.0[frame.0].names;
        if let Some(first) = names.get(name) {
            return Err(first.span());
        }
        names.insert(name, declaration);
        Ok(())
    }

    /// After a second declaration of a name: if one is an instance and the other is none, uses of the name report nothing,
    /// because it is not known which of them is meant.
    pub fn refuse_if_unlike(&mut self, frame: FrameId, name: &'a Word, second: Declaration<'a>) {
        let is_instance = |declaration: &Declaration<'_>| matches!(declaration, Declaration::Instance(..));
        if let Some(first) = self.0[frame.0].names.get_mut(name.text.as_str())
            && is_instance(first) != is_instance(&second)
        {
            *first = Declaration::Refused(first.word());
        }
    }

    /// The frame itself, then those around it.
    fn outward(&self, frame: FrameId) -> impl Iterator<Item = (FrameId, &Frame<'a>)> {
        std::iter::successors(Some(frame), |frame| self.0[frame.0].outer).map(|frame| (frame, &self.0[frame.0]))
    }

    /// What a name means in a frame, with the frame that declares it.
    pub fn look_up(&self, frame: FrameId, name: &str) -> Option<Placed<Declaration<'a>>> {
        self.outward(frame).find_map(|(frame, at)| Some(Placed { frame, part: *at.names.get(name)? }))
    }

    /// The names that are known in a frame.
    pub fn known(&self, frame: FrameId) -> impl Iterator<Item = (&'a str, &Declaration<'a>)> {
        self.outward(frame).flat_map(|(_, at)| at.names.iter().map(|(name, declaration)| (*name, declaration)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(text: &str, start: u32) -> Word {
        Word { text: text.to_owned(), span: Span { text: 0, start, end: start + 1 } }
    }

    #[test]
    fn a_name_is_looked_up_from_the_innermost_frame_outward() {
        let words = [word("a", 0), word("b", 2), word("a", 4)];
        let mut frames = Frames::default();
        frames.0.push(Frame { outer: Some(FrameId::SCRIPT), names: BTreeMap::new() });
        let inner = FrameId(1);
        for (frame, word) in [(FrameId::SCRIPT, &words[0]), (FrameId::SCRIPT, &words[1]), (inner, &words[2])] {
            assert_eq!(frames.declare(frame, &word.text, Declaration::Refused(word)), Ok(()));
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
