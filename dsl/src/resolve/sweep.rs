//! The axes of `sweep`: the values of a parameter, one for each case, counted or drawn.

use std::rc::Rc;

use super::findings::Remedy;
use super::meaning::{Meaning, Real};
use super::range::{Counting, counting, no_values};
use super::scale::Scale;
use super::scope::Scope;
use super::script::Declaration;
use crate::diagnostic::{Diagnostic, Edit};
use crate::nearest::nearest;
use crate::random::Draws;
use crate::scenario::RealExpression;
use crate::source::Span;
use crate::syntax::{self, Expression, ExpressionKind, Word};

/// The functions that stand behind `~`.
pub(super) const DISTRIBUTIONS: [&str; 3] = ["normal", "uniform", "choice"];

/// The values of one axis.
pub(super) enum Values {
    /// Those of a range.
    Counted(Counting),
    /// Those of a list.
    Listed(Vec<Rc<Meaning>>),
    /// Drawn for each case.
    Drawn(Distribution),
}

/// What the values of a case are drawn from.
pub(super) enum Distribution {
    /// Mean and standard deviation; what is drawn has the measure of the value.
    Normal(Real, [f64; 2]),
    /// The lowest and the highest value.
    Uniform(Real, [f64; 2]),
    /// One of these, each as often.
    Choice(Vec<Rc<Meaning>>),
}

impl Values {
    /// How many they are; `None` where each case has its own.
    pub fn count(&self) -> Option<u64> {
        match self {
            Self::Counted(counting) => Some(counting.count),
            Self::Listed(values) => Some(values.len() as u64),
            Self::Drawn(_) => None,
        }
    }

    /// The value of a case, which has this number on the axis.
    pub fn of_case(&self, number: u64, case: u64, draws: Draws) -> Rc<Meaning> {
        match self {
            Self::Counted(counting) => Rc::new(Meaning::Real(counting.value(number))),
            Self::Listed(values) => Rc::clone(&values[number as usize]),
            Self::Drawn(distribution) => distribution.drawn(case, draws),
        }
    }

    /// The values that show whether all are of the parameter's kind.
    fn samples(&self) -> Vec<Rc<Meaning>> {
        match self {
            Self::Counted(counting) => vec![Rc::new(Meaning::Real(counting.value(0)))],
            Self::Listed(values) | Self::Drawn(Distribution::Choice(values)) => values.clone(),
            Self::Drawn(Distribution::Normal(value, _) | Distribution::Uniform(value, _)) => {
                vec![Rc::new(Meaning::Real(value.clone()))]
            }
        }
    }
}

impl Distribution {
    fn drawn(&self, case: u64, draws: Draws) -> Rc<Meaning> {
        let (of, number) = match self {
            Self::Normal(of, [mean, deviation]) => (of, mean + deviation * draws.normal(0, case)),
            Self::Uniform(of, [low, high]) => (of, (low + (high - low) * draws.uniform(0, case)).min(*high)),
            Self::Choice(values) => {
                let place = draws.uniform(0, case) * values.len() as f64;
                return Rc::clone(&values[(place as usize).min(values.len() - 1)]);
            }
        };
        let value = RealExpression::Constant(number);
        Rc::new(Meaning::Real(Real::computed(value, of.measure, of.unit.clone()).on(of.scale)))
    }
}

impl Scope<'_, '_> {
    /// The values of an axis.
    pub fn axis_values(self, axis: &syntax::Axis) -> Option<Values> {
        let written = &axis.values;
        let values = match (&written.kind, axis.drawn) {
            (ExpressionKind::Call { function, arguments }, drawn)
                if DISTRIBUTIONS.contains(&function.text.as_str()) =>
            {
                if !drawn {
                    return self.refuse(not_drawn(axis, function));
                }
                Values::Drawn(self.distribution(function, arguments, written.span)?)
            }
            (_, true) => {
                let message = format!("`{}` is no distribution", self.text(written.span));
                let error = Diagnostic::error("E31", written.span, message);
                return self.refuse(error.help(DRAWS_LOOK));
            }
            (ExpressionKind::Range(from, to), false) => Values::Counted(counting(self, written, (from, to))?),
            (_, false) => Values::Listed(self.elements(written)?),
        };
        if values.count() == Some(0) {
            let error = Diagnostic::error("E38", written.span, format!("`{}` has no value", axis.name.text));
            let help = match values {
                Values::Counted(_) => "a range goes from the smaller number to the larger: `1..25`",
                _ => "write its values in the list: `[2, 4, 8] m`",
            };
            return self.refuse(error.help(help));
        }
        Some(values)
    }

    /// Whether the values of an axis may replace those of its parameter; if not, this is reported.
    pub fn fit_parameter(self, axis: &syntax::Axis, values: &Values) -> bool {
        let declared = match self.look_up(&axis.name.text).map(|found| found.part) {
            Some(Declaration::Parameter(binding)) => self.evaluate(&binding.value),
            None if axis.name.text == "seed" => self.implicit_seed(),
            Some(Declaration::Refused(_)) => None,
            _ => {
                self.report(self.no_parameter(&axis.name));
                return false;
            }
        };
        let Some(declared) = declared else { return false };
        let name = (axis.name.text.as_str(), axis.values.span);
        values.samples().iter().all(|value| self.check_kind(name, value, &declared))
    }

