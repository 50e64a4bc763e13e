//! Writes `modelDescription.xml`: elements in the schema's order, no empty lists, numbers in their shortest exact form.

use std::fmt::Write;

use super::{
    CoSimulation, DefaultExperiment, Kind, ModelDescription, Named, RealAttributes, SimpleType, TypeKind,
    UnitDefinition, Unknown, Variable,
};
use crate::units::{BaseUnit, Dimension};

/// The description as XML in UTF-8. Characters that XML cannot hold are replaced by U+FFFD.
#[must_use]
pub fn write(model: &ModelDescription) -> String {
    let mut xml = Xml { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(), open: Vec::new() };
    xml.begin("fmiModelDescription");
    xml.put("fmiVersion", &model.fmi_version);
    xml.put("modelName", &model.model_name);
    xml.put("guid", &model.guid);
    xml.put_some("description", model.description.as_deref());
    xml.put_some("author", model.author.as_deref());
    xml.put_some("version", model.version.as_deref());
    xml.put_some("copyright", model.copyright.as_deref());
    xml.put_some("license", model.license.as_deref());
    xml.put_some("generationTool", model.generation_tool.as_deref());
    xml.put_some("generationDateAndTime", model.generation_date_and_time.as_deref());
    xml.put("variableNamingConvention", model.variable_naming_convention.name());
    xml.put_some("numberOfEventIndicators", model.number_of_event_indicators.as_deref());
    if let Some(unit) = &model.model_exchange {
        xml.begin("ModelExchange");
        xml.put("modelIdentifier", &unit.model_identifier);
        xml.names("SourceFiles", "File", &unit.source_files);
        xml.end();
    }
    if let Some(unit) = &model.co_simulation {
        co_simulation(&mut xml, unit);
    }
    xml.list("UnitDefinitions", &model.units, unit_definition);
    xml.list("TypeDefinitions", &model.types, simple_type);
    xml.list("LogCategories", &model.log_categories, |xml, category| {
        xml.begin("Category");
        xml.put("name", &category.name);
        xml.put_some("description", category.description.as_deref());
        xml.end();
    });
    if let Some(experiment) = &model.default_experiment {
        default_experiment(&mut xml, experiment);
    }
    xml.names("VendorAnnotations", "Tool", &model.vendor_annotations);
    xml.list("ModelVariables", &model.variables, variable);
    xml.begin("ModelStructure");
    xml.list("Outputs", &model.structure.outputs, unknown);
    xml.list("Derivatives", &model.structure.derivatives, unknown);
    xml.list("InitialUnknowns", &model.structure.initial_unknowns, unknown);
    xml.end();
    xml.end();
    xml.text
}

fn co_simulation(xml: &mut Xml, unit: &CoSimulation) {
    xml.begin("CoSimulation");
    xml.put("modelIdentifier", &unit.model_identifier);
    xml.put_flag("needsExecutionTool", unit.needs_execution_tool);
    xml.put_flag("canHandleVariableCommunicationStepSize", unit.can_handle_variable_communication_step_size);
    xml.put_flag("canInterpolateInputs", unit.can_interpolate_inputs);
    if unit.max_output_derivative_order != 0 {
        xml.put("maxOutputDerivativeOrder", &unit.max_output_derivative_order.to_string());
    }
    xml.put_flag("canRunAsynchronuously", unit.can_run_asynchronuously);
    xml.put_flag("canBeInstantiatedOnlyOncePerProcess", unit.can_be_instantiated_only_once_per_process);
    xml.put_flag("canNotUseMemoryManagementFunctions", unit.can_not_use_memory_management_functions);
    xml.put_flag("canGetAndSetFMUstate", unit.can_get_and_set_fmu_state);
    xml.put_flag("canSerializeFMUstate", unit.can_serialize_fmu_state);
    xml.put_flag("providesDirectionalDerivative", unit.provides_directional_derivative);
    xml.names("SourceFiles", "File", &unit.source_files);
    xml.end();
}

fn boolean(value: bool) -> &'static str {
    if value { "true" } else { "false" }
}

fn default_experiment(xml: &mut Xml, experiment: &DefaultExperiment) {
    xml.begin("DefaultExperiment");
    xml.put_number("startTime", experiment.start_time);
    xml.put_number("stopTime", experiment.stop_time);
    xml.put_number("tolerance", experiment.tolerance);
    xml.put_number("stepSize", experiment.step_size);
    xml.end();
}

