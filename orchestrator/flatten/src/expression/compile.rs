//! Compiles expressions to programs.

use super::{Binary, Operation, Program, Text, Unary};
use crate::values::{Slot, ValueType};
use dsl::scenario::{BooleanExpression, Curve, Function, Margin, Near, Operand, Port, RealExpression, Value};
use std::sync::Arc;

/// Returns the slot of a port; called for every signal of an expression.
pub type SlotOf<'a> = dyn FnMut(Port) -> Slot + 'a;

impl Program {
    /// Compiles a real expression.
    pub fn compile_real(expression: &RealExpression, slot_of: &mut SlotOf<'_>) -> Self {
        Self::compile(|compiler| compiler.real(expression), slot_of)
    }

    /// Compiles a condition.
    pub fn compile_condition(condition: &BooleanExpression, slot_of: &mut SlotOf<'_>) -> Self {
        Self::compile(|compiler| compiler.condition(condition), slot_of)
    }

    /// Compiles the reading of one number: a Real, Integer, Enumeration or Boolean.
    pub fn compile_signal(port: Port, slot_of: &mut SlotOf<'_>) -> Self {
        Self::compile(|compiler| compiler.signal(port), slot_of)
    }

    /// The value of a curve over time.
    #[must_use]
    pub fn curve(curve: &Curve) -> Self {
        Self { operations: [Operation::Curve(Arc::new(curve.clone()))].into(), depth: 1 }
    }

    fn compile(write: impl FnOnce(&mut Compiler<'_, '_>), slot_of: &mut SlotOf<'_>) -> Self {
        let mut compiler = Compiler { slot_of, operations: Vec::new(), depth: 0, deepest: 0 };
        write(&mut compiler);
        assert_eq!(compiler.depth, 1, "an expression leaves one value on the stack");
        Self { operations: compiler.operations.into(), depth: compiler.deepest }
    }
}

struct Compiler<'a, 'p> {
    slot_of: &'a mut SlotOf<'p>,
    operations: Vec<Operation>,
    depth: usize,
    deepest: usize,
}

impl Compiler<'_, '_> {
    fn push(&mut self, operation: Operation) {
        self.operations.push(operation);
        self.depth += 1;
        self.deepest = self.deepest.max(self.depth);
    }

    fn unary(&mut self, function: Unary) {
        self.operations.push(Operation::Unary(function));
    }

    fn binary(&mut self, function: Binary) {
        self.operations.push(Operation::Binary(function));
        self.depth -= 1;
    }

    fn signal(&mut self, port: Port) {
        let slot = (self.slot_of)(port);
        let index = index(slot);
        self.push(match slot.base {
            ValueType::Real => Operation::Real(index),
            ValueType::Integer => Operation::Integer(index),
            ValueType::Boolean => Operation::Boolean(index),
            ValueType::Text => unreachable!("a text was resolved where a number is needed"),
        });
    }

    fn real(&mut self, expression: &RealExpression) {
        use RealExpression as E;
        match expression {
            E::Constant(value) => self.push(Operation::Push(*value)),
            E::Signal(port) => self.signal(*port),
            E::Time => self.push(Operation::Time),
            E::Affine { of, factor, offset } => {
                self.real(of);
                self.operations.push(Operation::Affine { factor: *factor, offset: *offset });
            }
            E::InverseAffine { of, factor, offset } => {
                self.real(of);
                self.operations.push(Operation::InverseAffine { factor: *factor, offset: *offset });
            }
            E::Negate(of) => {
                self.real(of);
                self.unary(Unary::Negate);
            }
            E::Add(a, b) => self.pair(a, b, Binary::Add),
            E::Subtract(a, b) => self.pair(a, b, Binary::Subtract),
            E::Multiply(a, b) => self.pair(a, b, Binary::Multiply),
            E::Divide(a, b) => self.pair(a, b, Binary::Divide),
            E::Curve(curve) => self.push(Operation::Curve(Arc::clone(curve))),
            E::Near(Near { of, curve, within_s }) => {
                self.real(of);
                self.operations.push(Operation::Near(Arc::clone(curve), *within_s));
            }
            E::Shared(slot) => self.push(Operation::Shared(u32::try_from(*slot).unwrap_or(u32::MAX))),
            E::Call(function, arguments) => self.call(*function, arguments),
            // A run sums up the samples that this gives: `running.rs`.
            E::Running(running) => self.real(&running.of),
            E::Truth(condition) => self.condition(condition),
        }
    }

    fn pair(&mut self, a: &RealExpression, b: &RealExpression, function: Binary) {
        self.real(a);
        self.real(b);
        self.binary(function);
    }

    fn call(&mut self, function: Function, arguments: &[RealExpression]) {
        assert!(!arguments.is_empty(), "a function was resolved without arguments");
        for argument in arguments {
            self.real(argument);
        }
        let count = u32::try_from(arguments.len()).unwrap_or(u32::MAX);
        self.operations.push(Operation::Call(function, count));
        self.depth -= arguments.len() - 1;
    }

    fn condition(&mut self, condition: &BooleanExpression) {
        use BooleanExpression as B;
        match condition {
            B::Constant(holds) => self.push(Operation::Push(super::truth(*holds))),
            B::Signal(port) => self.signal(*port),
            B::Margin(Margin { value, strict }) => {
                self.real(value);
                self.unary(if *strict { Unary::Positive } else { Unary::NotNegative });
            }
            B::Same(a, b) => self.same(a, b),
            B::Rises(slot) => self.push(Operation::Rises(u32::try_from(*slot).unwrap_or(u32::MAX))),
            B::Not(of) => {
                self.condition(of);
                self.unary(Unary::Not);
            }
            B::And(all) => self.join(all, true, Binary::And),
            B::Or(any) => self.join(any, false, Binary::Or),
        }
    }

    fn join(&mut self, conditions: &[BooleanExpression], if_empty: bool, join: Binary) {
        if conditions.is_empty() {
            self.push(Operation::Push(super::truth(if_empty)));
        }
        for (position, condition) in conditions.iter().enumerate() {
            self.condition(condition);
            if position > 0 {
                self.binary(join);
            }
        }
    }

    fn same(&mut self, a: &Operand, b: &Operand) {
        if let (Some(a), Some(b)) = (self.text(a), self.text(b)) {
            return self.push(Operation::SameText(Box::new((a, b))));
        }
        self.number(a);
        self.number(b);
        self.binary(Binary::Equal);
    }

    fn text(&mut self, operand: &Operand) -> Option<Text> {
        match operand {
            Operand::Constant(Value::String(text)) => Some(Text::Constant(text.clone())),
            Operand::Constant(Value::File(file)) => Some(Text::Constant(file.path.clone())),
            Operand::Constant(_) => None,
            Operand::Signal(port) => {
                let slot = (self.slot_of)(*port);
                (slot.base == ValueType::Text).then(|| Text::Slot(index(slot)))
            }
        }
    }

    fn number(&mut self, operand: &Operand) {
        match operand {
            Operand::Signal(port) => self.signal(*port),
            Operand::Constant(Value::Real(value)) => self.push(Operation::Push(*value)),
            Operand::Constant(Value::Integer(value)) => self.push(Operation::Push(f64::from(*value))),
            Operand::Constant(Value::Boolean(value)) => self.push(Operation::Push(super::truth(*value))),
            Operand::Constant(value) => unreachable!("{value:?} was resolved to be compared with a number"),
        }
    }
}

fn index(slot: Slot) -> u32 {
    u32::try_from(slot.index).unwrap_or_else(|_| unreachable!("a run with 2^32 values of one type"))
}
