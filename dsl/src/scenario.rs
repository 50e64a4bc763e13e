//! The meaning of a script: a scenario with every name resolved, every unit converted and every element spelt out. Next on the
//! walk: `orchestrator/flatten/src/wiring.rs`.
//!
//! This is the only type of the language that a run sees. It is flat on purpose: groups, vectors and conversions are
//! gone, each connection has one scalar target, times are ticks. Reals inside expressions are SI.

mod claim;
mod curve;
mod duration;
mod event;
mod reads;
mod running;
mod sweep;

use crate::source::FileRef;
pub use claim::{Claim, ClaimPart, Formula, Gated, Limit, MarginUnit, TickWindow, Until};
pub use curve::{Curve, Near};
pub use duration::duration;
pub use event::{Action, Condition, Event, Fault, FaultKind, Set, Stage, StopWhen, Trigger};
pub use reads::Slots;
pub use running::{Running, RunningKind, RunningMemory};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
pub use sweep::{Case, Parameter, Sweep};

/// A script, ready to run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scenario {
    /// The text of the `scenario` line.
    pub title: String,
    /// The communication step in nanoseconds.
    pub step_ns: u64,
    /// The tick at which the run begins: 0 for a script.
    pub start_tick: u64,
    /// The tick at which the run ends.
    pub stop_tick: u64,
    /// The parameters with the values of this run, in order of declaration, `seed` last unless declared.
    pub parameters: Vec<Parameter>,
    /// The `sweep` of the script.
    pub sweep: Option<Sweep>,
    /// The units, each once, in order of first use.
    pub units: Vec<Unit>,
    /// The units under their names, in order of declaration.
    pub instances: Vec<Instance>,
    /// How initialization carries values, in an order that respects the units' declared dependencies.
    pub initialization: Vec<InitialStep>,
    /// One for each driven input element, in order of the targets (instance, variable).
    pub connections: Vec<Connection>,
    /// The windows in the script's order.
    pub events: Vec<Event>,
    /// `stop when`
    pub stop_when: Option<StopWhen>,
    /// The seed of the random numbers of faults; 0 where no fault draws any.
    pub seed: i64,
    /// The conditions whose past counts, by slot.
    pub conditions: Vec<Condition>,
    /// What connections, conditions and claims use more than once; each may use those before it.
    pub shared: Vec<RealExpression>,
    /// The claims in the script's order.
    pub claims: Vec<Claim>,
    /// What is recorded, in column order.
    pub columns: Vec<Column>,
}

/// A unit as messages call it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unit {
    /// As the script wrote it: a path that ends in `.fmu`, or a name.
    pub name: String,
}

/// A unit under a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Instance {
    /// The name in the script.
    pub name: String,
    /// Index into [`Scenario::units`].
    pub unit: usize,
    /// The period in ticks.
    pub every: u64,
    /// The wave in which it steps: 0, or one more than the last of its `=>` sources.
    pub wave: usize,
    /// Parameters and start values from the braces, in order.
    pub presets: Vec<Preset>,
}

/// A value that is set before initialization.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Preset {
    /// Index into the unit's variables.
    pub variable: usize,
    /// The value, in the variable's own unit.
    pub value: Value,
}

/// A value of one of the base types.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// Real, in the variable's own unit.
    Real(f64),
    /// Integer, or the value of an enumeration item.
    Integer(i32),
    /// Boolean
    Boolean(bool),
    /// String
    String(String),
    /// `file("x")`, to be resolved and hashed by the run.
    File(FileRef),
}

/// One variable of one instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Port {
    /// Index into [`Scenario::instances`].
    pub instance: usize,
    /// Index into the variables of the instance's unit.
    pub variable: usize,
}

/// One step of initialization; [`Scenario::initialization`] holds them in order.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum InitialStep {
    /// Computes and sets the inputs of these connections (indices into [`Scenario::connections`]), all of one instance.
    Set {
        /// The instance.
        instance: usize,
        /// The connections.
        connections: Vec<usize>,
    },
    /// Reads these variables of one instance, so that later steps can use them.
    Get {
        /// The instance.
        instance: usize,
        /// The variables.
        variables: Vec<usize>,
    },
}

/// One arrow, for one element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Connection {
    /// The driven input.
    pub target: Port,
    /// What drives it.
    pub source: Drive,
    /// Whether the source steps first (`=>`).
    pub direct: bool,
}

/// What an input or a `set` gets, in the target's own type and unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Drive {
    /// The value of another port of the same base type and unit, bit for bit.
    Copy(Port),
    /// A real, already in the target's unit.
    Real(RealExpression),
    /// An integer or the value of an enumeration item.
    Integer(i32),
    /// A condition.
    Boolean(BooleanExpression),
    /// A text.
    String(String),
    /// A number, an item's value or a Boolean (0 or 1) over time.
    Curve(Curve),
}

/// A real value. Signals are read raw, in their variable's own unit; [`RealExpression::Affine`] and its inverse
/// convert them to SI and back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum RealExpression {
    /// A number.
    Constant(f64),
    /// A Real port, or an Integer port widened.
    Signal(Port),
    /// Seconds since the start, tick × step.
    Time,
    /// `factor * x + offset`
    Affine {
        /// The value.
        of: Box<RealExpression>,
        /// Multiplied first.
        factor: f64,
        /// Added then.
        offset: f64,
    },
    /// `(x - offset) / factor`
    InverseAffine {
        /// The value.
        of: Box<RealExpression>,
        /// Divided by last.
        factor: f64,
        /// Subtracted first.
        offset: f64,
    },
    /// `-x`
    Negate(Box<RealExpression>),
    /// `a + b`
    Add(Box<RealExpression>, Box<RealExpression>),
    /// `a - b`
    Subtract(Box<RealExpression>, Box<RealExpression>),
    /// `a * b`
    Multiply(Box<RealExpression>, Box<RealExpression>),
    /// `a / b`
    Divide(Box<RealExpression>, Box<RealExpression>),
    /// A function of its arguments.
    Call(Function, Vec<RealExpression>),
    /// Index into [`Scenario::shared`].
    Shared(usize),
    /// A value over time.
    Curve(Arc<Curve>),
    /// The least distance of a value from a curve within a time.
    Near(Near),
    /// A summary of the samples so far; in a finished scenario it stands in [`Scenario::shared`] only.
    Running(Running),
    /// 1 where a condition holds, else 0.
    Truth(Box<BooleanExpression>),
}

