//! The comparisons of a claim as pictures show them: quantities computed from recorded columns, and their limits.

use dsl::scenario::{
    BooleanExpression, Claim, Column, ColumnSource, Formula, Function, Margin, Port, RealExpression, Scenario,
    TickWindow,
};
use results::comparison::{Comparison, Operation, Quantity};
use unit::time::seconds;

/// A quantity of more parts is not written: no picture would explain it.
const MOST_PARTS: usize = 200;

/// The comparisons of a claim whose signals are recorded, in the order of its parts. Gates are left out: they limit
/// nothing.
#[must_use]
pub fn comparisons(claim: &Claim, scenario: &Scenario) -> Vec<Comparison> {
    let mut writer = Writer { claim, scenario, part: 0, comparisons: Vec::new() };
    writer.formula(&claim.formula, Counting::AT_START);
    writer.comparisons
}

/// When an atom counts, and whether it does at all.
#[derive(Clone, Copy)]
struct Counting {
    window: TickWindow,
    /// A gate is only a condition for something else.
    in_gate: bool,
    /// One sample is enough.
    once: bool,
}

impl Counting {
    const AT_START: Self = Self { window: TickWindow { from: 0, to: Some(0) }, in_gate: false, once: false };

    fn within(self, window: TickWindow) -> Self {
        let from = self.window.from.saturating_add(window.from);
        let to = self.window.to.zip(window.to).map(|(outer, inner)| outer.saturating_add(inner));
        Self { window: TickWindow { from, to }, ..self }
    }

    fn gate(self) -> Self {
        Self { in_gate: true, ..self }
    }
}

/// The sides of a comparison that are constants, in SI.
#[derive(Clone, Copy, Default)]
struct Limits {
    low: Option<f64>,
    high: Option<f64>,
    /// No side is a constant: what is compared is the margin, with zero.
    of_margin: bool,
}

impl Limits {
    fn at_least(low: f64) -> Self {
        Self { low: Some(low), ..Self::default() }
    }

    fn at_most(high: f64) -> Self {
        Self { high: Some(high), ..Self::default() }
    }

    fn about(middle: f64, distance: f64) -> Self {
        Self { low: Some(middle - distance), high: Some(middle + distance), of_margin: false }
    }
}

struct Writer<'a> {
    claim: &'a Claim,
    scenario: &'a Scenario,
    part: usize,
    comparisons: Vec<Comparison>,
}

