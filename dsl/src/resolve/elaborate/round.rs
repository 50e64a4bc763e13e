//! `for`: what its counter runs through, and the statements of each round.

use std::rc::Rc;

use super::Elaboration;
use crate::diagnostic::Diagnostic;
use crate::resolve::frame::FrameId;
use crate::resolve::meaning::{Meaning, Real};
use crate::resolve::range::counted;
use crate::resolve::script::{Declaration, RESERVED};
use crate::syntax::{Expression, Statement, Word};
use std::borrow::Cow;

/// How many rounds the loops of a script may have together: more than anybody means, and little memory.
const MOST_ROUNDS: usize = 100_000;

impl<'a> Elaboration<'a> {
    pub(super) fn rounds(&mut self, frame: FrameId, counter: &'a Word, range: &'a Expression, body: &'a [Statement]) {
        let values = self.with_scope(frame, |scope| counted(scope, range, MOST_ROUNDS));
        let Some(values) = values else { return self.refuse_names(frame, body) };
        if self.rounds + values.len() > MOST_ROUNDS {
            let message = format!("the loops of this script have more than {MOST_ROUNDS} rounds");
            self.found.push(Diagnostic::error("E39", range.span, message).help("count to less"));
            return self.refuse_names(frame, body);
        }
        self.rounds += values.len();
        for (round, value) in values.into_iter().enumerate() {
            let index = whole(&value).map_or_else(|| format!("[{}]", round + 1), |number| format!("[{number}]"));
            let inner = self.script.frames.add_round(frame, &index);
            self.script.counters.push(Rc::new(Meaning::Real(value)));
            let declaration = Declaration::Counter(self.script.counters.len() - 1, counter);
            self.declare(inner, Cow::Borrowed(&counter.text), counter, declaration, &RESERVED);
            self.block(inner, body);
        }
    }

    /// The names that the statements of a refused loop or part declare: their uses report nothing.
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

/// The number of a counter without a unit of measure.
fn whole(value: &Real) -> Option<i64> {
    let number = value.constant().filter(|number| number.fract() == 0.0 && number.abs() < 1e15);
    number.filter(|_| value.unit.is_none()).map(|number| number as i64)
}
