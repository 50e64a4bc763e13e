//! The script's parameters and what the command line makes of them.

use std::rc::Rc;

use super::frame::{FrameId, Placed};
use super::meaning::{Meaning, Origin, Real, Text};
use super::measure::{quantity, si_name};
use super::scope::Scope;
use super::script::Declaration;
use crate::diagnostic::Diagnostic;
use crate::scenario::{BooleanExpression, Parameter};
use crate::source::Span;
use crate::spelling;
use crate::syntax::{Binding, Expression};

use super::condition::Condition;
use super::meaning::Measure;

impl<'a> Scope<'_, 'a> {
    /// The value of a parameter of this frame as written: that of the command line, of a part that of the braces of `use`,
    /// else its own.
    pub fn assigned(&self, parameter: &'a Binding) -> Placed<&'a Expression> {
        let (name, frame) = (parameter.name.text.as_str(), self.frame());
        let own = Placed { frame, part: &parameter.value };
        if frame == FrameId::SCRIPT {
            return self.setting(name).map_or(own, |setting| Placed { frame, part: &setting.value });
        }
        self.shared.script.frames.given(frame, name).unwrap_or(own)
    }

    fn setting(&self, name: &str) -> Option<&'a Binding> {
        self.shared.settings.get(name).copied()
    }

    /// The value of `seed` in a script that does not declare it.
    pub fn implicit_seed(&self) -> Option<Rc<Meaning>> {
        if let Some(value) = self.script.case.get("seed") {
            return Some(Rc::clone(value));
        }
        match self.setting("seed") {
            Some(setting) => self.evaluate(&setting.value),
            None => Some(Rc::new(Meaning::Real(Real::plain(1.0)))),
        }
    }

    /// All parameters with their values, checked against what the command line says.
    pub fn parameters(&self) -> Vec<Parameter> {
        self.check_settings();
        let all = self.shared.script.parameters.iter();
        let (own, of_parts): (Vec<&Placed<&Binding>>, Vec<&Placed<&Binding>>) =
            all.partition(|it| it.frame == FrameId::SCRIPT);
        of_parts.into_iter().for_each(|it| self.at(it.frame).parameter_of_part(it.part));
        let mut parameters: Vec<_> = own.into_iter().filter_map(|it| self.parameter(it.part)).collect();
        if self.look_up("seed").is_none() {
            let set = self.setting("seed");
            let value = match (set, self.implicit_seed()) {
                (Some(setting), Some(value)) => {
                    let plain = Meaning::Real(Real::plain(1.0));
                    self.check_kind((&setting.name.text, setting.value.span), &value, &plain);
                    typed_again(&value)
                }
                (None, Some(value)) => typed_again(&value),
                (_, None) => None,
            };
            let set = set.is_some() && !self.script.case.contains_key("seed");
            parameters.extend(value.map(|value| Parameter { name: "seed".to_owned(), value, set }));
        }
        parameters
    }

    fn parameter(&self, parameter: &'a Binding) -> Option<Parameter> {
        let setting = self.setting(&parameter.name.text);
        let value = self.binding(parameter, self.assigned(parameter));
        if let Some(setting) = setting {
            let declared = self.evaluate(&parameter.value);
            if let (Some(value), Some(declared)) = (&value, &declared)
                && !self.check_kind((&setting.name.text, setting.value.span), value, declared)
            {
                self.forget(parameter);
                return None;
            }
        }
        let (value, place) = (value?, self.assigned(parameter).part.span);
        match typed_again(&value) {
            Some(value) => {
                let name = parameter.name.text.clone();
                let set = setting.is_some() && !self.script.case.contains_key(name.as_str());
                Some(Parameter { name, value, set })
            }
            None => self.refuse(self.must_be_known(place)),
        }
    }

    fn check_settings(&self) {
        for setting in self.request.settings {
            let name = setting.name.text.as_str();
            let declared = self.look_up(name).map(|found| found.part);
            if name == "seed" || matches!(declared, Some(Declaration::Parameter(_))) {
                continue;
            }
            self.report(self.no_parameter(&setting.name));
        }
    }

    /// A parameter of a part, whose value is known before the run and of the kind of its own value.
    fn parameter_of_part(&self, parameter: &'a Binding) {
        let assigned = self.assigned(parameter);
        let value = self.binding(parameter, assigned);
        if let (true, Some(value)) = (assigned.frame != self.frame(), &value)
            && let Some(declared) = self.evaluate(&parameter.value)
        {
            let fits = self.check_kind((&parameter.name.text, assigned.part.span), value, &declared);
            if !fits {
                self.forget(parameter);
            }
        }
        if value.is_some_and(|value| typed_again(&value).is_none()) {
            self.report(self.must_be_known(assigned.part.span));
        }
    }

    /// Whether a value may replace a parameter's own; if not, this is reported.
    pub fn check_kind(&self, (name, place): (&str, Span), value: &Meaning, declared: &Meaning) -> bool {
        if alike(value, declared) {
            return true;
        }
        let shown = |meaning: &Meaning| match meaning {
            Meaning::Real(value) => match value.measure {
                Measure::Known(dimension) => quantity(dimension),
                Measure::Undeclared => meaning.kind().to_owned(),
            },
            Meaning::List(elements) => format!("a list of {}", elements.len()),
            other => other.kind().to_owned(),
        };
        let message = format!("`{name}` cannot be set to this: its own value is {}", shown(declared));
        let error = Diagnostic::error("E37", place, message).saying(shown(value));
        let example = typed_again(declared).unwrap_or_default();
        self.report(error.help(format!("write a value of the same kind, for example `{name} = {example}`")));
        false
    }
}