    /// That the script has no such parameter.
    pub fn no_parameter(self, word: &Word) -> Diagnostic {
        let (name, script) = (word.text.as_str(), self.at(super::frame::FrameId::SCRIPT));
        let own = script.script.frames.known(script.frame());
        let parameters = own.filter(|(_, declared)| matches!(declared, Declaration::Parameter(_)));
        let names: Vec<_> = parameters.map(|(name, _)| name).filter(|name| *name != "seed").chain(["seed"]).collect();
        let error = Diagnostic::error("E01", word.span, format!("the script has no parameter `{name}`"));
        match nearest(name, names.iter().copied()) {
            Some(near) => Remedy::meant(near, word.span).of(error),
            None => error.help(format!("its parameters are {}", names.join(", "))),
        }
    }

    /// The elements of a list, which are known before the run.
    fn elements(self, list: &Expression) -> Option<Vec<Rc<Meaning>>> {
        let meaning = self.evaluate(list)?;
        let Meaning::List(elements) = &*meaning else { return self.refuse(no_values(&meaning, list)) };
        if !meaning.is_constant() {
            return self.refuse(self.must_be_known(list.span));
        }
        Some(elements.clone())
    }

    fn distribution(self, function: &Word, arguments: &[Expression], span: Span) -> Option<Distribution> {
        if function.text == "choice" {
            return self.choice(arguments, span).map(Distribution::Choice);
        }
        let [first, second] = arguments else {
            let message = format!("`{}` takes 2 arguments, found {}", function.text, arguments.len());
            return self.refuse(Diagnostic::error("E31", span, message).help(DRAWS_LOOK));
        };
        let is_normal = function.text == "normal";
        let (from, to) = (self.number_of_draw(first), self.number_of_draw(second));
        let ((from, from_si), (to, to_si)) = (from?, to?);
        if is_normal && to.scale == (Scale::Point { offset: true }) {
            self.refuse_offset(second, "a standard deviation");
            return None;
        }
        if from.measure != to.measure {
            let message = format!("`{}` of {} and {}", function.text, self.described(&from), self.described(&to));
            return self.refuse(Diagnostic::error("E02", span, message).help("give both one unit of measure"));
        }
        if (is_normal && to_si < 0.0) || (!is_normal && to_si < from_si) {
            let (message, help) = match is_normal {
                true => ("a standard deviation is not below zero", "write zero or more"),
                false => ("the second value is below the first", "write the smaller value first"),
            };
            return self.refuse(Diagnostic::error("E38", second.span, message).help(help));
        }
        // Ten standard deviations are never drawn.
        let widest = if is_normal { from_si.abs() + 10.0 * to_si } else { to_si - from_si };
        self.finite(Real::plain(widest), span)?;
        let ends = [from_si, to_si];
        Some(if is_normal { Distribution::Normal(from, ends) } else { Distribution::Uniform(from, ends) })
    }

    /// A number that is known before the run.
    fn number_of_draw(self, written: &Expression) -> Option<(Real, f64)> {
        let meaning = self.evaluate(written)?;
        let value = self.real(&meaning, written.span)?;
        match value.constant() {
            Some(number) => Some((value, number)),
            None => self.refuse(self.must_be_known(written.span)),
        }
    }

    /// The values to choose from: several arguments, or the elements of one list.
    fn choice(self, arguments: &[Expression], span: Span) -> Option<Vec<Rc<Meaning>>> {
        if let [list] = arguments {
            let values = self.elements(list)?;
            return if values.is_empty() { self.refuse(nothing_to_choose(span)) } else { Some(values) };
        }
        let known = |argument: &Expression| {
            let value = self.evaluate(argument)?;
            if value.is_constant() { Some(value) } else { self.refuse(self.must_be_known(argument.span)) }
        };
        let values: Vec<_> = arguments.iter().map(known).collect();
        if values.is_empty() {
            return self.refuse(nothing_to_choose(span));
        }
        values.into_iter().collect()
    }

    /// That a distribution stands where a value is meant.
    pub fn draw_outside_of_sweep(self, function: &Word, span: Span) -> Diagnostic {
        let message = format!("`{}` draws a value for each case of a sweep", function.text);
        let help = format!(
            "write `sweep {{ x ~ {}(…) }}`; what changes at random during a run is a fault, `noise` or `loss`, or a unit's own",
            function.text
        );
        Diagnostic::error("E31", span, message).help(help)
    }
}

const DRAWS_LOOK: &str =
    "a draw looks like `~ normal(0 m/s, 0.2 m/s)`, `~ uniform(1 m, 3 m)` or `~ choice(\"a\", \"b\")`";

fn nothing_to_choose(span: Span) -> Diagnostic {
    Diagnostic::error("E31", span, "`choice` has nothing to choose from").help(DRAWS_LOOK)
}

/// That `in` stands before a distribution.
fn not_drawn(axis: &syntax::Axis, function: &Word) -> Diagnostic {
    let between = Span { start: axis.name.span.end, end: axis.values.span.start, ..axis.name.span };
    let message = format!("`{}` draws values, and `in` counts them", function.text);
    Diagnostic::error("E31", axis.values.span, message)
        .help(format!("write `{} ~ {}(…)`", axis.name.text, function.text))
        .fix("write `~`", [Edit::new(between, " ~ ")])
}