fn unit_definition(xml: &mut Xml, unit: &UnitDefinition) {
    let scale = |xml: &mut Xml, factor: f64, offset: f64| {
        xml.put_number("factor", Some(factor).filter(|&factor| factor != 1.0));
        xml.put_number("offset", Some(offset).filter(|offset| offset.to_bits() != 0));
    };
    xml.begin("Unit");
    xml.put("name", &unit.name);
    if let Some(BaseUnit { dimension, factor, offset }) = unit.base {
        xml.begin("BaseUnit");
        for (name, exponent) in Dimension::BASE_NAMES.into_iter().zip(dimension.0).filter(|entry| entry.1 != 0) {
            xml.put(name, &exponent.to_string());
        }
        scale(xml, factor, offset);
        xml.end();
    }
    for display in &unit.display_units {
        xml.begin("DisplayUnit");
        xml.put("name", &display.name);
        scale(xml, display.factor, display.offset);
        xml.end();
    }
    xml.end();
}

fn simple_type(xml: &mut Xml, simple_type: &SimpleType) {
    xml.begin("SimpleType");
    xml.put("name", &simple_type.name);
    xml.put_some("description", simple_type.description.as_deref());
    match &simple_type.kind {
        TypeKind::Real(attributes) => {
            xml.begin("Real");
            real_attributes(xml, attributes);
        }
        TypeKind::Integer { min, max } => {
            xml.begin("Integer");
            xml.put_whole("min", *min);
            xml.put_whole("max", *max);
        }
        TypeKind::Boolean => xml.begin("Boolean"),
        TypeKind::String => xml.begin("String"),
        TypeKind::Enumeration { quantity, items } => {
            xml.begin("Enumeration");
            xml.put_some("quantity", quantity.as_deref());
            for item in items {
                xml.begin("Item");
                xml.put("name", &item.name);
                xml.put("value", &item.value.to_string());
                xml.put_some("description", item.description.as_deref());
                xml.end();
            }
        }
    }
    xml.end();
    xml.end();
}

fn real_attributes(xml: &mut Xml, real: &RealAttributes) {
    xml.put_some("quantity", real.quantity.as_deref());
    xml.put_some("unit", real.unit.as_deref());
    xml.put_some("displayUnit", real.display_unit.as_deref());
    xml.put_some("relativeQuantity", real.relative_quantity.map(boolean));
    xml.put_number("min", real.min);
    xml.put_number("max", real.max);
    xml.put_number("nominal", real.nominal);
    xml.put_flag("unbounded", real.unbounded);
}

fn variable(xml: &mut Xml, variable: &Variable) {
    xml.begin("ScalarVariable");
    xml.put("name", &variable.name);
    xml.put("valueReference", &variable.value_reference.to_string());
    xml.put_some("description", variable.description.as_deref());
    xml.put("causality", variable.causality.name());
    xml.put("variability", variable.variability.name());
    xml.put_some("initial", variable.initial.map(super::Initial::name));
    let can_handle = variable.can_handle_multiple_set_per_time_instant;
    xml.put_some("canHandleMultipleSetPerTimeInstant", can_handle.map(boolean));
    let declared_type = variable.declared_type.as_deref();
    match &variable.kind {
        Kind::Real(real) => {
            xml.begin("Real");
            xml.put_some("declaredType", declared_type);
            real_attributes(xml, &real.attributes);
            xml.put_number("start", real.start);
            xml.put_some("derivative", real.derivative.map(one_based).as_deref());
            xml.put_some("reinit", real.reinit.map(boolean));
        }
        Kind::Integer { start, min, max } | Kind::Enumeration { start, min, max } => {
            xml.begin(if matches!(variable.kind, Kind::Integer { .. }) { "Integer" } else { "Enumeration" });
            xml.put_some("declaredType", declared_type);
            xml.put_whole("min", *min);
            xml.put_whole("max", *max);
            xml.put_whole("start", *start);
        }
        Kind::Boolean { start } => {
            xml.begin("Boolean");
            xml.put_some("declaredType", declared_type);
            xml.put_some("start", start.map(boolean));
        }
        Kind::String { start } => {
            xml.begin("String");
            xml.put_some("declaredType", declared_type);
            xml.put_some("start", start.as_deref());
        }
    }
    xml.end();
    xml.names("Annotations", "Tool", &variable.annotations);
    xml.end();
}

