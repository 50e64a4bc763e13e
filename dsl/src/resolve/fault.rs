//! `fault`: which connections it acts on, what its kinds take, and the seed of its random numbers.

use std::rc::Rc;

use fmi2::description::Kind;
use fmi2::units::BaseUnit;

use super::assign::Role;
use super::fit::{Meeting, with_unit};
use super::grid::Least;
use super::meaning::{Meaning, Measure};
use super::measure::quantity;
use super::real;
use super::scale::Scale;
use super::scope::Scope;
use super::script::Declaration;
use crate::diagnostic::Diagnostic;
use crate::nearest::{listed, nearest};
use crate::scenario::{Action, Event, Fault, FaultKind, Port, RealExpression};
use crate::source::Span;
use crate::syntax::{Expression, Path, Word};

/// The kinds of faults, each with an example.
const KINDS: [(&str, &str); 5] = [
    ("bias", "bias 10 cm"),
    ("noise", "noise 10 cm"),
    ("loss", "loss 5 %"),
    ("freeze", "freeze"),
    ("delay", "delay 200 ms"),
];

/// The most values that the delays of one fault may keep; more would not fit into memory with the run.
const MOST_DELAYED: u64 = 10_000_000;

impl Scope<'_, '_> {
    /// The faults that one `fault` names, each with the place of its kind.
    pub fn faults(&self, target: &Path, kinds: &[(Word, Option<Expression>)]) -> Vec<(Span, Fault)> {
        let targets = self.faulty(target);
        let fault = |(word, operand): &(Word, Option<Expression>)| {
            let kind = self.fault_kind(word, operand.as_ref(), target, targets.as_deref());
            Some((word.span, Fault { targets: targets.clone()?, kind: kind? }))
        };
        kinds.iter().filter_map(fault).collect()
    }

    /// The driven inputs that a path covers.
    fn faulty(&self, path: &Path) -> Option<Vec<Port>> {
        let at = Meeting { source: path.span, target: path.span, arrow: None };
        let signal = self.touchable(Role::Fault, self.signal(path)?, at)?;
        let driven_by = self.driven_by.borrow();
        let mut driven = Vec::new();
        for port in signal.ports() {
            if driven_by.contains_key(&port) && !driven.contains(&port) {
                driven.push(port);
            }
        }
        if driven.is_empty() {
            let message = format!("a fault acts on a connection, and none drives `{}`", self.text(path.span));
            let error = Diagnostic::error("E45", path.span, message);
            return self.refuse(error.help("connect it, or change its value by `set`"));
        }
        Some(driven)
    }

    fn fault_kind(
        &self,
        word: &Word,
        operand: Option<&Expression>,
        path: &Path,
        targets: Option<&[Port]>,
    ) -> Option<FaultKind> {
        let Some((kind, example)) = KINDS.iter().find(|(kind, _)| *kind == word.text) else {
            let error = Diagnostic::error("E45", word.span, format!("there is no fault `{}`", word.text));
            let kinds = KINDS.iter().map(|(kind, _)| *kind);
            return self.refuse(error.help(match nearest(&word.text, kinds.clone()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("the faults are {}", listed(kinds)),
            }));
        };
        let operand = match (*kind, operand) {
            ("freeze", None) => return Some(FaultKind::Freeze),
            ("freeze", Some(operand)) => {
                let error = Diagnostic::error("E45", operand.span, "`freeze` takes no value: it holds the last one");
                return self.refuse(error.help("write `freeze`, or `loss 5 %` to hold it at times"));
            }
            (_, Some(operand)) => operand,
            (kind, None) => {
                let error = Diagnostic::error("E45", word.span, format!("`{kind}` needs a value"));
                return self.refuse(error.help(format!("write for example `{example}`")));
            }
        };
        match *kind {
            "loss" => self.probability(operand).map(FaultKind::Loss),
            "delay" => self.delay(operand, targets).map(FaultKind::Delay),
            kind => {
                let values = self.differences(kind, operand, path, targets)?;
                Some(if kind == "bias" { FaultKind::Bias(values) } else { FaultKind::Noise(values) })
            }
        }
    }

    fn delay(&self, operand: &Expression, targets: Option<&[Port]>) -> Option<u64> {
        let ticks = self.ticks(operand, Least::OneTick)?;
        let count = targets.map_or(1, <[Port]>::len) as u64;
        if ticks.saturating_mul(count) <= MOST_DELAYED {
            return Some(ticks);
        }
        let message = format!("this delay keeps {ticks} steps of {count} values, and at most {MOST_DELAYED} are kept");
        self.refuse(Diagnostic::error("E39", operand.span, message).help("shorten the delay, or write a longer `step`"))
    }

    /// What `bias` and `noise` take for each target, in the target's unit and without the offset of that.
    fn differences(
        &self,
        kind: &str,
        operand: &Expression,
        path: &Path,
        targets: Option<&[Port]>,
    ) -> Option<Vec<RealExpression>> {
        let meaning = self.evaluate(operand);
        let targets = targets?;
        if let Some(other) = targets.iter().find(|port| !matches!(self.variable(**port).kind, Kind::Real(_))) {
            let message = format!("`{kind}` adds to a Real, and `{}` is none", self.port_name(*other));
            let error = Diagnostic::error("E21", path.span, message);
            return self.refuse(error.help("`loss`, `freeze` and `delay` act on values of any type"));
        }
        let meaning = meaning?;
        let values = match &*meaning {
            Meaning::List(_) | Meaning::Group(_) => self.leaves(&meaning),
            _ => vec![Rc::clone(&meaning); targets.len()],
        };
        if values.len() != targets.len() {
            let message = format!("{} values meet {} driven inputs", values.len(), targets.len());
            let error = Diagnostic::error("E22", operand.span, message).saying(format!("gives {}", values.len()));
            let error = error.label(path.span, format!("takes {}", targets.len()));
            return self.refuse(error.help("write one value for each, or one for all of them"));
        }
        let difference = |(value, &target): (&Rc<Meaning>, &Port)| self.difference(kind, value, target, operand.span);
        values.iter().zip(targets).map(difference).collect()
    }

