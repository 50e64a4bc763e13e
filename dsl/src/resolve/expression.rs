//! The meaning of expressions, one kind after the other.

use std::rc::Rc;

use fmi2::units::{BaseUnit, Dimension};

use super::condition::Condition;
use super::frame::Placed;
use super::literal::literal;
use super::meaning::{Group, Meaning, Measure, Origin, Real, Text};
use super::measure::unit_name;
use super::path::Root;
use super::real;
use super::scale::Scale;
use super::scope::Scope;
use super::script::{Declaration, RESERVED};
use crate::diagnostic::Diagnostic;
use crate::scenario::{BooleanExpression, RealExpression};
use crate::source::Span;
use crate::syntax::{Expression, ExpressionKind as Kind, Path, Segment, Word};

/// The longest list that `[w; n]` makes: the largest groups of units have far fewer members.
const MOST_COPIES: usize = 4096;

/// The most parts of a list that `[w; n]` makes, with those of its elements.
const MOST_PARTS: usize = 1 << 16;

impl Scope<'_, '_> {
    /// What an expression means; `None` if that was refused, here or in something that it depends on.
    pub fn evaluate(&self, expression: &Expression) -> Option<Rc<Meaning>> {
        match &expression.kind {
            Kind::Path(path) => self.path(path),
            _ => self.computed(expression).map(Rc::new),
        }
    }

    fn computed(&self, expression: &Expression) -> Option<Meaning> {
        let span = expression.span;
        match &expression.kind {
            Kind::Quantity { number, unit } => self.quantity(expression, *number, unit.as_ref()),
            Kind::Text(text) => Some(Meaning::Text(Text::Literal(text.clone()))),
            Kind::Boolean(value) => Some(Meaning::plain(BooleanExpression::Constant(*value), Some(span))),
            Kind::Path(_) => unreachable!("the meaning of a path is looked up"),
            Kind::List { elements, copies, unit } => self.list(expression, elements, copies.as_deref(), unit.as_ref()),
            Kind::Call { function, arguments } => self.call(function, arguments, span),
            Kind::Negate(of) => self.negated(of),
            Kind::In(of, unit) => self.in_unit(expression, of, unit),
            Kind::As(of, unit) => self.as_unit(expression, of, unit),
            Kind::Arithmetic(operator, left, right) => self.arithmetic(*operator, left, right),
            Kind::Range(..) => {
                let error = Diagnostic::error("E21", span, "a range is no value");
                self.refuse(error.help("ranges stand in `within`, `for` and `sweep`; a chain reads `1 m < x < 5 m`"))
            }
            Kind::Comparison { first, rest } => self.comparison(first, rest, span).map(Meaning::Condition),
            Kind::Not(of) => Some(Meaning::Condition(Condition::Not(Box::new(self.condition(of)?)))),
            Kind::And(parts) => self.conditions(parts).map(|parts| Meaning::Condition(Condition::And(parts))),
            Kind::Or(parts) => self.conditions(parts).map(|parts| Meaning::Condition(Condition::Or(parts))),
            Kind::Until { left, span: window, right } => {
                self.until(left, window.as_ref(), right, span).map(|until| Meaning::Condition(Condition::Until(until)))
            }
            Kind::Implies(gate, then) => {
                let gate_span = gate.span;
                let (gate, then) = (self.condition(gate), self.condition(then));
                let (gate, then) = (Box::new(gate?), Box::new(then?));
                Some(Meaning::Condition(Condition::Implies { gate, gate_span, then }))
            }
            Kind::Temporal { word, word_span, span: window, body } => self
                .temporal(*word, *word_span, window.as_ref(), body)
                .map(|claim| Meaning::Condition(Condition::Temporal(claim))),
        }
    }

    fn quantity(&self, expression: &Expression, number: f64, unit: Option<&Word>) -> Option<Meaning> {
        let value = match unit {
            Some(unit) => literal(number, self.unit_of_measure(unit, expression)?, &unit.text),
            None => Real::plain(number),
        };
        self.finite(value, expression.span).map(Meaning::Real)
    }

