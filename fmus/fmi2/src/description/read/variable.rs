//! Reads `ModelVariables`. A variable is never left out, even if invalid, because indices refer to its position.

use super::element::{Element, from_one};
use super::header::named;
use super::types::{REAL_ATTRIBUTES, real_attributes};
use crate::description::{Causality, Initial, Kind, RealVariable, Variability, Variable};

const RULE: &str = "2.2.7";

pub(super) fn variables(element: &Element) -> Vec<Variable> {
    element.each(RULE, "ScalarVariable", |element| Some(variable(element)))
}

fn variable(element: &Element) -> Variable {
    element.expect_attributes(
        RULE,
        &[
            "name",
            "valueReference",
            "description",
            "causality",
            "variability",
            "initial",
            "canHandleMultipleSetPerTimeInstant",
        ],
    );
    if element.attribute("valueReference").is_none() {
        element.missing(RULE, "valueReference");
    }
    let name = element.text_or_empty("name");
    let (mut kind, mut declared_type, mut annotations) = (None, None, Vec::new());
    for child in element.children() {
        match self::kind(&child) {
            Some(_) if kind.is_some() => {
                child.error(RULE, format!("`{name}` has a second type, `{}`; the first one counts", child.name()));
            }
            Some(read) => {
                kind = Some(read);
                declared_type = child.text("declaredType");
            }
            None if child.name() == "Annotations" => annotations.extend(child.items(RULE, "Tool", named)),
            None => child.unknown(RULE, "ScalarVariable"),
        }
    }
    let kind = kind.unwrap_or_else(|| {
        let kinds = "Real, Integer, Boolean, String or Enumeration";
        element.error(RULE, format!("`{name}` has no type; expected an element {kinds}. It is read as Real"));
        Kind::Real(RealVariable::default())
    });
    Variable {
        position: element.position(),
        name,
        value_reference: element.number(RULE, "valueReference").unwrap_or(u32::MAX),
        description: element.text("description"),
        causality: element.choice(RULE, "causality", &Causality::ALL, Causality::name).unwrap_or_default(),
        variability: element.choice(RULE, "variability", &Variability::ALL, Variability::name).unwrap_or_default(),
        initial: element.choice(RULE, "initial", &Initial::ALL, Initial::name),
        can_handle_multiple_set_per_time_instant: element.boolean(RULE, "canHandleMultipleSetPerTimeInstant"),
        annotations,
        declared_type,
        kind,
    }
}

fn kind(element: &Element) -> Option<Kind> {
    let whole = |name| element.number::<i32>(RULE, name);
    let expect = |known: &[&str]| element.expect_attributes(RULE, known);
    Some(match element.name() {
        "Real" => {
            let own = ["declaredType", "start", "derivative", "reinit"];
            expect(&[REAL_ATTRIBUTES.as_slice(), own.as_slice()].concat());
            Kind::Real(RealVariable {
                start: element.number(RULE, "start"),
                derivative: element.number(RULE, "derivative").map(from_one),
                reinit: element.boolean(RULE, "reinit"),
                attributes: real_attributes(element, RULE),
            })
        }
        "Integer" => {
            expect(&["declaredType", "quantity", "min", "max", "start"]);
            Kind::Integer { start: whole("start"), min: whole("min"), max: whole("max") }
        }
        "Enumeration" => {
            expect(&["declaredType", "quantity", "min", "max", "start"]);
            Kind::Enumeration { start: whole("start"), min: whole("min"), max: whole("max") }
        }
        "Boolean" => {
            expect(&["declaredType", "start"]);
            Kind::Boolean { start: element.boolean(RULE, "start") }
        }
        "String" => {
            expect(&["declaredType", "start"]);
            Kind::String { start: element.text("start") }
        }
        _ => return None,
    })
}
