//! Builds the model description of a unit from its scalars; the GUID is a hash of the description.

use crate::declaration::{Experiment, Ports, Role};
use crate::library::{Package, scalars};
use crate::log::Category;
use crate::model::Model;
use crate::slots::Slots;
use crate::visitor::{Scalar, ScalarKind, Value};
use fmi2::calls::{Call, Permission, State, permitted};
use fmi2::description::{
    Causality, CoSimulation, DefaultExperiment, DisplayUnit, Initial, Item, Kind, LogCategory, ModelDescription,
    ModelStructure, NamingConvention, Position, RealAttributes, RealVariable, SimpleType, TypeKind, UnitDefinition,
    Unknown, Variability, Variable, write,
};
use fmi2::units;
use twox_hash::XxHash3_128;

/// Everything that follows from a unit's declarations.
#[derive(Debug)]
pub(crate) struct Described {
    pub(crate) xml: String,
    pub(crate) description: ModelDescription,
    pub(crate) slots: Slots,
    /// Indexed by state and number of the call.
    pub(crate) permissions: Vec<[Permission; Call::ALL.len() + 1]>,
}

/// `generationDateAndTime`, the same for all, so that equal sources give equal bytes: the earliest that an archive can say.
const GENERATED: &str = "1980-01-01T00:00:00Z";

/// Describes a model.
pub(crate) fn describe<M: Model>(package: &Package) -> Described {
    let scalars = scalars::<M>();
    let (slots, references) = Slots::of(&scalars, size_of::<M>());
    let mut description = ModelDescription {
        fmi_version: "2.0".to_owned(),
        model_name: M::NAME.unwrap_or(package.identifier).to_owned(),
        description: text(M::DESCRIPTION),
        author: text(&package.authors.replace(':', ", ")),
        version: text(package.version),
        copyright: copyright(package.authors),
        license: text(package.license),
        generation_tool: Some(concat!("Lockstep ", env!("CARGO_PKG_VERSION")).to_owned()),
        generation_date_and_time: Some(GENERATED.to_owned()),
        variable_naming_convention: NamingConvention::Structured,
        co_simulation: Some(capabilities(package)),
        units: unit_definitions(&scalars),
        types: types(&scalars),
        log_categories: Category::ALL.iter().map(|&category| log_category(category)).collect(),
        default_experiment: experiment(<M as Ports>::EXPERIMENT),
        variables: scalars.iter().zip(references).map(|(scalar, reference)| variable(scalar, reference)).collect(),
        structure: structure(&scalars),
        ..ModelDescription::default()
    };
    description.guid = fingerprint(&write::write(&description));
    Described { xml: write::write(&description), description, slots, permissions: permissions() }
}

/// The state table as an array, so that a look-up takes few nanoseconds.
fn permissions() -> Vec<[Permission; Call::ALL.len() + 1]> {
    let row = |state| {
        let mut row = [Permission::No; Call::ALL.len() + 1];
        for call in Call::ALL {
            row[call as usize] = permitted(call, state);
        }
        row
    };
    State::ALL.into_iter().map(row).collect()
}

/// The authors without their addresses; cargo separates them by colons.
fn copyright(authors: &str) -> Option<String> {
    let names: Vec<_> = authors.split(':').filter_map(|author| author.split('<').next()).map(str::trim).collect();
    (!authors.is_empty()).then(|| format!("Copyright {}", names.join(", ")))
}

fn text(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

/// The capabilities of every unit of this export layer.
fn capabilities(package: &Package) -> CoSimulation {
    CoSimulation {
        model_identifier: package.identifier.to_owned(),
        can_handle_variable_communication_step_size: true,
        can_not_use_memory_management_functions: true,
        can_get_and_set_fmu_state: true,
        can_serialize_fmu_state: true,
        ..CoSimulation::default()
    }
}

fn log_category(category: Category) -> LogCategory {
    LogCategory { position: Position::default(), name: category.name().to_owned(), description: None }
}

fn experiment(experiment: Experiment) -> Option<DefaultExperiment> {
    (experiment != Experiment::default()).then_some(DefaultExperiment {
        position: Position::default(),
        start_time: experiment.start,
        stop_time: experiment.stop,
        tolerance: None,
        step_size: experiment.step,
    })
}

/// A hash of 128 bits, formatted as a GUID.
fn fingerprint(text: &str) -> String {
    let digits = format!("{:032x}", XxHash3_128::oneshot(text.as_bytes()));
    format!("{}-{}-{}-{}-{}", &digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..])
}

/// The units that Reals use, each with their display units.
fn unit_definitions(scalars: &[Scalar]) -> Vec<UnitDefinition> {
    let mut definitions: Vec<UnitDefinition> = Vec::new();
    for scalar in scalars {
        let Some(unit) = scalar.declaration.unit else { continue };
        let base = known_unit(unit, scalar);
        let index = definitions.iter().position(|definition| definition.name == unit).unwrap_or_else(|| {
            definitions.push(UnitDefinition { name: unit.to_owned(), base: Some(base), ..Default::default() });
            definitions.len() - 1
        });
        let Some(display) = scalar.declaration.display else { continue };
        let displays = &mut definitions[index].display_units;
        if displays.iter().all(|known| known.name != display) {
            let conversion = base.conversion_to(&known_unit(display, scalar));
            assert!(conversion.is_some(), "`{}` cannot be shown in `{display}`: another dimension", scalar.name);
            let units::Conversion { factor, offset } = conversion.unwrap_or(units::Conversion::IDENTITY);
            displays.push(DisplayUnit { position: Position::default(), name: display.to_owned(), factor, offset });
        }
    }
    definitions
}

