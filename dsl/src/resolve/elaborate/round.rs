//! `for`: what its counter runs through, and the statements of each round.

use std::rc::Rc;

use super::{Elaboration, MOST_BLOCKS};
use crate::resolve::frame::FrameId;
use crate::resolve::meaning::{Meaning, Real};
use crate::resolve::range::counted;
use crate::resolve::script::{Declaration, RESERVED};
use crate::syntax::{Expression, Statement, Word};
use std::borrow::Cow;
use std::collections::BTreeSet;

impl<'a> Elaboration<'a> {
    pub(super) fn rounds(&mut self, frame: FrameId, counter: &'a Word, range: &'a Expression, body: &'a [Statement]) {
        let values = self.with_scope(frame, |scope| counted(scope, range, MOST_BLOCKS));
        let Some(values) = values else { return self.refuse_names(frame, body) };
        if !self.has_room(values.len(), range.span) {
            return self.refuse_names(frame, body);
        }
        for (index, value) in indices(&values).into_iter().zip(values) {
            let inner = self.script.frames.add_round(frame, &index);
            self.script.counters.push(Rc::new(Meaning::Real(value)));
            let declaration = Declaration::Counter(self.script.counters.len() - 1, counter);
            self.declare(inner, Cow::Borrowed(&counter.text), counter, declaration, &RESERVED);
            self.block(inner, body);
        }
    }

    /// The names that the statements of a refused loop declare: their uses report nothing.
    pub(super) fn refuse_names(&mut self, frame: FrameId, statements: &'a [Statement]) {
        use crate::syntax::StatementKind;
        let file = self.script.frames.file_of(frame);
        for statement in statements {
            match &statement.kind {
                StatementKind::Fmu(part) | StatementKind::Use(part) => self.refuse_name(file, &part.name.word),
                StatementKind::For { body, .. } => self.refuse_names(frame, body),
                _ => {}
            }
        }
    }
}

/// What names the rounds: the values of the counter if they are different whole numbers without a unit of measure, else
/// the rounds' own numbers from 1.
fn indices(values: &[Real]) -> Vec<String> {
    let numbers: Option<BTreeSet<i64>> = values.iter().map(whole).collect();
    let are_names = numbers.is_some_and(|numbers| numbers.len() == values.len());
    let name = |(round, value): (usize, &Real)| match whole(value).filter(|_| are_names) {
        Some(number) => format!("[{number}]"),
        None => format!("[{}]", round + 1),
    };
    values.iter().enumerate().map(name).collect()
}

/// The number of a counter without a unit of measure.
fn whole(value: &Real) -> Option<i64> {
    let number = value.constant().filter(|number| number.fract() == 0.0 && number.abs() < 1e15);
    number.filter(|_| value.unit.is_none()).map(|number| number as i64)
}
