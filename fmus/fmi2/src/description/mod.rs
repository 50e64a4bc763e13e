//! `modelDescription.xml` as a data structure: [`read`], [`write`], [`check`].
//!
//! The structure mirrors the schema of FMI 2.0.5 for co-simulation; names are the schema's in Rust's spelling. Whatever
//! was read remembers where it stood, so that every finding has a line and a column.

pub mod check;
pub mod read;
pub mod write;

use serde::{Deserialize, Serialize};

/// A place in `modelDescription.xml`, counted from 1; `0:0` for what was never read from a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// `fmiModelDescription`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelDescription {
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
    /// Whether a `ModelExchange` element is there.
    pub has_model_exchange: bool,
    /// `UnitDefinitions`.
    pub units: Vec<UnitDefinition>,
    /// `TypeDefinitions`.
    pub types: Vec<SimpleType>,
    /// `LogCategories`.
    pub log_categories: Vec<LogCategory>,
    /// `DefaultExperiment`.
    pub default_experiment: Option<DefaultExperiment>,
    /// Names of the tools in `VendorAnnotations`.
    pub vendor_annotations: Vec<String>,
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

/// `CoSimulation`: identifier and capability flags.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CoSimulation {
    /// Where the element stands.
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
    /// `SourceFiles/File/@name`.
    pub source_files: Vec<String>,
}

/// `Unit` with its `BaseUnit` and `DisplayUnit`s.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UnitDefinition {
    /// Where the element stands.
    pub position: Position,
    /// `name`.
    pub name: String,
    /// `BaseUnit`; absent means that nothing is known but the name.
    pub base: Option<crate::units::BaseUnit>,
    /// `DisplayUnit`s.
    pub display_units: Vec<DisplayUnit>,
}

/// `DisplayUnit`: `display = factor * value + offset`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplayUnit {
    /// `name`.
    pub name: String,
    /// `factor`, 1 unless given.
    pub factor: f64,
    /// `offset`, 0 unless given.
    pub offset: f64,
}

/// `SimpleType`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimpleType {
    /// Where the element stands.
    pub position: Position,
    /// `name`.
    pub name: String,
    /// `description`.
    pub description: Option<String>,
    /// The one child element.
    pub kind: TypeKind,
}

/// The child element of a `SimpleType`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TypeKind {
    /// `Real`
    Real(RealAttributes),
    /// `Integer`
    Integer {
        /// `min`
        min: Option<i32>,
        /// `max`
        max: Option<i32>,
    },
    /// `Boolean`
    Boolean,
    /// `String`
    String,
    /// `Enumeration`
    Enumeration {
        /// `quantity`
        quantity: Option<String>,
        /// `Item`s, in the file's order.
        items: Vec<Item>,
    },
}

/// `Item` of an enumeration type.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Item {
    /// `name`
    pub name: String,
    /// `value`, unique in its type.
    pub value: i32,
    /// `description`
    pub description: Option<String>,
}

/// The attributes that a Real type and a Real variable share.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RealAttributes {
    /// `quantity`
    pub quantity: Option<String>,
    /// `unit`
    pub unit: Option<String>,
    /// `displayUnit`
    pub display_unit: Option<String>,
    /// `relativeQuantity`
    pub relative_quantity: bool,
    /// `min`
    pub min: Option<f64>,
    /// `max`
    pub max: Option<f64>,
    /// `nominal`
    pub nominal: Option<f64>,
    /// `unbounded`
    pub unbounded: bool,
}

/// `Category` of `LogCategories`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LogCategory {
    /// `name`
    pub name: String,
    /// `description`
    pub description: Option<String>,
}

/// `DefaultExperiment`, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DefaultExperiment {
    /// `startTime`
    pub start_time: Option<f64>,
    /// `stopTime`
    pub stop_time: Option<f64>,
    /// `tolerance`
    pub tolerance: Option<f64>,
    /// `stepSize`
    pub step_size: Option<f64>,
}

/// `ScalarVariable`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Variable {
    /// Where the element stands.
    pub position: Position,
    /// `name`
    pub name: String,
    /// `valueReference`: the handle in get and set calls, unique with the base type.
    pub value_reference: u32,
    /// `description`
    pub description: Option<String>,
    /// `causality`
    pub causality: Causality,
    /// `variability`
    pub variability: Variability,
    /// `initial` as written; [`Variable::initial_or_default`] adds the standard's defaults.
    pub initial: Option<Initial>,
    /// `declaredType` of the child element.
    pub declared_type: Option<String>,
    /// The child element.
    pub kind: Kind,
}

/// The child element of a `ScalarVariable`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Kind {
    /// `Real`; `start` stands in [`RealVariable`].
    Real(RealVariable),
    /// `Integer`
    Integer {
        /// `start`
        start: Option<i32>,
        /// `min`
        min: Option<i32>,
        /// `max`
        max: Option<i32>,
    },
    /// `Boolean`
    Boolean {
        /// `start`
        start: Option<bool>,
    },
    /// `String`
    String {
        /// `start`
        start: Option<String>,
    },
    /// `Enumeration`; `declaredType` is mandatory.
    Enumeration {
        /// `start`
        start: Option<i32>,
        /// `min`
        min: Option<i32>,
        /// `max`
        max: Option<i32>,
    },
}