    fn list(
        &self,
        expression: &Expression,
        elements: &[Expression],
        copies: Option<&Expression>,
        unit: Option<&Word>,
    ) -> Option<Meaning> {
        let base = match unit {
            Some(unit) => Some((self.unit_of_measure(unit, expression)?, unit)),
            None => None,
        };
        let element = |element: &Expression| {
            let meaning = self.evaluate(element)?;
            match base {
                Some((base, unit)) => self.with_unit(&meaning, base, &unit.text, element.span),
                None => Some(meaning),
            }
        };
        let elements: Vec<_> = elements.iter().map(element).collect();
        let count = copies.map(|copies| self.number_of_copies(copies));
        let elements = elements.into_iter().collect::<Option<Vec<_>>>()?;
        match count {
            None => Some(Meaning::List(elements)),
            Some(count) => {
                let count = count?;
                let parts = elements.iter().map(|element| element.size()).sum::<usize>().saturating_mul(count);
                if parts > MOST_PARTS {
                    let error = Diagnostic::error("E39", expression.span, format!("this list has {parts} parts"));
                    return self.refuse(
                        error.help(format!("a list has at most {MOST_PARTS} parts, those of its elements included")),
                    );
                }
                Some(Meaning::List(elements.iter().cycle().take(count).cloned().collect()))
            }
        }
    }

    /// The number after the `;` of a list.
    fn number_of_copies(&self, copies: &Expression) -> Option<usize> {
        let count = self.whole_number(copies)?;
        usize::try_from(count).ok().filter(|count| (1..=MOST_COPIES).contains(count)).or_else(|| {
            let message = format!("a list of {count} elements");
            let error = Diagnostic::error("E38", copies.span, message);
            self.refuse(error.help(format!("`[w; 4]` is `[w, w, w, w]`; the number goes from 1 to {MOST_COPIES}")))
        })
    }

    /// Gives plain numbers the unit that follows their list.
    fn with_unit(&self, meaning: &Meaning, base: BaseUnit, name: &str, span: Span) -> Option<Rc<Meaning>> {
        let given = match meaning {
            Meaning::List(elements) => {
                let elements = elements.iter().map(|element| self.with_unit(element, base, name, span));
                Meaning::List(elements.collect::<Option<_>>()?)
            }
            Meaning::Real(Real { origin: Origin::Literal { number, has_unit: false, .. }, .. }) => {
                Meaning::Real(literal(*number, base, name))
            }
            Meaning::Real(value) if value.measure == Measure::PLAIN => {
                let unit = Some(unit_name(name, base, true));
                let value = real::to_si(value.expression.clone(), base);
                Meaning::Real(Real::computed(value, Measure::Known(base.dimension), unit).on(Scale::of(base)))
            }
            other => {
                let message = format!("`{}` cannot take the unit behind the list, `{name}`", self.text(span));
                let what = match other {
                    Meaning::Real(value) => self.described(value),
                    other => other.kind().to_owned(),
                };
                let error = Diagnostic::error("E33", span, message).saying(what);
                return self.refuse(error.help("give each element its own unit: `[1 m, 2 m]`"));
            }
        };
        Some(Rc::new(given))
    }

    fn path(&self, path: &Path) -> Option<Rc<Meaning>> {
        if path.tail.iter().any(|segment| matches!(segment, Segment::AllIndices(_))) {
            let elements = self.expanded(path).iter().map(|path| self.path(path)).collect::<Option<Vec<_>>>()?;
            return (!elements.is_empty()).then(|| Rc::new(Meaning::List(elements)));
        }
        let root = path.root.text.as_str();
        let is_refused = || matches!(self.look_up(root).map(|found| found.part), Some(Declaration::Refused(_)));
        let builtin = match root {
            "time" | "pi" if is_refused() => return None,
            "time" => Real::computed(RealExpression::Time, Measure::Known(super::grid::SECOND), None),
            "pi" => Real::plain(std::f64::consts::PI),
            _ => return self.declared(path),
        };
        self.narrowed_by(Rc::new(Meaning::Real(builtin)), &path.tail, path)
    }

    fn declared(&self, path: &Path) -> Option<Rc<Meaning>> {
        let (Placed { frame, part }, tail) = match self.root(path) {
            Root::Declared(found, tail) => (found, tail),
            Root::Reported => return None,
            Root::Unknown if path.root.text == "seed" => {
                self.note_use_of_seed();
                return self.narrowed_by(self.implicit_seed()?, &path.tail, path);
            }
            Root::Unknown => {
                return match self.wrong_index(path) {
                    Some(error) => self.refuse(error),
                    None => self.refuse_unknown_name(&path.root, |_| true, &RESERVED),
                };
            }
        };
        let meaning = match part {
            Declaration::Parameter(binding) => self.at(frame).binding(binding, self.at(frame).assigned(binding))?,
            Declaration::Let(binding) => self.at(frame).binding(binding, Placed { frame, part: &binding.value })?,
            Declaration::Counter(counter, _) => Rc::clone(&self.script.counters[counter]),
            Declaration::Instance(instance, _) => {
                let signal = self.walk(instance, String::new(), tail, path)?;
                return self.source(signal, path.span).map(Rc::new);
            }
            Declaration::Part(..) | Declaration::Refused(_) => return None,
        };
        self.narrowed_by(meaning, tail, path)
    }

