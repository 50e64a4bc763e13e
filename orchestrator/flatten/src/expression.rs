//! Expressions of the script as flat programs for a small stack machine.
//!
//! Conditions run on the same stack, where true is 1 and false is 0. The caller owns the stack and uses it for all
//! programs, so evaluating one allocates nothing. Next on the walk: `wiring.rs`, which assigns the slots that programs read.

mod compile;
pub use compile::SlotOf;
#[cfg(test)]
mod tests;

use crate::values::Values;
use dsl::scenario::{Curve, Function};
use std::sync::Arc;

/// What a program reads: the state of a run at one time.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// The outputs of all instances.
    pub outputs: &'a Values,
    /// Seconds since the start.
    pub time_s: f64,
    /// For each condition of `Scenario::conditions` whether it holds now and did not hold at the sample before.
    pub rises: &'a [bool],
    /// The values of `Scenario::shared` that programs use, computed from the same outputs.
    pub shared: &'a [f64],
}

/// Computes these shared expressions, given in their order: one may use those before it.
pub fn evaluate_shared(
    programs: &[Program],
    slots: impl IntoIterator<Item = usize>,
    (outputs, time_s): (&Values, f64),
    stack: &mut Stack,
    values: &mut [f64],
) {
    for slot in slots {
        values[slot] = programs[slot].real(&Moment { outputs, time_s, rises: &[], shared: values }, stack);
    }
}

/// A compiled expression.
#[derive(Clone, Debug)]
pub struct Program {
    operations: Box<[Operation]>,
    depth: usize,
}

/// The values that programs work on. It grows for a program that is deeper than usual and keeps that size.
#[derive(Clone, Debug)]
pub struct Stack(Vec<f64>);

impl Default for Stack {
    fn default() -> Self {
        Self(vec![0.0; 64])
    }
}

/// One operation; operands are the topmost values of the stack.
#[derive(Clone, Debug, PartialEq)]
enum Operation {
    Push(f64),
    Time,
    Real(u32),
    Integer(u32),
    Boolean(u32),
    Rises(u32),
    Shared(u32),
    Affine {
        factor: f64,
        offset: f64,
    },
    InverseAffine {
        factor: f64,
        offset: f64,
    },
    /// A function of so many values.
    Call(Function, u32),
    Unary(Unary),
    Binary(Binary),
    SameText(Box<(Text, Text)>),
    Curve(Arc<Curve>),
    /// The distance from a curve within so many seconds.
    Near(Arc<Curve>, f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Unary {
    Negate,
    Not,
    Positive,
    NotNegative,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Equal,
    And,
    Or,
}

#[derive(Clone, Debug, PartialEq)]
enum Text {
    Slot(u32),
    Constant(String),
}

impl Program {
    /// The number of values on the stack that it needs.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// The value at a moment.
    pub fn real(&self, moment: &Moment<'_>, stack: &mut Stack) -> f64 {
        if stack.0.len() < self.depth {
            stack.0.resize(self.depth, 0.0);
        }
        let stack = stack.0.as_mut_slice();
        let outputs = moment.outputs;
        let mut depth = 0;
        for operation in &self.operations {
            let pushed = match *operation {
                Operation::Push(value) => value,
                Operation::Time => moment.time_s,
                Operation::Real(index) => outputs.reals[index as usize],
                Operation::Integer(index) => f64::from(outputs.integers[index as usize]),
                Operation::Boolean(index) => truth(outputs.booleans[index as usize] != 0),
                Operation::Rises(index) => truth(moment.rises[index as usize]),
                Operation::Shared(index) => moment.shared[index as usize],
                Operation::Curve(ref curve) => curve.at(moment.time_s),
                Operation::SameText(ref texts) => truth(texts.0.read(outputs) == texts.1.read(outputs)),
                Operation::Affine { factor, offset } => {
                    depth -= 1;
                    factor * stack[depth] + offset
                }
                Operation::Near(ref curve, within_s) => {
                    depth -= 1;
                    let [from_s, to_s] = [moment.time_s - within_s, moment.time_s + within_s];
                    curve.least_distance(stack[depth], [from_s, to_s])
                }
                Operation::InverseAffine { factor, offset } => {
                    depth -= 1;
                    (stack[depth] - offset) / factor
                }
                Operation::Call(function, arguments) => {
                    let end = depth;
                    depth -= arguments as usize;
                    function.apply(&stack[depth..end])
                }
                Operation::Unary(function) => {
                    depth -= 1;
                    function.apply(stack[depth])
                }
                Operation::Binary(function) => {
                    depth -= 2;
                    function.apply(stack[depth], stack[depth + 1])
                }
            };
            stack[depth] = pushed;
            depth += 1;
        }
        stack[0]
    }

    /// The shared expressions that it uses.
    pub fn shared(&self) -> impl Iterator<Item = usize> + '_ {
        self.operations.iter().filter_map(|operation| match operation {
            Operation::Shared(slot) => Some(*slot as usize),
            _ => None,
        })
    }

    /// Whether the condition holds at a moment.
    pub fn holds(&self, moment: &Moment<'_>, stack: &mut Stack) -> bool {
        self.real(moment, stack) != 0.0
    }
}

impl Unary {
    fn apply(self, x: f64) -> f64 {
        match self {
            Self::Negate => -x,
            Self::Not => truth(x == 0.0),
            Self::Positive => truth(x > 0.0),
            Self::NotNegative => truth(x >= 0.0),
        }
    }
}

impl Binary {
    fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Equal => truth(a == b),
            Self::And => truth(a != 0.0 && b != 0.0),
            Self::Or => truth(a != 0.0 || b != 0.0),
        }
    }
}

impl Text {
    fn read<'a>(&'a self, outputs: &'a Values) -> &'a str {
        match self {
            Self::Slot(index) => &outputs.texts[*index as usize],
            Self::Constant(text) => text,
        }
    }
}

fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}
