//! Tests of the writer: the form of the file, and that a written description reads back equal.

use proptest::option::of;
use proptest::prelude::*;
use proptest::sample::select;

use super::*;
use crate::description::ModelExchange;
use crate::description::read::read;
use crate::description::{
    Causality, DependencyKind, DisplayUnit, Initial, Item, LogCategory, ModelStructure, NamingConvention, Position,
    RealVariable, Variability,
};

/// The same description without positions, as if it had not been read from a file.
pub(in crate::description) fn without_positions(mut model: ModelDescription) -> ModelDescription {
    let none = Position::default();
    model.position = none;
    model.structure.position = none;
    model.co_simulation.iter_mut().for_each(|unit| unit.position = none);
    model.default_experiment.iter_mut().for_each(|experiment| experiment.position = none);
    model.log_categories.iter_mut().for_each(|category| category.position = none);
    for unit in &mut model.units {
        unit.position = none;
        unit.display_units.iter_mut().for_each(|display| display.position = none);
    }
    for declared in &mut model.types {
        declared.position = none;
        if let TypeKind::Enumeration { items, .. } = &mut declared.kind {
            items.iter_mut().for_each(|item| item.position = none);
        }
    }
    let interfaces = [
        model.co_simulation.as_mut().map(|unit| &mut unit.source_files),
        model.model_exchange.as_mut().map(|unit| &mut unit.source_files),
    ];
    let lists = interfaces.into_iter().flatten().chain([&mut model.vendor_annotations]);
    lists.flatten().for_each(|element| element.position = none);
    model.model_exchange.iter_mut().for_each(|unit| unit.position = none);
    for variable in &mut model.variables {
        variable.position = none;
        variable.annotations.iter_mut().for_each(|element| element.position = none);
    }
    let ModelStructure { outputs, derivatives, initial_unknowns, .. } = &mut model.structure;
    outputs.iter_mut().chain(derivatives).chain(initial_unknowns).for_each(|unknown| unknown.position = none);
    model
}

#[test]
fn the_written_file_has_the_order_of_the_schema_and_no_empty_lists() {
    let good = include_str!("../../../corpus/description/tank.xml");
    let (model, _) = read(good.as_bytes()).unwrap();
    insta::assert_snapshot!(write(&model));
    insta::assert_snapshot!(write(&ModelDescription::default()));
}

#[test]
fn characters_that_xml_reserves_are_escaped_and_read_back_equal() {
    let model = ModelDescription {
        model_name: "a<b> & \"c\" 'd'\n\te\r ü €".to_owned(),
        guid: "bell \u{7}".to_owned(),
        ..ModelDescription::default()
    };
    let (again, _) = read(write(&model).as_bytes()).unwrap();
    assert_eq!(again.model_name, model.model_name);
    assert_eq!(again.guid, "bell \u{FFFD}");
}

#[test]
fn numbers_are_written_in_their_shortest_exact_form() {
    let numbers = [0.1, 1.0, -0.0, 1e300, 1e-7, 0.1 + 0.2, f64::MAX, 5e-324, f64::INFINITY, f64::NEG_INFINITY];
    let shown = numbers.map(|number| {
        let experiment = DefaultExperiment { start_time: Some(number), ..DefaultExperiment::default() };
        let model = ModelDescription { default_experiment: Some(experiment), ..ModelDescription::default() };
        let written = write(&model);
        let again = read(written.as_bytes()).unwrap().0.default_experiment.unwrap().start_time.unwrap();
        assert_eq!(again.to_bits(), number.to_bits());
        written.split("startTime=\"").nth(1).unwrap().split('"').next().unwrap().to_owned()
    });
    let expected = "0.1 1.0 -0.0 1e300 1e-7 0.30000000000000004 1.7976931348623157e308 5e-324 INF -INF";
    assert_eq!(shown.join(" "), expected);
}

/// Any text that XML can hold.
fn text() -> impl Strategy<Value = String> {
    "[a-zA-Zäß€<>&\"' \t\n\r\\[\\].{}%#]{0,8}"
}