/// Whether a value may replace another: same type, dimension and length.
fn alike(value: &Meaning, declared: &Meaning) -> bool {
    match (value, declared) {
        (Meaning::Real(value), Meaning::Real(declared)) => value.measure == declared.measure,
        (Meaning::List(values), Meaning::List(declared)) => {
            values.len() == declared.len()
                && values.iter().zip(declared).all(|(value, declared)| alike(value, declared))
        }
        (Meaning::Text(Text::File(_)), Meaning::Text(Text::File(_)))
        | (Meaning::Text(Text::Literal(_)), Meaning::Text(Text::Literal(_)))
        | (Meaning::Condition(_), Meaning::Condition(_)) => true,
        _ => false,
    }
}

/// A value as it can be typed; `None` if it is not known before the run.
fn typed_again(value: &Meaning) -> Option<String> {
    match value {
        Meaning::Real(value) => number(value),
        Meaning::Condition(Condition::Plain(BooleanExpression::Constant(value), _)) => Some(value.to_string()),
        Meaning::Condition(condition) => match condition.boolean() {
            Ok(BooleanExpression::Constant(value)) => Some(value.to_string()),
            _ => None,
        },
        Meaning::Text(Text::Literal(text)) => Some(spelling::text(text)),
        Meaning::Text(Text::File(file)) => Some(format!("file({})", spelling::text(&file.path))),
        Meaning::List(elements) => {
            let elements: Option<Vec<_>> = elements.iter().map(|element| typed_again(element)).collect();
            Some(format!("[{}]", elements?.join(", ")))
        }
        Meaning::Integer(_) | Meaning::Item(_) | Meaning::Text(Text::Port(_)) | Meaning::Group(_) => None,
    }
}

fn number(value: &Real) -> Option<String> {
    let si = value.constant()?;
    let (number, unit) = match (value.origin, &value.unit, value.measure) {
        (Origin::Literal { number, .. }, Some(unit), _) => (number, unit.spelt.clone()),
        (_, _, Measure::Known(dimension)) => (si, si_name(dimension)),
        (_, _, Measure::Undeclared) => (si, String::new()),
    };
    Some(match unit.as_str() {
        "" => number.to_string(),
        unit => format!("{number} {}", spelling::unit(unit)),
    })
}
