//! Rules for the attributes of a variable: causality, variability, initial, declared type, derivative.

use std::collections::BTreeSet;

use super::{Report, attributes};
use crate::description::{Causality, Initial, Kind, RealVariable, TypeKind, Variability, Variable};

const RULE: &str = "2.2.7";

pub(super) fn check(report: &mut Report) {
    let model = report.model;
    let mut independent: Option<&Variable> = None;
    let states: BTreeSet<usize> = model.variables.iter().filter_map(derivative_of).collect();
    for (index, variable) in model.variables.iter().enumerate() {
        combination(report, variable);
        declared_type(report, variable);
        if let Kind::Real(real) = &variable.kind {
            real_variable(report, variable, real);
        }
        of_model_exchange(report, variable, states.contains(&index));
        report.unique_named(RULE, &format!("a tool of the annotations of `{}`", variable.name), &variable.annotations);
        if variable.causality == Causality::Independent {
            if !matches!(variable.kind, Kind::Real(_)) {
                let message =
                    format!("the independent variable `{}` is {}; expected a Real", variable.name, kind_name(variable));
                report.error(RULE, variable.position, message);
            }
            match independent {
                None => independent = Some(variable),
                Some(first) => {
                    let message =
                        format!("`{}` is independent, and so is `{}`; one at most is", variable.name, first.name);
                    report.error(RULE, variable.position, message);
                }
            }
        }
    }
}

/// The variabilities that the causality may have.
fn variabilities(causality: Causality) -> &'static [Variability] {
    use Variability::{Constant, Continuous, Discrete, Fixed, Tunable};
    match causality {
        Causality::Parameter | Causality::CalculatedParameter => &[Fixed, Tunable],
        Causality::Input => &[Discrete, Continuous],
        Causality::Output => &[Constant, Discrete, Continuous],
        Causality::Local => &[Constant, Fixed, Tunable, Discrete, Continuous],
        Causality::Independent => &[Continuous],
    }
}

/// The values of `initial` that an allowed pair may have; inputs and the independent variable must not have the
/// attribute.
fn initials(causality: Causality, variability: Variability) -> &'static [Initial] {
    use Initial::{Approx, Calculated, Exact};
    match (causality, variability) {
        (Causality::Input | Causality::Independent, _) => &[],
        (Causality::Parameter, _) | (_, Variability::Constant) => &[Exact],
        (Causality::CalculatedParameter, _) | (_, Variability::Fixed | Variability::Tunable) => &[Calculated, Approx],
        (Causality::Output | Causality::Local, _) => &[Calculated, Exact, Approx],
    }
}

/// Checks causality, variability and initial against the table, and whether a start value is present.
fn combination(report: &mut Report, variable: &Variable) {
    let (name, at) = (&variable.name, variable.position);
    let (causality, variability) = (variable.causality, variable.variability);
    let allowed = variabilities(causality);
    if variability == Variability::Continuous && !matches!(variable.kind, Kind::Real(_)) {
        let other = allowed
            .iter()
            .find(|&&variability| variability != Variability::Continuous && variability != Variability::Constant);
        let help = other.map_or(String::new(), |other| format!("; write variability=\"{}\"", other.name()));
        let kind = kind_name(variable);
        let message = format!("`{name}` is {kind}, but only a Real is continuous, which is the default{help}");
        report.error(RULE, at, message);
        return;
    }
    if !allowed.contains(&variability) {
        let message = format!(
            "`{name}` has causality {} and variability {}; expected {}",
            causality.name(),
            variability.name(),
            or(allowed.iter().map(|variability| variability.name()))
        );
        report.error(RULE, at, message);
        return;
    }
    let initials = initials(causality, variability);
    if let Some(initial) = variable.initial.filter(|initial| !initials.contains(initial)) {
        let expected = match initials {
            [] => "none".to_owned(),
            some => or(some.iter().map(|initial| initial.name())),
        };
        let message = format!(
            "`{name}` has initial {}, but for causality {} and variability {} it is {expected}",
            initial.name(),
            causality.name(),
            variability.name()
        );
        report.error(RULE, at, message);
        return;
    }
    start(report, variable);
}

