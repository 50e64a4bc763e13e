//! Reads `UnitDefinitions`, `TypeDefinitions` and the attributes that types share with variables.

use super::element::Element;
use crate::description::{DisplayUnit, Item, RealAttributes, SimpleType, TypeKind, UnitDefinition};
use crate::units::{BaseUnit, Dimension};

pub(super) fn units(element: &Element) -> Vec<UnitDefinition> {
    element.items("2.2.2", "Unit", |element| Some(unit(element)))
}

fn unit(element: &Element) -> UnitDefinition {
    element.expect_attributes("2.2.2", &["name"]);
    let mut unit =
        UnitDefinition { position: element.position(), name: element.text_or_empty("name"), ..Default::default() };
    for child in element.children() {
        match child.name() {
            "BaseUnit" if unit.base.is_some() => {
                child.error("2.2.2", format!("the unit `{}` has a second `BaseUnit`; the first one counts", unit.name));
            }
            "BaseUnit" => unit.base = Some(base_unit(&child)),
            "DisplayUnit" => unit.display_units.push(display_unit(&child)),
            _ => child.unknown("2.2.2", "Unit"),
        }
    }
    unit
}

fn base_unit(element: &Element) -> BaseUnit {
    let mut known = Dimension::BASE_NAMES.to_vec();
    known.extend(["factor", "offset"]);
    element.expect_attributes("2.2.2", &known);
    let exponents = Dimension::BASE_NAMES.map(|name| element.number("2.2.2", name).unwrap_or(0));
    BaseUnit {
        dimension: Dimension(exponents),
        factor: element.number("2.2.2", "factor").unwrap_or(1.0),
        offset: element.number("2.2.2", "offset").unwrap_or(0.0),
    }
}

fn display_unit(element: &Element) -> DisplayUnit {
    element.expect_attributes("2.2.2", &["name", "factor", "offset"]);
    DisplayUnit {
        position: element.position(),
        name: element.text_or_empty("name"),
        factor: element.number("2.2.2", "factor").unwrap_or(1.0),
        offset: element.number("2.2.2", "offset").unwrap_or(0.0),
    }
}

pub(super) fn simple_types(element: &Element) -> Vec<SimpleType> {
    element.items("2.2.3", "SimpleType", simple_type)
}

fn simple_type(element: &Element) -> Option<SimpleType> {
    element.expect_attributes("2.2.3", &["name", "description"]);
    let name = element.text_or_empty("name");
    let mut kinds = element.children().filter_map(|child| {
        let kind = type_kind(&child);
        if kind.is_none() {
            child.unknown("2.2.3", "SimpleType");
        }
        kind
    });
    let kind = kinds.next();
    if kind.is_none() || kinds.next().is_some() {
        let found = if kind.is_none() { "none" } else { "several" };
        let kinds = "Real, Integer, Boolean, String or Enumeration";
        element.error("2.2.3", format!("the type `{name}` needs one element {kinds}; found {found}"));
    }
    Some(SimpleType { position: element.position(), name, description: element.text("description"), kind: kind? })
}

fn type_kind(element: &Element) -> Option<TypeKind> {
    Some(match element.name() {
        "Real" => {
            element.expect_attributes("2.2.3", &REAL_ATTRIBUTES);
            TypeKind::Real(real_attributes(element, "2.2.3"))
        }
        "Integer" => {
            element.expect_attributes("2.2.3", &["quantity", "min", "max"]);
            TypeKind::Integer { min: element.number("2.2.3", "min"), max: element.number("2.2.3", "max") }
        }
        "Boolean" => TypeKind::Boolean,
        "String" => TypeKind::String,
        "Enumeration" => {
            element.expect_attributes("2.2.3", &["quantity"]);
            TypeKind::Enumeration { quantity: element.text("quantity"), items: element.each("2.2.3", "Item", item) }
        }
        _ => return None,
    })
}

fn item(element: &Element) -> Option<Item> {
    element.expect_attributes("2.2.3", &["name", "value", "description"]);
    if element.attribute("value").is_none() {
        element.missing("2.2.3", "value");
    }
    Some(Item {
        position: element.position(),
        name: element.text_or_empty("name"),
        value: element.number("2.2.3", "value")?,
        description: element.text("description"),
    })
}

/// The attributes that a Real type and a Real variable share.
pub(super) const REAL_ATTRIBUTES: [&str; 8] =
    ["quantity", "unit", "displayUnit", "relativeQuantity", "min", "max", "nominal", "unbounded"];

pub(super) fn real_attributes(element: &Element, rule: &'static str) -> RealAttributes {
    RealAttributes {
        quantity: element.text("quantity"),
        unit: element.text("unit"),
        display_unit: element.text("displayUnit"),
        relative_quantity: element.boolean(rule, "relativeQuantity"),
        min: element.number(rule, "min"),
        max: element.number(rule, "max"),
        nominal: element.number(rule, "nominal"),
        unbounded: element.boolean(rule, "unbounded").unwrap_or(false),
    }
}
