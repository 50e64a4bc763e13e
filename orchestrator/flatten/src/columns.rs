//! The metadata of each recorded column, from the scenario and the descriptions of its units.

use crate::values::ValueType;
use dsl::scenario::{Column, ColumnSource, Scenario};
use fmi2::description::{Kind, ModelDescription, Variable};
use results::signals::{Due, Signal, SlotType, time};

/// The signals of a scenario's columns, in their order; `description_of` returns the description of an instance.
pub fn of<'a>(
    scenario: &'a Scenario,
    description_of: impl Fn(usize) -> &'a ModelDescription,
) -> impl Iterator<Item = Signal<'a>> {
    scenario.columns.iter().map(move |column| match &column.source {
        ColumnSource::Port(port) => {
            let (instance, description) = (&scenario.instances[port.instance].name, description_of(port.instance));
            signal(column, instance, (description, &description.variables[port.variable]))
        }
        ColumnSource::Real { unit, .. } => of_script(column, ("Real", SlotType::Real), unit),
        ColumnSource::Condition(_) => of_script(column, ("Boolean", SlotType::Boolean), ""),
    })
}

/// The signal of a `let`.
fn of_script<'a>(column: &'a Column, (kind, slot_type): (&'static str, SlotType), unit: &'a str) -> Signal<'a> {
    Signal {
        name: &column.name,
        unit: Some(unit).filter(|unit| !unit.is_empty()),
        kind,
        causality: "local",
        description: None,
        slot_type,
        due: due(column),
        ..time()
    }
}

fn signal<'a>(
    column: &'a Column,
    instance: &'a str,
    (description, variable): (&'a ModelDescription, &'a Variable),
) -> Signal<'a> {
    Signal {
        name: &column.name,
        unit: description.unit_of(variable),
        instance: Some(instance),
        variable: Some(&variable.name),
        kind: kind_name(variable),
        causality: variable.causality.name(),
        description: variable.description.as_deref(),
        items: description.items_of(variable).iter().map(|item| (item.value, item.name.as_str())).collect(),
        slot_type: slot_type(ValueType::of(variable)),
        due: due(column),
    }
}

fn due(column: &Column) -> Due {
    Due { every: column.every, from_tick: column.from_tick }
}

fn kind_name(variable: &Variable) -> &'static str {
    match variable.kind {
        Kind::Real(_) => "Real",
        Kind::Integer { .. } => "Integer",
        Kind::Boolean { .. } => "Boolean",
        Kind::String { .. } => "String",
        Kind::Enumeration { .. } => "Enumeration",
    }
}

fn slot_type(value_type: ValueType) -> SlotType {
    match value_type {
        ValueType::Real => SlotType::Real,
        ValueType::Integer => SlotType::Integer,
        ValueType::Boolean => SlotType::Boolean,
        ValueType::Text => unreachable!("the resolver admits no column of strings"),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]
mod tests {
    use super::*;
    use dsl::scenario::{Instance, Port, Unit};
    use results::signals::{csv_columns, json};

    const DESCRIPTION: &[u8] = br#"<fmiModelDescription fmiVersion="2.0" modelName="q" guid="g">
      <CoSimulation modelIdentifier="q"/>
      <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>
      <TypeDefinitions><SimpleType name="Method"><Enumeration>
        <Item name="grid" value="1"/><Item name="ant_colony" value="2"/>
      </Enumeration></SimpleType></TypeDefinitions>
      <ModelVariables>
        <ScalarVariable name="height" valueReference="0" causality="output" description="Height over ground">
          <Real unit="m"/>
        </ScalarVariable>
        <ScalarVariable name="method" valueReference="1" causality="output" variability="discrete">
          <Enumeration declaredType="Method"/>
        </ScalarVariable>
      </ModelVariables>
      <ModelStructure/>
    </fmiModelDescription>"#;

    #[test]
    fn each_column_has_unit_instance_causality_description_and_items() {
        let column = |(name, variable): (&str, usize)| Column::of_port(name, Port { instance: 0, variable });
        let scenario = Scenario {
            title: "Quadcopter flies".to_owned(),
            step_ns: 10_000_000,
            start_tick: 0,
            stop_tick: 9000,
            parameters: vec![],
            sweep: None,
            units: vec![Unit { name: "quadcopter".to_owned() }],
            instances: vec![Instance { name: "quad".to_owned(), unit: 0, every: 1, wave: 0, presets: vec![] }],
            initialization: vec![],
            connections: vec![],
            events: vec![],
            stop_when: None,
            seed: 0,
            conditions: vec![],
            shared: vec![],
            claims: vec![],
            columns: [("quad.height", 0), ("quad.method", 1)].map(column).into(),
        };
        let (description, _) = fmi2::description::read::read(DESCRIPTION).unwrap();
        let signals: Vec<_> = std::iter::once(time()).chain(of(&scenario, |_| &description)).collect();
        insta::assert_snapshot!(json(&signals));
        let types: Vec<_> = csv_columns(&signals).into_iter().map(|column| column.slot_type).collect();
        assert_eq!(types, [SlotType::Real, SlotType::Integer]);
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
