//! Reads the root element: identity, capabilities, log categories and default experiment of the unit.

use super::element::Element;
use super::{structure, types, variable};
use crate::description::{
    CoSimulation, DefaultExperiment, LogCategory, ModelDescription, ModelExchange, Named, NamingConvention,
};

/// The order that the schema prescribes; the first two may be swapped.
const ORDER: [(&str, usize); 9] = [
    ("ModelExchange", 0),
    ("CoSimulation", 0),
    ("UnitDefinitions", 1),
    ("TypeDefinitions", 2),
    ("LogCategories", 3),
    ("DefaultExperiment", 4),
    ("VendorAnnotations", 5),
    ("ModelVariables", 6),
    ("ModelStructure", 7),
];

const ATTRIBUTES: [&str; 12] = [
    "fmiVersion",
    "modelName",
    "guid",
    "description",
    "author",
    "version",
    "copyright",
    "license",
    "generationTool",
    "generationDateAndTime",
    "variableNamingConvention",
    "numberOfEventIndicators",
];

/// Reads everything below the root element.
pub(super) fn model_description(root: &Element) -> ModelDescription {
    root.expect_attributes("2.2.1", &ATTRIBUTES);
    let naming = [NamingConvention::Flat, NamingConvention::Structured];
    let mut model = ModelDescription {
        position: root.position(),
        fmi_version: root.text_or_empty("fmiVersion"),
        model_name: root.text_or_empty("modelName"),
        guid: root.text_or_empty("guid"),
        description: root.text("description"),
        author: root.text("author"),
        version: root.text("version"),
        copyright: root.text("copyright"),
        license: root.text("license"),
        generation_tool: root.text("generationTool"),
        generation_date_and_time: root.text("generationDateAndTime"),
        variable_naming_convention: root
            .choice("2.2.1", "variableNamingConvention", &naming, NamingConvention::name)
            .unwrap_or_default(),
        number_of_event_indicators: root.text("numberOfEventIndicators"),
        ..ModelDescription::default()
    };
    let mut seen: Vec<(&str, usize)> = Vec::new();
    for child in root.children() {
        let Some(&(name, rank)) = ORDER.iter().find(|(name, _)| *name == child.name()) else {
            child.unknown("2.2.1", root.name());
            continue;
        };
        if seen.iter().any(|(earlier, _)| *earlier == name) {
            child.error("2.2.1", format!("a second `{name}`; one is allowed, and the first one counts"));
            continue;
        }
        if let Some((later, _)) = seen.iter().find(|(_, earlier)| *earlier > rank) {
            child.error("2.2.1", format!("`{name}` stands after `{later}`; the schema wants it before"));
        }
        seen.push((name, rank));
        read_child(&child, &mut model);
    }
    // The checker detects that there are no variables, but not whether the structure element was present.
    if !seen.iter().any(|(name, _)| *name == "ModelStructure") {
        root.error("2.2.1", "`fmiModelDescription` has no element `ModelStructure`, which is mandatory".to_owned());
    }
    model
}

fn read_child(child: &Element, model: &mut ModelDescription) {
    match child.name() {
        "ModelExchange" => model.model_exchange = Some(model_exchange(child)),
        "CoSimulation" => model.co_simulation = Some(co_simulation(child)),
        "UnitDefinitions" => model.units = types::units(child),
        "TypeDefinitions" => model.types = types::simple_types(child),
        "LogCategories" => model.log_categories = log_categories(child),
        "DefaultExperiment" => model.default_experiment = Some(default_experiment(child)),
        "VendorAnnotations" => model.vendor_annotations = child.items("2.2.6", "Tool", named),
        "ModelVariables" => model.variables = variable::variables(child),
        _ => model.structure = structure::model_structure(child),
    }
}

fn co_simulation(element: &Element) -> CoSimulation {
    element.expect_attributes(
        "4.3.1",
        &[
            "modelIdentifier",
            "needsExecutionTool",
            "canHandleVariableCommunicationStepSize",
            "canInterpolateInputs",
            "maxOutputDerivativeOrder",
            "canRunAsynchronuously",
            "canBeInstantiatedOnlyOncePerProcess",
            "canNotUseMemoryManagementFunctions",
            "canGetAndSetFMUstate",
            "canSerializeFMUstate",
            "providesDirectionalDerivative",
        ],
    );
    let flag = |name| element.boolean("4.3.1", name).unwrap_or(false);
    CoSimulation {
        position: element.position(),
        model_identifier: element.text_or_empty("modelIdentifier"),
        needs_execution_tool: flag("needsExecutionTool"),
        can_handle_variable_communication_step_size: flag("canHandleVariableCommunicationStepSize"),
        can_interpolate_inputs: flag("canInterpolateInputs"),
        max_output_derivative_order: element.number("4.3.1", "maxOutputDerivativeOrder").unwrap_or(0),
        can_run_asynchronuously: flag("canRunAsynchronuously"),
        can_be_instantiated_only_once_per_process: flag("canBeInstantiatedOnlyOncePerProcess"),
        can_not_use_memory_management_functions: flag("canNotUseMemoryManagementFunctions"),
        can_get_and_set_fmu_state: flag("canGetAndSetFMUstate"),
        can_serialize_fmu_state: flag("canSerializeFMUstate"),
        provides_directional_derivative: flag("providesDirectionalDerivative"),
        source_files: source_files(element, "4.3.1"),
    }
}

fn model_exchange(element: &Element) -> ModelExchange {
    element.expect_attributes(
        "3.3.1",
        &[
            "modelIdentifier",
            "needsExecutionTool",
            "completedIntegratorStepNotNeeded",
            "canBeInstantiatedOnlyOncePerProcess",
            "canNotUseMemoryManagementFunctions",
            "canGetAndSetFMUstate",
            "canSerializeFMUstate",
            "providesDirectionalDerivative",
        ],
    );
    ModelExchange {
        position: element.position(),
        model_identifier: element.text_or_empty("modelIdentifier"),
        source_files: source_files(element, "3.3.1"),
    }
}

fn source_files(element: &Element, rule: &'static str) -> Vec<Named> {
    let mut files = Vec::new();
    for child in element.children() {
        if child.name() == "SourceFiles" {
            files.extend(child.items(rule, "File", named));
        } else {
            child.unknown(rule, element.name());
        }
    }
    files
}

/// A `File` or a `Tool`.
pub(super) fn named(element: &Element) -> Option<Named> {
    Some(Named { position: element.position(), name: element.text_or_empty("name") })
}

fn log_categories(element: &Element) -> Vec<LogCategory> {
    element.items("2.2.4", "Category", |item| {
        item.expect_attributes("2.2.4", &["name", "description"]);
        let (position, name) = (item.position(), item.text_or_empty("name"));
        Some(LogCategory { position, name, description: item.text("description") })
    })
}

fn default_experiment(element: &Element) -> DefaultExperiment {
    element.expect_attributes("2.2.5", &["startTime", "stopTime", "tolerance", "stepSize"]);
    DefaultExperiment {
        position: element.position(),
        start_time: element.number("2.2.5", "startTime"),
        stop_time: element.number("2.2.5", "stopTime"),
        tolerance: element.number("2.2.5", "tolerance"),
        step_size: element.number("2.2.5", "stepSize"),
    }
}