fn unknown(xml: &mut Xml, unknown: &Unknown) {
    xml.begin("Unknown");
    xml.put("index", &one_based(unknown.index));
    if let Some(dependencies) = &unknown.dependencies {
        let indices: Vec<_> = dependencies.iter().map(|&index| one_based(index)).collect();
        xml.put("dependencies", &indices.join(" "));
    }
    if let Some(kinds) = &unknown.dependencies_kind {
        let words: Vec<_> = kinds.iter().map(|kind| kind.name()).collect();
        xml.put("dependenciesKind", &words.join(" "));
    }
    xml.end();
}

/// The index counted from 1 as in the file; `usize::MAX`, which represents an index of 0, becomes 0 again.
fn one_based(index: usize) -> String {
    index.wrapping_add(1).to_string()
}

/// The text so far, and the open elements, each with whether it has children.
struct Xml {
    text: String,
    open: Vec<(&'static str, bool)>,
}

impl Xml {
    fn begin(&mut self, name: &'static str) {
        if let Some((_, has_children)) = self.open.last_mut()
            && !std::mem::replace(has_children, true)
        {
            self.text.push_str(">\n");
        }
        self.text.push_str(&"  ".repeat(self.open.len()));
        self.text.push('<');
        self.text.push_str(name);
        self.open.push((name, false));
    }

    fn end(&mut self) {
        match self.open.pop() {
            Some((name, true)) => {
                self.text.push_str(&"  ".repeat(self.open.len()));
                self.text.push_str("</");
                self.text.push_str(name);
                self.text.push_str(">\n");
            }
            Some((_, false)) => self.text.push_str("/>\n"),
            None => unreachable!("each end has its begin"),
        }
    }

    fn list<T>(&mut self, name: &'static str, items: &[T], write: impl Fn(&mut Self, &T)) {
        if items.is_empty() {
            return;
        }
        self.begin(name);
        for item in items {
            write(self, item);
        }
        self.end();
    }

    fn names(&mut self, list: &'static str, element: &'static str, items: &[Named]) {
        self.list(list, items, |xml, item| {
            xml.begin(element);
            xml.put("name", &item.name);
            xml.end();
        });
    }

    /// Writes an attribute; line breaks and tabs as references, since a reader converts them to blanks.
    fn put(&mut self, name: &str, value: &str) {
        self.text.push(' ');
        self.text.push_str(name);
        self.text.push_str("=\"");
        for letter in value.chars() {
            match letter {
                '&' => self.text.push_str("&amp;"),
                '<' => self.text.push_str("&lt;"),
                '>' => self.text.push_str("&gt;"),
                '"' => self.text.push_str("&quot;"),
                '\n' => self.text.push_str("&#10;"),
                '\r' => self.text.push_str("&#13;"),
                '\t' => self.text.push_str("&#9;"),
                '\0'..='\u{1F}' | '\u{FFFE}' | '\u{FFFF}' => self.text.push('\u{FFFD}'),
                _ => self.text.push(letter),
            }
        }
        self.text.push('"');
    }

    fn put_some(&mut self, name: &str, value: Option<&str>) {
        if let Some(value) = value {
            self.put(name, value);
        }
    }

    fn put_flag(&mut self, name: &str, value: bool) {
        self.put_some(name, value.then_some("true"));
    }

    fn put_whole(&mut self, name: &str, value: Option<i32>) {
        self.put_some(name, value.map(|value| value.to_string()).as_deref());
    }

    /// Writes the shortest decimal that reads back to the same bits.
    fn put_number(&mut self, name: &str, value: Option<f64>) {
        let Some(value) = value else { return };
        let mut written = String::new();
        let done = match value {
            f64::INFINITY => write!(written, "INF"),
            f64::NEG_INFINITY => write!(written, "-INF"),
            _ => write!(written, "{value:?}"),
        };
        assert!(done.is_ok(), "writing to a string cannot fail");
        self.put(name, &written);
    }
}

#[cfg(test)]
pub(in crate::description) mod tests;