    /// Follows the path after the name of a `let` or `param`.
    fn narrowed_by(&self, meaning: Rc<Meaning>, tail: &[Segment], path: &Path) -> Option<Rc<Meaning>> {
        let Some((first, rest)) = tail.split_first() else { return Some(meaning) };
        match &*meaning {
            Meaning::Group(group) => {
                let signal = self.walk(group.instance, group.prefix.clone(), tail, path)?;
                self.source(signal, path.span).map(Rc::new)
            }
            Meaning::List(elements) => {
                let Segment::Index(index, span) = first else { return self.refuse(self.no_parts(path)) };
                let [index] = index.as_slice() else { return self.refuse(self.no_parts(path)) };
                let at = self.whole_number(index)?;
                let element = usize::try_from(at - 1).ok().and_then(|at| elements.get(at));
                let Some(element) = element else {
                    let message = format!("`{}` has no element `[{at}]`", path.root.text);
                    let help = format!("its elements go from `[1]` to `[{}]`", elements.len());
                    return self.refuse(Diagnostic::error("E22", *span, message).help(help));
                };
                self.narrowed_by(Rc::clone(element), rest, path)
            }
            _ => self.refuse(self.no_parts(path)),
        }
    }

    fn no_parts(&self, path: &Path) -> Diagnostic {
        let message = format!("`{}` has no parts that could be named so", path.root.text);
        Diagnostic::error("E22", path.span, message)
            .help("lists have elements such as `[1]`, groups have members by name")
    }

    fn in_unit(&self, whole: &Expression, of: &Expression, unit: &Word) -> Option<Meaning> {
        let (meaning, base) = (self.evaluate(of), self.unit_of_measure(unit, whole));
        let value = self.operand(&*meaning?, of.span)?;
        let (value, base) = self.converted(&value, of, (base?, unit))?;
        let Measure::Known(dimension) = value.measure else {
            let message = format!("`{}` declares no unit that could be taken out", self.text(of.span));
            return self.refuse(
                Diagnostic::error("E33", of.span, message)
                    .help(format!("it is a number already; its unit is given by `as {}`", unit.text)),
            );
        };
        if dimension.without_angle() != base.dimension.without_angle() {
            let message = format!("`{}` is not measured in {}", self.text(of.span), unit.text);
            let error = Diagnostic::error("E02", unit.span, message).saying(base.dimension.to_string());
            return self
                .refuse(error.label(of.span, self.described(&value)).help("`in` needs a unit of the same dimension"));
        }
        let number = match value.origin {
            Origin::Literal { number, base: written, .. } if written == base => RealExpression::Constant(number),
            _ => real::from_si(value.expression, base),
        };
        Some(Meaning::Real(Real::computed(number, Measure::PLAIN, None)))
    }

    fn as_unit(&self, whole: &Expression, of: &Expression, unit: &Word) -> Option<Meaning> {
        let (meaning, base) = (self.evaluate(of), self.unit_of_measure(unit, whole));
        let value = self.operand(&*meaning?, of.span)?;
        let (value, base) = self.converted(&value, of, (base?, unit))?;
        if !matches!(value.measure, Measure::Undeclared | Measure::Known(Dimension::NONE)) {
            let message = format!("`{}` has a unit already", self.text(of.span));
            let error = Diagnostic::error("E33", of.span, message).saying(self.described(&value));
            return self
                .refuse(error.help(format!("units are converted by themselves; the number is `… in {}`", unit.text)));
        }
        let scale = if value.scale.is_difference() { value.scale } else { Scale::of(base) };
        let expression = real::to_si(value.expression, base);
        let unit = Some(unit_name(&unit.text, base, true));
        Some(Meaning::Real(Real::computed(expression, Measure::Known(base.dimension), unit).on(scale)))
    }