impl Writer<'_> {
    /// Visits the atoms in the order of the claim's parts.
    fn formula(&mut self, formula: &Formula, counting: Counting) {
        match formula {
            Formula::Margin(margin) => {
                if !counting.in_gate {
                    self.margin(margin, counting);
                }
                self.part += 1;
            }
            Formula::Condition(_) => self.part += 1,
            Formula::And(parts) | Formula::Or(parts) => parts.iter().for_each(|part| self.formula(part, counting)),
            Formula::Always(window, body) => self.formula(body, counting.within(*window)),
            Formula::Eventually(window, body) => {
                self.formula(body, Counting { once: true, ..counting.within(*window) });
            }
            Formula::Gated(gated) => {
                self.formula(&gated.gate, counting.gate());
                self.formula(&gated.body, counting);
            }
            Formula::Until(until) => {
                self.formula(&until.gate, counting.gate());
                self.formula(&until.body, counting.within(TickWindow { from: 0, to: until.window.to }));
            }
            Formula::Finally(body) => {
                let last = self.scenario.stop_tick;
                self.formula(body, Counting { window: TickWindow { from: last, to: None }, ..counting });
            }
        }
    }

    fn margin(&mut self, margin: &Margin, counting: Counting) {
        let mut sides = Vec::new();
        split(&margin.value, false, &mut sides);
        for (compared, limits) in sides {
            if let Some(comparison) = self.comparison(&compared, limits, counting) {
                self.comparisons.push(comparison);
            }
        }
    }

    fn comparison(&self, compared: &RealExpression, limits: Limits, counting: Counting) -> Option<Comparison> {
        let (quantity, unit, limits) = match self.own_scale(compared) {
            // Limits in the unit of the column: si = factor * own + offset
            Some((name, factor, offset)) => {
                let own = |limit: f64| (limit - offset) / factor;
                let (low, high) = (limits.low.map(own), limits.high.map(own));
                let (low, high) = if factor < 0.0 { (high, low) } else { (low, high) };
                (Quantity::Column { column: name.to_owned() }, None, Limits { low, high, ..limits })
            }
            None => {
                let quantity = self.quantity(compared, &mut { MOST_PARTS })?;
                let unit = self.claim.unit.as_ref();
                let factor = unit.map_or(1.0, |unit| unit.factor);
                let shown = |limit: f64| limit / factor;
                let quantity = match factor {
                    1.0 => quantity,
                    _ => Quantity::call(Operation::Divide, vec![quantity, Quantity::Constant(factor)]),
                };
                let unit = unit.map(|unit| unit.name.clone()).filter(|name| !name.is_empty());
                (quantity, unit, Limits { low: limits.low.map(shown), high: limits.high.map(shown), ..limits })
            }
        };
        let at = |tick: u64| seconds(tick, self.scenario.step_ns);
        let is_known =
            !quantity.columns().is_empty() && [limits.low, limits.high].iter().flatten().all(|x| x.is_finite());
        is_known.then(|| Comparison {
            text: self.claim.parts.get(self.part).map(|part| part.text.clone()).unwrap_or_default(),
            part: self.part,
            quantity,
            is_margin: limits.of_margin,
            unit,
            low: limits.low,
            high: limits.high,
            once: counting.once,
            from_s: at(counting.window.from),
            to_s: counting.window.to.filter(|&to| to < self.scenario.stop_tick).map(at),
        })
    }

    /// A column that alone is the expression, with the factor and the offset that convert it to SI.
    fn own_scale(&self, expression: &RealExpression) -> Option<(&str, f64, f64)> {
        match expression {
            RealExpression::Signal(port) => Some((self.column_of(*port)?, 1.0, 0.0)),
            RealExpression::Affine { of, factor, offset } => {
                let (name, inner_factor, inner_offset) = self.own_scale(of)?;
                Some((name, factor * inner_factor, factor * inner_offset + offset))
            }
            RealExpression::InverseAffine { of, factor, offset } => {
                let (name, inner_factor, inner_offset) = self.own_scale(of)?;
                Some((name, inner_factor / factor, (inner_offset - offset) / factor))
            }
            RealExpression::Shared(slot) => {
                self.recorded_let(*slot).or_else(|| self.own_scale(self.scenario.shared.get(*slot)?))
            }
            _ => None,
        }
        .filter(|(_, factor, _)| *factor != 0.0)
    }

    fn column_of(&self, port: Port) -> Option<&str> {
        let shows = |column: &&Column| column.port() == Some(port);
        self.scenario.columns.iter().find(shows).map(|column| column.name.as_str())
    }

    /// The column of a `let` that shows a shared expression.
    fn recorded_let(&self, slot: usize) -> Option<(&str, f64, f64)> {
        self.scenario.columns.iter().find_map(|column| match &column.source {
            ColumnSource::Real { value: RealExpression::Shared(shown), .. } if *shown == slot => {
                Some((column.name.as_str(), 1.0, 0.0))
            }
            ColumnSource::Real { value: RealExpression::InverseAffine { of, factor, offset }, .. }
                if **of == RealExpression::Shared(slot) =>
            {
                Some((column.name.as_str(), *factor, *offset))
            }
            _ => None,
        })
    }

    /// The expression over columns; `None` where a signal is not recorded, or the samples before count too.
    fn quantity(&self, expression: &RealExpression, left: &mut usize) -> Option<Quantity> {
        use RealExpression as E;
        *left = left.checked_sub(1)?;
        let mut pair = |call: Operation, a: &E, b: &E| {
            Some(Quantity::call(call, vec![self.quantity(a, left)?, self.quantity(b, left)?]))
        };
        match expression {
            E::Constant(value) => value.is_finite().then_some(Quantity::Constant(*value)),
            E::Signal(port) => Some(Quantity::Column { column: self.column_of(*port)?.to_owned() }),
            E::Time => Some(Quantity::call(Operation::Time, Vec::new())),
            E::Affine { of, factor, offset } => {
                let of = self.quantity(of, left)?;
                Some(scaled(of, *factor, *offset))
            }
            E::InverseAffine { of, factor, offset } => {
                let shifted =
                    Quantity::call(Operation::Subtract, vec![self.quantity(of, left)?, Quantity::Constant(*offset)]);
                Some(Quantity::call(Operation::Divide, vec![shifted, Quantity::Constant(*factor)]))
            }
            E::Negate(of) => pair(Operation::Subtract, &E::Constant(0.0), of),
            E::Add(a, b) => pair(Operation::Sum, a, b),
            E::Subtract(a, b) => pair(Operation::Subtract, a, b),
            E::Multiply(a, b) => pair(Operation::Multiply, a, b),
            E::Divide(a, b) => pair(Operation::Divide, a, b),
            E::Call(function, arguments) => {
                let of = arguments.iter().map(|argument| self.quantity(argument, left));
                Some(Quantity::call(operation(*function), of.collect::<Option<_>>()?))
            }
            E::Shared(slot) => match self.recorded_let(*slot) {
                Some((name, factor, offset)) => {
                    Some(scaled(Quantity::Column { column: name.to_owned() }, factor, offset))
                }
                None => self.quantity(self.scenario.shared.get(*slot)?, left),
            },
            E::Curve(_) | E::Near(_) | E::Running(_) => None,
            E::Truth(condition) => match &**condition {
                BooleanExpression::Signal(port) => Some(Quantity::Column { column: self.column_of(*port)?.to_owned() }),
                _ => None,
            },
        }
    }
}