fn known_unit(unit: &str, scalar: &Scalar) -> units::BaseUnit {
    match units::parse(unit) {
        Ok(base) => base,
        Err(unknown) => unreachable!("the derive let `{}` pass with a unit nobody knows: {unknown}", scalar.name),
    }
}

/// The enumerations that ports use.
fn types(scalars: &[Scalar]) -> Vec<SimpleType> {
    let mut types: Vec<SimpleType> = Vec::new();
    for scalar in scalars {
        let ScalarKind::Enumeration(enumeration) = scalar.kind else { continue };
        let items = enumeration.items.iter().map(|&(name, value, description)| Item {
            position: Position::default(),
            name: name.to_owned(),
            value,
            description: text(description),
        });
        let simple_type = SimpleType {
            position: Position::default(),
            name: enumeration.name.to_owned(),
            description: text(enumeration.description),
            kind: TypeKind::Enumeration { quantity: None, items: items.collect() },
        };
        match types.iter().find(|known| known.name == simple_type.name) {
            Some(known) => assert!(*known == simple_type, "two enumerations are named `{}`", known.name),
            None => types.push(simple_type),
        }
    }
    types
}

/// The attributes of the standard for the role of a scalar.
pub(crate) fn attributes(scalar: &Scalar) -> (Causality, Variability, Option<Initial>) {
    let (causality, initial) = match scalar.declaration.role {
        Role::Input => (Causality::Input, None),
        Role::Parameter { .. } => (Causality::Parameter, Some(Initial::Exact)),
        Role::ExactOutput => (Causality::Output, Some(Initial::Exact)),
        Role::CalculatedOutput { .. } => (Causality::Output, Some(Initial::Calculated)),
        Role::ExactLocal => (Causality::Local, Some(Initial::Exact)),
        Role::CalculatedLocal => (Causality::Local, Some(Initial::Calculated)),
    };
    let variability = match (&scalar.declaration.role, scalar.kind) {
        (Role::Parameter { tunable: false }, _) => Variability::Fixed,
        (Role::Parameter { tunable: true }, _) => Variability::Tunable,
        (_, ScalarKind::Real) => Variability::Continuous,
        _ => Variability::Discrete,
    };
    (causality, variability, initial)
}

fn variable(scalar: &Scalar, value_reference: u32) -> Variable {
    let (causality, variability, initial) = attributes(scalar);
    let declared_type = match scalar.kind {
        ScalarKind::Enumeration(enumeration) => Some(enumeration.name.to_owned()),
        _ => None,
    };
    Variable {
        position: Position::default(),
        name: scalar.name.clone(),
        value_reference,
        description: text(scalar.declaration.description),
        causality,
        variability,
        initial,
        can_handle_multiple_set_per_time_instant: None,
        annotations: Vec::new(),
        declared_type,
        kind: kind(scalar),
    }
}

fn kind(scalar: &Scalar) -> Kind {
    let declared = &scalar.declaration;
    let start = declared.role.has_start().then(|| scalar.start.clone());
    #[expect(clippy::cast_possible_truncation, reason = "the bounds of Integers were written as i32")]
    let [min, max] = [declared.min, declared.max].map(|bound| bound.map(|bound| bound as i32));
    match (&scalar.start, scalar.kind) {
        (Value::Real(_), _) => Kind::Real(RealVariable {
            start: start.and_then(|start| if let Value::Real(start) = start { Some(start) } else { None }),
            attributes: RealAttributes {
                unit: declared.unit.map(str::to_owned),
                display_unit: declared.display.map(str::to_owned),
                min: declared.min,
                max: declared.max,
                nominal: declared.nominal,
                ..RealAttributes::default()
            },
            ..RealVariable::default()
        }),
        (Value::Integer(value), ScalarKind::Enumeration(_)) => {
            Kind::Enumeration { start: start.map(|_| *value), min: None, max: None }
        }
        (Value::Integer(value), _) => Kind::Integer { start: start.map(|_| *value), min, max },
        (Value::Boolean(value), _) => Kind::Boolean { start: start.map(|_| *value) },
        (Value::String(value), _) => Kind::String { start: start.map(|_| value.clone()) },
    }
}

/// Outputs with the inputs, and initial unknowns with the start values, that they depend on.
fn structure(scalars: &[Scalar]) -> ModelStructure {
    let mut structure = ModelStructure::default();
    for (index, scalar) in scalars.iter().enumerate() {
        let known = |known: &Scalar| known.declaration.role == Role::Input;
        match &scalar.declaration.role {
            Role::ExactOutput => structure.outputs.push(unknown(index, vec![])),
            Role::CalculatedOutput { depends, depends_at_start, .. } => {
                structure.outputs.push(unknown(index, dependencies(scalars, scalar, depends, known)));
                let at_start =
                    dependencies(scalars, scalar, depends_at_start, |known| known.declaration.role.has_start());
                structure.initial_unknowns.push(unknown(index, at_start));
            }
            _ => {}
        }
    }
    structure
}

fn unknown(index: usize, dependencies: Vec<usize>) -> Unknown {
    Unknown { index, dependencies: Some(dependencies), ..Unknown::default() }
}

/// The known scalars that are named, singly or by their group.
fn dependencies(scalars: &[Scalar], of: &Scalar, names: &[String], known: impl Fn(&Scalar) -> bool) -> Vec<usize> {
    for name in names {
        let exists = scalars.iter().any(|scalar| scalar.is_named(name));
        assert!(exists, "`{}` depends on `{name}`, which is no port of the unit", of.name);
    }
    let indexed = scalars.iter().enumerate();
    let named = indexed.filter(|(_, scalar)| known(scalar) && names.iter().any(|name| scalar.is_named(name)));
    named.map(|(index, _)| index).collect()
}
