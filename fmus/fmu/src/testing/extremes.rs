//! Checks that a unit answers extreme values with outputs or with a fault, never with a panic.

use super::Findings;
use super::bases::below;
use super::subject::Subject;
use crate::instance::panic_text;
use crate::library::Library;
use crate::visitor::Value;
use fmi2::description::{Causality, Kind};
use models::random::Generator;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Number of runs.
const RUNS: u64 = 200;
/// Steps of each run, each with other inputs.
const STEPS: u32 = 3;
/// What a Real is set to, as far as its limits allow; all are finite.
const REALS: [f64; 9] = [0.0, 1e-300, 1e-3, -1.0, 1e5, -1e5, 1e150, f64::MAX, f64::MIN];

/// Checks that the unit does not panic at any values within their limits. The export layer makes an output that is not
/// finite a fault, so what remains is that finite values give finite outputs or a fault.
///
/// # Errors
///
/// The values at which it panicked, with the message of the panic.
pub fn finite_values_give_finite_outputs_or_a_fault(library: &'static Library) -> Result<(), Findings> {
    let mut found = Vec::new();
    for run in 0..RUNS {
        let mut subject = Subject::new(library);
        let mut generator = Generator::new(run, 1);
        let answered = catch_unwind(AssertUnwindSafe(|| run_once(&mut subject, &mut generator)));
        if let Err(panic) = answered {
            let set = subject.variables(|variable| variable.has_start()).into_iter();
            let values = set.map(|known| format!("{} = {:?}", subject.name(known), subject.get(known)));
            found.push(format!("it panics: {}, with {}", panic_text(&*panic), values.collect::<Vec<_>>().join(", ")));
            break;
        }
    }
    Findings::none_or(found)
}

/// Sets some variables to extreme values, initializes and makes steps with other inputs, up to the first fault.
fn run_once(subject: &mut Subject, generator: &mut Generator) {
    let knowns = subject.variables(|variable| variable.has_start());
    // Some runs change few values, so that not every run ends with a fault at the start.
    let share = generator.uniform();
    for known in knowns {
        if generator.uniform() < share {
            set_extreme(subject, known, generator);
        }
    }
    if subject.init(0.0).is_err() {
        return;
    }
    let inputs = subject.variables(|variable| variable.causality == Causality::Input);
    for n in 0..STEPS {
        for &input in &inputs {
            set_extreme(subject, input, generator);
        }
        if subject.step(f64::from(n) * subject.step_s, subject.step_s).is_err() {
            return;
        }
    }
}

fn set_extreme(subject: &mut Subject, variable: usize, generator: &mut Generator) {
    let described = &subject.description().variables[variable];
    let mut index = |length: usize| below(length, generator);
    let value = match &described.kind {
        Kind::Real(real) => {
            let wanted = REALS[index(REALS.len())];
            Value::Real(wanted.clamp(real.min.unwrap_or(f64::MIN), real.max.unwrap_or(f64::MAX)))
        }
        Kind::Integer { min, max, .. } => {
            let wanted = [0, 1, -1, i32::MIN, i32::MAX][index(5)];
            Value::Integer(wanted.clamp(min.unwrap_or(i32::MIN), max.unwrap_or(i32::MAX)))
        }
        Kind::Enumeration { .. } => {
            let items = subject.description().items_of(described);
            let Some(item) = items.get(index(items.len())) else { return };
            Value::Integer(item.value)
        }
        Kind::Boolean { .. } => Value::Boolean(index(2) == 1),
        Kind::String { .. } => return,
    };
    subject.set(variable, &value);
}