fn number() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("a number", |number| !number.is_nan())
}

fn real_attributes() -> impl Strategy<Value = RealAttributes> {
    let texts = (of(text()), of(text()), of(text()));
    (texts, any::<(Option<bool>, bool)>(), of(number()), of(number()), of(number())).prop_map(
        |((quantity, unit, display_unit), (relative_quantity, unbounded), min, max, nominal)| RealAttributes {
            quantity,
            unit,
            display_unit,
            relative_quantity,
            min,
            max,
            nominal,
            unbounded,
        },
    )
}

fn kind() -> impl Strategy<Value = Kind> {
    let real = (of(number()), of(0..9_usize), any::<Option<bool>>(), real_attributes()).prop_map(
        |(start, derivative, reinit, attributes)| Kind::Real(RealVariable { start, derivative, reinit, attributes }),
    );
    let whole = any::<(Option<i32>, Option<i32>, Option<i32>)>;
    prop_oneof![
        real,
        whole().prop_map(|(start, min, max)| Kind::Integer { start, min, max }),
        whole().prop_map(|(start, min, max)| Kind::Enumeration { start, min, max }),
        any::<Option<bool>>().prop_map(|start| Kind::Boolean { start }),
        of(text()).prop_map(|start| Kind::String { start }),
    ]
}

fn variable() -> impl Strategy<Value = Variable> {
    let table = (select(&Causality::ALL), select(&Variability::ALL), of(select(&Initial::ALL)));
    let rare = (any::<Option<bool>>(), names());
    (text(), any::<u32>(), of(text()), table, rare, of(text()), kind()).prop_map(
        |(name, value_reference, description, (causality, variability, initial), rare, declared_type, kind)| Variable {
            position: Position::default(),
            name,
            value_reference,
            description,
            causality,
            variability,
            initial,
            can_handle_multiple_set_per_time_instant: rare.0,
            annotations: rare.1,
            declared_type,
            kind,
        },
    )
}

fn type_kind() -> impl Strategy<Value = TypeKind> {
    let item = (text(), any::<i32>(), of(text()));
    let item =
        item.prop_map(|(name, value, description)| Item { position: Position::default(), name, value, description });
    let items = (of(text()), prop::collection::vec(item, 1..4));
    prop_oneof![
        real_attributes().prop_map(TypeKind::Real),
        any::<(Option<i32>, Option<i32>)>().prop_map(|(min, max)| TypeKind::Integer { min, max }),
        Just(TypeKind::Boolean),
        Just(TypeKind::String),
        items.prop_map(|(quantity, items)| TypeKind::Enumeration { quantity, items }),
    ]
}

fn simple_type() -> impl Strategy<Value = SimpleType> {
    (text(), of(text()), type_kind()).prop_map(|(name, description, kind)| SimpleType {
        position: Position::default(),
        name,
        description,
        kind,
    })
}

fn unit() -> impl Strategy<Value = UnitDefinition> {
    let base = (any::<[i8; 8]>(), number(), number());
    let base =
        base.prop_map(|(exponents, factor, offset)| BaseUnit { dimension: Dimension(exponents), factor, offset });
    let display = (text(), number(), number());
    let display =
        display.prop_map(|(name, factor, offset)| DisplayUnit { name, factor, offset, ..DisplayUnit::default() });
    (text(), of(base), prop::collection::vec(display, 0..3)).prop_map(|(name, base, display_units)| UnitDefinition {
        position: Position::default(),
        name,
        base,
        display_units,
    })
}

fn unknowns() -> impl Strategy<Value = Vec<Unknown>> {
    let kinds = of(prop::collection::vec(select(&DependencyKind::ALL), 0..3));
    let unknown = (prop_oneof![0..9_usize, Just(usize::MAX)], of(prop::collection::vec(0..9_usize, 0..3)), kinds);
    let unknown = unknown.prop_map(|(index, dependencies, dependencies_kind)| Unknown {
        position: Position::default(),
        index,
        dependencies,
        dependencies_kind,
    });
    prop::collection::vec(unknown, 0..3)
}