/// `factor * of + offset`
fn scaled(of: Quantity, factor: f64, offset: f64) -> Quantity {
    let product = match factor {
        1.0 => of,
        _ => Quantity::call(Operation::Multiply, vec![Quantity::Constant(factor), of]),
    };
    match offset {
        0.0 => product,
        _ => Quantity::call(Operation::Sum, vec![product, Quantity::Constant(offset)]),
    }
}

/// What a margin compares with which limits: `max(|a|, |b|) < c` limits `a` and `b` on both sides. A margin without a
/// constant is compared with zero.
fn split(value: &RealExpression, negated: bool, sides: &mut Vec<(RealExpression, Limits)>) {
    use RealExpression as E;
    match value {
        E::Negate(of) => split(of, !negated, sides),
        E::Subtract(a, b) => match (&**a, &**b) {
            (compared, E::Constant(limit)) => bounded(compared, *limit, !negated, sides),
            (E::Constant(limit), compared) => bounded(compared, *limit, negated, sides),
            _ => sides.push((value.clone(), beside_zero(negated))),
        },
        _ => sides.push((value.clone(), beside_zero(negated))),
    }
}

fn beside_zero(negated: bool) -> Limits {
    let limits = if negated { Limits::at_most(0.0) } else { Limits::at_least(0.0) };
    Limits { of_margin: true, ..limits }
}

/// `compared` above a limit, or below it.
fn bounded(compared: &RealExpression, limit: f64, above: bool, sides: &mut Vec<(RealExpression, Limits)>) {
    use RealExpression as E;
    match compared {
        E::Call(Function::Max, arguments) if !above => {
            arguments.iter().for_each(|argument| bounded(argument, limit, above, sides));
        }
        E::Call(Function::Min, arguments) if above => {
            arguments.iter().for_each(|argument| bounded(argument, limit, above, sides));
        }
        E::Call(Function::Abs, arguments) if !above => match arguments.as_slice() {
            [E::Subtract(a, b)] => match (&**a, &**b) {
                (of, E::Constant(middle)) | (E::Constant(middle), of) => {
                    sides.push((of.clone(), Limits::about(*middle, limit)));
                }
                _ => sides.push((E::Subtract(a.clone(), b.clone()), Limits::about(0.0, limit))),
            },
            [of] => sides.push((of.clone(), Limits::about(0.0, limit))),
            _ => {}
        },
        of if above => sides.push((of.clone(), Limits::at_least(limit))),
        of => sides.push((of.clone(), Limits::at_most(limit))),
    }
}

fn operation(function: Function) -> Operation {
    match function {
        Function::Abs => Operation::Abs,
        Function::Min => Operation::Min,
        Function::Max => Operation::Max,
        Function::Sum => Operation::Sum,
        Function::Mean => Operation::Mean,
        Function::Sqrt => Operation::Sqrt,
        Function::Exp => Operation::Exp,
        Function::Log => Operation::Log,
        Function::Floor => Operation::Floor,
        Function::Sin => Operation::Sin,
        Function::Cos => Operation::Cos,
        Function::Tan => Operation::Tan,
        Function::Atan2 => Operation::Atan2,
        Function::Norm => Operation::Norm,
    }
}

#[cfg(test)]
mod tests;
