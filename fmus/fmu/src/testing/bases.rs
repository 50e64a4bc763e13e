//! Values of inputs and parameters before initialization, from which a test changes one at a time.

use super::subject::Subject;
use crate::library::Unit;
use crate::visitor::Value;
use fmi2::description::{Causality, Kind};
use models::random::Generator;

/// Number of bases with random values.
const RANDOM: u64 = 200;

/// From what a test starts.
pub(super) struct Base {
    /// The unit before initialization.
    pub(super) unit: Box<dyn Unit>,
    /// The start of the run, in seconds.
    pub(super) start_s: f64,
}

/// The unit before initialization: with start values; with changed inputs; with these and one changed parameter that is
/// not Real; with random values of everything, at random times of its experiment.
pub(super) fn bases(subject: &mut Subject, start: &dyn Unit) -> Vec<Base> {
    let at_0 = |subject: &Subject| Base { unit: subject.save(), start_s: 0.0 };
    let inputs = subject.variables(|variable| variable.causality == Causality::Input);
    let choices = subject
        .variables(|variable| variable.causality == Causality::Parameter && !matches!(variable.kind, Kind::Real(_)));
    subject.restore(start);
    let mut bases = vec![at_0(subject)];
    for input in inputs {
        if let Some(moved) = subject.others(input).last() {
            subject.set(input, moved);
        }
    }
    let moved = at_0(subject);
    for choice in choices {
        for other in subject.others(choice) {
            subject.restore(&*moved.unit);
            subject.set(choice, &other);
            bases.push(at_0(subject));
        }
        subject.restore(&*moved.unit);
    }
    bases.push(moved);
    for seed in 0..RANDOM {
        subject.restore(start);
        let mut generator = Generator::new(seed, 0);
        for known in subject.variables(|variable| variable.has_start()) {
            let value = any_value(subject, known, &mut generator);
            subject.set(known, &value);
        }
        bases.push(Base { unit: subject.save(), start_s: subject.stop_s * generator.uniform() });
    }
    bases
}

/// A random value within the limits of a variable: a Real or Integer of the size of its start value, or of its nominal
/// value.
fn any_value(subject: &Subject, variable: usize, generator: &mut Generator) -> Value {
    let described = &subject.description().variables[variable];
    let present = subject.get(variable);
    match (&present, &described.kind) {
        (Value::Real(start), Kind::Real(real)) => {
            let size = if *start == 0.0 { real.nominal.unwrap_or(1.0) } else { *start };
            let (min, max) = (real.min.unwrap_or(f64::MIN), real.max.unwrap_or(f64::MAX));
            // What cannot be negative keeps its order of magnitude.
            let least = if min >= 0.0 { 0.3 } else { -1.0 };
            Value::Real((size * (least + (2.0 - least) * generator.uniform())).clamp(min, max))
        }
        (Value::Integer(_), Kind::Enumeration { .. }) => {
            let items = subject.description().items_of(described);
            items.get(below(items.len(), generator)).map_or(present, |item| Value::Integer(item.value))
        }
        (Value::Integer(start), Kind::Integer { min, max, .. }) => {
            let near = i32::try_from(below(20, generator)).unwrap_or(0) - 10;
            Value::Integer(start.saturating_add(near).clamp(min.unwrap_or(i32::MIN), max.unwrap_or(i32::MAX)))
        }
        (Value::Boolean(_), _) => Value::Boolean(generator.uniform() < 0.5),
        _ => present,
    }
}

/// A random index of a list of this length.
pub(super) fn below(length: usize, generator: &mut Generator) -> usize {
    usize::try_from(generator.next_u64() % length.max(1) as u64).unwrap_or(0)
}
