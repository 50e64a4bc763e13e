//! `signals.json`: what each column of the trace is, so that a reader needs no unit and no script.

use super::csv::CsvColumn;
use dsl::scenario::{Column, Scenario};
use fmi2::description::{BaseType, ModelDescription, Variable};
use serde::Serialize;
use std::collections::BTreeMap;

/// One column of the trace.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Signal<'a> {
    /// The name in the trace's header.
    pub name: &'a str,
    /// Its unit of measure, as its FMU names it.
    pub unit: Option<&'a str>,
    /// The instance; `None` for `time`.
    pub instance: Option<&'a str>,
    /// The variable's name in its FMU; `None` for `time`.
    pub variable: Option<&'a str>,
    /// `Real`, `Integer`, `Boolean` or `Enumeration`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// `output`, `input`, …
    pub causality: &'static str,
    /// The FMU's words.
    pub description: Option<&'a str>,
    /// The names of an enumeration's numbers.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub items: BTreeMap<i32, &'a str>,
    /// How its slots are read.
    #[serde(skip)]
    pub base_type: BaseType,
}

impl Signal<'_> {
    /// What there is to say besides the name, as keys and texts.
    #[must_use]
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let items = (!self.items.is_empty()).then(|| serde_json::json!(self.items).to_string());
        let facts = [
            ("unit", self.unit),
            ("instance", self.instance),
            ("variable", self.variable),
            ("type", Some(self.kind)),
            ("causality", Some(self.causality)),
            ("description", self.description),
            ("items", items.as_deref()),
        ];
        facts.into_iter().filter_map(|(key, fact)| Some((key, fact?.to_owned()))).collect()
    }
}

/// The columns of a scenario's trace, `time` first; `description_of` hands out the description of an instance.
pub fn of<'a>(scenario: &'a Scenario, description_of: impl Fn(usize) -> &'a ModelDescription) -> Vec<Signal<'a>> {
    let time = Signal {
        name: "time",
        unit: Some("s"),
        instance: None,
        variable: None,
        kind: "Real",
        causality: "independent",
        description: Some("Simulated time"),
        items: BTreeMap::new(),
        base_type: BaseType::Real,
    };
    std::iter::once(time).chain(of_columns(scenario, description_of)).collect()
}

/// What the columns of a scenario are, in their order.
pub fn of_columns<'a>(
    scenario: &'a Scenario,
    description_of: impl Fn(usize) -> &'a ModelDescription,
) -> impl Iterator<Item = Signal<'a>> {
    scenario.columns.iter().map(move |column| {
        signal(column, &scenario.instances[column.port.instance].name, description_of(column.port.instance))
    })
}

/// The text of the file.
#[must_use]
pub fn json(signals: &[Signal<'_>]) -> String {
    super::json_text(&signals)
}

/// The columns as `trace.csv` needs them: it has the time anyway.
#[must_use]
pub fn csv_columns(signals: &[Signal<'_>]) -> Vec<CsvColumn> {
    let column = |signal: &Signal<'_>| CsvColumn { name: signal.name.to_owned(), base_type: signal.base_type };
    signals.iter().skip(1).map(column).collect()
}

fn signal<'a>(column: &'a Column, instance: &'a str, description: &'a ModelDescription) -> Signal<'a> {
    let variable = &description.variables[column.port.variable];
    Signal {
        name: &column.name,
        unit: description.unit_of(variable),
        instance: Some(instance),
        variable: Some(&variable.name),
        kind: kind_name(variable),
        causality: variable.causality.name(),
        description: variable.description.as_deref(),
        items: description.items_of(variable).iter().map(|item| (item.value, item.name.as_str())).collect(),
        base_type: variable.base_type(),
    }
}

fn kind_name(variable: &Variable) -> &'static str {
    use fmi2::description::Kind;
    match variable.kind {
        Kind::Real(_) => "Real",
        Kind::Integer { .. } => "Integer",
        Kind::Boolean { .. } => "Boolean",
        Kind::String { .. } => "String",
        Kind::Enumeration { .. } => "Enumeration",
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::trace::verdict::tests::scenario;
    use dsl::scenario::Port;
    use fmi2::description::{Causality, Item, Kind, RealAttributes, RealVariable, SimpleType, TypeKind};
    use fmi2::description::{Position, Variability};

    /// A column that says no more than it must.
    pub(crate) fn signal(name: &str, base_type: BaseType) -> Signal<'_> {
        Signal {
            name,
            unit: None,
            instance: None,
            variable: None,
            kind: "Real",
            causality: "output",
            description: None,
            items: BTreeMap::new(),
            base_type,
        }
    }

    fn variable(name: &str, kind: Kind) -> Variable {
        Variable {
            position: Position::default(),
            name: name.to_owned(),
            value_reference: 0,
            description: None,
            causality: Causality::Output,
            variability: Variability::Continuous,
            initial: None,
            declared_type: None,
            kind,
        }
    }

    /// Of a unit with a `height` and a `method`.
    pub(crate) fn description() -> ModelDescription {
        let attributes = RealAttributes { unit: Some("m".to_owned()), ..RealAttributes::default() };
        let mut height = variable("height", Kind::Real(RealVariable { attributes, ..RealVariable::default() }));
        height.description = Some("Height over ground".to_owned());
        let mut method = variable("method", Kind::Enumeration { start: None, min: None, max: None });
        method.declared_type = Some("Method".to_owned());
        let item =
            |name: &str, value| Item { name: name.to_owned(), value, description: None, position: Position::default() };
        let items = vec![item("grid", 1), item("ant_colony", 2)];
        let types = vec![SimpleType {
            position: Position::default(),
            name: "Method".to_owned(),
            description: None,
            kind: TypeKind::Enumeration { quantity: None, items },
        }];
        ModelDescription { variables: vec![height, method], types, ..ModelDescription::default() }
    }

    #[test]
    fn each_column_tells_unit_instance_causality_description_and_items() {
        let mut scenario = scenario();
        for (name, variable) in [("quad.height", 0), ("quad.method", 1)] {
            scenario.columns.push(Column { name: name.to_owned(), port: Port { instance: 0, variable } });
        }
        let description = description();
        let signals = of(&scenario, |_| &description);
        insta::assert_snapshot!(json(&signals));
        let types: Vec<_> = csv_columns(&signals).into_iter().map(|column| column.base_type).collect();
        assert_eq!(types, [BaseType::Real, BaseType::Integer]);
        let facts: Vec<_> = signals[2].facts().into_iter().map(|(key, fact)| format!("{key}: {fact}")).collect();
        assert_eq!(
            facts,
            [
                "instance: quad",
                "variable: method",
                "type: Enumeration",
                "causality: output",
                r#"items: {"1":"grid","2":"ant_colony"}"#
            ]
        );
    }
}