fn names() -> impl Strategy<Value = Vec<Named>> {
    prop::collection::vec(text().prop_map(|name| Named { position: Position::default(), name }), 0..3)
}

fn co_simulation() -> impl Strategy<Value = CoSimulation> {
    (text(), any::<[bool; 9]>(), any::<u32>(), names()).prop_map(
        |(model_identifier, flags, max_output_derivative_order, source_files)| CoSimulation {
            position: Position::default(),
            model_identifier,
            needs_execution_tool: flags[0],
            can_handle_variable_communication_step_size: flags[1],
            can_interpolate_inputs: flags[2],
            max_output_derivative_order,
            can_run_asynchronuously: flags[3],
            can_be_instantiated_only_once_per_process: flags[4],
            can_not_use_memory_management_functions: flags[5],
            can_get_and_set_fmu_state: flags[6],
            can_serialize_fmu_state: flags[7],
            provides_directional_derivative: flags[8],
            source_files,
        },
    )
}

fn header() -> impl Strategy<Value = ModelDescription> {
    let texts = prop::collection::vec(of(text()), 8);
    let naming = select(vec![NamingConvention::Flat, NamingConvention::Structured]);
    let model_exchange = (text(), names()).prop_map(|(model_identifier, source_files)| ModelExchange {
        position: Position::default(),
        model_identifier,
        source_files,
    });
    (text(), text(), texts, naming, of(model_exchange), of(co_simulation())).prop_map(
        |(model_name, guid, texts, variable_naming_convention, model_exchange, co_simulation)| {
            let mut texts = texts.into_iter().flatten();
            ModelDescription {
                fmi_version: "2.0".to_owned(),
                model_name,
                guid,
                description: texts.next(),
                author: texts.next(),
                version: texts.next(),
                copyright: texts.next(),
                license: texts.next(),
                generation_tool: texts.next(),
                generation_date_and_time: texts.next(),
                number_of_event_indicators: texts.next(),
                variable_naming_convention,
                model_exchange,
                co_simulation,
                ..ModelDescription::default()
            }
        },
    )
}

fn lists() -> impl Strategy<Value = ModelDescription> {
    let experiment = any::<[Option<f64>; 4]>().prop_filter("numbers", |all| all.iter().flatten().all(|n| !n.is_nan()));
    let categories = prop::collection::vec((text(), of(text())), 0..3);
    let few = (prop::collection::vec(unit(), 0..3), prop::collection::vec(simple_type(), 0..3));
    let structure = (unknowns(), unknowns(), unknowns());
    (few, categories, of(experiment), names(), prop::collection::vec(variable(), 0..4), structure).prop_map(
        |((units, types), categories, experiment, vendor_annotations, variables, structure)| ModelDescription {
            units,
            types,
            log_categories: categories
                .into_iter()
                .map(|(name, description)| LogCategory { position: Position::default(), name, description })
                .collect(),
            default_experiment: experiment.map(|[start_time, stop_time, tolerance, step_size]| DefaultExperiment {
                position: Position::default(),
                start_time,
                stop_time,
                tolerance,
                step_size,
            }),
            vendor_annotations,
            variables,
            structure: ModelStructure {
                position: Position::default(),
                outputs: structure.0,
                derivatives: structure.1,
                initial_unknowns: structure.2,
            },
            ..ModelDescription::default()
        },
    )
}

proptest! {
    #[test]
    fn every_written_description_reads_back_equal(header in header(), lists in lists()) {
        let ModelDescription { units, types, log_categories, default_experiment, .. } = lists;
        let ModelDescription { vendor_annotations, variables, structure, .. } = lists;
        let model = ModelDescription {
            units, types, log_categories, default_experiment, vendor_annotations, variables, structure, ..header
        };
        let (again, findings) = read(write(&model).as_bytes()).expect("what was written can be read");
        prop_assert_eq!(findings, []);
        prop_assert_eq!(without_positions(again), model);
    }
}