/// The functions with a real value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Function {
    /// Magnitude of one argument.
    Abs,
    /// Smallest argument; NaN if any is.
    Min,
    /// Largest argument; NaN if any is.
    Max,
    /// Sum from left to right.
    Sum,
    /// Sum over count.
    Mean,
    /// Square root.
    Sqrt,
    /// Exponential.
    Exp,
    /// Natural logarithm.
    Log,
    /// Largest integer not above.
    Floor,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Angle of (y, x).
    Atan2,
    /// Euclidean length of the arguments.
    Norm,
}

impl Function {
    /// The value for these arguments, to the bit what a run computes.
    #[must_use]
    pub fn apply(self, arguments: &[f64]) -> f64 {
        let first = arguments.first().copied().unwrap_or(f64::NAN);
        let sum = || arguments.iter().skip(1).fold(first, |sum, argument| sum + argument);
        let pick = |better: fn(f64, f64) -> f64| arguments.iter().skip(1).fold(first, |best, &x| better(best, x));
        let count = arguments.len() as f64;
        match self {
            Self::Abs => first.abs(),
            Self::Min => pick(smaller),
            Self::Max => pick(larger),
            Self::Sum => sum(),
            Self::Mean => sum() / count,
            Self::Sqrt => first.sqrt(),
            Self::Exp => libm::exp(first),
            Self::Log => libm::log(first),
            Self::Floor => first.floor(),
            Self::Sin => libm::sin(first),
            Self::Cos => libm::cos(first),
            Self::Tan => libm::tan(first),
            Self::Atan2 => libm::atan2(first, arguments.get(1).copied().unwrap_or(f64::NAN)),
            Self::Norm => arguments.iter().fold(0.0, |sum, x| sum + x * x).sqrt(),
        }
    }
}

/// The smaller of two numbers, the first where both are equal; NaN if one is.
#[inline]
#[must_use]
pub fn smaller(a: f64, b: f64) -> f64 {
    if b.is_nan() || b < a { b } else { a }
}

/// The larger of two numbers, the first where both are equal; NaN if one is.
#[inline]
#[must_use]
pub fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() || b > a { b } else { a }
}

/// A condition. A comparison with a NaN operand is false.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum BooleanExpression {
    /// `true`, `false`
    Constant(bool),
    /// A Boolean port.
    Signal(Port),
    /// `margin > 0`, or `margin >= 0` unless strict.
    Margin(Margin),
    /// Two Integer, Boolean or String operands are equal.
    Same(Operand, Operand),
    /// Slot of [`Scenario::conditions`]: holds now and did not at the sample before.
    Rises(usize),
    /// `not a`
    Not(Box<BooleanExpression>),
    /// All hold.
    And(Vec<BooleanExpression>),
    /// At least one holds.
    Or(Vec<BooleanExpression>),
}

/// An operand of `==` between discrete values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Operand {
    /// A port of Integer, Enumeration, Boolean or String type.
    Signal(Port),
    /// A value written in the script.
    Constant(Value),
}

/// A comparison of reals as the distance from its limit, positive where it holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Margin {
    /// `x - c` for `x > c`, `c - x` for `x < c`, `d - |x - c|` for `x == c ± d`; SI.
    pub value: RealExpression,
    /// Whether zero fails.
    pub strict: bool,
}

/// One column of the trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// `instance.variable`, or the name of a `let`.
    pub name: String,
    /// What it shows.
    pub source: ColumnSource,
    /// Its period in ticks.
    pub every: u64,
    /// The first tick with a value; before it its cells are empty.
    pub from_tick: u64,
}

/// What a column shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ColumnSource {
    /// The value of a port, as its unit has it.
    Port(Port),
    /// A real `let`.
    Real {
        /// The value, in the unit of measure in which it is shown.
        value: RealExpression,
        /// That unit; empty for plain numbers.
        unit: String,
    },
    /// A Boolean `let`, as 0 or 1.
    Condition(BooleanExpression),
}

impl Column {
    /// A column that shows a port at each tick.
    #[must_use]
    pub fn of_port(name: impl Into<String>, port: Port) -> Self {
        Self { name: name.into(), source: ColumnSource::Port(port), every: 1, from_tick: 0 }
    }

    /// The port, unless it shows a `let`.
    #[must_use]
    pub fn port(&self) -> Option<Port> {
        match self.source {
            ColumnSource::Port(port) => Some(port),
            ColumnSource::Real { .. } | ColumnSource::Condition(_) => None,
        }
    }

    /// Visits each port that a `let` is computed from.
    pub fn reads(&self, slots: Slots<'_>, visit: &mut dyn FnMut(Port)) {
        match &self.source {
            ColumnSource::Port(_) => {}
            ColumnSource::Real { value, .. } => value.reads(slots, visit),
            ColumnSource::Condition(condition) => condition.reads(slots, visit),
        }
    }
}