    /// A value and the unit that it is brought to by `in` or gets by `as`: the value's FMU may define that name, and a
    /// difference has no offset.
    fn converted(&self, value: &Real, of: &Expression, (base, unit): (BaseUnit, &Word)) -> Option<(Real, BaseUnit)> {
        let wanted = self.read_beside((&literal(0.0, base, &unit.text), unit.span), value)?;
        let base = match wanted.origin {
            Origin::Literal { base, .. } if wanted.measure != Measure::Undeclared => base,
            _ => base,
        };
        Some((self.read_beside((value, of.span), &wanted)?, base))
    }

    /// One real number.
    pub fn real(&self, meaning: &Meaning, span: Span) -> Option<Real> {
        self.read_alone(&self.operand(meaning, span)?, span)
    }

    /// One real number that another or a variable may give the meaning of its unit.
    pub fn operand(&self, meaning: &Meaning, span: Span) -> Option<Real> {
        match meaning {
            Meaning::Real(value) => Some(value.clone()),
            Meaning::Integer(port) => Some(Real {
                expression: RealExpression::Signal(*port),
                measure: Measure::PLAIN,
                unit: None,
                origin: Origin::Port(*port),
                scale: Scale::Either,
            }),
            Meaning::List(elements) => self.refuse(self.one_expected(span, elements.len())),
            Meaning::Group(group) => self.refuse(self.one_expected(span, group.members.len())),
            other => {
                let message = format!("expected a number, found {}", other.kind());
                self.refuse(Diagnostic::error("E21", span, message).help("texts and Booleans have no arithmetic"))
            }
        }
    }

    fn one_expected(&self, span: Span, count: usize) -> Diagnostic {
        let message = format!("expected one number, `{}` is a vector of {count}", self.text(span));
        Diagnostic::error("E22", span, message)
            .help("`norm`, `max` or `sum` make one number of it, `.x` or `[1]` takes one out")
    }

    /// The elements of a vector; one number is a vector of one.
    pub fn reals(&self, meaning: &Meaning, span: Span) -> Option<Vec<Real>> {
        match meaning {
            Meaning::List(elements) => elements.iter().map(|element| self.real(element, span)).collect(),
            Meaning::Group(group) => self.vector(group, span),
            other => Some(vec![self.real(other, span)?]),
        }
    }

    fn vector(&self, group: &Group, span: Span) -> Option<Vec<Real>> {
        let meanings = group.ports().map(|port| (port, self.port_meaning(port)));
        let mut values: Vec<Real> = Vec::new();
        for (port, meaning) in meanings {
            let Meaning::Real(value) = meaning else {
                return self.refuse(self.mixed(
                    group,
                    span,
                    &format!("`{}` is {}", self.port_name(port), meaning.kind()),
                ));
            };
            let same = |first: &Real| first.measure == value.measure && first.unit == value.unit;
            if let Some(first) = values.first().filter(|first| !same(first)) {
                let units = format!("it holds {} and {}", self.described(first), self.described(&value));
                return self.refuse(self.mixed(group, span, &units));
            }
            values.push(value);
        }
        Some(values)
    }

    fn mixed(&self, group: &Group, span: Span, why: &str) -> Diagnostic {
        let message = format!("`{}` does not compute: {why}", self.text(span));
        let first = group.members.first().map_or("", |(suffix, _)| suffix.as_str());
        let help = format!("such a group connects as a whole; take one part, for example `{}{first}`", self.text(span));
        Diagnostic::error("E23", span, message).help(help)
    }

    /// The condition that an expression is.
    pub fn condition(&self, expression: &Expression) -> Option<Condition> {
        let meaning = self.evaluate(expression)?;
        self.as_condition(&meaning, expression.span)
    }

    /// The condition that a meaning is.
    pub fn as_condition(&self, meaning: &Meaning, span: Span) -> Option<Condition> {
        match meaning {
            Meaning::Condition(condition) => Some(condition.clone()),
            other => {
                let message = format!("expected a condition, `{}` is {}", self.text(span), other.kind());
                self.refuse(Diagnostic::error("E21", span, message).help("a condition compares, for example `x > 3 m`"))
            }
        }
    }

    fn conditions(&self, parts: &[Expression]) -> Option<Vec<Condition>> {
        let parts: Vec<_> = parts.iter().map(|part| self.condition(part)).collect();
        parts.into_iter().collect()
    }

    /// That a value has to be known before the run.
    pub fn must_be_known(&self, span: Span) -> Diagnostic {
        let message = format!("`{}` is not known before the run", self.text(span));
        Diagnostic::error("E27", span, message).help("numbers, parameters and what is computed from them stand here")
    }
}