fn start(report: &mut Report, variable: &Variable) {
    let (name, at) = (&variable.name, variable.position);
    let because = match (variable.causality, variable.initial_or_default()) {
        (Causality::Input, _) => "an input",
        (_, Some(Initial::Exact)) => "a variable with initial exact",
        (_, Some(Initial::Approx)) => "a variable with initial approx",
        (_, Some(Initial::Calculated)) if variable.has_start() => {
            report.error(
                RULE,
                at,
                format!("`{name}` has a start value, but with initial calculated it must not have one"),
            );
            return;
        }
        (Causality::Independent, _) if variable.has_start() => {
            report.error(
                RULE,
                at,
                format!("`{name}` has a start value, but the independent variable must not have one"),
            );
            return;
        }
        _ => return,
    };
    if !variable.has_start() {
        let default =
            if variable.causality != Causality::Input && variable.initial.is_none() { " (the default)" } else { "" };
        report.error(RULE, at, format!("`{name}` has no start value; {because}{default} needs one"));
    }
}

fn declared_type(report: &mut Report, variable: &Variable) {
    let (name, at) = (&variable.name, variable.position);
    let Some(declared_name) = &variable.declared_type else {
        if matches!(variable.kind, Kind::Enumeration { .. }) {
            report.error(RULE, at, format!("`{name}` is an Enumeration without declaredType, which lists its items"));
        }
        return;
    };
    let Some(declared) = report.types.get(declared_name.as_str()) else {
        let message = format!("`{name}` has the declaredType `{declared_name}`, which TypeDefinitions does not define");
        report.error(RULE, at, message);
        return;
    };
    let type_kind = match declared.kind {
        TypeKind::Real(_) => "a Real",
        TypeKind::Integer { .. } => "an Integer",
        TypeKind::Boolean => "a Boolean",
        TypeKind::String => "a String",
        TypeKind::Enumeration { .. } => "an Enumeration",
    };
    if type_kind != kind_name(variable) {
        let message =
            format!("`{name}` is {}, but its declaredType `{declared_name}` is {type_kind}", kind_name(variable));
        report.error(RULE, at, message);
    }
}

fn real_variable<'a>(report: &mut Report<'a>, variable: &'a Variable, real: &RealVariable) {
    let (name, at, model) = (&variable.name, variable.position, report.model);
    let what = format!("`{name}`");
    let place = attributes::Place { rule: RULE, position: at, what: &what };
    attributes::check(report, &place, &real.attributes);
    // The unit of an undefined type is unknown.
    let type_is_known = variable.declared_type.as_deref().is_none_or(|declared| report.types.contains_key(declared));
    if type_is_known {
        let inherited = report.unit_of(variable);
        attributes::display_unit(report, &place, &real.attributes, inherited);
    }
    let Some(index) = real.derivative else { return };
    let message = match model.variables.get(index) {
        None => format!(
            "`{name}` is the derivative of variable {}; indices go from 1 to {}",
            index.wrapping_add(1),
            model.variables.len()
        ),
        Some(state) if std::ptr::eq(state, variable) => format!("`{name}` is the derivative of itself"),
        Some(state) if !matches!(state.kind, Kind::Real(_)) || state.variability != Variability::Continuous => {
            format!("`{name}` is the derivative of `{}`, which is no continuous Real", state.name)
        }
        Some(_) => return,
    };
    report.error(RULE, at, message);
}

/// Attributes that are for model exchange, each for one kind of variable.
fn of_model_exchange(report: &mut Report, variable: &Variable, is_state: bool) {
    let (name, at) = (&variable.name, variable.position);
    let reinit = matches!(&variable.kind, Kind::Real(real) if real.reinit.is_some());
    let attributes = [
        ("reinit", reinit, is_state, "no continuous-time state"),
        (
            "canHandleMultipleSetPerTimeInstant",
            variable.can_handle_multiple_set_per_time_instant.is_some(),
            variable.causality == Causality::Input,
            "no input",
        ),
    ];
    for (attribute, _, may_have, kind) in attributes.into_iter().filter(|&(_, is_there, ..)| is_there) {
        if report.model.model_exchange.is_none() {
            report.error(RULE, at, format!("`{name}` has {attribute}, but the unit has no ModelExchange"));
        } else if !may_have {
            report.error(RULE, at, format!("`{name}` has {attribute}, but is {kind}"));
        }
    }
}

/// The index of the variable whose derivative this is.
fn derivative_of(variable: &Variable) -> Option<usize> {
    match &variable.kind {
        Kind::Real(real) => real.derivative,
        _ => None,
    }
}

fn kind_name(variable: &Variable) -> &'static str {
    match variable.kind {
        Kind::Real(_) => "a Real",
        Kind::Integer { .. } => "an Integer",
        Kind::Boolean { .. } => "a Boolean",
        Kind::String { .. } => "a String",
        Kind::Enumeration { .. } => "an Enumeration",
    }
}

/// `a, b or c`.
fn or<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let words: Vec<_> = words.collect();
    match words.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => words.concat(),
    }
}