/// `Real` of a `ScalarVariable`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RealVariable {
    /// `start`
    pub start: Option<f64>,
    /// `derivative`: 0-based index of the variable whose derivative this is (1-based in the file).
    pub derivative: Option<usize>,
    /// `reinit`
    pub reinit: bool,
    /// What a type may declare too; the variable's own value counts first.
    pub attributes: RealAttributes,
}

impl std::ops::Deref for RealVariable {
    type Target = RealAttributes;
    fn deref(&self) -> &RealAttributes {
        &self.attributes
    }
}

/// The base types that get and set calls distinguish; Enumeration travels as Integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum BaseType {
    /// `fmi2Real`
    Real,
    /// `fmi2Integer`, also of enumerations
    Integer,
    /// `fmi2Boolean`
    Boolean,
    /// `fmi2String`
    String,
}

impl Variable {
    /// Which get and set calls the variable travels by.
    #[must_use]
    pub fn base_type(&self) -> BaseType {
        match self.kind {
            Kind::Real(_) => BaseType::Real,
            Kind::Integer { .. } | Kind::Enumeration { .. } => BaseType::Integer,
            Kind::Boolean { .. } => BaseType::Boolean,
            Kind::String { .. } => BaseType::String,
        }
    }

    /// Whether a start value is written.
    #[must_use]
    pub fn has_start(&self) -> bool {
        match &self.kind {
            Kind::Real(real) => real.start.is_some(),
            Kind::Integer { start, .. } | Kind::Enumeration { start, .. } => start.is_some(),
            Kind::Boolean { start } => start.is_some(),
            Kind::String { start } => start.is_some(),
        }
    }

    /// `initial`, with the standard's default for the causality and variability where none is written (table of 2.2.7).
    #[must_use]
    pub fn initial_or_default(&self) -> Option<Initial> {
        self.initial.or_else(|| default_initial(self.causality, self.variability))
    }
}

/// The default of `initial` in the table of section 2.2.7; `None` for inputs, the independent variable and pairs that the table forbids.
#[must_use]
pub fn default_initial(causality: Causality, variability: Variability) -> Option<Initial> {
    use {Causality as C, Variability as V};
    match (causality, variability) {
        (C::Parameter, V::Fixed | V::Tunable) | (C::Output | C::Local, V::Constant) => Some(Initial::Exact),
        (C::CalculatedParameter, V::Fixed | V::Tunable)
        | (C::Output, V::Discrete | V::Continuous)
        | (C::Local, V::Fixed | V::Tunable | V::Discrete | V::Continuous) => Some(Initial::Calculated),
        _ => None,
    }
}

/// `causality`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Causality {
    /// `parameter`
    Parameter,
    /// `calculatedParameter`
    CalculatedParameter,
    /// `input`
    Input,
    /// `output`
    Output,
    /// `local`, the schema's default
    #[default]
    Local,
    /// `independent`
    Independent,
}

impl Causality {
    /// The schema's spelling.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Parameter => "parameter",
            Self::CalculatedParameter => "calculatedParameter",
            Self::Input => "input",
            Self::Output => "output",
            Self::Local => "local",
            Self::Independent => "independent",
        }
    }
}

/// `variability`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Variability {
    /// `constant`
    Constant,
    /// `fixed`
    Fixed,
    /// `tunable`
    Tunable,
    /// `discrete`
    Discrete,
    /// `continuous`, the schema's default
    #[default]
    Continuous,
}

impl Variability {
    /// The schema's spelling.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Fixed => "fixed",
            Self::Tunable => "tunable",
            Self::Discrete => "discrete",
            Self::Continuous => "continuous",
        }
    }
}

/// `initial`
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Initial {
    /// `exact`
    Exact,
    /// `approx`
    Approx,
    /// `calculated`
    Calculated,
}

/// `ModelStructure`; indices count from 0 into [`ModelDescription::variables`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelStructure {
    /// Where the element stands.
    pub position: Position,
    /// `Outputs`
    pub outputs: Vec<Unknown>,
    /// `Derivatives`
    pub derivatives: Vec<Unknown>,
    /// `InitialUnknowns`
    pub initial_unknowns: Vec<Unknown>,
}

/// `Unknown`
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Unknown {
    /// Where the element stands.
    pub position: Position,
    /// The variable; `usize::MAX` stands for an index of 0 in the file, which the checker reports.
    pub index: usize,
    /// `dependencies`: `None` (absent) means on everything, an empty list on nothing.
    pub dependencies: Option<Vec<usize>>,
    /// `dependenciesKind`, as many as dependencies.
    pub dependencies_kind: Option<Vec<DependencyKind>>,
}

/// One entry of `dependenciesKind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DependencyKind {
    /// `dependent`
    Dependent,
    /// `constant`
    Constant,
    /// `fixed`
    Fixed,
    /// `tunable`
    Tunable,
    /// `discrete`
    Discrete,
}
