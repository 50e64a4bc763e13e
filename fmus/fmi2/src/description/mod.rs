//! `modelDescription.xml` as a data structure: [`mod@read`], [`mod@write`], [`mod@check`].
//!
//! The structure mirrors the schema of FMI 2.0.5 for co-simulation; names are the schema's in Rust's spelling. Elements
//! keep their position in the file, so that every finding has a line and a column.

mod causality;
pub mod check;
mod finding;
mod limits;
pub mod read;
mod simple_type;
mod structure;
mod unit_definition;
mod variable;
pub mod write;

pub use causality::{Causality, Initial, Variability, default_initial};
pub use finding::{Finding, Position, Severity};
pub use limits::Limits;
use serde::{Deserialize, Serialize};
pub use simple_type::{Item, RealAttributes, SimpleType, TypeKind};
pub use structure::{DependencyKind, ModelStructure, Unknown};
pub use unit_definition::{DisplayUnit, UnitDefinition};
pub use variable::{BaseType, Kind, RealVariable, Variable};

/// `fmiModelDescription`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelDescription {
    /// Position of the element.
    pub position: Position,
    /// `fmiVersion`, `2.0`.
    pub fmi_version: String,
    /// `modelName`.
    pub model_name: String,
    /// `guid`: equal in the description and in the library.
    pub guid: String,
    /// `description`.
    pub description: Option<String>,
    /// `author`.
    pub author: Option<String>,
    /// `version` of the model.
    pub version: Option<String>,
    /// `copyright`.
    pub copyright: Option<String>,
    /// `license`.
    pub license: Option<String>,
    /// `generationTool`.
    pub generation_tool: Option<String>,
    /// `generationDateAndTime`.
    pub generation_date_and_time: Option<String>,
    /// `variableNamingConvention`.
    pub variable_naming_convention: NamingConvention,
    /// `numberOfEventIndicators`, as written.
    pub number_of_event_indicators: Option<String>,
    /// `CoSimulation`, absent for units that only do model exchange.
    pub co_simulation: Option<CoSimulation>,
    /// `ModelExchange`, absent for units that only do co-simulation.
    pub model_exchange: Option<ModelExchange>,
    /// `UnitDefinitions`.
    pub units: Vec<UnitDefinition>,
    /// `TypeDefinitions`.
    pub types: Vec<SimpleType>,
    /// `LogCategories`.
    pub log_categories: Vec<LogCategory>,
    /// `DefaultExperiment`.
    pub default_experiment: Option<DefaultExperiment>,
    /// The tools in `VendorAnnotations`.
    pub vendor_annotations: Vec<Named>,
    /// `ModelVariables`, in the file's order; indices elsewhere count from 0 into this list.
    pub variables: Vec<Variable>,
    /// `ModelStructure`.
    pub structure: ModelStructure,
}

impl ModelDescription {
    /// The index of the variable of this name.
    #[must_use]
    pub fn variable(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|variable| variable.name == name)
    }

    /// The declared type of this name.
    #[must_use]
    pub fn simple_type(&self, name: &str) -> Option<&SimpleType> {
        self.types.iter().find(|simple_type| simple_type.name == name)
    }

    /// The definition of the unit of measure of this name.
    #[must_use]
    pub fn unit(&self, name: &str) -> Option<&UnitDefinition> {
        self.units.iter().find(|unit| unit.name == name)
    }

    /// The unit name of a Real variable: its own, else that of its declared type.
    #[must_use]
    pub fn unit_of<'a>(&'a self, variable: &'a Variable) -> Option<&'a str> {
        let Kind::Real(own) = &variable.kind else { return None };
        own.unit.as_deref().or_else(|| {
            let declared = self.simple_type(variable.declared_type.as_deref()?)?;
            match &declared.kind {
                TypeKind::Real(real) => real.unit.as_deref(),
                _ => None,
            }
        })
    }

    /// The items of an Enumeration variable's declared type; empty for other variables.
    #[must_use]
    pub fn items_of(&self, variable: &Variable) -> &[Item] {
        let declared = variable.declared_type.as_deref().and_then(|name| self.simple_type(name));
        match declared.map(|declared| &declared.kind) {
            Some(TypeKind::Enumeration { items, .. }) => items,
            _ => &[],
        }
    }
}

/// `variableNamingConvention`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum NamingConvention {
    /// `flat`, the schema's default.
    #[default]
    Flat,
    /// `structured`: dots and indices have meaning.
    Structured,
}

impl NamingConvention {
    /// The schema's spelling.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Structured => "structured",
        }
    }
}

/// `CoSimulation`: identifier and capability flags.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CoSimulation {
    /// Position of the element.
    pub position: Position,
    /// `modelIdentifier`: the library's file name without extension.
    pub model_identifier: String,
    /// `needsExecutionTool`.
    pub needs_execution_tool: bool,
    /// `canHandleVariableCommunicationStepSize`.
    pub can_handle_variable_communication_step_size: bool,
    /// `canInterpolateInputs`.
    pub can_interpolate_inputs: bool,
    /// `maxOutputDerivativeOrder`.
    pub max_output_derivative_order: u32,
    /// `canRunAsynchronuously`, spelt as in the schema.
    pub can_run_asynchronuously: bool,
    /// `canBeInstantiatedOnlyOncePerProcess`.
    pub can_be_instantiated_only_once_per_process: bool,
    /// `canNotUseMemoryManagementFunctions`.
    pub can_not_use_memory_management_functions: bool,
    /// `canGetAndSetFMUstate`.
    pub can_get_and_set_fmu_state: bool,
    /// `canSerializeFMUstate`.
    pub can_serialize_fmu_state: bool,
    /// `providesDirectionalDerivative`.
    pub provides_directional_derivative: bool,
    /// The files in `SourceFiles`.
    pub source_files: Vec<Named>,
}

/// `ModelExchange`: what its rules need; nothing here runs it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelExchange {
    /// Position of the element.
    pub position: Position,
    /// `modelIdentifier`: the library's file name without extension.
    pub model_identifier: String,
    /// The files in `SourceFiles`.
    pub source_files: Vec<Named>,
}

/// An element of which only the name is kept: `File` of `SourceFiles`, `Tool` of annotations.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Named {
    /// Position of the element.
    pub position: Position,
    /// `name`
    pub name: String,
}

/// `Category` of `LogCategories`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogCategory {
    /// Position of the element.
    pub position: Position,
    /// `name`
    pub name: String,
    /// `description`
    pub description: Option<String>,
}

/// `DefaultExperiment`, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DefaultExperiment {
    /// Position of the element.
    pub position: Position,
    /// `startTime`
    pub start_time: Option<f64>,
    /// `stopTime`
    pub stop_time: Option<f64>,
    /// `tolerance`
    pub tolerance: Option<f64>,
    /// `stepSize`
    pub step_size: Option<f64>,
}