    fn difference(&self, kind: &str, value: &Meaning, target: Port, span: Span) -> Option<RealExpression> {
        let value = self.read_for(&self.operand(value, span)?, target, span)?;
        self.refuse_running(&value.expression, span)?;
        let name = self.port_name(target);
        if value.scale == (Scale::Point { offset: true }) {
            let message = format!("`{kind}` is a difference, and `{}` is a point on a scale", self.text(span));
            let error = Diagnostic::error("E32", span, message);
            return self.refuse(error.help("write the difference in K, for example `2 K`"));
        }
        if kind == "noise" && value.constant().is_some_and(|sigma| sigma.is_nan() || sigma < 0.0) {
            let message = format!("`noise` is a standard deviation, and `{}` is below zero", self.text(span));
            return self.refuse(Diagnostic::error("E38", span, message).help("write a value of zero or more"));
        }
        let (Measure::Known(given), Some(taken)) = (value.measure, self.declared_unit(target)) else {
            if self.declared_unit(target).is_none() {
                self.warn_undeclared(&value, span, &name, Some(target));
            }
            return Some(value.expression);
        };
        if given.without_angle() != taken.dimension.without_angle() {
            let takes = quantity(taken.dimension);
            let message = format!("`{kind}` of `{name}` is {takes}, found {}", self.described(&value));
            let unit = self.known(target.instance).unit_of(target.variable).unwrap_or_default();
            let help = match (value.measure == Measure::PLAIN, value.constant()) {
                (true, Some(_)) => with_unit(&self.text(span), unit),
                _ => format!("it takes a value such as `1 {}`", super::measure::si_name(taken.dimension)),
            };
            return self.refuse(Diagnostic::error("E02", span, message).help(help));
        }
        Some(real::from_si(value.expression, BaseUnit { offset: 0.0, ..taken }))
    }

    fn probability(&self, operand: &Expression) -> Option<RealExpression> {
        let meaning = self.evaluate(operand)?;
        let value = self.real(&meaning, operand.span)?;
        self.refuse_running(&value.expression, operand.span)?;
        if !matches!(value.measure, Measure::Undeclared | Measure::PLAIN) {
            let message = format!("expected a probability, found {}", self.described(&value));
            return self.refuse(Diagnostic::error("E02", operand.span, message).help("write for example `loss 5 %`"));
        }
        if value.constant().is_some_and(|value| !(0.0..=1.0).contains(&value)) {
            let message = format!("`{}` is not a probability", self.text(operand.span));
            let help = "a probability is from 0 to 1, which is 100 %";
            return self.refuse(Diagnostic::error("E38", operand.span, message).help(help));
        }
        Some(value.expression)
    }

    /// The seed of the random numbers of faults; 0 where none draws any.
    pub fn fault_seed(&self, events: &[Event]) -> Option<i64> {
        let draws = |action: &Action| matches!(action, Action::Fault(fault) if fault.kind.draws());
        if !events.iter().flat_map(|event| &event.actions).any(draws) {
            return Some(0);
        }
        self.note_use_of_seed();
        self.whole_seed("`noise` and `loss`")
    }

    /// The value of `seed`, from which something draws its random numbers.
    pub fn whole_seed(&self, of: &str) -> Option<i64> {
        let declared = self.look_up("seed");
        let seed = match declared.map(|found| (found.frame, found.part)) {
            Some((frame, Declaration::Parameter(binding))) => self.at(frame).binding(binding, self.assigned(binding)),
            _ => self.implicit_seed(),
        };
        let number = match seed.as_deref()? {
            Meaning::Real(value) if value.measure == Measure::PLAIN => value.constant(),
            _ => None,
        };
        match number.filter(|number| number.fract() == 0.0 && number.abs() < 9e15) {
            Some(number) => Some(number as i64),
            None => {
                let written = self.settings.get("seed").map(|setting| setting.value.span);
                let declared = || declared.map_or(Span::default(), |found| found.part.span());
                let span = written.unwrap_or_else(declared);
                let error = Diagnostic::error("E38", span, format!("the seed of {of} is a whole number"));
                self.refuse(error.help("write for example `seed = 1`"))
            }
        }
    }

    /// Notes that something uses `seed`: a declared one at its place, else at that of its axis.
    pub fn note_use_of_seed(&self) {
        self.shared.used.borrow_mut().extend(self.place_of_seed());
    }

    /// The place under which uses of `seed` are noted; `None` if it is neither declared nor swept.
    pub fn place_of_seed(&self) -> Option<Span> {
        let swept = || self.script.axes().iter().find(|axis| axis.name.text == "seed").map(|axis| axis.name.span);
        self.look_up("seed").map(|found| found.part.span()).or_else(swept)
    }
}
